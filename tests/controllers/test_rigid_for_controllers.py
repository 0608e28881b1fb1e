"""A joint with elasticity or play counts as rigid for every controller, its guard and the observer;
inertias that no arm can have are said to be that."""

from __future__ import annotations

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.controllers import CONTROLLERS, controller, guarded, momentum_observer
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError

ROBOT = irb.load_robot("irb2400")
SOFT = ROBOT.with_effects(
    LIBRARY["elastic_joint"].of(2, stiffness_Nm_rad=3e5, stiffening_per_rad=100.0),
    LIBRARY["transmission_backlash"].of(5, **LIBRARY["transmission_backlash"].example),
)


def made(name: str, robot: irb.Robot) -> Block:
    if name == "momentum_observer":
        return momentum_observer(robot)
    return guarded(controller(name, robot), robot)


@pytest.mark.parametrize("name", [*CONTROLLERS, "momentum_observer"])
def test_springs_and_play_are_left_out_of_the_code(name: str) -> None:
    """Guards, observer and `gravity_pd` held the spring's law, which has no form in C: no package
    of an arm with an elastic joint could be made."""
    soft = made(name, SOFT)
    stiff = made(name, ROBOT)
    package = Package(soft, "float")
    assert package.graph == Package(stiff, "float").graph
    running = HostController(package)
    assert running.init_status == 0
    assert running.step(package.initial_input())[1] == 0


@pytest.mark.parametrize("name", ["gravity_pd", "pid"])
def test_an_axis_without_inertia_is_said(name: str) -> None:
    """Eigenvalues that did not converge were all that was said."""
    coupled = LIBRARY["far_wrist_coupling"].of(4, inertia_kgm2=0.3)
    with pytest.raises(InputError, match=r"no kinetic energy.*inertias.*far_wrist_coupling"):
        controller(name, ROBOT.with_effects(coupled))
    assert np.all(controller(name, ROBOT).parameters[0].start > 0)
