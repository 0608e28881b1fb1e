"""`irb2400 robot check` and `export` from the shell."""

from __future__ import annotations

from pathlib import Path

from command_line import irb2400

import irb2400_ctrl as irb
from irb2400_ctrl.model.consistency import check


def test_check_names_the_links_and_writes_the_nearest_robot(tmp_path: Path) -> None:
    done = irb2400("robot", "check", "irb2400", "--project", "near.toml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for words in (
        "link_2: a principal moment",
        "link_4: principal moments",
        "mass matrix is positive definite",
        "0.66",
    ):
        assert words in done.stdout
    assert check(irb.load_robot(tmp_path / "near.toml")) == []
    again = irb2400("robot", "check", "near.toml", cwd=tmp_path)
    assert "every body could exist" in again.stdout


def test_check_writes_the_symmetric_robot(tmp_path: Path) -> None:
    done = irb2400("robot", "check", "--symmetry-plane", "symmetric.toml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert irb.load_robot(tmp_path / "symmetric.toml").links[4].body.com_m == (0.0, 0.0, 0.0)


def test_export_writes_urdf(tmp_path: Path) -> None:
    done = irb2400("robot", "export", "irb2400", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "abb_irb_2400.urdf").read_text().startswith("<?xml")


def test_a_missing_robot_is_one_line(tmp_path: Path) -> None:
    done = irb2400("robot", "check", "nowhere.toml", cwd=tmp_path)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1


def test_long_names_keep_the_columns_together(tmp_path: Path) -> None:
    robot = irb.load_robot("irb2400")
    first = robot.links[0].model_copy(update={"name": "a_link_whose_name_is_very_long_indeed"})
    links = (first, *robot.links[1:])
    irb.save_robot(
        robot.model_copy(update={"links": links, "outline": None}), tmp_path / "long.toml"
    )
    for command, column in (("show", "mass [kg]"), ("check", "principal moments")):
        text = irb2400("robot", command, "long.toml", cwd=tmp_path).stdout.split("\n")
        at = next(k for k, line in enumerate(text) if column in line)
        begun = text[at].index(column)
        rows = text[at + 1 : at + 1 + robot.n]
        assert all(row[begun - 1] == " " and row[: begun - 1].strip() for row in rows)
