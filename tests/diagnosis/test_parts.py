"""Parts of the diagnosis, each against something it must equal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
import pytest
from diagnosis.plain_motion import BASES, ROBOT, motion
from scipy.integrate import solve_ivp

from irb2400_ctrl.arrays import rms
from irb2400_ctrl.diagnosis.estimation import fit as fit_module
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.evidence import Problem, Score
from irb2400_ctrl.diagnosis.preparation.base_prior import BasePrior
from irb2400_ctrl.diagnosis.preparation.metrics import errors, noise_floor
from irb2400_ctrl.diagnosis.preparation.noise import (
    ORDER,
    SLOW,
    Noise,
    NoiseModel,
    _not_too_coloured,
    complete_rows,
)
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque, predicted_torque
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.added_body import Payload
from irb2400_ctrl.effects.encoder_zero import EncoderZero
from irb2400_ctrl.effects.signals import Signals
from irb2400_ctrl.effects.time_delay import TimeDelay
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Uncertainty
from irb2400_ctrl.symbolic.vectorised import Vectorised


def test_vectorised_expression_equals_casadi() -> None:
    x = ca.SX.sym("x")
    y = ca.SX.sym("y")
    expression = ca.vertcat(
        ca.if_else(x > y, ca.sin(x) * y**2, ca.fabs(y) ** 1.7 - ca.sign(x)),
        ca.exp(-ca.fabs(x)) / (1 + y**2) + ca.atan2(y, x) + ca.fmin(x, y) * ca.tanh(y),
        ca.sqrt(1 + x**2) - ca.cosh(y) + 2 * x,
        ca.logic_and(x > 0, y <= 0.5),
    )
    rng = np.random.default_rng(0)
    a = rng.normal(size=40)
    b = rng.normal(size=(7, 1))
    found = np.array([np.broadcast_to(v, (7, 40)) for v in Vectorised([x, y], expression)(a, b)])
    grid = np.array(np.broadcast_arrays(a, b)).reshape(2, -1)
    exact = np.asarray(ca.Function("f", [ca.vertcat(x, y)], [expression])(grid)).reshape(4, 7, 40)
    np.testing.assert_allclose(found, exact, rtol=1e-13, atol=1e-14)


def test_a_law_of_the_users_own_may_differentiate_a_signal() -> None:
    before = dict(LIBRARY)

    class Slope(EncoderZero):
        sentence: ClassVar[str] = "a wrong zero, written out"
        example: ClassVar[Mapping[str, Any]] = {"zero_rad": 0.01}
        kind: Literal["slope"] = "slope"  # type: ignore[assignment]

        def basis(self, s: Signals) -> ca.SX:
            return ca.jacobian(s.load, s.q)[:, self.index]

    try:
        (own,) = BASES.columns("slope", 3, motion())
        (known,) = BASES.columns("encoder_zero", 3, motion())
    finally:
        LIBRARY.clear()
        LIBRARY.update(before)
    assert own.joints == known.joints
    np.testing.assert_allclose(own.values, known.values, rtol=1e-9, atol=1e-9)


def test_evidence_equals_the_direct_integral() -> None:
    """Marginal likelihood of y = Z z + X b + e with normal z, b, e, from the full covariance
    matrix."""
    rng = np.random.default_rng(1)
    rows = 60
    kept = np.arange(60)
    Z = rng.normal(size=(rows, 1, 4))
    X = rng.normal(size=(rows, 1, 2))
    y = Z @ np.ones(4) + X @ np.array([0.4, -0.2]) + rng.normal(size=(rows, 1))
    noise = Noise(np.append(1.0, np.zeros(ORDER)), np.ones(rows), kept)
    problem = Problem(y, Z, [noise])
    usual = np.array([0.2, -0.5])
    spread = np.array([0.7, 0.3])
    score = problem.score(
        RegressorColumns((0,), X), expected=tuple(zip(usual, spread, strict=True))
    )

    def direct(with_law: bool) -> float:
        S = np.eye(rows) + Z[:, 0] @ Z[:, 0].T
        v = y[:, 0]
        if with_law:
            S += (X[:, 0] * np.square(spread)) @ X[:, 0].T
            v = v - X[:, 0] @ usual
        return float(-0.5 * (v @ np.linalg.solve(S, v) + np.linalg.slogdet(S)[1]))

    assert score.gain == pytest.approx(direct(True) - direct(False), rel=1e-9)
    assert problem.log_evidence == pytest.approx(direct(False), rel=1e-9)
    blocks = problem.gains(0, [X[:, 0], Z[:, 0]])
    assert blocks[0] == pytest.approx(problem.score(RegressorColumns((0,), X)).gain, rel=1e-9)


def test_numbers_stand_beside_the_effects_as_they_are_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Not as a further step of the fit would move them: of a TX40 axis 1 was told with 4.3 Nm
    left where 2.5 are."""
    monkeypatch.setattr(fit_module, "ITERATIONS", 0)  # before any step
    base_prior = BasePrior.of(ROBOT, Uncertainty(), motion())
    Z = motion().filtered(base_prior.columns(BASES.model, motion()))
    effect = LIBRARY["viscous_power"].of(2, coefficient=40.0, exponent=1.3)
    nothing = RegressorColumns((1,), np.zeros((len(Z), 1, 1)))
    score = Score(0.0, np.zeros(1), np.zeros(0))
    candidate = Candidate("viscous_power", 2, "", (), (effect,), nothing, None, score)
    calm = np.zeros(Z.shape[:2], dtype=bool)
    fit = fit_module.Fitter(ROBOT, BASES, motion(), Z, calm).fit([candidate])
    robot = ROBOT.model_copy(update={"effects": fit.effects})
    left = motion().filtered(motion().tau_smooth - predicted_torque(robot, motion()))
    np.testing.assert_allclose(fit.residual, left - Z @ fit.z, atol=1e-6)


def test_prediction_knows_payload_delay_and_encoder_zero() -> None:
    m = motion()
    payload = Payload(mass_kg=3.0, com_m=(0.02, 0.0, 0.1))
    loaded = ROBOT.with_effects(payload)
    np.testing.assert_allclose(
        predicted_torque(loaded, m), Model(loaded).inverse_dynamics(m.q, m.qd, m.qdd), rtol=1e-12
    )
    # the effect's basis says the same, to the last digit: it is linear in the body's parameters
    change = predicted_torque(loaded, m) - predicted_torque(ROBOT, m)
    np.testing.assert_allclose(
        effect_torque(BASES, payload, m), change, atol=1e-9 * np.abs(change).max()
    )
    plain = predicted_torque(ROBOT, m)
    late = predicted_torque(ROBOT.with_effects(TimeDelay(delay_s=0.008)), m)
    np.testing.assert_allclose(late[2:], plain[:-2], atol=1e-9)
    turned = predicted_torque(ROBOT.with_effects(EncoderZero(joint=2, zero_rad=0.01)), m)
    shifted = m.q + np.array([0, 0.01, 0, 0, 0, 0])
    np.testing.assert_allclose(
        turned, BASES.model.inverse_dynamics(shifted, m.qd, m.qdd), atol=1e-12
    )


@pytest.mark.parametrize("kind", sorted(LIBRARY))
def test_every_effect_has_finite_columns_and_discrepancy(kind: str) -> None:
    effect = LIBRARY[kind]
    for joint in effect.joints(6):
        grid = effect.grid(joint)[:2]
        for discrepancy in (False, True):
            for columns in BASES.columns(kind, joint, motion(), grid, discrepancy=discrepancy):
                assert columns.values.shape[:2] == (motion().rows, len(columns.joints))
                assert np.isfinite(columns.values).all()


@pytest.mark.parametrize(
    "coefficients", [(1.8, -0.85), (0.98, 0.0), (-0.7, 0.2), (0.2, 0.75), (1.4, -1.1), (1.9, -0.2)]
)
def test_noise_is_not_believed_to_be_slower_than_allowed(coefficients: tuple[float, float]) -> None:
    """Slow, oscillating at half the rate, or growing without bound."""
    found = _not_too_coloured(np.array(coefficients))
    turn = np.exp(-1j * np.outer(np.linspace(0, np.pi, 100_001), [1, 2]))
    spectrum = 1 / np.abs(1 - turn @ found) ** 2
    span = spectrum.max() / np.exp(np.log(spectrum).mean())
    assert span == pytest.approx(4.0, rel=1e-3)
    # drawn towards white
    share = found[0] / coefficients[0]
    assert found[1] == pytest.approx(share**2 * coefficients[1])
    mild = np.array([0.3, 0.1])
    np.testing.assert_array_equal(_not_too_coloured(mild), mild)


@pytest.mark.parametrize("lost", [0.2, 0.0])
def test_whitening_is_the_filter_on_rows_with_all_it_needs(lost: float) -> None:
    rng = np.random.default_rng(7)
    known = rng.random(60) >= lost
    noise = Noise(
        np.array([1.0, -0.7, 0.2]), rng.random(complete_rows(known).size), complete_rows(known)
    )
    columns = rng.standard_normal((60, 3, 2))
    expected = [
        w * (columns[row] - 0.7 * columns[row - 1] + 0.2 * columns[row - 2])
        for w, row in zip(noise.weight, noise.kept, strict=True)
    ]
    np.testing.assert_allclose(noise.whiten(columns), expected, rtol=1e-12)


def test_a_single_reversal_counts_with_the_misfit_it_has() -> None:
    """However few its rows are: taken for as good as the others, whatever bends there gains."""
    residual = np.random.default_rng(8).standard_normal(200)
    reversal = np.zeros(200, dtype=bool)
    reversal[90:96] = True
    residual[reversal] *= 20.0
    model = NoiseModel(np.ones((200, 1), dtype=bool), reversal[:, None], np.zeros(1), 0.04)
    (noise,) = model.coloured(residual[:, None])
    near = reversal[noise.kept]
    assert noise.weight[near].max() < 0.2 * noise.weight[~near].min()


def test_what_a_model_of_the_arm_leaves_of_any_motion_is_noise_of_slow_kind() -> None:
    """Of a wander of 0.7 Nm beside noise of 0.1 the whitened errors have unit variance, and are
    white; of one that the model does not know of they have not."""
    rng = np.random.default_rng(9)
    stays = np.exp(-0.04 / SLOW)
    wander = np.zeros(20_000)
    for k in range(1, wander.size):
        wander[k] = stays * wander[k - 1] + 0.7 * np.sqrt(1.0 - stays**2) * rng.standard_normal()
    quick = 0.1 * rng.standard_normal((wander.size, 1))
    all_rows = np.ones((wander.size, 1), dtype=bool)
    for size in (0.0, 0.7):
        model = NoiseModel(all_rows, ~all_rows, np.array([size]), 0.04)
        (noise,) = model.coloured(quick)
        quiet, whole = (noise.whiten(one) for one in (quick, quick + wander[:, None]))
        if size:
            assert whole.std() == pytest.approx(1.0, abs=0.03)
            assert abs(np.corrcoef(whole[1:, 0], whole[:-1, 0])[0, 1]) < 0.05
            assert quiet.std() < 0.6
        else:
            assert quiet.std() == pytest.approx(1.0, abs=0.03)
            assert whole.std() > 5.0


def test_a_wander_counts_on_few_rows_as_well() -> None:
    rng = np.random.default_rng(4)
    rows = np.ones((30, 1), dtype=bool)
    residual = 0.1 * rng.standard_normal((30, 1))
    (plain,) = NoiseModel(rows, ~rows, np.zeros(1), 0.04).coloured(residual)
    (wary,) = NoiseModel(rows, ~rows, np.full(1, 0.7), 0.04).coloured(residual)
    assert 1.0 / plain.weight[0] < 0.2
    assert 1.0 / wary.weight[0] == pytest.approx(np.hypot(0.7, 1.0 / plain.weight[0]))


def test_the_step_of_the_noise_is_that_of_the_rows() -> None:
    """Rows of logs that a recorder low-passed stand further apart than the common filter says."""
    rows = np.concatenate([np.arange(0.0, 5.0, 0.124), np.arange(6.0, 12.0, 0.124)])
    known = np.ones((len(rows), 1), dtype=bool)
    log: Any = SimpleNamespace(row_time=rows, row_known=known, tau=np.ones_like(known, float))
    assert NoiseModel.of(log, ~known, np.zeros(1)).step == pytest.approx(0.124)


def test_a_body_more_needs_no_model_of_its_own() -> None:
    m = motion()
    loaded = ROBOT.with_effects(Payload(mass_kg=4.0, com_m=(0.05, -0.02, 0.1)))
    direct = np.asarray(Model(loaded).inverse_dynamics(m.q, m.qd, m.qdd))
    np.testing.assert_allclose(predicted_torque(loaded, m, BASES), direct, atol=1e-8)


def test_metrics_are_equations_75_to_77_and_the_floor_is_the_noise() -> None:
    rng = np.random.default_rng(3)
    t = np.arange(0, 40, 0.004)
    measured = 50 * np.sin(t)[:, None] + rng.normal(0, 2.0, (len(t), 1))
    known = np.ones((len(t), 1), dtype=bool)
    found = errors(measured, np.zeros_like(measured), known)
    assert found.mae[0] == pytest.approx(np.abs(measured).mean())
    assert found.rmse[0] == pytest.approx(np.sqrt((measured**2).mean()))
    assert found.rmse_over_mean_percent[0] == pytest.approx(
        100 * found.rmse[0] / np.abs(measured).mean()
    )
    slow_error = 0.8 * np.sin(2 * np.pi * 0.3 * t)[:, None]
    residual = measured - 50 * np.sin(t)[:, None] + slow_error
    assert noise_floor(residual, known, 0.004)[0] == pytest.approx(2.0, rel=0.03)


@pytest.mark.parametrize(("stiffening", "off"), [(0.0, 0.02), (1500.0, 0.15)])
def test_swing_and_slow_twist_together_are_the_link_on_its_spring(
    stiffening: float, off: float
) -> None:
    """Both columns of an elastic joint against an integration of its equation; a slow motion has
    hardly any swing."""
    m = motion()
    k = 4e4
    zeta = 0.04
    j = 0
    straight = {"stiffness_Nm_rad": k, "damping_ratio": zeta}
    nonlinear = {**straight, "stiffening_per_rad": stiffening}
    (law,) = BASES.columns("elastic_joint", 1, m, [nonlinear], filtered=False)
    swing, slow = law.values[:, law.joints.index(j)].T
    load = BASES.model.inverse_dynamics(m.q, m.qd, m.qdd, friction=False)[:, j]
    inertia = BASES.model.mass_matrix(m.q)[:, j, j]
    time = m.time - m.time[0]

    def rate(t: float, x: np.ndarray) -> list[float]:
        w2 = k / np.interp(t, time, inertia)
        spring = k / stiffening * np.sinh(stiffening * x[0] / k) if stiffening else x[0]
        return [x[1], w2 * (np.interp(t, time, load) - spring) - 2 * zeta * np.sqrt(w2) * x[1]]

    first = k / stiffening * np.arcsinh(stiffening * load[0] / k) if stiffening else load[0]
    found = solve_ivp(rate, (0.0, time[-1]), [first, 0.0], t_eval=time, max_step=2e-3, rtol=1e-8)
    acceleration = np.array([rate(t, x)[1] for t, x in zip(time, found.y.T, strict=True)])
    whole = -inertia * acceleration / k  # nothing of axis 1's torque depends on q1
    assert rms(swing + slow - whole) < off * rms(whole)
    (law,) = BASES.columns("elastic_joint", 1, m, [straight], filtered=False)
    of_straight = law.values[:, law.joints.index(j)].sum(axis=1)
    # at most 3.4 times as stiff under its load
    assert (rms(of_straight - whole) > 0.9 * rms(whole)) == (stiffening > 0)

    still = 2 * np.pi * 0.3 * time
    parts = [0.5 * (2 * np.pi * 0.3) ** n * np.cos(still + n * np.pi / 2) for n in range(5)]
    held = np.tile(m.q[0], (len(time), 1))
    rows = [held.copy(), *(np.zeros_like(held) for _ in range(4))]
    for row, part in zip(rows, parts, strict=True):
        row[:, j] = part
    calm = replace(m, **dict(zip(("q", "qd", "qdd", "qddd", "qdddd"), rows, strict=True)))
    (law,) = BASES.columns("elastic_joint", 1, calm, [straight], filtered=False)
    late = law.values[
        len(time) // 2 :, law.joints.index(j)
    ]  # what the beginning stirred up has died out
    assert np.abs(late[:, 0]).max() < 0.2 * np.abs(late[:, 1]).max()
