"""What the written files hold: every key of every JSON file, every column of trajectory.csv and of
a sweep's cases, with its unit.

`irb2400 schema` prints them; the tests hold every such file they make against them.
"""

from irb2400_ctrl.formats.case_row import CaseRow
from irb2400_ctrl.formats.excitation_file import ExcitationFile
from irb2400_ctrl.formats.findings_file import FindingsFile
from irb2400_ctrl.formats.identification_file import (
    CovarianceFile,
    IdentificationFile,
    ValidationFile,
)
from irb2400_ctrl.formats.placement_file import PlacementFile
from irb2400_ctrl.formats.plan_file import PlanFile
from irb2400_ctrl.formats.program_file import ProgramFile
from irb2400_ctrl.formats.rotation_map_file import RotationMapFile
from irb2400_ctrl.formats.simulation_file import ClosedLoopFile, SimulationFile
from irb2400_ctrl.formats.trajectory_row import TrajectoryRow
from irb2400_ctrl.formats.verification_file import VerificationFile
from irb2400_ctrl.formats.watch_file import WatchFile

__all__ = [
    "JSON_FILES",
    "CaseRow",
    "ClosedLoopFile",
    "CovarianceFile",
    "ExcitationFile",
    "FindingsFile",
    "IdentificationFile",
    "PlacementFile",
    "PlanFile",
    "ProgramFile",
    "RotationMapFile",
    "SimulationFile",
    "TrajectoryRow",
    "ValidationFile",
    "VerificationFile",
    "WatchFile",
]

JSON_FILES = {
    "plan": PlanFile,
    "program": ProgramFile,
    "rotation_map": RotationMapFile,
    "placement": PlacementFile,
    "simulation": SimulationFile,
    "findings": FindingsFile,
    "closed_loop": ClosedLoopFile,
    "identification": IdentificationFile,
    "covariance": CovarianceFile,
    "validation": ValidationFile,
    "excitation": ExcitationFile,
    "watch": WatchFile,
    "verification": VerificationFile,
}
"""what is in NAME.json"""
