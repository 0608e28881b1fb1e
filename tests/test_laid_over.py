"""Torques laid over real recordings: what they are, and how what is said of them counts."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log

sys.path.insert(0, str(Path(__file__).parents[1]))

from benchmarks.real_injected import LAWS, Motion, carried, judged, laid_over, table
from benchmarks.real_robots import Case

TIME = np.arange(0.0, 6.0, 0.004)
ANGLES = 0.5 * np.sin(np.outer(TIME, [1.0, 1.3, 0.9, 1.7, 2.1, 1.2]) + np.arange(6.0))


def motion() -> Motion:
    tau = 40.0 * np.cos(np.outer(TIME, [0.7, 1.1, 1.9, 0.8, 1.4, 1.6]))
    return Motion.of(Log(TIME, ANGLES, tau))


def arm() -> irb.Robot:
    """Without its parallelogram, as the recorded arms are."""
    robot = irb.load_robot("irb2400")
    serial = robot.coupling.model_copy(
        update={"matrix": tuple(map(tuple, np.eye(6))), "offset_rad": (0.0,) * 6}
    )
    return robot.model_copy(update={"coupling": serial})


def test_a_load_weighs_what_the_model_says() -> None:
    """Written twice: here J^T (a - g), there Newton and Euler."""
    m = motion()
    case = Case("arm", arm(), (), ())
    at = (0.02, -0.03, 0.1)
    loaded = case.robot.with_effects(LIBRARY["payload"].of(None, mass_kg=1.0, com_m=at))
    with_it, without = (
        np.asarray(irb.Model(robot).inverse_dynamics(m.q, m.qd, m.qdd))
        for robot in (loaded, case.robot)
    )
    np.testing.assert_allclose(carried(case, m, np.array(at)), with_it - without, atol=1e-5)


@pytest.mark.parametrize("kind", [*LAWS, "payload"])
def test_it_is_a_share_of_the_torque_of_the_joint_that_it_acts_on_most(kind: str) -> None:
    m = motion()
    torque, joint, size = laid_over(
        Case("arm", arm(), (), ()), m, kind, 0.25, np.random.default_rng(3)
    )
    shares = np.sqrt(np.mean(torque**2, axis=0) / np.mean(m.tau**2, axis=0))
    assert shares.max() == pytest.approx(0.25)
    assert size != 0.0
    if joint is not None:
        assert np.flatnonzero(shares).tolist() == [joint - 1]


def found(*names: tuple[str, int | None], **more: Any) -> Any:
    findings = [
        SimpleNamespace(effect=SimpleNamespace(kind=kind, joint=joint), alternatives=())
        for kind, joint in names
    ]
    about = {
        "findings": findings,
        "numbers": (),
        "verdict": "explained",
        "taken_up": (),
        "change": True,
    }
    return SimpleNamespace(**(about | more))


def test_how_a_diagnosis_counts() -> None:
    silent = {"verdict": "nothing_missing"}
    assert judged(found(("torque_offset", 3)), "torque_offset", 3) == "exact"
    assert judged(found(("coulomb_asymmetry", 3)), "torque_offset", 3) == "group"
    assert judged(found(("torque_offset", 2)), "torque_offset", 3) == "other"
    assert judged(found(verdict="unexplained"), "torque_offset", 3) == "said"
    assert judged(found(**silent, taken_up=(3,)), "torque_offset", 3) == "said"
    assert judged(found(**silent), "torque_offset", 3) == "silent"
    number = SimpleNamespace(list="changed", place="joint 3", name="coulomb_Nm")
    assert judged(found(**silent, numbers=(number,)), "coulomb_change", 3) == "exact"
    assert judged(found(**silent, numbers=(number,)), "torque_offset", 3) == "said"
    assert judged(found(**silent, numbers=(number,)), "torque_offset", 2) == "silent"
    number.list = "special"
    assert judged(found(**silent, numbers=(number,)), "torque_offset", 3) == "silent"
    assert judged(found(**silent, numbers=(number,), change=False), "torque_offset", 3) == "said"
    lines = [{"robot": "arm", "share": 0.25, "judged": word} for word in ("exact", "exact", "said")]
    assert table(lines).endswith("| arm | 25 % | 3 | 2 | 0 | 0 | 1 | 0 |")
