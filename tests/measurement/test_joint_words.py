"""Joints that are called by words of their own: a column map is proposed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import load_column_map, read_log
from irb2400_ctrl.measurement.columns.joint_words import worded

LOG = made()
WORDS = ("Base", "Shoulder", "Elbow", "Wrist1", "Wrist2", "Wrist3")


@pytest.mark.parametrize("robot", [None, ("a", "b", "c", "d", "e", "f")])
@pytest.mark.parametrize(
    ("angle", "torque"),
    [("{} pos [rad]", "{} torque [Nm]"), ("position.{}", "torque.{}"), ("{}_angle", "{}_torque")],
)
def test_the_proposed_map_reads_them(
    angle: str, torque: str, robot: tuple[str, ...] | None, tmp_path: Path
) -> None:
    path = tmp_path / "log.csv"
    header = ["Robot time", *map(angle.format, WORDS), *map(torque.format, WORDS)]
    values = np.column_stack([LOG.time, LOG.q, LOG.tau])
    np.savetxt(path, values, delimiter=",", header=",".join(header), comments="", fmt="%.12g")
    with pytest.raises(InputError, match="guessed, check them") as refused:
        read_log(path, names=robot)
    columns = tmp_path / "map.toml"
    columns.write_text(str(refused.value).split("check them:\n\n")[1], "utf-8")
    same(read_log(path, columns=load_column_map(columns)), LOG, 1e-9)


def test_words_are_taken_where_two_kinds_of_columns_have_them() -> None:
    one = [f"{word} pos" for word in WORDS]
    other = [f"{word} torque" for word in WORDS]
    assert worded(one, 6) == {}
    assert worded([*one, *other], 7) == {}
    assert worded([*one, *other[1:]], 6) == {}
    assert worded(sorted([*one, *other]), 6) == {}
    assert worded([*other, *one], 6) == {("", " torque"): other, ("", " pos"): one}
