"""A page is whole: it answers first, loads nothing, lets no stranger's text through, is the same
each time."""

from __future__ import annotations

import html
import math
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import irb2400_ctrl as irb
from irb2400_ctrl.codegen.verification import Verification
from irb2400_ctrl.report import ArmView, Colouring, Page, Provenance
from irb2400_ctrl.report.elements.glossary import WORDS
from irb2400_ctrl.report.elements.inline_svg import COLOURS
from irb2400_ctrl.report.elements.page import TEMPLATES, of_limit, sentence, show, with_error
from irb2400_ctrl.report.elements.plots import Line, joint_plots, parity, spectrum, thin
from irb2400_ctrl.report.figures.plan_figures import feed_figure
from irb2400_ctrl.report.pages.main_page import _compared

STRANGER = "<script>alert('x')</script>&\"'"


def figures(name: str = "torque {joint} [Nm]") -> list[Figure]:
    time = np.linspace(0.0, 2.0, 200)
    return joint_plots(time, [Line(np.sin(time[:, None] * [1.0, 2.0]))], name)


@cache
def page(text: str = "plain") -> Page:
    return fresh(text)


def fresh(text: str = "plain") -> Page:
    made = Page(f"Plan of {text}")
    made.answer(f"It can be driven: {text}.", "good", [("duration", "3.2 s"), (text, text)])
    for k in range(3):
        made.heading(f"Part {k} of {text}")
        made.text(f"The noise floor and the TCP of {text}.")
        made.finding(text)
        made.table(text, (text, "mass [kg]"), [[text, 1.23456], ["b", 12345.6]])
        made.figures(figures(text + " {joint}"), text, zoomable=True)
    robot = irb.load_robot("irb2400")
    time = np.linspace(0.0, 1.0, 30)
    q = np.outer(np.sin(time), np.ones(6))
    made.arm(ArmView(robot, time, q, (Colouring(text, "mm/s", time),)), text)
    made.provenance(Provenance.of(robot, [Path(__file__)], f"irb2400 plan {text}", seed=3))
    return made


def test_answer_is_the_first_thing_said() -> None:
    text = page().html()
    body = text[text.index("<main") :]
    assert body.index("It can be driven") < body.index("<nav") < body.index("<section")
    assert "3.2 s" in body[: body.index("<nav")]


def test_nothing_is_loaded_from_elsewhere() -> None:
    text = page().html()
    assert re.findall(r'(?:src|href)="(?!#|data:)[^"]*"', text) == []
    assert "http" not in re.sub(r'xmlns(:\w+)?="[^"]*"|"http://www.w3.org/2000/svg"', "", text)
    assert "@import" not in text


def test_a_strangers_text_stays_text() -> None:
    made = page(STRANGER).html()
    assert "<script>alert" not in made
    assert html.escape(STRANGER, quote=False)[:20] in made


def test_the_same_page_is_the_same_bytes() -> None:
    assert page().html() == fresh().html()
    assert not re.search(r"\b20\d\d-\d\d-\d\d", page().html())


def test_ids_are_unique_and_links_lead_somewhere() -> None:
    text = page().html()
    ids = re.findall(r'\bid="([^"]+)"', text[text.index("<main") :])
    assert len(ids) == len(set(ids))
    links = re.findall(r'href="#([^"]+)"', text) + re.findall(r"url\(#([^)]+)\)", text)
    assert set(links) <= set(ids)


def test_figures_take_the_colours_of_the_page() -> None:
    """Black letters on a black page is what a figure with colours of its own gives."""
    text = page().html()
    svgs = re.findall(r"<svg.*?</svg>", text, re.DOTALL)
    assert len(svgs) == 6
    assert not any(re.search(r"#[0-9a-fA-F]{6}\b", svg) for svg in svgs)
    css = (TEMPLATES / "page.css").read_text()
    light, dark, _ = re.findall(r":root \{(.*?)\}", css, re.DOTALL)
    for variable in set(COLOURS.values()) | {"quiet", "line", "soft"}:
        assert f"--{variable}:" in light
        assert f"--{variable}:" in dark


def test_numbers_of_a_figure_are_not_rounded_away() -> None:
    """Places are rounded, what a reader reads is not."""
    figure = Figure(figsize=(4.0, 2.0))
    axis = figure.subplots()
    axis.plot([0.0, 0.025], [0.0, 1.23456])
    axis.set_title("rms 0.11438 mm")
    axis.set_xticks([0.0, 0.0125, 0.025])
    made = Page("x")
    made.figure(figure, "c")
    for text in ("0.0125", "rms 0.11438 mm"):
        assert text in made.html()


@pytest.mark.parametrize(
    ("value", "told"),
    [
        (1.2, "1.20"), (0.3, "0.300"), (99.97, "100"), (-12345.6, "-12,346"), (0.0, "0"),
        (1.21e-5, "1.21·10⁻⁵"), (np.float64(31), "31.0"), (math.nan, "-"), (7, "7"), ("x", "x"),
    ],
)  # fmt: skip
def test_numbers_of_a_table_have_three_digits(value: object, told: str) -> None:
    assert show(value) == told


@pytest.mark.parametrize(
    ("value", "error", "told"),
    [
        (3.0801, 0.0113, "3.080 ± 0.011"),
        (1234.5, 25.0, "1,234 ± 25"),
        (0.5, 0.0, "0.500"),
        (0.5, math.inf, "0.500"),
        (2e-9, 3e-10, "2.00·10⁻⁹ ± 3.00·10⁻¹⁰"),
    ],
)
def test_a_number_has_the_digits_its_error_leaves(value: float, error: float, told: str) -> None:
    assert with_error(value, error) == told


def test_a_number_and_its_error_stay_in_one_line_of_a_table() -> None:
    page = Page("Mass")
    page.table("Masses", ["link", "mass [kg]"], [["1", with_error(3.0801, 0.0113)]])
    assert "3.080\N{NO-BREAK SPACE}±\N{NO-BREAK SPACE}0.011" in page.html()


def test_nothing_is_wider_than_a_phone() -> None:
    """What may be wide scrolls in itself: tables, wide figures; grids fall back to one column."""
    css = (TEMPLATES / "page.css").read_text()
    text = page().html()
    body = text[text.index("<main") :]
    assert body.count("<table ") == body.count('<div class="scroll"><table ') == 3
    assert body.count('<svg class="plot"') == body.count('<div class="plotbox"><svg')
    for rule in (".scroll { overflow-x: auto", ".plotbox { overflow-x: auto", "minmax(min(100%,"):
        assert rule in css
    assert not re.search(r"(?<![-\w])width: \d{3,}px", css)
    assert 'name="viewport" content="width=device-width' in text


def test_words_are_explained_where_they_are_used_first() -> None:
    text = page().html()
    assert text.count('href="#word-noise-floor"') == 1
    assert html.escape(WORDS["noise floor"]) in text
    assert "word-elbow-singularity" not in text


def test_provenance_names_command_robot_effects_hashes_and_seed() -> None:
    text = page().html()
    end = text[text.index('id="provenance"') :]
    for part in ("irb2400 plan plain", irb.__version__, "ABB IRB 2400", "none", "sha256", "seed"):
        assert part in end
    assert len(re.findall(r"\b[0-9a-f]{64}\b", end)) == 2


def test_a_notebook_shows_plans_runs_and_diagnoses() -> None:
    from irb2400_ctrl.diagnosis import Diagnosis
    from irb2400_ctrl.identification import Identification
    from irb2400_ctrl.planners import Plan, ProgramMotion
    from irb2400_ctrl.report.notebook import page_of
    from irb2400_ctrl.simulation import Simulation

    for kind in (Plan, ProgramMotion, Simulation, Diagnosis, Identification):
        assert hasattr(kind, "_repr_html_")
        assert page_of.dispatch(kind) is not page_of.dispatch(object)
    robot = irb.load_robot("irb2400")
    box = irb.planners.builders.circle((0.95, 0.0, 0.6), 0.02, feed=0.1)
    planned = irb.plan_path(robot, box)
    # at a prompt it was 115,000 characters of robot and samples
    assert repr(planned) == "<Plan: write(folder) has its files, a notebook its report>"
    shown = planned._repr_html_()
    assert shown.startswith("<iframe sandbox")
    assert "The way can be driven" in shown
    assert "<main" not in shown


def test_gaps_and_peaks_survive_thinning() -> None:
    time = np.linspace(0.0, 100.0, 100_000)
    values = np.sin(time)
    values[5000] = 40.0
    values[20_000:40_000] = np.nan
    x, y = thin(time, values)
    assert len(x) < 4000
    assert np.nanmax(y) == 40.0
    assert np.isnan(y[(x > 20.5) & (x < 39.5)]).all()
    assert x[0] == 0.0
    assert x[-1] == 100.0


def test_spectrum_and_parity_take_gaps() -> None:
    residual = np.random.default_rng(1).normal(size=1000)
    residual[100:300] = np.nan
    made = Page("x")
    lines = [("before", residual, "tab:red"), ("after", residual, "tab:blue")]
    made.figures([spectrum(lines, 250.0, 1), parity(np.arange(9.0), np.arange(9.0), 2)], "c")
    assert made.html().count("<svg") == 2


@pytest.mark.parametrize("name", ["arm.js", "zoom.js"])
def test_scripts_keep_to_themselves(name: str) -> None:
    script = (TEMPLATES / name).read_text()
    for word in ("fetch(", "XMLHttpRequest", "localStorage", "cookie", "innerHTML", "eval("):
        assert word not in script


def test_a_package_that_nothing_compiled_is_not_called_different() -> None:
    missing = ("found no C compiler (looked for cc); expected one",)
    numbers = (1e-3, 1024, "", "", {}, {}, np.inf)
    one = Verification("p", {}, "host", "double", *numbers, None, None, missing)
    assert _compared(one) == "written, not checked: found no C compiler"
    wrong = replace(one, faults_held=True)
    assert _compared(wrong).startswith("DIFFERS from the model")
    right = replace(wrong, max_relative_difference=1e-14)
    assert _compared(right) == "equal to the model within 1e-14 over 1024 states"


def test_rapid_moves_leave_the_feed_to_be_seen() -> None:
    time = np.linspace(0.0, 2.0, 201)
    s = np.where(time < 1.0, 0.01 * time, 0.01 + (time - 1.0))
    still = np.zeros((201, 6))
    motion = irb.Trajectory(time, still, still, still, still, s=s)
    assert feed_figure(motion, None, 10.0).axes[0].get_ylim() == (0.0, 15.0)
    # nothing is cut off where nothing is programmed, or nothing is faster
    assert feed_figure(motion, None, None).axes[0].get_ylim()[1] > 1000
    assert feed_figure(motion, None, 900.0).axes[0].get_ylim()[1] > 1000


@pytest.mark.parametrize(
    ("ratio", "says"),
    [(0.8104, "81 % of limit"), (0.998, "99.8 % of limit"), (1.0, "100 % of limit")],
)
def test_a_limit_that_is_not_reached_is_not_called_so(ratio: float, says: str) -> None:
    assert of_limit(ratio) == says


@pytest.mark.parametrize(
    ("remark", "shown"),
    [
        ("joint 2 rests", "Joint 2 rests."),
        ("joint 2: 0.5 Nm are left", "Joint 2: 0.5 Nm are left."),
        ("monday.csv: joint 2 rests", "monday.csv: joint 2 rests."),
    ],
)
def test_a_remark_becomes_a_sentence_that_leaves_file_names_alone(remark: str, shown: str) -> None:
    """A log called tiago.csv was Tiago.csv."""
    assert sentence(remark) == shown
