"""Log files: what is read, and what is refused in plain words."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, load_column_map, read_log, write_log


def text_of(log: Log, **changes: str) -> str:
    """CSV text with columns renamed."""
    names = ["time_s", *(f"q{j}_rad" for j in range(1, 7)), *(f"tau{j}_Nm" for j in range(1, 7))]
    names = [changes.get(name, name) for name in names]
    rows = np.column_stack([log.time, log.q, log.tau])
    return (
        ",".join(names) + "\n" + "\n".join(",".join(f"{v:.9g}" for v in row) for row in rows) + "\n"
    )


@pytest.mark.parametrize("suffix", [".csv", ".csv.gz"])
def test_written_log_reads_again(tmp_path: Path, suffix: str) -> None:
    log = made()
    again = read_log(write_log(log, tmp_path / f"log{suffix}"))
    for name, digits in (("time", 6), ("q", 7), ("qd", 6), ("tau", 3), ("q_ref", 7)):
        np.testing.assert_allclose(getattr(again, name), getattr(log, name), atol=10.0**-digits)


def test_columns_in_any_order_and_extra_ones_kept_aside(tmp_path: Path) -> None:
    log = made()
    lines = [line.split(",") for line in text_of(log).splitlines()]
    order = np.random.default_rng(0).permutation(len(lines[0]))
    text = "\n".join(
        ",".join([line[k] for k in order] + ["load" if i == 0 else "7"])
        for i, line in enumerate(lines)
    )
    path = tmp_path / "log.csv"
    path.write_text(text)
    found = read_log(path)
    np.testing.assert_allclose(found.q, log.q, atol=1e-8)
    assert set(found.extra) == {"load"}
    assert found.q_ref is None


def test_degrees_and_radians_are_the_same_log(tmp_path: Path) -> None:
    log = made()
    text = text_of(
        Log(log.time, np.degrees(log.q), log.tau), **{f"q{j}_rad": f"q{j}_deg" for j in range(1, 7)}
    )
    path = tmp_path / "log.csv"
    path.write_text(text)
    np.testing.assert_allclose(read_log(path).q, log.q, atol=1e-8)


def test_arrays_are_read_only() -> None:
    with pytest.raises(ValueError, match="read-only"):
        made().q[0, 0] = 1.0


NASTY = {
    "no torque columns": (lambda t: t.replace("_Nm", "_A"), "tau1_Nm"),
    "one joint missing": (lambda t: t.replace("q4_rad", "spare"), "q4_deg or q4_rad"),
    "joints from zero": (lambda t: t.replace("q1_rad", "q0_rad"), "joints that count from 1"),
    "no unit": (lambda t: t.replace("q2_rad", "q2"), "has no unit"),
    "no time": (lambda t: t.replace("time_s", "stamp"), "time_s"),
    "a word among numbers": (lambda t: t.replace("\n0.004,", "\nlost,", 1), "line 3"),
    "nan": (lambda t: t.replace("\n0.008,", "\nnan,", 1), "line 4"),
    "a short row": (lambda t: t.replace("\n0.012,", "\n", 1), "line 5"),
    "doubled name": (lambda t: t.replace("q2_rad", "q1_rad"), "appears 2 times"),
    "time runs back": (lambda t: t.replace("\n0.016,", "\n0.001,", 1), "time does not rise"),
    "empty": (lambda t: t.split("\n")[0] + "\n", "no samples"),
    "no header": (lambda t: "hello\n", "first line"),
}


@pytest.mark.parametrize("name", NASTY)
def test_nasty_files_are_refused_with_the_place(tmp_path: Path, name: str) -> None:
    change, expected = NASTY[name]
    path = tmp_path / "log.csv"
    path.write_text(change(text_of(made())))
    with pytest.raises(InputError) as caught:
        read_log(path)
    assert expected in str(caught.value)


def test_missing_broken_and_slow_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no log file"):
        read_log(tmp_path / "absent.csv")
    path = tmp_path / "log.csv.gz"
    path.write_bytes(gzip.compress(b"time_s,q1_rad\n")[:-9])
    with pytest.raises(InputError, match="not a readable"):
        read_log(path)
    with pytest.raises(InputError, match="at least 10"):
        made(rate=5.0)


NAMES = ["time_s", *(f"q{j}_rad" for j in range(1, 7)), *(f"tau{j}_Nm" for j in range(1, 7))]


DIALECTS = {
    "semicolon, decimal comma": lambda t: t.replace(",", ";").replace(".", ","),
    "semicolon": lambda t: t.replace(",", ";"),
    "tab": lambda t: t.replace(",", "\t"),
    "byte order mark": lambda t: "\ufeff" + t,
    "comments first": lambda t: "# written by a logger\n% 2 lines\n\n" + t,
    "comma at the end of each line": lambda t: t.replace("\n", ",\n"),
    "windows line ends": lambda t: t.replace("\n", "\r\n"),
    "old line ends": lambda t: t.replace("\n", "\r"),
    "a word in a column aside": lambda t: t.replace("\n", ",auto\n").replace("auto", "mode", 1),
}


@pytest.mark.parametrize("name", DIALECTS)
def test_dialects(tmp_path: Path, name: str) -> None:
    path = tmp_path / "log.csv"
    path.write_text(DIALECTS[name](text_of(made())), encoding="utf-8", newline="")
    same(read_log(path), made())


def test_utf_16(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(text_of(made()).encode("utf-16"))
    same(read_log(path), made())


def test_milliseconds_and_speeds_in_radians(tmp_path: Path) -> None:
    log = made()
    path = tmp_path / "log.csv"
    rows = [line.split(",") for line in text_of(log).splitlines()]
    rows[0][0] = "time_ms"
    rows[0] += [f"qd{j}_rad_s" for j in range(1, 7)]
    assert log.qd is not None
    for row, stamp, speed in zip(rows[1:], log.time, log.qd, strict=True):
        row[0] = f"{1e3 * stamp:.9g}"
        row += [f"{v:.9g}" for v in speed]
    path.write_text("\n".join(",".join(row) for row in rows))
    found = read_log(path)
    same(found, log)
    np.testing.assert_allclose(found.qd, log.qd, atol=1e-8)


CONTRADICTIONS = {
    "angle in two units": ("q1_deg", "'q1_rad' and 'q1_deg'"),
    "torque in two units": ("tau3_kNm", "'tau3_Nm' and 'tau3_kNm'"),
    "two clocks": ("time_ms", "'time_s' and 'time_ms'"),
}


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_contradictory_columns_are_refused(tmp_path: Path, name: str) -> None:
    column, expected = CONTRADICTIONS[name]
    lines = text_of(made()).splitlines()
    path = tmp_path / "log.csv"
    path.write_text("\n".join([f"{lines[0]},{column}", *(f"{line},1" for line in lines[1:])]))
    with pytest.raises(InputError, match="say the same thing") as caught:
        read_log(path)
    assert expected in str(caught.value)


def test_parquet(tmp_path: Path) -> None:
    import pyarrow as pa
    from pyarrow import parquet

    log = made()
    table = np.column_stack([log.time, log.q, log.tau])
    columns = {name: table[:, k] for k, name in enumerate(NAMES)}
    path = tmp_path / "log.parquet"
    parquet.write_table(pa.table(columns | {"state": ["on"] * len(table)}), path)
    same(read_log(path), log)
    path.write_bytes(b"PAR1 no")
    with pytest.raises(InputError, match="not a readable Parquet"):
        read_log(path)


def test_parquet_with_instants_and_lists(tmp_path: Path) -> None:
    """As pandas and recorders of learning data write them."""
    import pyarrow as pa
    from pyarrow import parquet

    log = made()
    ns = 1_700_000_000_000_000_000 + np.round(1e9 * log.time).astype(np.int64)
    path = tmp_path / "log.parquet"
    instants = pa.array(ns, pa.timestamp("ns"))
    named = {f"q{j + 1}_rad": log.q[:, j] for j in range(6)}
    named |= {f"tau{j + 1}_Nm": log.tau[:, j] for j in range(6)}
    parquet.write_table(pa.table({"timestamp": instants, **named}), path)
    found = read_log(path)
    np.testing.assert_allclose(found.time, log.time - log.time[0], atol=1e-8)
    np.testing.assert_array_equal(found.q, log.q)
    lists = {"state": list(log.q), "load": list(log.tau), "t": log.time}
    parquet.write_table(pa.table(lists), path)
    columns = tmp_path / "map.toml"
    columns.write_text(
        '[time]\ncolumn = "t"\n'
        '[[columns]]\nfile = "state[{j}]"\nquantity = "q"\nunit = "rad"\n'
        '[[columns]]\nfile = "load[{j}]"\nquantity = "tau"\nunit = "Nm"\n'
    )
    same(read_log(path, columns=columns), log)


def test_an_instant_in_words_is_shown(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("time_s,q1_rad,tau1_Nm\n1.5 h,0,1\n1.6 h,0,1\n")
    with pytest.raises(InputError, match=r"where '1.5 h' stands; expected .* in seconds"):
        read_log(path)


def test_mat_vectors_matrices_and_structures(tmp_path: Path) -> None:
    from scipy.io import savemat

    log = made()
    path = tmp_path / "log.mat"
    savemat(path, {"time_s": log.time, "q_deg": np.degrees(log.q), "tau_Nm": log.tau, "rate": 250})
    same(read_log(path), log)
    turned = {"q_deg": np.degrees(log.q).T, "tau_Nm": log.tau.T}
    savemat(path, {"time_s": log.time, **turned})
    same(read_log(path), log)
    savemat(path, {"out": {"t": log.time, "signals": {"q": log.q, "current": log.tau / 2.0}}})
    text = '[time]\ncolumn = "out.t"\n'
    for j in range(1, 7):
        text += (
            f'[[columns]]\nfile = "out.signals.q[{j}]"\nquantity = "q"\njoint = {j}\n'
            f'unit = "rad"\n[[columns]]\nfile = "out.signals.current[{j}]"\nquantity = "tau"\n'
            f'joint = {j}\nunit = "A"\nNm_per_A = 0.02\ngear_ratio = 100.0\n'
        )
    map_path = tmp_path / "map.toml"
    map_path.write_text(text)
    same(read_log(path, columns=map_path), log)
    path.write_bytes(b"MATLAB 5.0 no")
    with pytest.raises(InputError, match="not a readable MAT"):
        read_log(path)


def test_mat_of_version_7_3(tmp_path: Path) -> None:
    import h5py

    log = made()
    path = tmp_path / "log.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        # as MATLAB writes it: turned over
        file["time_s"] = log.time[None, :]
        file["q_rad"] = log.q.T
        file["tau_Nm"] = log.tau.T
    with path.open("r+b") as raw:
        head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
        raw.write(head)
    same(read_log(path), log)


UNITS = {
    "deg": ("q", 'unit = "deg"', np.degrees(1.0)),
    "motor turns": ("q", 'unit = "rev"\ngear_ratio = -80.0', -80.0 / (2 * np.pi)),
    "motor torque": ("tau", 'unit = "Nm"\ngear_ratio = 80.0', 1.0 / 80.0),
    "kNm": ("tau", 'unit = "kNm"', 1e-3),
    "per cent": ("tau", 'unit = "percent"\nfull_scale_Nm = 50.0', 2.0),
    "current": ("tau", 'unit = "A"\nNm_per_A = 0.5\ngear_ratio = 100.0\nsign = -1', -0.02),
    "own factor": ("tau", 'unit = "Nm"\nfactor = 4.0', 0.25),
}


@pytest.mark.parametrize("name", UNITS)
def test_column_map_brings_any_unit_to_the_joint(tmp_path: Path, name: str) -> None:
    quantity, entry, scale = UNITS[name]
    log = made()
    values = {"q": log.q, "tau": log.tau}
    values[quantity] = values[quantity] * scale
    lines = ["T;" + ";".join(f"{s} {j}" for s in ("q", "tau") for j in range(1, 7))]
    table = np.column_stack([1e6 * log.time, values["q"], values["tau"]])
    lines += [";".join(f"{v:.12g}".replace(".", ",") for v in row) for row in table]
    path = tmp_path / "log.txt"
    path.write_text("\n".join(lines))
    text = '[time]\ncolumn = "T"\nunit = "us"\n'
    for s, plain in (("q", 'unit = "rad"'), ("tau", 'unit = "Nm"')):
        for j in range(1, 7):
            text += f'[[columns]]\nfile = "{s} {j}"\nquantity = "{s}"\njoint = {j}\n'
            text += (entry if s == quantity else plain) + "\n"
    map_path = tmp_path / "map.toml"
    map_path.write_text(text)
    same(read_log(path, columns=load_column_map(map_path)), log, atol=1e-7)


ENTRY = '[[columns]]\nfile = "a"\nquantity = "tau"\njoint = 1\nunit = "Nm"\n'
WRONG_MAPS = {
    "a current without a constant": (ENTRY.replace("Nm", "A"), "Nm_per_A"),
    "a unit of another quantity": (ENTRY.replace("Nm", "deg"), "unit 'deg'"),
    "one column twice": (ENTRY + ENTRY.replace("joint = 1", "joint = 2"), "'a' appears more"),
    "one joint twice": (ENTRY + ENTRY.replace('"a"', '"b"'), "'tau 1' appears more"),
    "an unknown entry": (ENTRY + "colour = 1\n", "colour"),
    "no column": ("[time]\ncolumn = 't'\n", "columns"),
    "no toml": ("[time", "is not TOML"),
    "a column that is not there": (ENTRY + '[time]\ncolumn = "time_s"\n', "no column 'a'"),
}


@pytest.mark.parametrize("name", WRONG_MAPS)
def test_wrong_column_maps_are_refused(tmp_path: Path, name: str) -> None:
    text, expected = WRONG_MAPS[name]
    path = tmp_path / "log.csv"
    path.write_text(text_of(made()))
    map_path = tmp_path / "map.toml"
    map_path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_log(path, columns=map_path)
    assert expected in str(caught.value)


@pytest.mark.parametrize("name", ["arm.toml", "arm.urdf"])
def test_a_robot_in_the_place_of_a_log_is_said_to_be_one(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("# an arm, of six axes\nname = 1\n")
    with pytest.raises(InputError, match="expected a log; a robot is given with --robot"):
        read_log(tmp_path / name)


@pytest.mark.parametrize(
    ("columns", "advised"),
    [(["q{}_deg", "motor current {} [A]"], True), (["tau{}_Nm", "motor current {} [A]"], False)],
)
def test_currents_are_advice_where_torques_are_missing(
    tmp_path: Path, columns: list[str], advised: bool
) -> None:
    names = ["time_s", *(form.format(j) for form in columns for j in range(1, 7))]
    rows = [",".join([str(0.004 * k), *[str(k)] * 12]) for k in range(20)]
    (tmp_path / "log.csv").write_text("\n".join([",".join(names), *rows]))
    with pytest.raises(InputError) as refused:
        read_log(tmp_path / "log.csv")
    assert ("currents become torques" in str(refused.value)) is advised
