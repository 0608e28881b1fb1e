"""What the pages say of what a model leaves, and of what a place leaves."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from irb2400_ctrl.cli.planning.margin_lines import margin_lines
from irb2400_ctrl.identification import LogComparison, LogResult, Validation
from irb2400_ctrl.planners.placement import Proof
from irb2400_ctrl.report.elements.page import Page
from irb2400_ctrl.report.figures.residual_figures import left_of
from irb2400_ctrl.report.pages.diagnosis_tables import recalibration_rows
from irb2400_ctrl.report.pages.placement_page import _sentence
from irb2400_ctrl.report.pages.residual_section import add_parity, add_residual
from irb2400_ctrl.report.pages.validation_page import validation_page
from irb2400_ctrl.robot import load_robot

TIME = np.arange(5000) / 250.0


def compared(friction: float) -> LogComparison:
    """Two joints whose model is right but for noise, and dry friction on the first."""
    phase = 2.0 * np.pi * np.outer(TIME, [0.41, 0.73])
    q = np.sin(phase)
    qd = 2.0 * np.pi * np.array([0.41, 0.73]) * np.cos(phase)
    modelled = 50.0 * np.cos(q)
    noise = np.random.default_rng(1).standard_normal(q.shape)
    measured = modelled + noise + friction * np.sign(qd) * np.array([1.0, 0.0])
    known = np.ones(q.shape, dtype=bool)
    return LogComparison("log.csv", TIME, q, qd, measured, modelled, known)


def test_a_cause_is_told_by_what_it_goes_with() -> None:
    html = validation_page(Validation("arm", (compared(1.0),))).html()
    assert "What is left is more than noise: on joint 1 it goes with the direction (+0.69)." in html
    assert "on joint 2" not in html
    assert 'id="word-autocorrelation"' in html


def test_noise_is_called_noise() -> None:
    html = validation_page(Validation("arm", (compared(0.0),))).html()
    assert "goes with none of these more than by chance, and does not last." in html


def test_what_lasts_and_goes_with_nothing_is_no_noise() -> None:
    seen = compared(0.0)
    swing = 2.0 * np.sin(2.0 * np.pi * 2.3 * TIME)
    measured = seen.measured + np.column_stack([0.0 * swing, swing])
    html = validation_page(Validation("arm", (replace(seen, measured=measured),))).html()
    assert "What is left is more than noise: on joint 2 it lasts (autocorrelation 0." in html
    assert "on joint 1" not in html


def test_a_joint_without_samples_is_left_out() -> None:
    seen = compared(1.0)
    known = seen.known & np.array([True, False])
    html = validation_page(Validation("arm", (replace(seen, known=known),))).html()
    assert "on joint 1 it goes with the direction" in html


def test_new_friction_stands_below_the_old() -> None:
    robot = load_robot("irb2400")
    new = list(range(6))
    rows = recalibration_rows({"coulomb": new, "offset": new}, robot)
    assert [row[0] for row in rows] == ["coulomb [Nm], as given", "coulomb [Nm]", "offset [Nm]"]
    np.testing.assert_allclose(np.array(rows[0][1:], dtype=float), robot.friction[:, 1])


@pytest.mark.parametrize(
    ("margins", "says"),
    [
        ({"joint_limits_deg": 25.0, "wrist": 0.9}, "Every margin is comfortable."),
        (
            {"joint_limits_deg": 13.9, "wrist": 0.2},
            "Every margin is comfortable at the points looked at; between them the room to the "
            "joint limits is down to 13.9 deg (20 is comfortable), the distance from the wrist "
            "singularity is down to 0.2  (0.3 is comfortable).",
        ),
    ],
)
def test_a_place_is_not_called_comfortable_where_it_is_not(
    margins: dict[str, float], says: str
) -> None:
    found = SimpleNamespace(worth=1.0, worst="singularity")
    assert _sentence(found, Proof(margins)) == says.replace("  ", " ")


def test_a_place_with_a_worst_margin_says_what_is_worse_between_the_points() -> None:
    """16 mm at the points was told as the worst; on the path it was 7.8 mm."""
    found = SimpleNamespace(worth=0.8, worst="clearance_mm")
    assert _sentence(found, Proof({"clearance_mm": 7.82})) == (
        "The worst margin, clearance, is 80 % of what is comfortable at the points looked at; "
        "between them the clearance is down to 7.82 mm (20 is comfortable)."
    )


def test_margins_are_a_table_with_units() -> None:
    start = {"margins": {}, "continuous": None}
    found = {"margins": {"reach_mm": 340.0}, "continuous": {"margins": {"wrist": 0.961}}}
    lines = [line.split() for line in margin_lines(start, found)]
    assert lines[0][-3:] == ["start", "found", "comfortable"]
    assert lines[1][-4:] == ["[mm]", "-", "340", "100"]
    assert lines[3][-4:] == ["[-]", "-", "0.961", "0.3"]


def test_a_clearance_is_told_as_far_as_it_was_measured() -> None:
    """20 mm at the points of a path and 29.9 mm also between them cannot both be the least."""
    seen = {"margins": {"clearance_mm": 20.0}, "continuous": {"margins": {"clearance_mm": 29.9}}}
    lines = margin_lines({"margins": {"clearance_mm": 12.34}}, seen)
    assert lines[1].split()[-5:] == ["12.3", "20", "or", "more", "20"]
    assert lines[3].split()[-3:] == ["-", "29.9", "20"]


def test_an_identified_arm_is_judged_by_what_its_fit_had_not_seen() -> None:
    seen = compared(1.0)
    log = LogResult(
        name=seen.log,
        role="identification",
        time=seen.time,
        q=seen.q,
        qd=seen.qd,
        measured=seen.measured,
        known=seen.known,
        before=np.zeros_like(seen.measured),
        fitted=seen.measured,
        unseen=seen.modelled,
        plain=seen.measured,
    )
    page = Page("of an identification")
    add_parity(page, log)
    add_residual(page, log, [("identified", left_of(log), "tab:blue")])
    told = page.html()
    page = Page("of an identification")
    add_parity(page, seen)
    add_residual(page, seen, [("identified", left_of(seen), "tab:blue")])
    assert told == page.html()
    assert "on joint 1 it goes with the direction (+0.69)" in told
