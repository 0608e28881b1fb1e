"""The report of an object, in a frame that a notebook shows."""

from __future__ import annotations

from functools import singledispatch

from irb2400_ctrl.diagnosis import Diagnosis
from irb2400_ctrl.identification import Identification
from irb2400_ctrl.planners import Plan, ProgramMotion
from irb2400_ctrl.report.elements.page import Page
from irb2400_ctrl.report.elements.provenance import Provenance
from irb2400_ctrl.report.pages.diagnosis_page import diagnosis_page
from irb2400_ctrl.report.pages.identification_page import identification_page
from irb2400_ctrl.report.pages.plan_page import plan_page
from irb2400_ctrl.report.pages.simulation_page import simulation_page
from irb2400_ctrl.simulation import Simulation


def framed(thing: object) -> str:
    """The page of `thing` as one element of HTML; its scripts and styles stay inside."""
    return str(page_of(thing)._repr_html_())


@singledispatch
def page_of(thing: object) -> Page:
    """The report of an object.

    Raises:
        TypeError: it has none.
    """
    raise TypeError(f"no report for {type(thing).__name__}")


@page_of.register
def _plan(thing: Plan) -> Page:
    page = plan_page(thing, f"Plan of {thing.path.name}")
    page.provenance(Provenance.of(thing.robot))
    return page


@page_of.register
def _program(thing: ProgramMotion) -> Page:
    return plan_page(thing, f"Plan of {thing.name}")


@page_of.register
def _run(thing: Simulation) -> Page:
    page = simulation_page(thing, thing.controller.name)
    page.provenance(Provenance.of(thing.robot, seed=thing.seed))
    return page


@page_of.register
def _diagnosis(thing: Diagnosis) -> Page:
    page = diagnosis_page(thing, f"Diagnosis of {thing.identification.name}")
    page.provenance(Provenance.of(thing.given))
    return page


@page_of.register
def _identification(thing: Identification) -> Page:
    page = identification_page(thing)
    page.provenance(Provenance.of(thing.given))
    return page
