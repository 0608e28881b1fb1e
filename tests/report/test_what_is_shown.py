"""What stands in tables, lines and figures is what it says it is, and can be read."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex

from irb2400_ctrl import load_robot
from irb2400_ctrl.diagnosis.body_estimates import BodyEstimate, BodyEstimates
from irb2400_ctrl.report.elements.inline_svg import COLOURS as CHANGED
from irb2400_ctrl.report.elements.page import Page
from irb2400_ctrl.report.elements.plots import Line, over_time, wide
from irb2400_ctrl.report.figures.rotation_figure import COLOURS
from irb2400_ctrl.report.pages.diagnosis_page import _joints_to_show
from irb2400_ctrl.report.pages.diagnosis_tables import (
    error_table,
    recalibration_rows,
    worse_elsewhere,
    worse_here,
)
from irb2400_ctrl.report.pages.three_lists import Entry, body_lines
from irb2400_ctrl.report.pages.validation_page import lines
from irb2400_ctrl.wording import joined, numbered

TIME = np.linspace(0.0, 1.0, 50)


def finding(joint: int, value: float, alternatives: tuple[str, ...] = (), body: Any = None) -> Any:
    effect = SimpleNamespace(
        kind="rotor_inertia",
        joint=joint,
        windows_s=(),
        parameters=lambda: {"inertia_kgm2": value},
    )
    return SimpleNamespace(
        effect=effect,
        standard_errors={"inertia_kgm2": 0.1},
        alternatives=alternatives,
        body=body,
    )


def errors(*rmse: float) -> Any:
    return SimpleNamespace(
        rmse=np.array(rmse), mae=np.array(rmse), rmse_over_mean_percent=np.array(rmse)
    )


def compared(before: tuple[float, ...], after: tuple[float, ...]) -> Any:
    return SimpleNamespace(
        name="folder/other.csv",
        error_before=errors(*before),
        error_recalibrated=errors(*before),
        error_after=errors(*after),
        noise_floor=np.full(len(before), 1.2),
        known=np.array([[True, False]]),
    )


def test_numbers_of_the_tool_do_not_stand_below_joints() -> None:
    """The three coordinates of a tool's centre stood below joints 1 to 3."""
    robot = load_robot("irb2400")
    moved = {"tool_com": [0.1, 0.2, 0.3], "tool_inertia": [1.0] * 6, "coulomb": [1.0] * 6}
    rows = recalibration_rows(moved, robot)
    assert [row[0] for row in rows] == ["coulomb [Nm], as given", "coulomb [Nm]"]


def test_a_size_names_its_number_once() -> None:
    entry = Entry((finding(1, 2.0), finding(2, 3.0)))
    assert entry.size == "inertia_kgm2 2.00 ± 0.10; 3.00 ± 0.10"


def test_lookalikes_are_a_sentence() -> None:
    assert Entry((finding(1, 2.0, ("a", "b", "c")),)).could_be == "a, b or c"
    assert joined(["a"]) == "a"
    assert numbered("link", [2]) == "link 2"
    assert numbered("link", [2, 3, 4]) == "links 2, 3 and 4"


def test_no_error_of_a_body_is_written_as_nothing() -> None:
    """A load was `4.09 ± 0.00 kg at (28, -20, 115) ± (0, 0, 0) mm`."""
    com = np.array([0.02828, -0.02, 0.1151])
    sharp = BodyEstimate(4.0922, com, 0.06, np.array([0.0038, 2e-4, 2e-4, 3e-4]))
    lines = body_lines(Entry((finding(1, 2.0, body=BodyEstimates(sharp, sharp)),)))
    assert lines[0].endswith(
        "4.0922 ± 0.0038 kg at (28.28 ± 0.20, -20.00 ± 0.20, 115.10 ± 0.30) mm"
    )


def test_a_motion_that_is_predicted_worse_is_named() -> None:
    """Below "what is left is noise" the error of joint 3 went from 1.34 to 1.67 Nm."""
    found: Any = SimpleNamespace(validation=compared((3.0, 1.3), (1.25, 1.7)))
    (line,) = worse_elsewhere(found)
    assert line.startswith("Joint 2: on other.csv the error grows from 1.30 to 1.70 Nm rms")
    found.validation = compared((1.0, 1.3), (1.3, 1.35))  # noise
    assert worse_elsewhere(found) == []
    found.validation = None
    assert worse_elsewhere(found) == []


def test_numbers_that_make_their_own_log_worse_are_named() -> None:
    """The rows recalibrated and after stood at 0.369 Nm, before at 0.302, without a word."""
    found: Any = SimpleNamespace(identification=compared((3.0, 0.302), (1.25, 0.369)))
    (line,) = worse_here(found)
    assert line.startswith("Joint 2: on other.csv the error grows from 0.302 to 0.369 Nm rms")
    found.identification = compared((1.0, 1.3), (1.05, 1.35))
    assert worse_here(found) == []
    # where the given numbers are told, nothing is worse, whatever others would do
    kept = compared((1.0, 1.3), (1.0, 1.3))
    kept.error_recalibrated = SimpleNamespace(rmse=np.array([1.0, 1.9]))
    found.identification = kept
    assert worse_here(found) == []


def test_where_nothing_was_tried_nothing_stands_after() -> None:
    head, rows = error_table(compared((3.0, 1.0), (3.0, 1.0)), tried=False)
    assert list(head) == ["joint", "MAE before", "RMSE before", "RMSE/AVG before %"]
    assert rows[0] == ["1", 3.0, 3.0, 3.0]


def test_a_resting_joint_has_no_floor_and_no_empty_figures() -> None:
    """Its floor was 0, and its residual, parity and spectrum were shown with nothing in them."""
    _, rows = error_table(compared((3.0, 9.0), (3.0, 9.0)))
    assert rows[0][6] == 1.2
    assert np.isnan(rows[1][6])
    found: Any = SimpleNamespace(
        findings=(), unexplained=(), not_excited=(2,), validation=compared((3.0, 9.0), (3.0, 9.0))
    )
    assert _joints_to_show(found) == [1]


def test_columns_of_words_are_read_from_the_left() -> None:
    page = Page("x")
    page.table("t", ("what", "it is", "size"), [["a", "some words", 1.0], ["b", "-", 2.0]])
    text = page.html()
    assert '<td class="left">some words</td>' in text
    assert '<th scope="col" class="left">it is</th>' in text
    assert "<td>1.00</td>" in text


def test_a_grid_does_not_cross_bars() -> None:
    assert wide(2.0)[1].get_axisbelow() is True


def test_a_curve_does_not_lie_on_the_frame() -> None:
    """A margin of 0.94 to 0.95 could not be told from the frame above it."""
    figure = over_time(TIME, [Line(np.full(50, 0.95) - 0.001 * TIME)], "margin [-]", floor=0.0)
    low, high = figure.axes[0].get_ylim()
    assert low == 0.0
    assert high > 0.95 * 1.04


@pytest.mark.parametrize(("most", "told"), [(2.5e5, "200k"), (2500.0, "2000")])
def test_large_numbers_fit_beside_a_small_plot(most: float, told: str) -> None:
    figure = over_time(TIME, [Line(most * TIME)], "torque 1 [Nm]")
    figure.draw_without_rendering()
    assert told in [label.get_text() for label in figure.axes[0].get_yticklabels()]


def test_the_legend_of_an_image_has_its_colours() -> None:
    """A page changed the grey of the legend, and in the dark its black, but not the image's."""
    assert not {to_hex(colour) for colour in COLOURS[1:]} & CHANGED.keys()


def test_a_validation_shows_three_digits() -> None:
    """A mean torque stood there as 256.813 Nm."""
    error = SimpleNamespace(
        mae=np.array([0.99213]),
        rmse=np.array([2.0581]),
        rmse_over_mean_percent=np.array([100 * 2.0581 / 256.813]),
    )
    quiet = np.zeros((1, 1))
    log: Any = SimpleNamespace(
        log="a.csv", error=error, notes=(), known=quiet > 0, measured=quiet, modelled=quiet
    )
    told = lines(SimpleNamespace(logs=[log], error=error))  # type: ignore[arg-type]
    assert told[1].split() == ["1", "0.992", "2.06", "257", "0.801"]
