"""Figures and self-contained pages of plans, runs, studies and diagnoses."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irb2400_ctrl._lazy import lazily

if TYPE_CHECKING:
    from irb2400_ctrl.report.diagnosis_report import diagnosis_page
    from irb2400_ctrl.report.main_job import MainJob, run_main_job
    from irb2400_ctrl.report.plan_figures import save_figures
    from irb2400_ctrl.report.simulation_figures import tracking_figure
    from irb2400_ctrl.report.sweep_figures import sweep_figure

__all__ = [
    "MainJob",
    "diagnosis_page",
    "run_main_job",
    "save_figures",
    "sweep_figure",
    "tracking_figure",
]

# each draws with Matplotlib for one command; nobody needs all of them
__getattr__ = lazily(
    __name__,
    {
        "MainJob": "main_job",
        "diagnosis_page": "diagnosis_report",
        "run_main_job": "main_job",
        "save_figures": "plan_figures",
        "sweep_figure": "sweep_figures",
        "tracking_figure": "simulation_figures",
    },
)
