"""Joint moves: limits between the rows, exact ends, all axes together, and inputs that ruckig would
swallow."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from scipy.interpolate import CubicHermiteSpline

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.planners.joint_move import JointMove, joint_move

Array = npt.NDArray[np.float64]
HOME = np.radians([0.0, -20.0, 10.0, 0.0, 60.0, 0.0])


@pytest.fixture(scope="module")
def model() -> irb.Model:
    return irb.Model(irb.load_robot("irb2400"))


def at_10_kHz(move: JointMove) -> tuple[Array, Array, Array]:
    """The move between its rows, as the cubic through angles and speeds that a controller would
    make of them."""
    spline = CubicHermiteSpline(move.time, move.q, move.qd)
    time = np.arange(0.0, move.duration, 1e-4)
    return spline(time), spline(time, 1), spline(time, 2)


def random_pairs(model: irb.Model, count: int, seed: int) -> list[tuple[Array, Array]]:
    draw = np.random.default_rng(seed)
    low = model.robot.q_min
    high = model.robot.q_max
    q = draw.uniform(low, high, (2 * count, 6))
    return [(q[2 * k], q[2 * k + 1]) for k in range(count)]


@pytest.mark.parametrize("pair", range(6))
def test_rest_to_rest_keeps_every_limit_at_10_kHz(model: irb.Model, pair: int) -> None:
    start, target = random_pairs(model, 6, seed=1)[pair]
    # a row every 0.1 ms: the limits are those of the motion itself, no interpolation between rows
    # in between
    move = joint_move(model, start, target, rate=10_000.0)
    robot = model.robot
    tau = model.inverse_dynamics(move.q, move.qd, move.qdd)
    assert (np.abs(tau) / robot.tau_max).max() <= 1.0
    assert (np.abs(tau) / robot.tau_max).max() == pytest.approx(move.max_torque_ratio, abs=0.01)
    assert (np.abs(move.qd) <= robot.qd_max * (1 + 1e-9)).all()
    assert (np.abs(move.qdd) <= move.qdd_max * (1 + 1e-9)).all()
    assert (move.q >= robot.q_min - 1e-9).all()
    assert (move.q <= robot.q_max + 1e-9).all()
    jerk = np.abs(np.diff(move.qdd, axis=0)) * 10_000.0
    assert (jerk <= move.qddd_max * (1 + 1e-6)).all()
    # the limits are used: torque, or the speed of an axis, is what bounds the move
    assert max(move.max_torque_ratio, float((np.abs(move.qd) / robot.qd_max).max())) > 0.97


def test_ends_are_exact_and_rows_equidistant(model: irb.Model) -> None:
    target = HOME + np.array([0.5, 0.3, -0.2, 1.0, -0.5, 2.0])
    move = joint_move(model, HOME, target)
    assert np.abs(move.q[0] - HOME).max() < 1e-12
    assert np.abs(move.q[-1] - target).max() < 1e-9
    for end in (move.qd[[0, -1]], move.qdd[[0, -1]]):
        assert np.abs(end).max() < 1e-9
    assert np.allclose(np.diff(move.time), 1 / 250)
    # rows are consistent with each other: q is the integral of qd
    q, qd, _ = at_10_kHz(move)
    assert np.abs(np.gradient(q, 1e-4, axis=0) - qd)[1:-1].max() < 1e-3


def test_axes_start_and_end_together_on_a_straight_line(model: irb.Model) -> None:
    target = HOME + np.array([0.5, 0.3, -0.2, 1.0, -0.5, 2.0])
    move = joint_move(model, HOME, target)
    share = (move.q - HOME) / (target - HOME)
    assert np.ptp(share, axis=1).max() < 1e-9


@pytest.mark.parametrize("stated", [False, True])
def test_whatever_the_limits_the_line_is_straight(model: irb.Model, stated: bool) -> None:
    """Every third move left the line, by up to 0.09 rad: the slowest axis' profile, in proportion,
    was too much for another, and ruckig went on without a word."""
    draw = np.random.default_rng(12)
    limits = {}
    for start, target in random_pairs(model, 4, seed=7):
        if stated:
            limits = {"qdd_max": 10 ** draw.uniform(-0.5, 1, 6), "qddd_max": draw.uniform(5, 50, 6)}
        move = joint_move(model, 0.6 * start, 0.6 * target, **limits)
        share = (move.q - move.q[0]) / (move.q[-1] - move.q[0])
        assert np.ptp(share, axis=1).max() < 1e-9
        jerk = np.abs(np.diff(move.qdd, axis=0)) * 250.0
        assert (jerk <= move.qddd_max * (1 + 1e-6)).all()


def test_an_axis_that_hardly_moves_or_stands_keeps_the_line(model: irb.Model) -> None:
    way = np.array([0.7, 1e-6, 1e-13, 0.0, -0.4, 2e-4])
    move = joint_move(model, HOME, HOME + way)
    assert np.abs(move.q - HOME - np.outer((move.q[:, 0] - HOME[0]) / 0.7, way)).max() < 1e-12
    tiny = joint_move(model, HOME, HOME + 1e-7 * way)
    assert np.abs(tiny.q[-1] - HOME - 1e-7 * way).max() < 1e-15


def test_a_move_of_hours_is_refused_in_words(model: irb.Model) -> None:
    """ruckig answers it by a number that its own enumeration lacks: a ValueError came through."""
    fast = 0.6 * model.robot.qd_max
    with pytest.raises(InfeasibleError, match=r"swings out of the joint box|takes hours"):
        joint_move(model, HOME, HOME + 0.1, qd_start=fast, qdd_max=np.full(6, 1e-3))
    with pytest.raises(InfeasibleError, match="takes hours"):
        joint_move(model, HOME, HOME + 0.1, qdd_max=np.full(6, 1e-9))


def test_goes_on_from_a_moving_state(model: irb.Model) -> None:
    draw = np.random.default_rng(3)
    for _ in range(8):
        qd = draw.uniform(-0.2, 0.2, 6) * model.robot.qd_max
        qdd = draw.uniform(-0.5, 0.5, 6)
        target = HOME + draw.uniform(-0.4, 0.4, 6)
        move = joint_move(model, HOME, target, qd_start=qd, qdd_start=qdd)
        assert np.abs(move.q[0] - HOME).max() < 1e-12
        assert np.abs(move.qd[0] - qd).max() < 1e-12
        assert np.abs(move.qdd[0] - qdd).max() < 1e-12
        assert np.abs(move.q[-1] - target).max() < 1e-8
        assert np.abs(move.qd[-1]).max() < 1e-8
        q, qd_fine, _ = at_10_kHz(move)
        assert (np.abs(qd_fine) <= model.robot.qd_max * 1.001).all()
        assert (
            np.abs(model.inverse_dynamics(move.q, move.qd, move.qdd)) <= model.robot.tau_max
        ).all()
        assert (q > model.robot.q_min).all()


def test_stated_limits_are_never_exceeded(model: irb.Model) -> None:
    acceleration = np.full(6, 1.5)
    jerk = np.full(6, 9.0)
    move = joint_move(model, HOME, HOME + 0.5, qdd_max=acceleration, qddd_max=jerk, rate=10_000.0)
    assert (np.abs(move.qdd) <= 1.5 + 1e-9).all()
    assert (np.abs(np.diff(move.qdd, axis=0)) * 1e4 <= 9.0 + 1e-3).all()
    assert np.abs(move.qdd).max() > 1.4


def test_accelerations_stated_for_some_axes_are_kept() -> None:
    """A file that stated one of six was read as one that states none: 80 times as much was used."""
    robot = irb.load_robot("irb2400")
    first, *others = robot.joints
    limits = first.limits.model_copy(update={"acceleration_deg_s2": 60.0})
    joints = (first.model_copy(update={"limits": limits}), *others)
    part = irb.Model(robot.model_copy(update={"joints": joints}))
    target = HOME + np.radians([70.0, 20.0, 10.0, 0.0, 0.0, 0.0])
    move = joint_move(part, HOME, target)
    assert np.degrees(np.abs(move.qdd[:, 0]).max()) <= 60.0 * (1 + 1e-9)
    assert np.degrees(move.qdd_max[0]) == pytest.approx(60.0)
    # an axis that states none is only held to its torque
    alone = joint_move(part, HOME, HOME + np.radians([0.0, 20.0, 10.0, 0.0, 0.0, 0.0]))
    assert np.degrees(np.abs(alone.qdd[:, 1]).max()) > 200.0


def test_weaker_motors_make_a_slower_move(model: irb.Model) -> None:
    target = HOME + np.array([1.0, 0.6, -0.4, 0.0, 0.0, 0.0])
    limits = [joint.limits for joint in model.robot.joints]
    weak = [
        joint.model_copy(
            update={"limits": limit.model_copy(update={"torque_Nm": 0.6 * limit.torque_Nm})}
        )
        for joint, limit in zip(model.robot.joints, limits, strict=True)
    ]
    slow_model = irb.Model(model.robot.model_copy(update={"joints": tuple(weak)}))
    slow = joint_move(slow_model, HOME, target)
    fast = joint_move(model, HOME, target)
    assert slow.duration > 1.1 * fast.duration
    assert (
        np.abs(slow_model.inverse_dynamics(slow.q, slow.qd, slow.qdd)) <= slow_model.robot.tau_max
    ).all()


def test_nothing_to_do_takes_no_time(model: irb.Model) -> None:
    move = joint_move(model, HOME, HOME)
    assert move.duration == 0.0
    assert move.q.shape == (1, 6)


def test_rows_cannot_be_written(model: irb.Model) -> None:
    with pytest.raises(ValueError, match="read-only"):
        joint_move(model, HOME, HOME).q[0, 0] = 1.0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"q_start": np.zeros(5)}, r"q_start has shape \(5,\), expected \(6,\)"),
        ({"q_target": np.zeros(7)}, r"q_target has shape \(7,\)"),
        ({"q_target": np.zeros((1, 6))}, r"q_target has shape \(1, 6\)"),
        ({"qd_start": np.zeros(5)}, "qd_start has shape"),
        ({"qdd_start": np.zeros(8)}, "qdd_start has shape"),
        ({"qdd_max": np.ones(3)}, "qdd_max has shape"),
        ({"qddd_max": np.ones(7)}, "qddd_max has shape"),
        ({"qddd_max": np.zeros(6)}, "expected a positive number"),
        ({"q_target": np.full(6, np.nan)}, "axis 1 is not finite"),
        ({"qd_start": np.array([0, 0, np.inf, 0, 0, 0])}, "axis 3 is not finite"),
        ({"q_target": np.radians([0, 0, 70.0, 0, 0, 0])}, "axis 3 at 70.00 deg, range -60 to 65"),
        (
            {"qd_start": np.radians([0, 160.0, 0, 0, 0, 0])},
            "axis 2 has 160.0 deg/s, expected at most 150.0",
        ),
        # it was taken, and a motion stated to keep the limit began at twice that
        (
            {"qdd_start": np.array([0, 2.0, 0, 0, 0, 0]), "qdd_max": np.ones(6)},
            "qdd_start: axis 2 has 114.6 deg/s2, expected at most 57.3",
        ),
        ({"rate": 0.0}, "rate: found 0.0"),
    ],
)
def test_wrong_input_is_refused_in_words(
    model: irb.Model, change: dict[str, object], message: str
) -> None:
    request: dict[str, object] = {"q_start": HOME, "q_target": HOME + 0.1} | change
    with pytest.raises(InputError, match=message):
        joint_move(model, **request)  # type: ignore[arg-type]


def test_an_arm_that_cannot_hold_itself_is_refused(model: irb.Model) -> None:
    joints = list(model.robot.joints)
    joints[1] = joints[1].model_copy(
        update={"limits": joints[1].limits.model_copy(update={"torque_Nm": 200.0})}
    )
    weak = irb.Model(model.robot.model_copy(update={"joints": tuple(joints)}))
    stretched = np.radians([0.0, 80.0, 0.0, 0.0, 0.0, 0.0])
    with pytest.raises(
        InfeasibleError, match=r"q_target: axis 2 cannot hold the arm: needs .* of 200 Nm"
    ):
        joint_move(weak, HOME, stretched)


def test_too_weak_to_overcome_friction_names_the_place(model: irb.Model) -> None:
    joints = list(model.robot.joints)
    joints[5] = joints[5].model_copy(
        update={"limits": joints[5].limits.model_copy(update={"torque_Nm": 10.0})}
    )
    weak = irb.Model(model.robot.model_copy(update={"joints": tuple(joints)}))
    with pytest.raises(InfeasibleError, match=r"at \d\.\d+ s axis 6 needs \d+ of 10 Nm"):
        joint_move(weak, HOME, HOME + np.array([0, 0, 0, 0, 0, 1.0]))


def test_too_fast_towards_the_end_of_the_box_is_refused(model: irb.Model) -> None:
    near = HOME.copy()
    near[0] = np.radians(178.0)
    with pytest.raises(InfeasibleError, match=r"swings out of the joint box.*axis 1"):
        joint_move(model, near, HOME, qd_start=np.radians([140.0, 0, 0, 0, 0, 0]))


def test_an_axis_without_inertia_is_refused_or_stated() -> None:
    """Bodies that are points on their axis: a division by zero, then an acceleration of inf."""
    robot = irb.load_robot("irb2400")
    nothing = robot.tool.body.model_copy(
        update={"com_m": (0.0, 0.0, 0.1), "inertia_kgm2": (0.0,) * 6}
    )
    last = robot.links[-1].model_copy(update={"body": nothing})
    tool = robot.tool.model_copy(update={"body": nothing})
    point = irb.Model(robot.model_copy(update={"links": (*robot.links[:-1], last), "tool": tool}))
    goal = [0.1, 0.1, 0.1, 0.1, 0.6, 0.1]
    with pytest.raises(InputError, match=r"axis 6 turns nothing.*expected qdd_max"):
        joint_move(point, [0, 0, 0, 0, 0.5, 0], goal)
    stated = joint_move(point, [0, 0, 0, 0, 0.5, 0], goal, qdd_max=[2.0] * 6)
    assert np.abs(stated.qdd).max() <= 2.0 + 1e-9
