"""What a URDF states of a joint elsewhere: its `<transmission>`, Drake's rotors in it, and the
spring that Gazebo puts across it."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import dataclass

REDUCTIONS = ("mechanicalReduction", "mechanical_reduction", "drake:gear_ratio")
"""of ROS 1, of ROS 2, of Drake: the last one counts"""
ROTOR = "drake:rotor_inertia"


@dataclass(frozen=True)
class Gear:
    """Between a motor and its joint."""

    ratio: float = 1.0
    """motor turns per joint turn [-]; 1 stands in most files, whatever the gear is"""
    rotor: float | None = None
    """inertia on the motor's side [kg m2]"""


@dataclass(frozen=True)
class Driven:
    """What drives the joints of a file, by their names."""

    gears: Mapping[str, Gear]
    springs: Mapping[str, tuple[str | None, str | None]]
    """stiffness [Nm/rad] and where it is at rest [rad], as they are written"""

    def gear(self, joint: str) -> Gear:
        """Of a joint; direct where the file does not say."""
        return self.gears.get(joint, Gear())


def springs(root: ET.Element) -> dict[str, tuple[str | None, str | None]]:
    """Springs across joints, `<gazebo reference="JOINT">`."""
    return {
        str(element.get("reference")): (
            element.findtext("springStiffness"),
            element.findtext("springReference"),
        )
        for element in root.findall("gazebo")
        if element.find("springStiffness") is not None
    }


def gears(root: ET.Element) -> dict[str, Gear]:
    """What the transmissions that turn one joint say, by its name; words in place of a number say
    nothing."""
    found: dict[str, Gear] = {}
    for element in root.iter("transmission"):
        names = {str(joint.get("name")) for joint in element.findall("joint")}
        if len(names) != 1:
            continue
        ratios = [_number(one) for tag in REDUCTIONS for one in element.iter(tag)]
        stated = [ratio for ratio in ratios if ratio]
        rotors = [_number(one) for one in element.iter(ROTOR)]
        found[names.pop()] = Gear(stated[-1] if stated else 1.0, rotors[-1] if rotors else None)
    return found


def _number(element: ET.Element) -> float | None:
    """In an attribute, as Drake has it, or between the tags."""
    try:
        return float(element.get("value", element.text or ""))
    except ValueError:
        return None
