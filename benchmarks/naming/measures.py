"""Counts of a naming run, suite by suite, the baseline beside."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from benchmarks.evaluation_table import SURE, VISIBLE, exact, in_group

Line = dict[str, Any]
FLOORS = 2.0
"""times the difference floor beyond which what is left is not noise"""
LEAST_LOAD = 1.9
"""[kg]"""
BINS = (0.0, 0.6, 0.75, 0.9, 0.95, 1.01)


def table(lines: Sequence[Line]) -> str:
    """Markdown: a row per suite and measure, a column per giver."""
    givers = sorted({line["by"] for line in lines}, reverse=True)
    suites = list(dict.fromkeys(line["case"].split("/")[0] for line in lines))
    rows = [f"| suite | measure | {' | '.join(givers)} |", "| --- " * (2 + len(givers)) + "|"]
    for suite in suites:
        of_suite = [line for line in lines if line["case"].split("/")[0] == suite]
        for name, measure in MEASURES.items():
            cells = [measure([x for x in of_suite if x["by"] == giver]) for giver in givers]
            if any(cells):
                rows.append(f"| {suite} | {name} | {' | '.join(c or '-' for c in cells)} |")
    whole = [overall([x for x in lines if x["by"] == giver]) for giver in givers]
    rows += ["", f"| over all suites | {' | '.join(givers)} |", "| --- " * (1 + len(givers)) + "|"]
    rows += [f"| {name} | {' | '.join(one[name] for one in whole)} |" for name in whole[0]]
    return "\n".join(rows)


def _count(hits: int, total: int) -> str:
    return f"{hits} / {total}" if total else ""


def asked(line: Line) -> list[Line]:
    """Effects of the library that stand far enough out of noise and data sheet."""
    return [t for t in line["truth"] if t["in_library"] and t["strength"] >= VISIBLE]


def _names(line: Line) -> list[Line]:
    return line.get("names", [])


def _per_effect(hit: Callable[[Line, Line], bool]) -> Callable[[Sequence[Line]], str]:
    def measure(lines: Sequence[Line]) -> str:
        pairs = [(line, t) for line in lines for t in asked(line)]
        return _count(sum(hit(line, t) for line, t in pairs), len(pairs))

    return measure


def _clean_named(lines: Sequence[Line]) -> str:
    clean = [line for line in lines if not line["truth"]]
    return _count(sum(bool(_names(line)) for line in clean), len(clean))


def _clean_unexplained(lines: Sequence[Line]) -> str:
    clean = [line for line in lines if not line["truth"]]
    return _count(sum(line.get("verdict") == "unexplained" for line in clean), len(clean))


def _refused(lines: Sequence[Line]) -> str:
    count = sum("refused" in x or x.get("verdict") == "log_not_understood" for x in lines)
    return _count(count, len(lines)) if count else ""


def moved(line: Line) -> bool:
    """Whether inertial numbers are said to be off."""
    numbers = line.get("said", {}).get("numbers", [])
    special = [n for n in numbers if n["list"] != "lacks"]
    return any(n["place"].startswith(("tool", "link")) for n in special)


def _payload_named(lines: Sequence[Line]) -> str:
    loaded = [x for x in lines if x["case"].startswith("payload/")]
    named = [x for x in loaded if any(in_group(n, x["truth"][0]) for n in _names(x))]
    return _count(len(named), len(loaded))


def _payload_said(lines: Sequence[Line]) -> str:
    """Of loads that one log can show."""
    loaded = [x for x in lines if x["case"].startswith("payload/")]
    loaded = [x for x in loaded if x["truth"][0]["size"] > LEAST_LOAD and "said" in x]
    said = [x for x in loaded if moved(x) or any(in_group(n, x["truth"][0]) for n in _names(x))]
    return _count(len(said), len(loaded))


def _moved(lines: Sequence[Line]) -> str:
    """On payloads it is wanted, on clean arms it is the price; the baseline says nothing of it."""
    judged = [x for x in lines if "left" in x]
    judged = [x for x in judged if not x["truth"] or x["case"].startswith("payload/")]
    return _count(sum(moved(x) for x in judged), len(judged))


def _silent(lines: Sequence[Line]) -> str:
    arms = [x for x in lines if asked(x)]
    silent = [x for x in arms if not _names(x) and x.get("verdict") == "nothing_missing"]
    return _count(len(silent), len(arms))


def false_names(line: Line) -> list[Line]:
    """Names that no effect of the arm answers to, not even by an alternative."""
    return [n for n in _names(line) if not any(in_group(n, t) for t in line["truth"])]


def _extra(lines: Sequence[Line]) -> str:
    arms = [x for x in lines if x["truth"]]
    return _count(sum(bool(false_names(x)) for x in arms), len(arms))


def _sure_and_wrong(lines: Sequence[Line]) -> str:
    sure = [x for x in lines if any((n["confidence"] or 0.0) >= SURE for n in false_names(x))]
    given = any(n["confidence"] is not None for x in lines for n in _names(x))
    return _count(len(sure), len(lines)) if given else ""


def _all_in_group(lines: Sequence[Line]) -> str:
    arms = [x for x in lines if len(x["truth"]) > 1 and len(asked(x)) == len(x["truth"])]
    hits = sum(all(any(in_group(n, t) for n in _names(x)) for t in asked(x)) for x in arms)
    return _count(hits, len(arms))


def _outside(lines: Sequence[Line]) -> str:
    arms = [x for x in lines if x["truth"] and not x["truth"][0]["in_library"]]
    arms = [x for x in arms if x["truth"][0]["strength"] >= VISIBLE]
    return _count(sum(x.get("verdict") == "unexplained" for x in arms), len(arms))


def called_noise(line: Line) -> bool:
    """More than twice the difference floor is left on some joint, and nothing is said of it."""
    if line.get("verdict") != "nothing_missing" or "left" not in line:
        return False
    return bool((np.array(line["left"]) > FLOORS * np.array(line["floor"])).any())


def _called_noise(lines: Sequence[Line]) -> str:
    judged = [x for x in lines if "left" in x]
    return _count(sum(called_noise(x) for x in judged), len(judged))


MEASURES: dict[str, Callable[[Sequence[Line]], str]] = {
    "a name on a clean arm": _clean_named,
    "unexplained on a clean arm": _clean_unexplained,
    "log refused": _refused,
    "exact kind and joint": _per_effect(lambda x, t: any(exact(n, t) for n in _names(x))),
    "in the group": _per_effect(lambda x, t: any(in_group(n, t) for n in _names(x))),
    "all effects, each in its group": _all_in_group,
    "payload named, whatever its size": _payload_named,
    "payload of 2 kg and more named, or inertial numbers said to be off": _payload_said,
    "inertial numbers said to be off": _moved,
    "nothing said": _silent,
    "outside: reported unexplained": _outside,
    "arms with a false name": _extra,
    "sure and wrong (0.9 or more)": _sure_and_wrong,
    "left over twice the difference floor, called noise": _called_noise,
}


def calibration_error(lines: Sequence[Line]) -> float | None:
    """Mean distance of confidence from the share of exact names, over bins of confidence."""
    said = [
        (n["confidence"], any(exact(n, t) for t in x["truth"]))
        for x in lines
        for n in _names(x)
        if n["confidence"] is not None
    ]
    if not said:
        return None
    p, right = np.array(said, dtype=float).T
    place = np.digitize(p, BINS)
    parts = [np.flatnonzero(place == k) for k in np.unique(place)]
    return float(sum(abs(p[k].sum() - right[k].sum()) for k in parts) / len(p))


def overall(lines: Sequence[Line]) -> dict[str, str]:
    """Arms, names, calibration error, CPU time."""
    error = calibration_error(lines)
    cpu = [x["cpu"] for x in lines]
    return {
        "arms": str(len(lines)),
        "names": str(sum(len(_names(x)) for x in lines)),
        "expected calibration error": "-" if error is None else f"{error:.3f}",
        "CPU per log: median [s]": f"{np.median(cpu):.1f}",
        "CPU per log: largest [s]": f"{np.max(cpu):.1f}",
    }
