"""Many runs: a study drawn over plants, effects, payloads, motions and controllers, on all cores or
a cluster."""

from irb2400_ctrl.sweep.cases import simulate_case
from irb2400_ctrl.sweep.run import Sweep, run_sweep
from irb2400_ctrl.sweep.study import Study, load_study
from irb2400_ctrl.sweep.table import summary_text

__all__ = ["Study", "Sweep", "load_study", "run_sweep", "simulate_case", "summary_text"]
