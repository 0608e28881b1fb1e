"""`<frame>` of MJCF: what stands in one is put where the frame places it, and the frame is gone."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.importing.mjcf_orientation import TURNS, Numbers, over
from irb2400_ctrl.robot.importing.mjcf_parts import Defaults, stated_numbers
from irb2400_ctrl.robot.importing.tree import pose

_OF_CLASS = ("joint", "geom", "site")
_MADE = ("replicate", "attach", "composite", "flexcomp")
"""what MuJoCo makes other elements of"""


@dataclass(frozen=True)
class Frames:
    """Takes the frames of a file away.

    Args:
        path: of the file, for messages.
        classes: its default classes.
        turned: reads an orientation.
    """

    path: Path
    classes: Defaults
    turned: Callable[[Mapping[str, str], Numbers], Array]

    def dissolve(self, parent: ET.Element, kind: str = "main") -> None:
        """Put the contents of the frames of a body, or of the world, into it.

        Args:
            parent: the body; its bodies are gone through as well.
            kind: the default class of what stands in it.

        Raises:
            InputError: elements that MuJoCo has to make of others.
        """
        parent[:] = [
            inner for child in list(parent) for inner in self._out(parent, child, kind, None)
        ]

    def _out(
        self, parent: ET.Element, child: ET.Element, kind: str, X: Array | None
    ) -> list[ET.Element]:
        """The child itself, or what stands in it; X is the pose of the frame around it."""
        tag = str(child.tag)
        if tag in _MADE and (parent.tag == "body" or tag == "attach" or _holds_body(child)):
            where = parent.get("name", f"<{parent.tag}>")
            raise InputError(
                f"{self.path}: <{tag}> in {where} is not read; save the file as MuJoCo understands "
                "it (mj_saveLastXML) and import that"
            )
        if tag == "frame":
            around = np.eye(4) if X is None else X
            within = child.get("childclass", kind)
            X = around @ self._pose(child.attrib)
            return [inner for one in child for inner in self._out(parent, one, within, X)]
        if tag == "body":
            self.dissolve(child, child.get("childclass", kind))
        if X is not None:
            self._place(child, kind, X)
        return [child]

    def _place(self, element: ET.Element, kind: str, X: Array) -> None:
        """State the element's own class and its place, in the frame around its frame."""
        keys = dict(element.attrib)
        if element.tag == "body":
            element.set("childclass", keys.get("childclass", kind))
        if element.tag in _OF_CLASS:
            element.set("class", keys.get("class", kind))
            of_class = self.classes.get(element.get("class", ""), {})
            keys = over(of_class.get(str(element.tag), {}), keys)
        R = X[:3, :3]
        if element.tag == "joint":
            element.set("pos", _text(R @ self._three(keys.get("pos", "0 0 0")) + X[:3, 3]))
            element.set("axis", _text(R @ self._three(keys.get("axis", "0 0 1"))))
        elif "fromto" in keys:
            ends = stated_numbers(str(self.path), keys["fromto"], 6).reshape(2, 3)
            element.set("fromto", _text((ends @ R.T + X[:3, 3]).ravel()))
        elif element.tag in ("body", "geom", "site"):
            X = X @ self._pose(keys)
            for key in TURNS:
                element.attrib.pop(key, None)
            element.set("pos", _text(X[:3, 3]))
            element.set("xyaxes", _text(X[:3, :2].T.ravel()))

    def _pose(self, keys: Mapping[str, str]) -> Array:
        R = self.turned(keys, lambda text, count: stated_numbers(str(self.path), text, count))
        return pose(self._three(keys.get("pos", "0 0 0")), R)

    def _three(self, text: str) -> Array:
        return stated_numbers(str(self.path), text, 3)


def _holds_body(element: ET.Element) -> bool:
    return element.find(".//body") is not None


def _text(numbers: Array) -> str:
    return " ".join(repr(float(number)) for number in numbers)
