"""What an effect is: in words, in one figure, and what it is taken for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from irb2400_ctrl.report.effect_words import as_in_a_file, excite_line
from irb2400_ctrl.report.elements.page import Page, sentence
from irb2400_ctrl.report.figures.effect_figure import effect_figure

SHOWN = (
    "What it adds to the torque of joint {joint} of an IRB 2400, in a usual size, where all joints "
    "go back and forth: over time, and over what orders it best. Gaps: the joint turns round."
)


def effect_page(found: Mapping[str, Any], robot: str | None = None) -> Page:
    """The page."""
    page = Page(f"The effect {found['kind']}")
    page.answer(
        sentence(found["sentence"]),
        "note",
        [("acts", found["acts_where"]), ("sits on", found["on"])],
    )
    figure, joint = effect_figure(found["kind"])
    page.figure(figure, SHOWN.format(joint=joint))
    page.heading("Its law")
    for part in found["law"].split("\n\n"):
        page.text(" ".join(part.split()))
    if found["parameters"]:
        rows = [
            [
                p["name"],
                p["unit"] or "",
                p["meaning"],
                "" if p["usual"] is None else as_in_a_file(p["usual"]),
            ]
            for p in found["parameters"]
        ]
        page.table("Parameters", ["parameter", "unit", "meaning", "for example"], rows)
    if found["look_alikes"]:
        page.heading("What it is taken for")
        others = [
            [o["kind"], o["sentence"], o["told_apart_by"] or "-", o["measure_else"] or "-"]
            for o in found["look_alikes"]
        ]
        head = ["effect", "what it is", "told apart by", "where no motion helps"]
        page.table("Look-alikes", head, others)
        page.text(f"A motion that separates them: {excite_line(found['kind'], robot)}")
    for remark in found["remarks"]:
        page.text(sentence(remark))
    return page
