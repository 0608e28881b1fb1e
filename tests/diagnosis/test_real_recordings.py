"""Real arms, where their recordings lie beside the project: what both parts of one must say."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from irb2400_ctrl.diagnosis import diagnose

ROOT = Path(__file__).parents[2]
MEASURED = Path(os.environ.get("IRB2400_SHARED", ROOT.parent / "shared")) / "measured"

pytestmark = pytest.mark.skipif(not MEASURED.is_dir(), reason="no real recordings here")


def test_both_runs_of_a_loaded_arm_name_its_load_and_its_rotors(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """150 kg that the file does not know and six rotors that it leaves out; of one run nothing was
    named for a while."""
    monkeypatch.syspath_prepend(str(ROOT))
    monkeypatch.delitem(sys.modules, "benchmarks", raising=False)
    from benchmarks.real_robots import CASES

    case = CASES["kr300"](MEASURED)
    for log in (case.logs[0], case.others[0]):
        found = diagnose(case.robot, log)
        names = {(f.effect.kind, f.effect.joint) for f in found.findings}
        assert names >= {("payload", None), *(("rotor_inertia", j) for j in range(1, 7))}
        assert found.verdict == "explained"
        (load,) = (f for f in found.findings if f.effect.kind == "payload")
        assert load.effect.coefficients()[0] == pytest.approx(150.0, rel=0.15)
