"""Every command of docs/robots.md runs as it is written."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
from command_line import fenced
from robots.public_arms import arms, urdf
from typer.testing import CliRunner

from irb2400_ctrl.cli.main import app

PAGE = (Path(__file__).parents[2] / "docs" / "robots.md").read_text()
NAMES = "mass_kg,com_x_mm,com_y_mm,com_z_mm,ixx_kgm2,iyy_kgm2,izz_kgm2"
TABLE = f"""alpha_deg,a_mm,d_mm,theta_offset_deg,{NAMES}
-90,100,400,10,5,1,2,3,0.1,0.1,0.1
0,300,0,-20,4,10,2,3,0.1,0.1,0.1
"""


def test_every_command_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(urdf(arms()["irb4600"]))
    Path("table.csv").write_text(TABLE)
    blocks = fenced(PAGE, "bash")
    commands = [line for block in blocks for line in block.splitlines()]
    assert len(commands) >= 10
    for command in commands:
        words = shlex.split(command)
        assert words[0] == "irb2400"
        found = CliRunner().invoke(app, words[1:])
        assert found.exit_code == 0, f"{command}: {found.output} {found.exception}"
