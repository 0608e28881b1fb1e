"""The three lists of a diagnosis in words: what the file lacks, what is special, what changed.

One kind on several joints is one entry, numbers of one name are one row.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.diagnosis import Diagnosis, Finding, Number
from irb2400_ctrl.diagnosis.comparison.acceptance import STANDARD_ERRORS
from irb2400_ctrl.report.elements.page import sentence, show, with_error
from irb2400_ctrl.report.pages.diagnosis_tables import numbers_beside, window
from irb2400_ctrl.wording import joined, numbered

LISTS = {
    "changed": (
        "What changed since the reference",
        "Look at what happened to the arm since then; the causes below begin with the largest.",
    ),
    "special": (
        "What is special on this arm",
        "Other arms of this type do not have it: look at the arm before trusting its model.",
    ),
    "lacks": (
        "What the file lacks, as on every robot",
        "No fault of the arm: the robot.toml beside this report has these numbers.",
    ),
}
"""heading of each list and what to do about it, in the order of their weight"""
OF_A_FILE = (
    "What is otherwise than the reference file states",
    "It has changed since then, or was there before and is not in the file: diagnose logs of the "
    "reference, and what they show is known.",
)
"""the first of them where the reference is a robot file, which nobody searched for effects"""
WORDS = {
    "coulomb_Nm": "Coulomb friction [Nm]",
    "viscous_Nms_rad": "viscous friction [Nm s/rad]",
    "offset_Nm": "torque offset [Nm]",
    "rotor_kgm2": "rotor inertia [kg m2]",
    "mass_kg": "mass [kg]",
    "load_kg": "load beyond the mass [kg]",
    "friction_ratio": "all friction over the reference's [-]",
    **{f"com_{axis}_m": f"centre of mass {axis} [m]" for axis in "xyz"},
    **{f"I{k}": f"inertia I{k} [kg m2]" for k in ("xx", "yy", "zz", "xy", "xz", "yz")},
}
"""names of numbers for a reader"""
SIGNED = ("com_x_m", "com_y_m", "com_z_m", "Ixy", "Ixz", "Iyz", "offset_Nm")
"""numbers whose zero says nothing: a centre of mass from -1.8 to -350 mm has no per cent"""
MOST_LINES = 8
"""of numbers of one list that a terminal shows"""


@dataclass(frozen=True)
class Entry:
    """Findings of one kind in one list.

    Args:
        findings: the largest first.
    """

    findings: tuple[Finding, ...]

    @property
    def kind(self) -> str:
        """As in findings.json."""
        return self.findings[0].effect.kind

    @property
    def where(self) -> str:
        """`joint 4`, `joints 1, 3 and 4`, or the whole arm."""
        joints = sorted({f.effect.joint for f in self.findings if f.effect.joint is not None})
        return "the whole arm" if not joints else numbered("joint", joints)

    @property
    def sentence(self) -> str:
        """What it is, in plain words."""
        return sentence(self.findings[0].says)

    @property
    def size(self) -> str:
        """Of each joint, in the order of `where`: the number with its error."""
        sizes = list(map(_size, sorted(self.findings, key=lambda f: f.effect.joint or 0)))
        first = sizes[0].partition(" ")[0] + " "
        return "; ".join([sizes[0], *(size.removeprefix(first) for size in sizes[1:])])

    @property
    def share(self) -> str:
        """Of the joints' torque."""
        shares = [100.0 * float(np.max(f.share)) for f in self.findings]
        low = min(shares)
        high = max(shares)
        return f"{high:.1f} %" if high - low < 0.1 else f"{low:.1f} to {high:.1f} %"

    @property
    def confidence(self) -> str:
        """Of the least sure one."""
        return f"{100.0 * min(f.confidence for f in self.findings):.0f} %"

    @property
    def gain(self) -> str:
        """How much worse the other motion is predicted without the name; empty if not known."""
        told = [f.validation_gain for f in self.findings if f.validation_gain is not None]
        if not told:
            return ""
        return f"{abs(max(told)):.0f} % {'smaller' if max(told) >= 0.0 else 'larger'}"

    @property
    def lookalikes(self) -> str:
        """Kinds that the log cannot exclude."""
        return ", ".join(dict.fromkeys(a for f in self.findings for a in f.alternatives))

    @property
    def could_be(self) -> str:
        """The same in a sentence: `torque_offset or balancer`."""
        return joined(self.lookalikes.split(", "), "or")

    @property
    def splits(self) -> str:
        """What to measure to exclude them."""
        return next((f.splits for f in self.findings if f.splits), "")

    @property
    def line(self) -> str:
        """All of it in one sentence."""
        text = f"{self.kind} on {self.where}: {self.size} ({self.share} of the torque, "
        text += f"confidence {self.confidence}"
        if self.gain:
            text += f", held-out error {self.gain}"
        if self.lookalikes:
            text += f"; not excluded: {self.lookalikes}"
        return text + ")"


def lists_of(diagnosis: Diagnosis) -> dict[str, tuple[str, str]]:
    """The lists with their headings and advice, as the reference of a diagnosis asks for."""
    return LISTS if diagnosis.before is not None else {**LISTS, "changed": OF_A_FILE}


def findings_of(diagnosis: Diagnosis, which: str) -> list[Entry]:
    """Entries of one list, those of the reference included."""
    found = list(diagnosis.findings)
    if diagnosis.before is not None:
        found += diagnosis.before.findings
    by_kind: dict[tuple[str, str], list[Finding]] = {}
    for finding in found:
        if finding.list == which:
            by_kind.setdefault((finding.effect.kind, finding.says), []).append(finding)
    entries = [
        Entry(tuple(sorted(group, key=lambda f: -float(np.max(f.share)))))
        for group in by_kind.values()
    ]
    return sorted(entries, key=lambda e: -max(float(np.max(f.share)) for f in e.findings))


def numbers_of(diagnosis: Diagnosis, which: str) -> list[Number]:
    """Numbers of one list, those of the reference included; the furthest moved first."""
    found = list(diagnosis.numbers)
    if diagnosis.before is not None:
        found += diagnosis.before.numbers
    return sorted((n for n in found if n.list == which), key=_furthest_first)


def _furthest_first(number: Number) -> float:
    return -abs(number.sigmas)


def number_lines(numbers: Sequence[Number]) -> list[str]:
    """A line for each name of number, its joints together, the furthest moved first."""
    by_name: dict[str, list[Number]] = {}
    for number in numbers:
        by_name.setdefault(number.name, []).append(number)
    return [_number_line(name, group) for name, group in by_name.items()]


def _number_line(name: str, numbers: Sequence[Number]) -> str:
    """`mass [kg] of tool: 20 -> 23 ± 0.1 (+15 %)`, or of several the range of the change: of
    coordinates and products of inertia, which have no natural zero, no per cent."""
    words = WORDS.get(name, name)
    if len(numbers) == 1:
        number = numbers[0]
        before = "not stated" if number.before is None else show(number.before)
        text = f"{words} of {number.place}: {before} -> "
        text += with_error(number.after, number.standard_error)
        change = None if name in SIGNED else _change(number)
        return text if change is None else f"{text} ({change:+.0f} %)"
    where = _places([number.place for number in numbers])
    if name in SIGNED and None not in [number.before for number in numbers]:
        moves = [number.after - (number.before or 0.0) for number in numbers]
        ends = dict.fromkeys((show(min(moves)), show(max(moves))))
        return f"{words} of {where}: moved by {' to '.join(ends)}"
    changes = [_change(number) for number in numbers]
    told = [change for change in changes if change is not None]
    if len(told) < len(changes):
        values = ", ".join(show(number.after) for number in sorted(numbers, key=_place))
        return f"{words} of {where}: {values}"
    return f"{words} of {where}: {min(told):+.0f} to {max(told):+.0f} %"


def _change(number: Number) -> float | None:
    """[%] of what it was; None where that is next to nothing, or not stated."""
    if number.before is None or abs(number.before) <= 0.1 * number.standard_error:
        return None
    return 100.0 * (number.after / number.before - 1.0)


def _place(number: Number) -> str:
    return number.place


def _places(places: Sequence[str]) -> str:
    """`joints 1, 2 and 4`, `link 3 and tool`."""
    joints = sorted(int(p.split()[1]) for p in places if p.startswith("joint"))
    links = sorted(int(p.split()[1]) for p in places if p.startswith("link"))
    others = sorted(p for p in places if not p.startswith(("joint", "link")))
    each_kind = [numbered(*each) for each in (("joint", joints), ("link", links)) if each[1]]
    return " and ".join([*each_kind, *others])


def list_lines(diagnosis: Diagnosis) -> list[str]:
    """The lists for a terminal."""
    found = []
    for which, (heading, _) in lists_of(diagnosis).items():
        entries = findings_of(diagnosis, which)
        numbers = numbers_of(diagnosis, which)
        if not entries and not numbers:
            continue
        found.append(f"{heading.lower()}:")
        for entry in entries:
            found += [f"  {entry.line}", f"    {entry.sentence}"]
            found += [f"    {text}" for text in (*further_numbers(entry), *body_lines(entry))]
            if entry.lookalikes and entry.splits:
                found.append(f"    to tell them apart: {entry.splits}")
        told = number_lines(numbers)
        found += [f"  {line}" for line in told[:MOST_LINES]]
        if len(told) > MOST_LINES:
            found.append(f"  and {len(told) - MOST_LINES} further numbers (findings.json)")
    return found


def further_numbers(entry: Entry) -> list[str]:
    """A line for each joint: the numbers beside the one of its size, if the effect has others."""
    found = []
    for finding in sorted(entry.findings, key=lambda f: f.effect.joint or 0):
        name = _first(finding)
        told = "" if name is None else numbers_beside(finding, name)
        if told:
            place = f" of joint {finding.effect.joint}" if len(entry.findings) > 1 else ""
            found.append(f"its other numbers{place}: {told}")
    return found


def body_lines(entry: Entry) -> list[str]:
    """Both estimates of a body."""
    found = []
    for finding in entry.findings:
        if finding.body is None:
            continue
        for name, body in (
            ("with the arm's bodies uncertain", finding.body.robust),
            ("were the file's bodies exact, ± of the noise alone", finding.body.given_bodies),
        ):
            mass = with_error(body.mass, body.errors[0])
            centre = ", ".join(
                with_error(1e3 * v, 1e3 * e) for v, e in zip(body.com, body.errors[1:], strict=True)
            )
            found.append(f"{name}: {mass} kg at ({centre}) mm")
    return found


def entry_rows(entries: Iterable[Entry]) -> tuple[Sequence[str], list[list[object]]]:
    """Head and rows of one list."""
    head = ("what", "where", "size", "of the torque", "confidence", "held-out error", "looks like")
    rows: list[list[object]] = [
        [e.kind, e.where, e.size, e.share, e.confidence, e.gain or "-", e.lookalikes or "-"]
        for e in entries
    ]
    return head, rows


def number_rows(numbers: Iterable[Number]) -> tuple[Sequence[str], list[list[object]]]:
    """Head and rows of numbers."""
    head = ("number", "of", "before", "now", "standard error", "sigmas")
    rows: list[list[object]] = [
        [
            n.name,
            n.place,
            "-" if n.before is None else n.before,
            n.after,
            n.standard_error,
            f"{n.sigmas:+.1f}",
        ]
        for n in numbers
    ]
    return head, rows


def _size(finding: Finding) -> str:
    """The first number of an effect, with its error. Then what is so of it (`of_angle`,
    `in_tool_frame`) and when it acts."""
    name = _first(finding)
    if name is None:
        return ""
    parameters = finding.effect.parameters()
    error = finding.standard_errors.get(name)
    value = parameters[name]
    told = with_error(value, error) if isinstance(error, float) else show(value)
    when = [window(*each, " s") for each in finding.effect.windows_s]
    acts = [f"acts {joined(when)}"] if when else []
    return ", ".join([f"{name} {told}", *(k for k, v in parameters.items() if v is True), *acts])


def _first(finding: Finding) -> str | None:
    """The first number of an effect, of a direction its largest part; another one where that is
    nothing and the other stands clear."""
    numbers = {k: v for k, v in finding.effect.parameters().items() if isinstance(v, float)}
    if not numbers:
        return None
    errors = finding.standard_errors
    clear = {
        k: abs(v) / max(error, 1e-12)
        for k, v in numbers.items()
        if isinstance(error := errors.get(k), float)
    }
    first = next(iter(numbers))
    if clear.get(first, np.inf) < STANDARD_ERRORS:
        first = max(clear, key=lambda k: clear[k])
    # force_x_N, force_y_N, force_z_N are parts of one
    parts = [k for k in numbers if _without_axis(k) == _without_axis(first)]
    return max(parts, key=lambda k: abs(numbers[k]))


def _without_axis(name: str) -> str:
    return re.sub("_[xyz]_", "_", name)
