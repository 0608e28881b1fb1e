"""Real arms, where their recordings lie beside the project: not worse than the baselines."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MEASURED = Path(os.environ.get("IRB2400_SHARED", ROOT.parent / "shared")) / "measured"

pytestmark = pytest.mark.skipif(not MEASURED.is_dir(), reason="no real recordings here")

GOAL = 1.05
ABOVE = {
    # above the goal today: a little more than what they reach, so that they do not get worse
    "kr300": {6: 1.06},
    "tx40": {2: 1.15},
    "ur10": {4: 1.11, 5: 1.19, 6: 1.10},
}


def test_drives_that_read_in_part_are_found_on_the_other_half(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The second half of the UR10 judged by the first: its wrist left a fifth more before."""
    pytest.importorskip("pinocchio")
    monkeypatch.syspath_prepend(str(ROOT))
    from benchmarks.real_recordings import swapped, table
    from benchmarks.real_robots import CASES

    rows, _ = table(swapped(CASES["ur10"](MEASURED)))
    assert (rows["ratio"][:5] <= GOAL).all()
    assert rows["ratio"][5] <= 1.09
    sys.modules.pop("benchmarks", None)


@pytest.mark.parametrize("name", ABOVE)
def test_not_worse_than_the_better_baseline(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if name == "ur10":
        pytest.importorskip("pinocchio")
    monkeypatch.syspath_prepend(str(ROOT))
    from benchmarks.real_recordings import table
    from benchmarks.real_robots import CASES

    rows, _ = table(CASES[name](MEASURED))
    for joint, ratio in enumerate(rows["ratio"], start=1):
        assert ratio <= ABOVE[name].get(joint, GOAL), (joint, ratio)
    assert rows["identify"].mean() < min(rows["plain"].mean(), rows["file's bodies"].mean())
    sys.modules.pop("benchmarks", None)
