"""Self-contained pages of plans, runs, studies, identifications and diagnoses: one family.

A page answers first, then shows figures that follow light, dark, phone and print, then says where
it comes from. A page of one's own is made of the same parts (`Page`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from irb2400_ctrl._lazy import lazily

if TYPE_CHECKING:
    from irb2400_ctrl.report.elements.arm_view import ArmView, Colouring
    from irb2400_ctrl.report.elements.page import Page
    from irb2400_ctrl.report.elements.provenance import Provenance
    from irb2400_ctrl.report.main_job import MainJob, run_main_job
    from irb2400_ctrl.report.pages.diagnosis_page import diagnosis_page
    from irb2400_ctrl.report.pages.excitation_page import excitation_page
    from irb2400_ctrl.report.pages.identification_motion_page import identification_motion_page
    from irb2400_ctrl.report.pages.identification_page import identification_page
    from irb2400_ctrl.report.pages.placement_page import placement_page, rail_page
    from irb2400_ctrl.report.pages.plan_page import plan_page
    from irb2400_ctrl.report.pages.simulation_page import simulation_page
    from irb2400_ctrl.report.pages.sweep_page import sweep_page
    from irb2400_ctrl.report.pages.validation_page import validation_page
    from irb2400_ctrl.report.pages.watch_page import watch_page

__all__ = [
    "ArmView",
    "Colouring",
    "MainJob",
    "Page",
    "Provenance",
    "diagnosis_page",
    "excitation_page",
    "identification_motion_page",
    "identification_page",
    "placement_page",
    "plan_page",
    "rail_page",
    "run_main_job",
    "simulation_page",
    "sweep_page",
    "validation_page",
    "watch_page",
]

# each draws with Matplotlib for one command; nobody needs all of them
__getattr__ = lazily(
    __name__,
    {
        "ArmView": "elements.arm_view",
        "Colouring": "elements.arm_view",
        "MainJob": "main_job",
        "Page": "elements.page",
        "Provenance": "elements.provenance",
        "diagnosis_page": "pages.diagnosis_page",
        "excitation_page": "pages.excitation_page",
        "identification_motion_page": "pages.identification_motion_page",
        "identification_page": "pages.identification_page",
        "placement_page": "pages.placement_page",
        "plan_page": "pages.plan_page",
        "rail_page": "pages.placement_page",
        "run_main_job": "main_job",
        "simulation_page": "pages.simulation_page",
        "sweep_page": "pages.sweep_page",
        "validation_page": "pages.validation_page",
        "watch_page": "pages.watch_page",
    },
)
