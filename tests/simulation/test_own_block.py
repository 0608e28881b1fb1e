"""A block of one's own: it is simulated as its package works, in the units of the ports."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from simulation.planar_arm import planar, reach

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.controllers import guarded
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.simulation import simulate

UNITS = {"q": "rad", "qd": "rad/s", "q_ref": "rad", "qd_ref": "rad/s"}
LIMIT = Field(
    "tau_limit", 2, "Nm", "largest magnitude of tau that is sent", (12.0, 1.0), (0.0,) * 2
)


def own(*, low: float = -1e3, high: float = 1e3, table: bool = False) -> Block:
    """A stiff law that leaves the cutting of its torque to its bounds, or to a row of the table."""
    ports = {name: ca.SX.sym(name, 2) for name in UNITS}
    row = ca.SX.sym("tau_limit", 2)
    error = ports["q_ref"] - ports["q"]
    tau = ca.DM([900, 90]) * (error + (ports["qd_ref"] - ports["qd"]) / 15)
    taken = [*ports.values(), row] if table else [*ports.values()]
    names = [*ports, "tau_limit"] if table else [*ports]
    end = (12.0, 1.0)
    lower, upper = (tuple(-v for v in end), end) if table else ((low, low), (high, high))
    return Block(
        "own",
        "a law of one's own",
        1e-3,
        states=(),
        inputs=tuple(Field(name, 2, unit, name) for name, unit in UNITS.items()),
        outputs=(Field("tau", 2, "Nm", "torque", lower=lower, upper=upper),),
        parameters=(LIMIT,) if table else (),
        step=ca.Function("own", taken, [tau], names, ["tau"]),
    )


def commands(block: Block, **gains: float) -> np.ndarray:
    run = simulate(planar(), reach(), block, gains=gains)
    return np.asarray(run.signals["command"])


def test_its_torque_is_cut_at_its_bounds_as_in_the_package() -> None:
    assert commands(own()).min() < -20.0
    assert commands(own(low=-10.0, high=1.0)).min() == -10.0
    device = HostController(Package(own(low=-10.0, high=1.0), "double"))
    tau, status = device.step([0.0, 0.0, 0.0, 0.0, 0.5, -0.5, 0.0, 0.0])
    assert (tau.tolist(), status) == ([1.0, -10.0], 0)


def test_the_row_of_the_table_takes_the_place_of_the_bounds() -> None:
    assert np.abs(commands(own(table=True))).max(axis=0).tolist() == [12.0, 1.0]
    assert np.abs(commands(own(table=True), tau_limit=2.0)).max(axis=0).tolist() == [2.0, 2.0]


@pytest.mark.parametrize(
    ("port", "unit", "expected"),
    [("q", "deg", "rad"), ("qd_ref", "rpm", "rad/s"), ("tau", "A", "Nm"), ("tau", "mNm", "Nm")],
)
def test_ports_in_other_units_are_refused(port: str, unit: str, expected: str) -> None:
    block = own()
    fields = {
        group: tuple(replace(f, unit=unit) if f.name == port else f for f in getattr(block, group))
        for group in ("inputs", "outputs")
    }
    for use in (lambda b: simulate(planar(), reach(), b), lambda b: guarded(b, planar())):
        with pytest.raises(InputError, match=f"{port} is in {unit}; expected {expected}"):
            use(replace(block, **fields))


@pytest.mark.parametrize("unit", ["N m", "N*m", "N·m", "", "-"])
def test_other_spellings_are_the_same_unit(unit: str) -> None:
    block = own()
    commands(replace(block, outputs=(replace(block.outputs[0], unit=unit),)))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"sample_time": 0.0}, "sample_time: found 0.0, expected a positive number"),
        ({"sample_time": "1 ms"}, "sample_time: found '1 ms', expected a number"),
        ({"name": "left arm"}, "found 'left arm' as the name of a block"),
        ({"outputs": Field("tau", 2, "Nm", "torque")}, "outputs: found a Field"),
    ],
)
def test_what_is_no_block_is_said(change: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        replace(own(), **change)


def test_a_field_takes_arrays_as_lists() -> None:
    field = Field("gain", 2, "Nm", "K", default=np.array([1.0, 2.0]), lower=[0.0, 0.0])
    assert (field.default, field.lower) == ((1.0, 2.0), (0.0, 0.0))
