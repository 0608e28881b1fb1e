"""Exports of TwinCAT Scope, whose lines about the channels were taken for samples, and traces of
other makers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log

TIME = 0.004 * np.arange(1500)
Q = np.degrees(0.3 * np.sin(np.outer(TIME, 1 + 0.2 * np.arange(6))))
TAU = 20 * np.cos(np.outer(TIME, 1 + 0.1 * np.arange(6)))
NAMES = [f"J{j}.q{j}" for j in range(1, 7)] + [f"J{j}.tau{j}" for j in range(1, 7)]
PLAIN = [f"q{j}" for j in range(1, 7)] + [f"tau{j}" for j in range(1, 7)]


def export(path: Path, separator: str = "\t", each: bool = False, shift: float = 0.0) -> Path:
    """As TwinCAT Scope writes it: decimal commas, one time, or one for each channel."""

    def row(label: str, cells: list[str]) -> str:
        if each:
            return separator.join(separator.join([label, cell]) for cell in cells)
        return separator.join([label, *cells])

    lines = [
        separator.join(["Name", "Scope Project"]),
        separator.join(["File", r"C:\scope.svdx"]),
        separator.join(["Starttime of export", "132959373843760000", "13:56:24"]),
        "",
        row("Name", PLAIN),
        row("NetId", ["5.40.11.2.1.1"] * 12),
        row("Port", ["851"] * 12),
        row("SampleTime[ms]", ["4"] * 12),
        row("SymbolName", [f"MAIN.{name}" for name in NAMES]),
        row("Data-Type", ["REAL64"] * 12),
        row("Unit", ["deg"] * 6 + ["Nm"] * 6),
        "",
    ]
    for time, q, tau in zip(TIME, Q, TAU, strict=True):
        cells = [f"{value:.9f}".replace(".", ",") for value in (*q, *tau)]
        lines.append(row(f"{1e3 * time + shift:g}", cells))
    path.write_text("\r\n".join([*lines, "EOF", ""]))
    return path


@pytest.mark.parametrize("separator", ["\t", ";"])
def test_an_export_of_twincat_is_read(tmp_path: Path, separator: str) -> None:
    log = read_log(export(tmp_path / "scope.csv", separator))
    np.testing.assert_allclose(log.time, TIME, atol=1e-9)
    np.testing.assert_allclose(log.q, np.radians(Q), atol=1e-9)
    np.testing.assert_allclose(log.tau, TAU, atol=1e-8)


def test_a_time_of_each_channel_is_one_where_all_say_the_same(tmp_path: Path) -> None:
    """As TwinCAT exports by itself: a time in front of every channel."""
    path = export(tmp_path / "scope.csv", each=True)
    log = read_log(path)
    np.testing.assert_allclose(log.time, TIME, atol=1e-9)
    np.testing.assert_allclose(log.q, np.radians(Q), atol=1e-9)
    np.testing.assert_allclose(log.tau, TAU, atol=1e-8)
    lines = path.read_text().split("\n")
    cells = lines[30].split("\t")
    cells[6] = "999"
    path.write_text("\n".join([*lines[:30], "\t".join(cells), *lines[31:]]))
    with pytest.raises(InputError, match=r"line 31: .* times \(.* and '999' ms\).*Timelines"):
        read_log(path)


def test_full_stamps_are_refused_with_what_to_choose(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="without Full Timestamp"):
        read_log(export(tmp_path / "scope.csv", shift=132959373843760000))
    text = "Name\tq1\nSampleTime[ms]\t4\n10:00:00.1\t0.5\n10:00:00.2\t0.6\n"
    (tmp_path / "clock.csv").write_text(text)
    with pytest.raises(InputError, match="without Full Timestamp"):
        read_log(tmp_path / "clock.csv")


def test_the_header_of_a_kuka_trace_says_where_its_samples_are(tmp_path: Path) -> None:
    path = tmp_path / "trace.dat"
    path.write_text("DIAEXTENDED  {@:ENGLISH\r\n#BEGINGLOBALHEADER\r\n200,Position\r\n")
    with pytest.raises(InputError, match=r"header of a KUKA trace.*export them as text"):
        read_log(path)


def test_a_proposed_map_keeps_zeros_before_the_number(tmp_path: Path) -> None:
    names = [f"gAxis0{j}:{word}" for word in ("Position", "Torque") for j in range(1, 7)]
    rows = np.column_stack([4 * np.arange(1500), Q, TAU])
    path = tmp_path / "trace.csv"
    head = ";".join(["Zeitstempel [ms]", *names])
    np.savetxt(path, rows, delimiter=";", header=head, comments="", fmt="%.9f")
    with pytest.raises(InputError) as refused:
        read_log(path)
    proposed = str(refused.value)
    (tmp_path / "map.toml").write_text(proposed[proposed.index("[time]") :])
    assert "nan" not in proposed[proposed.index("[time]") :]
    log = read_log(path, columns=tmp_path / "map.toml")
    np.testing.assert_allclose(log.q, np.radians(Q), atol=1e-9)
