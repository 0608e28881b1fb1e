"""Self-contained pages of plans, runs, studies, identifications and diagnoses: one family.

A page answers first, then shows figures that follow light, dark, phone and print, then says where
it comes from. A page of one's own is made of the same parts (`Page`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from irb2400_ctrl._lazy import lazily

if TYPE_CHECKING:
    from irb2400_ctrl.report.arm_view import ArmView, Colouring
    from irb2400_ctrl.report.diagnosis_report import diagnosis_page
    from irb2400_ctrl.report.excitation_page import excitation_page
    from irb2400_ctrl.report.identification_report import identification_page
    from irb2400_ctrl.report.main_job import MainJob, run_main_job
    from irb2400_ctrl.report.page import Page
    from irb2400_ctrl.report.plan_page import plan_page
    from irb2400_ctrl.report.provenance import Provenance
    from irb2400_ctrl.report.simulation_page import simulation_page
    from irb2400_ctrl.report.sweep_page import sweep_page
    from irb2400_ctrl.report.validation_report import validation_page

__all__ = [
    "ArmView",
    "Colouring",
    "MainJob",
    "Page",
    "Provenance",
    "diagnosis_page",
    "excitation_page",
    "identification_page",
    "plan_page",
    "run_main_job",
    "simulation_page",
    "sweep_page",
    "validation_page",
]

# each draws with Matplotlib for one command; nobody needs all of them
__getattr__ = lazily(
    __name__,
    {
        "ArmView": "arm_view",
        "Colouring": "arm_view",
        "MainJob": "main_job",
        "Page": "page",
        "Provenance": "provenance",
        "diagnosis_page": "diagnosis_report",
        "excitation_page": "excitation_page",
        "identification_page": "identification_report",
        "plan_page": "plan_page",
        "run_main_job": "main_job",
        "simulation_page": "simulation_page",
        "sweep_page": "sweep_page",
        "validation_page": "validation_report",
    },
)
