"""The table of a blind evaluation: counts, not impressions."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

Case = dict[str, Any]

VISIBLE = 10.0
"""strength (standard deviations, priors and noise counted) above which an effect can honestly be
asked for"""
SURE = 0.9


def table(cases: list[Case]) -> str:
    """Markdown."""
    by_suite: dict[str, list[Case]] = {}
    for case in cases:
        by_suite.setdefault(case["case"].split("/")[0], []).append(case)
    lines = ["| suite | arms | measure | count | share |", "| --- | --- | --- | --- | --- |"]
    for suite, members in by_suite.items():
        for measure, hit, total in [*_refused(members), *_measures(suite, members)]:
            share = f"{100 * hit / total:.1f} %" if total else "-"
            lines.append(f"| {suite} | {len(members)} | {measure} | {hit} / {total} | {share} |")
    lines += ["", *_errors(cases), "", *_calibration(cases), "", *_confusion(cases)]
    return "\n".join(lines)


def exact(finding: Case, truth: Case) -> bool:
    """Kind and joint right."""
    same_joint = finding["joint"] == truth["joint"] or (
        truth["joint"] is None and finding["joint"] is None
    )
    return bool(finding["kind"] == truth["kind"] and same_joint)


def in_group(finding: Case, truth: Case) -> bool:
    """The truth is the name or among the alternatives given with it."""
    near = finding["joint"] in (truth["joint"], None) or truth["joint"] is None
    return exact(finding, truth) or (near and truth["kind"] in finding["alternatives"])


def _known(case: Case) -> list[Case]:
    return [
        t for t in case["truth"] if t["in_library"] and t["strength"] >= VISIBLE and not t["idle"]
    ]


def _refused(cases: list[Case]) -> list[tuple[str, int, int]]:
    """Logs that the diagnosis took for another robot's, where there are any."""
    refused = sum(c["verdict"] == "log_not_understood" for c in cases)
    return [("log not understood", refused, len(cases))] if refused else []


def _measures(suite: str, cases: list[Case]) -> list[tuple[str, int, int]]:
    """(measure, hits, total) of one suite."""
    found: list[tuple[str, int, int]] = []
    clean = [c for c in cases if not c["truth"]]
    if clean:
        named = sum(bool(c["found"]) for c in clean)
        found += [("a name on a clean arm", named, len(clean))]
        found += [
            ("unexplained on a clean arm", sum(bool(c["unexplained"]) for c in clean), len(clean))
        ]
    asked = [(c, t) for c in cases for t in _known(c)]
    if asked:
        found += [
            (
                "exact kind and joint",
                sum(any(exact(f, t) for f in c["found"]) for c, t in asked),
                len(asked),
            ),
            (
                "truth in the reported group",
                sum(any(in_group(f, t) for f in c["found"]) for c, t in asked),
                len(asked),
            ),
            (
                "named or reported unexplained",
                sum(bool(c["found"] or c["unexplained"]) for c, _ in asked),
                len(asked),
            ),
        ]
        arms = [c for c in cases if _known(c)]
        extra = [f for c in arms for f in c["found"] if not any(in_group(f, t) for t in c["truth"])]
        found.append(
            ("arms with a further wrong name", sum(_has_extra(c) for c in arms), len(arms))
        )
        found.append(
            ("sure and wrong (0.9 or more)", sum(f["confidence"] >= SURE for f in extra), len(arms))
        )
        if suite == "pairs":
            both = [c for c in arms if len(_known(c)) == 2]
            hits = sum(
                all(any(in_group(f, t) for f in c["found"]) for t in _known(c)) for c in both
            )
            found.append(("both named, each in its group", hits, len(both)))
    outside = [c for c in cases if c["truth"] and not any(t["in_library"] for t in c["truth"])]
    outside = [c for c in outside if c["truth"][0]["strength"] >= VISIBLE]
    if outside:
        reported = [c for c in outside if c["unexplained"]]
        right_joint = [
            c
            for c in reported
            if any(u["joint"] == c["truth"][0]["main_joint"] for u in c["unexplained"])
        ]
        found += [
            ("outside: reported unexplained", len(reported), len(outside)),
            ("outside: right joint", len(right_joint), len(reported)),
            ("outside: right signal", sum(_right_signal(c) for c in right_joint), len(right_joint)),
            ("outside: named something surely", sum(_sure(c) for c in outside), len(outside)),
        ]
    return found


def _has_extra(case: Case) -> bool:
    return any(not any(in_group(f, t) for t in case["truth"]) for f in case["found"])


def _sure(case: Case) -> bool:
    return any(f["confidence"] >= SURE for f in case["found"])


def _right_signal(case: Case) -> bool:
    """A true signal is among those named for the right joint."""
    truth = case["truth"][0]
    joint = truth["main_joint"]
    same = {"sign_qd": "qd", f"q{joint}": "q", f"qd{joint}": "qd", f"qdd{joint}": "qdd"}
    true = {same.get(s, s) for s in truth["signals"]}
    said = {
        same.get(s, s) for u in case["unexplained"] if u["joint"] == joint for s in u["depends_on"]
    }
    return bool(true & said)


def _errors(cases: list[Case]) -> list[str]:
    """Error on the validation motion over the noise floor of arms with a finding, and run time."""
    # a simulated log without any noise has no floor
    noisy = [c for c in cases if c["found"] and min(c["floor"]) > 0.0]
    ratios = [(c, np.array(c["validation"]["after"]) / np.array(c["floor"])) for c in noisy]
    own = [ratio[t["main_joint"] - 1] for c, ratio in ratios for t in _known(c)]
    lines = ["| over all suites | median | 90 % |", "| --- | --- | --- |"]
    for name, values in (
        ("validation RMSE after, over the noise floor, joint of the effect", own),
        ("the same, middle joint of the arm", [np.median(ratio) for _, ratio in ratios]),
        ("the same, worst joint of the arm", [np.max(ratio) for _, ratio in ratios]),
        ("seconds per arm on a shared machine", [c["seconds"] for c in cases]),
    ):
        if values:
            lines.append(f"| {name} | {np.median(values):.3f} | {np.quantile(values, 0.9):.3f} |")
    return lines


def _calibration(cases: list[Case]) -> list[str]:
    """Share of right names by confidence."""
    said = [
        (f["confidence"], any(exact(f, t) for t in c["truth"])) for c in cases for f in c["found"]
    ]
    lines = [
        "| confidence | findings | mean confidence | exactly right |",
        "| --- | --- | --- | --- |",
    ]
    for low, high in ((0.0, 0.6), (0.6, 0.75), (0.75, 0.9), (0.9, 0.95), (0.95, 1.01)):
        part = [(p, right) for p, right in said if low <= p < high]
        if part:
            p, right = np.array(part, dtype=float).T
            lines.append(
                f"| {low:.2f} to {min(high, 1):.2f} | {len(part)} | {p.mean():.3f} | "
                f"{right.mean():.3f} |"
            )
    return lines


def _confusion(cases: list[Case]) -> list[str]:
    """What was said of each kind, library kinds that can be seen, one effect per arm."""
    said: dict[str, Counter[str]] = {}
    for case in cases:
        if len(case["truth"]) == 1 and (_known(case) or not case["truth"][0]["in_library"]):
            truth = case["truth"][0]
            names = [f["kind"] if not exact(f, truth) else "right" for f in case["found"]]
            names += ["unexplained"] * bool(case["unexplained"])
            said.setdefault(truth["kind"], Counter()).update(set(names) or {"nothing"})
    lines = ["| what it has | what was said |", "| --- | --- |"]
    for kind, counter in sorted(said.items()):
        lines.append(
            f"| {kind} | {', '.join(f'{name} {count}' for name, count in counter.most_common())} |"
        )
    return lines
