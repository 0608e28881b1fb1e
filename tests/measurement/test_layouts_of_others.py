"""Recordings in layouts that public repositories hold, each with the same motion in it.

The layouts are those of libfranka's logs, of PlotJuggler, of `joint_states` flattened by hand, of
spreadsheets with a date, of makers' scopes that state the unit in brackets, of identification data
as bare numbers; names and separators as found there, no line of any of them.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from measured_logs import made, same

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log, load_column_map, read_log
from irb2400_ctrl.measurement.instants.time_base import ungrouped

LOG = made()
T = LOG.time
Q = LOG.q
TAU = LOG.tau
SPEED = np.asarray(LOG.qd)
DEG = np.degrees(Q)
J = range(1, 7)
ROBOT = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
PLAIN = ["time_s", *(f"q{j}_rad" for j in J), *(f"tau{j}_Nm" for j in J)]


def of(form: str, first: int = 1) -> list[str]:
    return [form.replace("#", str(k + first)) for k in range(6)]


def table(names: list[str], *columns: np.ndarray, separator: str = ",") -> str:
    rows = (separator.join(f"{v:.17g}" for v in row) for row in np.column_stack(columns))
    return "\n".join([separator.join(names), *rows, ""])


def libfranka() -> str:
    """Its older log: `duration` in ms, names of the state again for the command."""
    names = ["duration", " success rate", *of(" q[#]", 0), *of("q_d[#]", 0), *of("dq[#]", 0)]
    names += [*of("tau_J[#]", 0), *of("tau_ext_hat_filtered[#]", 0), "sent commands"]
    names += [*of("q_d[#]", 0), *of("tau_J_d[#]", 0)]
    ones = np.ones(len(T))
    columns = [np.round(1e3 * T), ones, Q, Q + 1.0, SPEED, TAU, 0 * TAU, 0 * ones, 0 * Q, 0 * Q]
    return table(names, *columns)


def clock(form: Callable[[float], str]) -> str:
    """A time of day in the first column."""
    body = table(["time", *PLAIN[1:]], T, Q, TAU).splitlines()
    rows = [f"{form(t)},{line.split(',', 1)[1]}" for t, line in zip(T, body[1:], strict=True)]
    return "\n".join(["timestamp," + body[0].split(",", 1)[1], *rows, ""])


def german() -> str:
    """Date and time in two columns, decimal commas."""
    names = ["Datum", "Uhrzeit", *of("Achse # [Grad]"), *of("Achse # Drehmoment [Nm]")]
    body = table(names[2:], DEG, TAU, separator=";").replace(".", ",").splitlines()[1:]
    rows = [f"04.05.2023;23:59:{58 + t:06.3f};{line}" for t, line in zip(T, body, strict=True)]
    rows = [row.replace("23:59:6", "00:00:0") for row in rows]
    return "\n".join([";".join(names), *rows, ""]).replace("58.", "58,")


STATES = [f"{s}_{name}_joint" for s in ("position", "effort") for name in reversed(ROBOT)]
LAYOUTS = {
    "libfranka": libfranka(),
    "iso": clock(lambda t: f"2023-05-04 12:00:{t:09.6f}"),
    "underscore": clock(lambda t: f"2023-05-04_12:00:{t:09.6f}"),
    "stroke": clock(lambda t: f"2023/05/04/12:00:{t:09.6f}"),
    "zulu": clock(lambda t: f"2023-05-04T12:00:{t:09.6f}Z"),
    "clock": clock(lambda t: f"9:59:{t:09.6f}"),
    "over midnight": clock(lambda t: f"23:59:{t + 59:09.6f}" if t < 1 else f"00:00:{t - 1:09.6f}"),
    "timedelta": clock(lambda t: f"0 days 00:00:{t:09.6f}"),
    "german": german(),
    "states": table(["time", *STATES], T, Q[:, ::-1], TAU[:, ::-1]),
    "dots": table(
        ["__time", *of("/joint_states/position.#", 0), *of("/joint_states/effort.#", 0)],
        *(1.6e9 + T, Q, TAU),
    ),
    "letters": table(
        ["t (s)", *of("q# (rad)"), *of("dq# (rad/s)"), *of("tau# (Nm)")], T, Q, SPEED, TAU
    ),
    "greek": table(["t [s]", *of("θ# [rad]"), *of("τ# [Nm]")], T, Q, TAU),
    "spelled": table(["time[s]", *of("theta#[deg]"), *of("tau#[N·m]")], T, DEG, TAU),
    "last word": table(["time_sec", *of("joint#_pos_rad"), *of("joint#_torque_nm")], T, Q, TAU),
    "humps": table(
        ["Time(ms)", *of("JntPos#(deg)"), *of("JntTrq#(Nm)"), *of("JntCmd#(deg)")],
        *(1e3 * T, DEG, TAU, DEG + 1.0),
    ),
    "columns of one width": table(
        ["Time (s)", *of("q# (rad)"), *of("tau# (Nm)")], T, Q, TAU, separator="   "
    ),
    "torn at the end": table(PLAIN, T, Q, TAU) + "2.0,0.1,0.",
    **{
        f"torn at the end, {cell!r}": table(PLAIN, T, Q, TAU)
        + ",".join(["2.0"] + ["0.1"] * 11)
        + f",{cell}"
        for cell in ("", "-", "1.2e", "\n")
    },
    "zeros at the end": table(PLAIN, T, Q, TAU) + "\0" * 300,
    "doubled rows": table(PLAIN, *(np.repeat(column, 2, axis=0) for column in (T, Q, TAU))),
    "with an index": table(["", *PLAIN], np.arange(len(T)), T, Q, TAU),
    "copies": table(["time_s", *PLAIN], T, T, Q, TAU),
    "bars": table(PLAIN, T, Q, TAU, separator="|"),
    "bars in a title": "UR10 | cell 4 | Monday\n" + table(PLAIN, T, Q, TAU),
}


@pytest.mark.parametrize("name", LAYOUTS)
def test_a_layout_is_read(name: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(LAYOUTS[name], "utf-8")
    found = read_log(path, names=ROBOT)
    np.testing.assert_allclose(
        found.time - found.time[0], T, atol=1e-3 if name == "german" else 1e-6
    )
    np.testing.assert_allclose(found.q, Q, atol=1e-8)
    np.testing.assert_allclose(found.tau, TAU, atol=1e-8)


OTHER = {
    "gravity": (of("tau# (Nm)"), of("tau_g# (Nm)"), "no column tau1_Nm"),
    "external": (of("tau# (Nm)"), of("tau#_ext (Nm)"), "because of the word 'ext'"),
    "commanded": (of("tau# (Nm)"), of("torque_cmd# (Nm)"), "no column tau1_Nm"),
    "letter against unit": (of("q# (rad)"), of("tau# (rad)"), "no column q1_deg"),
    "error": (of("q# (rad)"), of("J#_PosError [deg]"), "because of the word 'error'"),
    "speed of the motor": (of("q# (rad)"), of("motor_vel_# (rad)"), "no column q1_deg"),
}


@pytest.mark.parametrize("name", OTHER)
def test_another_thing_with_a_unit_is_left_aside(name: str, tmp_path: Path) -> None:
    there, instead, told = OTHER[name]
    names = ["t (s)", *of("q# (rad)"), *of("tau# (Nm)")]
    text = table(names, T, Q, TAU)
    for one, other in zip(there, instead, strict=True):
        text = text.replace(one, other)
    path = tmp_path / "log.csv"
    path.write_text(text, "utf-8")
    with pytest.raises(InputError, match=told):
        read_log(path)


def test_a_name_that_two_columns_have_is_named(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table([*PLAIN, "q2_rad"], T, Q, TAU, Q[:, 0]), "utf-8")
    with pytest.raises(InputError, match=r"no column q2_deg.*'q2_rad' appears 2 times"):
        read_log(path)


BARE = """
[time]
column = "column 1"

[[columns]]
file = "column {j+1}"
quantity = "q"
unit = "rad"
joints = 6

[[columns]]
file = "column {j+7}"
quantity = "tau"
unit = "Nm"
joints = 6
"""


def test_a_short_line_within_is_refused_and_a_coarse_clock_is_counted(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table(PLAIN, T, Q, TAU) + "2.0,0.1,0.\n" + "0," * 12 + "0\n", "utf-8")
    with pytest.raises(InputError, match="line 502: found 3 cells, expected 13"):
        read_log(path)
    # the angles bear out that its rows are samples of one motion, or do not
    path.write_text(table(PLAIN, np.round(T, 2), Q, TAU), "utf-8")
    np.testing.assert_allclose(np.diff(ungrouped(read_log(path)).time), T[1] - T[0], rtol=0.01)
    mixed = np.random.default_rng(1).permutation(Q)
    path.write_text(table(PLAIN, np.round(T, 2), mixed, TAU), "utf-8")
    with pytest.raises(InputError, match="too coarse for its rows, state rate_Hz"):
        read_log(path)


def test_numbers_without_names_are_read_with_a_map(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table(PLAIN, T, Q, TAU).split("\n", 1)[1], "utf-8")
    with pytest.raises(InputError, match=r"expected a line of names.*'column 1' to 'column 13'"):
        read_log(path)
    columns = tmp_path / "map.toml"
    columns.write_text(BARE)
    found = read_log(path, columns=columns)
    same(found, LOG)
    assert len(found.time) == len(T)


def test_samples_without_a_time_are_read_with_their_rate(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(table(PLAIN[1:], Q, TAU), "utf-8")
    with pytest.raises(InputError, match="rate_Hz = nan"):
        read_log(path)
    columns = tmp_path / "map.toml"
    columns.write_text(
        "[time]\nrate_Hz = 250.0\n"
        '[[columns]]\nfile = "q{j}_rad"\nquantity = "q"\nunit = "rad"\n'
        '[[columns]]\nfile = "tau{j}_Nm"\nquantity = "tau"\nunit = "Nm"\n'
    )
    same(read_log(path, columns=columns), LOG)
    columns.write_text(columns.read_text().replace("rate_Hz", 'column = "t"\nrate_Hz'))
    with pytest.raises(InputError, match="either column or rate_Hz"):
        load_column_map(columns)


def test_angles_within_one_turn_go_on(tmp_path: Path) -> None:
    """A Kinova states 0 to 360 deg."""
    path = tmp_path / "log.csv"
    turned = table(["t (s)", *of("q# (deg)"), *of("tau# (Nm)")], T, (3.0 * DEG) % 360.0, TAU)
    path.write_text(turned, "utf-8")
    text = '[time]\ncolumn = "t (s)"\n[[columns]]\nfile = "q{j} (deg)"\nquantity = "q"\n'
    text += 'unit = "deg"\nwrapped = true\n[[columns]]\nfile = "tau{j} (Nm)"\n'
    text += 'quantity = "tau"\nunit = "Nm"\n'
    columns = tmp_path / "map.toml"
    columns.write_text(text)
    found = read_log(path, columns=columns).q
    turns = (found - 3.0 * Q) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns[:1]) + 0 * turns, atol=1e-9)
    assert np.abs(found[0]).max() <= np.pi
    columns.write_text(text + "wrapped = true\n")
    with pytest.raises(InputError, match="wrapped = true for tau"):
        load_column_map(columns)


def test_arrays_of_numpy_and_of_hdf5(tmp_path: Path) -> None:
    import h5py

    path = tmp_path / "log.npz"
    np.savez(path, time_s=T, q_rad=Q, tau_Nm=TAU)
    same(read_log(path), LOG)
    np.savez(path, time_s=np.array([{}], dtype=object))
    with pytest.raises(InputError, match="not a readable NumPy archive"):
        read_log(path)
    path.write_bytes(b"PK\x03\x04 no")
    with pytest.raises(InputError, match="not a readable NumPy archive"):
        read_log(path)
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        file["time_s"] = T
        file["q_rad"] = Q
        file["tau_Nm"] = TAU
    same(read_log(path), LOG)
    path.write_bytes(b"no")
    with pytest.raises(InputError, match="not a readable HDF5"):
        read_log(path)


def test_a_matrix_with_a_sample_in_every_column(tmp_path: Path) -> None:
    """Simulink's `To File`: the time is the first of many rows."""
    from scipy.io import savemat

    path = tmp_path / "log.mat"
    savemat(path, {"ans": np.vstack([T, Q.T, SPEED.T, TAU.T])})
    columns = tmp_path / "map.toml"
    columns.write_text(
        BARE.replace("column 1", "ans[1]")
        .replace("column {j+1}", "ans[{j+1}]")
        .replace("column {j+7}", "ans[{j+13}]")
    )
    same(read_log(path, columns=columns), LOG)
    savemat(path, {"time_s": T, "q_rad": Q.T[:, None, :], "tau_Nm": TAU.T[:, None, :]})
    same(read_log(path), LOG)


def test_the_text_of_a_topic_is_told_apart(tmp_path: Path) -> None:
    path = tmp_path / "log.txt"
    path.write_text("header:\n  stamp:\n    sec: 1\nname:\n- a\nposition:\n- 0.1\n---\n")
    with pytest.raises(InputError, match="give the bag itself, or rostopic echo -p"):
        read_log(path)


@pytest.mark.parametrize("suffix", ["xls", "tdms", "pkl", "npy", "json", "bag", "r64"])
def test_what_is_not_read_is_told_what_to_make_of_it(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"log.{suffix}"
    path.write_bytes(b"\x00\x01")
    with pytest.raises(InputError, match=r"save|convert|export|write"):
        read_log(path)


def written(path: Path, text: str) -> Log:
    path.write_text(text, "utf-8")
    return read_log(path, names=ROBOT)


def test_joints_called_by_words_are_suggested_by_the_robot(tmp_path: Path) -> None:
    """Goals are not taken for the measured angles, `wrist_1` not for joint 1."""
    names = [
        f"{s}_{joint}_joint" for s in ("goal_pos", "actual_pos", "actual_trq") for joint in ROBOT
    ]
    with pytest.raises(InputError) as refused:
        written(tmp_path / "log.csv", table(["timestamp", *names], T, Q + 1.0, Q, TAU))
    columns = tmp_path / "map.toml"
    columns.write_text(str(refused.value).split("check them:\n\n")[1])
    same(read_log(tmp_path / "log.csv", columns=columns), LOG)


def test_places_of_a_message_are_not_taken_for_the_joints(tmp_path: Path) -> None:
    """ROS orders joints as it likes: without the robot's names no order is guessed."""
    order = [2, 1, 0, 3, 4, 5]
    listed = str([f"{ROBOT[k]}_joint" for k in order])
    rows = (
        f'{t},"{listed}","{q[order].tolist()}","{tau[order].tolist()}"'
        for t, q, tau in zip(1.6e9 + T, Q, TAU, strict=True)
    )
    text = "\n".join(["Time,name,position,effort", *rows, ""])
    np.testing.assert_allclose(written(tmp_path / "log.csv", text).q, Q)
    axes = [f"axis_{j}" for j in J]
    with pytest.raises(InputError, match=r"--robot.*file = 'position\[1\]'") as refused:
        read_log(tmp_path / "log.csv", names=axes)
    assert "check them" not in str(refused.value)


def test_what_the_suggestion_says_of_units_and_of_nothing(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    small = 0.01 * DEG
    with pytest.raises(InputError, match=r'file = "Achse \{j\} Winkel \[Grad\]"\n.*\n.*"deg"'):
        written(path, table(["x", *of("Achse # Winkel [Grad]"), *of("Moment #")], T, small, TAU))
    with pytest.raises(InputError, match="called as measured torques or currents are"):
        written(path, table(["timestamp", *of("J#")], T, DEG))
    with pytest.raises(InputError, match=r"resolver_angle[^[]*\ngear_ratio = nan"):
        written(path, table(["t", *of("resolver_angle #"), *of("torque #")], T, Q, TAU))
    with pytest.raises(InputError) as refused:
        written(path, table(["t", *of("J# pos"), *of("J#_DisturbTorque")], T, Q, TAU))
    assert "DisturbTorque{j}" not in str(refused.value)
