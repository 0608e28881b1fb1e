"""Physical consistency of the mass data, the nearest consistent set, and what it changes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irb2400_ctrl as irb
from irb2400_ctrl.model.consistency import (
    ROUNDING,
    check,
    distances,
    nearest,
    project,
    report,
    second_moments,
)
from irb2400_ctrl.model.positive_definite import certify
from irb2400_ctrl.model.standard_motions import standard_motions, torque_differences
from irb2400_ctrl.robot import Body

moments = st.floats(-1.0, 1.0)
tensors = st.tuples(*[st.floats(-0.5, 2.0)] * 3, *[moments] * 3)


class TestReport:
    def test_table_3_is_no_set_of_bodies(self, robot: irb.Robot) -> None:
        found = {issue.place: issue.kind for issue in check(robot)}
        assert found == {
            "link_2": "negative_moment",
            "link_3": "negative_moment",
            "link_4": "triangle_inequality",
            "link_6": "triangle_inequality",
        }

    def test_sentences_hold_the_numbers(self, robot: irb.Robot) -> None:
        sentences = {issue.place: issue.sentence for issue in check(robot)}
        assert "-0.0375" in sentences["link_2"]
        assert "-0.01423" in sentences["link_3"]
        assert "0.9394" in sentences["link_4"]

    def test_three_conditions_agree(self, robot: irb.Robot) -> None:
        """Triangle slack is twice the smallest eigenvalue of Sigma."""
        for body in report(robot):
            assert body.triangle_slack == pytest.approx(2 * body.pseudo_inertia, abs=1e-12)
            assert body.consistent == (body.pseudo_inertia >= -body.tolerance)

    def test_a_massless_link_with_inertia_is_found(self, robot: irb.Robot) -> None:
        links = list(robot.links)
        links[4] = links[4].model_copy(
            update={"body": links[4].body.model_copy(update={"mass_kg": 0.0})}
        )
        kinds = {
            issue.place: issue.kind
            for issue in check(robot.model_copy(update={"links": tuple(links)}))
        }
        assert kinds["link_5"] == "massless"


class TestProjection:
    def test_nothing_is_left_to_complain_about(self, robot: irb.Robot) -> None:
        projected, distance = project(robot)
        assert check(projected) == []
        assert distance == pytest.approx(0.668443, abs=1e-6)
        assert distance == pytest.approx(np.linalg.norm(list(distances(robot, projected).values())))

    def test_masses_and_centres_stay(self, robot: irb.Robot) -> None:
        projected, _ = project(robot)
        for old, new in zip(robot.links, projected.links, strict=True):
            assert (old.body.mass_kg, old.body.com_m) == (new.body.mass_kg, new.body.com_m)

    def test_only_inconsistent_links_change_and_say_so(self, robot: irb.Robot) -> None:
        projected, _ = project(robot)
        changed = [
            new.name for old, new in zip(robot.links, projected.links, strict=True) if old != new
        ]
        assert changed == ["link_2", "link_3", "link_4", "link_6"]
        assert all(
            "nearest physically consistent" in projected.links[i].source for i in (1, 2, 3, 5)
        )

    def test_projecting_twice_changes_nothing(self, robot: irb.Robot) -> None:
        projected, _ = project(robot)
        assert project(projected) == (projected, 0.0)

    @settings(deadline=None, max_examples=100)
    @given(tensors, st.integers(0, 2**31))
    def test_no_consistent_body_is_nearer(self, six: tuple[float, ...], seed: int) -> None:
        """Optimality of the projection: (Sigma - P) . (S - P) <= 0 for every positive semidefinite
        S."""
        body = Body(mass_kg=1.0, com_m=(0, 0, 0), inertia_kgm2=six)
        Sigma = second_moments(body)
        P = second_moments(nearest(body))
        # a body that is one but for rounding stays as it is
        rounding = ROUNDING * float(np.abs(np.linalg.eigvalsh(body.tensor())).max())
        assert np.linalg.eigvalsh(P)[0] > -rounding - 1e-12
        rng = np.random.default_rng(seed)
        for _ in range(20):
            root = rng.normal(size=(3, 3))
            S = root @ root.T
            assert np.sum((Sigma - P) * (S - P)) < 1e-9


class TestTorqueDifference:
    def test_motions_stay_in_the_limits_and_are_their_own_derivatives(
        self, robot: irb.Robot
    ) -> None:
        for motion in standard_motions(robot):
            assert (motion.q >= robot.q_min).all()
            assert (motion.q <= robot.q_max).all()
            assert (np.abs(motion.qd) <= robot.qd_max).all()
            step = 1 / 250
            np.testing.assert_allclose(
                np.gradient(motion.q, step, axis=0)[1:-1], motion.qd[1:-1], atol=0.05
            )
            np.testing.assert_allclose(
                np.gradient(motion.qd, step, axis=0)[1:-1], motion.qdd[1:-1], atol=0.6
            )

    def test_an_unknown_speed_limit_hinders_no_motion(self, robot: irb.Robot) -> None:
        """`robot export` ended where a file states no speed and a body had to be moved."""
        unknown = [
            joint.model_copy(
                update={"limits": joint.limits.model_copy(update={"speed_deg_s": None})}
            )
            for joint in robot.joints
        ]
        for motion in standard_motions(robot.model_copy(update={"joints": tuple(unknown)})):
            assert 0.0 < np.abs(motion.qd).max() <= 1.0

    def test_difference_is_what_the_tensors_make(self, robot: irb.Robot) -> None:
        projected, _ = project(robot)
        found = torque_differences(robot, projected)
        # axis 6 alone moves link 6 only, whose tensor was 2e-5 kg m2 away
        assert found["axis 6 alone"].max() < 1e-3
        assert 0.5 < found["axis 2 alone"][1] < 2.0
        together = np.array([d for name, d in found.items() if "mixture" in name])
        assert 0.1 < together.max() < 4.0

    def test_a_robot_differs_from_itself_by_nothing(self, robot: irb.Robot) -> None:
        assert all(d.max() == 0.0 for d in torque_differences(robot, robot).values())


class TestPositiveDefinite:
    def test_shown_for_the_table_as_printed(self, robot: irb.Robot) -> None:
        """Links 2 and 3 are indefinite; the part of M of links 1-3 is bounded from below over the
        whole box."""
        found = certify(robot)
        assert found.shown
        assert "links 1-3 is positive definite" in found.reason

    def test_sampling_never_falls_below_the_bound(self, robot: irb.Robot, model: irb.Model) -> None:
        """M of the whole arm may be smaller than that of links 1-3, but never negative."""
        q = np.random.default_rng(7).uniform(robot.q_min, robot.q_max, (5000, 6))
        smallest = np.linalg.eigvalsh(model.mass_matrix(q))[:, 0].min()
        assert 0.04 < smallest < 0.05

    def test_shown_at_once_for_consistent_bodies(self, robot: irb.Robot) -> None:
        found = certify(project(robot)[0])
        assert found.shown
        assert found.reason == "no body has a negative principal moment"

    def test_not_shown_where_it_is_not_so(self, robot: irb.Robot) -> None:
        links = list(robot.links)
        bad = links[1].body.model_copy(
            update={"mass_kg": 0.1, "inertia_kgm2": (0, 0, -50.0, 0, 0, 0)}
        )
        links[1] = links[1].model_copy(update={"body": bad})
        light = robot.model_copy(update={"links": tuple(links)})
        found = certify(light)
        assert not found.shown
        assert "may not be" in found.reason
        rng = np.random.default_rng(0)
        q = rng.uniform(robot.q_min, robot.q_max, (200, 6))
        assert np.linalg.eigvalsh(irb.Model(light).mass_matrix(q))[:, 0].min() < 0.0

    def test_an_indefinite_tool_concerns_the_whole_arm(self, robot: irb.Robot) -> None:
        assert robot.tool is not None
        body = robot.tool.body.model_copy(update={"inertia_kgm2": (-0.1, 0.2, 0.2, 0, 0, 0)})
        arm = robot.model_copy(update={"tool": robot.tool.model_copy(update={"body": body})})
        found = certify(arm)
        assert not found.shown
        assert "link 6" in found.reason
