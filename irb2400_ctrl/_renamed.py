"""Module names of version 0.1, importable until 0.3 with a `DeprecationWarning`."""

from __future__ import annotations

import importlib
import sys
import warnings
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

PACKAGE = "irb2400_ctrl."
RENAMED = {
    "codegen.toolchain": "codegen.machine_code.toolchain",
    "diagnosis.bases": "diagnosis.regressors.bases",
    "diagnosis.candidate": "diagnosis.estimation.candidate",
    "diagnosis.confidence": "diagnosis.comparison.confidence",
    "diagnosis.criteria": "diagnosis.comparison.criteria",
    "diagnosis.evidence": "diagnosis.estimation.evidence",
    "diagnosis.fit": "diagnosis.estimation.fit",
    "diagnosis.generic": "diagnosis.comparison.non_parametric",
    "diagnosis.judge": "diagnosis.comparison.comparison",
    "diagnosis.memory": "diagnosis.regressors.effect_states",
    "diagnosis.metrics": "diagnosis.preparation.metrics",
    "diagnosis.motion": "measurement.prepared_log",
    "diagnosis.noise": "diagnosis.preparation.noise",
    "diagnosis.nuisance": "diagnosis.preparation.base_prior",
    "diagnosis.parameters": "diagnosis.estimation.effect_parameters",
    "diagnosis.predict": "diagnosis.regressors.predict",
    "diagnosis.result": "diagnosis.diagnosis",
    "diagnosis.scan": "diagnosis.comparison.scan",
    "diagnosis.selection": "diagnosis.comparison.selection",
    "diagnosis.step": "diagnosis.comparison.step",
    "diagnosis.vectorised": "symbolic.vectorised",
    "diagnosis.windows": "diagnosis.comparison.onset",
    "excitation.design": "excitation.motion_design",
    "excitation.result": "excitation.excitation",
    "measurement.clock_times": "measurement.text.clock_times",
    "measurement.column_map": "measurement.columns.column_map",
    "measurement.csv_dialect": "measurement.text.csv_dialect",
    "measurement.joint_order": "measurement.columns.joint_order",
    "measurement.signal_names": "measurement.columns.signal_names",
    "model.evaluate": "model.numeric",
    "planners.added_torque": "planners.enclosure.effect_bounds",
    "planners.ball": "planners.enclosure.complex_disc",
    "planners.builders": "planners.toolpath.builders",
    "planners.cells": "planners.enclosure.cells",
    "planners.certificate": "planners.timing.certificate",
    "planners.certified": "planners.timing.time_optimal",
    "planners.deviation": "planners.enclosure.deviation",
    "planners.effect_forms": "planners.enclosure.effect_forms",
    "planners.egm": "planners.programs.egm.egm_stream",
    "planners.egm_proto": "planners.programs.egm.egm_messages",
    "planners.feed": "planners.timing.feed",
    "planners.follow": "planners.redundancy.follow",
    "planners.interior_point": "planners.timing.rate_limited.interior_point",
    "planners.interval": "planners.enclosure.interval",
    "planners.irregular": "planners.timing.sampled_timing",
    "planners.kept_law": "planners.trajectory_optimisation.retiming",
    "planners.knots": "planners.trajectory_optimisation.knots",
    "planners.ladder": "planners.redundancy.ladder_graph",
    "planners.limits": "planners.timing.motion_limits",
    "planners.margins": "planners.redundancy.singularity_margins",
    "planners.optimise": "planners.trajectory_optimisation.optimise_motion",
    "planners.optimised": "planners.trajectory_optimisation.optimised",
    "planners.orientation": "planners.toolpath.orientation",
    "planners.path_dynamics": "planners.enclosure.path_dynamics",
    "planners.positioner": "planners.toolpath.positioner",
    "planners.rapid": "planners.programs.rapid.rapid_program",
    "planners.rapid_data": "planners.programs.rapid.rapid_data",
    "planners.rapid_reader": "planners.programs.rapid.rapid_reader",
    "planners.rapid_thinning": "planners.programs.rapid.rapid_thinning",
    "planners.read_path": "planners.toolpath.read_path",
    "planners.remedies": "planners.redundancy.wrist_remedies",
    "planners.retime": "planners.timing.time_joint_path",
    "planners.rows": "planners.timing.torque_constraints",
    "planners.selection": "planners.redundancy.choices",
    "planners.smooth_certificate": "planners.timing.rate_limited.output_bounds",
    "planners.smooth_channels": "planners.timing.rate_limited.constrained_outputs",
    "planners.smooth_grid": "planners.timing.rate_limited.rate_limited_grid",
    "planners.smooth_law": "planners.timing.rate_limited.rate_limited_law",
    "planners.smooth_looks": "planners.timing.rate_limited.sampled_check",
    "planners.smooth_program": "planners.timing.rate_limited.rate_limited_program",
    "planners.smooth_timing": "planners.timing.rate_limited.time_rate_limited",
    "planners.sparse_program": "planners.trajectory_optimisation.sparse_program",
    "planners.stuck": "planners.timing.infeasible_point",
    "planners.task_curve": "planners.toolpath.task_curve",
    "planners.time_law": "planners.timing.time_law",
    "planners.tip": "planners.enclosure.tcp_path",
    "planners.toppra_timing": "planners.timing.toppra_timing",
    "planners.transcription": "planners.trajectory_optimisation.transcription",
    "planners.two_pass": "planners.timing.two_pass",
    "planners.warm_start": "planners.trajectory_optimisation.warm_start",
    "planners.waypoints": "planners.trajectory_optimisation.waypoints",
    "planners.wrist_passage": "planners.redundancy.wrist_passage",
    "simulation.close_loop": "simulation.close_the_loop",
    "simulation.elasticity": "simulation.spring_step",
    "simulation.recorded": "measurement.recorded",
    "simulation.result": "simulation.simulation",
    "simulation.trajectory": "trajectory",
    "measurement.two_part_time": "measurement.columns.two_part_time",
    "urdf": "robot.urdf_export",
}
"""old name -> new name, both below `irb2400_ctrl`"""


class KeepsItsPromises(ModuleType):
    """A package whose functions stay where they are when a module of the same name is loaded."""

    def __setattr__(self, name: str, value: object) -> None:
        if not (isinstance(value, ModuleType) and callable(getattr(self, name, None))):
            super().__setattr__(name, value)


class OldNames(MetaPathFinder, Loader):
    """Finds a module under the name it had before; asked only where no such file exists."""

    def __init__(self) -> None:
        self._true_specs: dict[str, ModuleSpec | None] = {}

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The place of the renamed module, None for any other name."""
        new = RENAMED.get(name.removeprefix(PACKAGE)) if name.startswith(PACKAGE) else None
        return None if new is None else ModuleSpec(name, self, origin=PACKAGE + new)

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """The module itself, so that its classes are the same under both names."""
        assert spec.origin is not None
        warnings.warn(
            f"{spec.name} is called {spec.origin} now; the old name goes in version 0.3",
            DeprecationWarning,
            stacklevel=2,
        )
        module = importlib.import_module(spec.origin)
        # what imports a module makes it an attribute of its package
        sys.modules[spec.name.rpartition(".")[0]].__class__ = KeepsItsPromises
        self._true_specs[spec.origin] = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Give the module its own spec back; it has run under its new name."""
        module.__spec__ = self._true_specs[module.__name__]


def install() -> None:
    """Ask `OldNames` after every other finder."""
    if not any(isinstance(finder, OldNames) for finder in sys.meta_path):
        sys.meta_path.append(OldNames())
