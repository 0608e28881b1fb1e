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
    "kr300": {},
    "tx40": {},
    # its torques were low-passed; where that smears a standstill nobody is judged, which helps the
    # baseline of joint 6 (5.0 % instead of 6.0) more than us. Bodies as uncertain as those of a
    # URDF are cost joint 5 (3.9 % before) what they give joint 6, and joint 2 of the TX40; friction
    # of joint 2 that grows with load takes a third off its error, and adds a hundredth to joint 5's
    "ur10": {5: 1.19, 6: 1.10},
}
ERRORS = {"ur10": (3.9, 3.3, 2.7, 3.5, 4.5, 5.6)}
"""[%] that are not exceeded, joint by joint"""


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
    assert rows["ratio"][5] <= 1.13
    assert (rows["identify"] <= (3.7, 1.8, 3.8, 4.1, 3.9, 5.6)).all()
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
    if name in ERRORS:
        assert (rows["identify"] <= ERRORS[name]).all()
    assert rows["identify"].mean() < min(rows["plain"].mean(), rows["file's bodies"].mean())
    sys.modules.pop("benchmarks", None)
