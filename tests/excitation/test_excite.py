"""The planned motion keeps every limit, says what no motion can do, and helps on a plant that
shares no code."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from independent_plant import Case
from independent_plant import Effect as PlantEffect
from independent_plant.motion import Motion as PlantMotion

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.excitation import Budget, Excitation, excite, groups
from irb2400_ctrl.excitation.alternatives import Alternatives
from irb2400_ctrl.excitation.assemble import Workshop
from irb2400_ctrl.excitation.feasible import SHARE, between
from irb2400_ctrl.excitation.groups import group_called
from irb2400_ctrl.excitation.motion_design import standard_course
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid.rapid_check import check_rapid
from irb2400_ctrl.planners.programs.rapid.rapid_reader import read_rapid
from irb2400_ctrl.robot import load_robot
from irb2400_ctrl.trajectory import Trajectory

ROBOT = load_robot("irb2400")
SMALL = Budget(pool=30, rounds=1, mutations=12)


@cache
def planned(group: str, joint: int | None, seconds: float = 24.0) -> Excitation:
    return excite(ROBOT, group, joint=joint, seconds=seconds, budget=SMALL)


def recorded(case: Case, course: Trajectory | None) -> Log:
    """Log of the plant on the course (default its own identification motion), the effects as large
    in both."""
    commanded = None
    if course is not None:
        time = np.arange(round(course.duration * 1000) + 1) / 1000
        q = between(course, time)[0]
        commanded = PlantMotion(0.0, 1.0, np.vstack([np.tile(q[0], (1000, 1)), q]))
    log = case.simulate(commanded)[0]
    return Log(time=log.time, q=log.q, qd=log.qd, tau=log.tau, q_ref=log.q_ref)


@pytest.mark.parametrize(
    ("group", "joint"), [("friction level", 3), pytest.param("gain", 2, marks=pytest.mark.slow)]
)
def test_every_limit_holds_between_the_rows(group: str, joint: int) -> None:
    found = planned(group, joint)
    course = found.course
    model = Model(ROBOT)
    at = np.linspace(0.0, course.duration, 20 * len(course.time))
    q, qd, qdd = between(course, at)
    assert (q >= ROBOT.q_min).all()
    assert (q <= ROBOT.q_max).all()
    assert (np.abs(qd) <= ROBOT.qd_max).all()
    assert (np.abs(model.inverse_dynamics(q, qd, qdd)) <= (SHARE + 0.01) * ROBOT.tau_max).all()
    assert model.tcp_pose(q[::10])[:, 2, 3].min() > 0.09
    for end in (0, -1):
        assert not course.qd[end].any()
        assert not course.qdd[end].any()


def test_rows_are_one_motion() -> None:
    """Speeds and accelerations are the derivatives of the angles, also where pieces are joined."""
    course = planned("friction level", 3).course
    h = 1 / 250
    np.testing.assert_allclose(np.diff(course.time), h, rtol=1e-9)
    # within a step the speed changes by the acceleration, whose own change is bounded by the jerk
    mean = 0.5 * (course.qd[1:] + course.qd[:-1])
    jump = np.abs(np.diff(course.qdd, axis=0)).max()
    assert np.abs(np.diff(course.q, axis=0) / h - mean).max() <= h * jump
    np.testing.assert_allclose(
        np.diff(course.qd, axis=0) / h, 0.5 * (course.qdd[1:] + course.qdd[:-1]), atol=jump
    )


def test_duration_is_the_one_asked_for() -> None:
    for seconds in (12.0, 24.0):
        assert planned("friction level", 3, seconds).course.duration == pytest.approx(
            seconds, abs=0.01
        )


def test_same_seed_same_motion() -> None:
    again = excite(ROBOT, "friction level", joint=3, seconds=12.0, budget=SMALL)
    np.testing.assert_array_equal(again.course.q, planned("friction level", 3, 12.0).course.q)


def test_files(tmp_path: Path) -> None:
    found = planned("friction level", 3, 12.0)
    found.write(tmp_path)
    lines = (tmp_path / "trajectory.csv").read_text().splitlines()
    assert lines[0].startswith("time_s,q1_deg,")
    assert lines[0].endswith("tau6_Nm,s")
    assert len(lines) == len(found.course.time) + 1
    summary = json.loads((tmp_path / "excitation.json").read_text())
    assert summary["improves"]
    assert {"member", "rival", "distance_before", "distance_after", "why_not"} <= set(
        summary["separability"][0]
    )
    module = (tmp_path / "excitation.mod").read_text()
    assert read_rapid(module) is not None
    assert check_rapid(module) == ()


def test_offset_is_said_to_need_another_measurement() -> None:
    found = planned("offset", 2, 12.0)
    assert {row.verdict for row in found.table} == {"no motion separates them"}
    assert all(row.ceiling < 1.0 for row in found.table)
    assert "brakes on" in found.summary()["measure_else"]


def test_rotor_inertia_1_is_the_inertia_of_link_1() -> None:
    found = planned("inertia", 1, 12.0)
    row = next(row for row in found.table if row.member == ("rotor_inertia", 1))
    assert not row.row()["separable_by_motion"]
    assert "Izz of link 1" in row.reason
    # no record shows more of it than the data sheet's uncertainty leaves
    assert row.distance[1] <= row.ceiling


def test_no_motion_exceeds_the_ceiling() -> None:
    for group, joint in (("inertia", None), ("mass", None)):
        for row in planned(group, joint, 12.0).table:
            assert row.distance[1] <= row.ceiling * 1.01 + 0.1


def test_every_effect_of_the_library_is_in_a_group_with_advice() -> None:
    from irb2400_ctrl.effects import LIBRARY

    known = groups()
    tried = {kind for kind, effect in LIBRARY.items() if effect.search.in_diagnosis}
    assert {kind for group in known.values() for kind in group.kinds} == tried
    assert set(LIBRARY) - tried == {"acceleration_reading", "coupled_friction", "geared_motor"}
    for group in known.values():
        assert group.splits, group.name
        assert group.measure_else, group.name


def test_unknown_group_lists_the_groups_and_names_the_nearest_effect() -> None:
    with pytest.raises(InputError, match=r"'nonsense'; expected one of base, .*, friction level,"):
        excite(ROBOT, "nonsense")
    with pytest.raises(InputError, match=r"did you mean load_friction\?"):
        excite(ROBOT, "load_fricton")
    assert (
        group_called("load_friction").name
        == group_called("friction-level").name
        == "friction level"
    )


@pytest.mark.parametrize(("seconds", "joint"), [(5.0, None), (np.nan, None), (40.0, 7)])
def test_wrong_input(seconds: float, joint: int | None) -> None:
    with pytest.raises(InputError, match="expected"):
        excite(ROBOT, "gain", seconds=seconds, joint=joint)


@pytest.mark.parametrize(
    ("group", "joint", "kind", "times"),
    [("friction level", 3, "load_friction", 1.5), ("position error", 2, "encoder_zero", 1.5)],
)
def test_separates_better_on_the_independent_plant(
    group: str, joint: int, kind: str, times: float
) -> None:
    """Measured on what the plant really did: the closest pair is further apart than on its
    identification motion."""
    found = planned(group, joint)
    workshop = Workshop(ROBOT)
    standard = workshop.recorded(standard_course(workshop, 40.0))
    alternatives = Alternatives(ROBOT, group_called(group), standard, joint)
    case = Case(4, (PlantEffect(kind, joint, 0.03),))
    before, after = (
        alternatives.distances(alternatives.gram(prepare(recorded(case, course))))[0].min()
        for course in (None, found.course)
    )
    assert after > times * before


@pytest.mark.slow
@pytest.mark.parametrize(
    ("group", "kind", "joint", "fraction", "seed"),
    [
        ("friction level", "load_friction", 3, 0.03, 2),
        # below a share of 1 % of the joint's torque nothing is named
        ("position error", "encoder_zero", 2, 0.03, 1),
    ],
)
def test_diagnosis_is_surer_on_the_planned_motion(
    group: str, kind: str, joint: int, fraction: float, seed: int
) -> None:
    """The right member is named, and leads the next best effect by more than on the identification
    motion."""
    case = Case(seed, (PlantEffect(kind, joint, fraction),))
    before, after = (
        diagnose(ROBOT, recorded(case, c)) for c in (None, planned(group, joint).course)
    )
    assert (kind, joint) in [(f.effect.kind, f.effect.joint) for f in after.findings]
    leads = [
        max((f.margin for f in d.findings if f.effect.kind == kind), default=0.0)
        for d in (before, after)
    ]
    assert leads[1] > 1.3 * leads[0]


def test_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from irb2400_ctrl.cli.main import run

    out = tmp_path / "next"
    monkeypatch.setattr(
        "sys.argv", ["irb2400", "excite", "--for", "no such thing", "--out", str(out)]
    )
    with pytest.raises(SystemExit) as end:
        run()
    assert end.value.code == 2
    assert "expected one of base, coupling" in capsys.readouterr().err
    assert not out.exists()
