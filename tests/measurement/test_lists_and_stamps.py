"""Logs with lists in one cell, and with a time in two columns."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import read_log

Array = npt.NDArray[np.float64]
COUNT = 60
NAMES = ["elbow", "base", "wrist"]
START = 1_700_000_000


def _motion() -> tuple[Array, Array, Array]:
    """Time [s], angles [rad], torques [Nm]."""
    time = 0.004 * np.arange(COUNT) + 0.9
    q = np.outer(np.sin(time), [0.3, -0.2, 0.5])
    return time, q, 10.0 * q


def _written(folder: Path, form: str = "[{}]", between: str = ", ", separator: str = ",") -> Path:
    time, q, tau = _motion()
    lines = [separator.join(("header.stamp.sec", "header.stamp.nanosec", "name", "position",
                             "velocity", "effort"))]  # fmt: skip
    for k in range(COUNT):
        seconds = int(time[k] // 1)
        beyond = round((time[k] - seconds) * 1e9)
        lists = [
            '"' + form.format(between.join(f"{v:.9f}" for v in row)) + '"' for row in (q[k], tau[k])
        ]
        joints = '"' + str(NAMES) + '"'
        cells = (str(START + seconds), str(beyond), joints, lists[0], "[]", lists[1])
        lines.append(separator.join(cells))
    path = folder / "log.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize(
    ("form", "between", "separator"),
    [("[{}]", ", ", ","), ("({})", ", ", ","), ("[{}]", "  ", ","), ("[{}]", ",", ";"),
     ("array([{}])", ", ", ","), ("array('d', [{}])", ", ", ",")],
)  # fmt: skip
def test_lists_in_a_cell_are_joints_by_name(
    form: str, between: str, separator: str, tmp_path: Path
) -> None:
    _, q, tau = _motion()
    log = read_log(_written(tmp_path, form, between, separator), names=["base", "elbow", "wrist"])
    order = [1, 0, 2]
    np.testing.assert_allclose(log.q, q[:, order], atol=1e-9)
    np.testing.assert_allclose(log.tau, tau[:, order], atol=1e-8)
    # the last digits of the stamps are kept
    np.testing.assert_allclose(np.diff(log.time), 0.004, atol=1e-9)


def test_names_of_the_library_may_be_lists(tmp_path: Path) -> None:
    time, q, tau = _motion()
    lines = ["secs,nsecs,q_rad,tau_Nm"]
    lines += [
        f'{int(t)},{round(t % 1 * 1e9)},"{list(map(float, a))}","{list(map(float, b))}"'
        for t, a, b in zip(time, q, tau, strict=True)
    ]
    path = tmp_path / "log.csv"
    path.write_text("\n".join(lines))
    log = read_log(path)
    np.testing.assert_allclose(log.q, q, atol=1e-12)
    np.testing.assert_allclose(log.time - log.time[0], time - time[0], atol=1e-8)


def test_a_map_names_lists_and_stamps(tmp_path: Path) -> None:
    path = _written(tmp_path)
    text = path.read_text().replace("header.stamp.sec,header.stamp.nanosec", "a,b")
    path.write_text(text.replace("position,velocity,effort", "angle,velocity,load"))
    with pytest.raises(InputError, match="no column time_s"):
        read_log(path)
    columns = tmp_path / "map.toml"
    columns.write_text(
        '[time]\ncolumn = "a"\nnanoseconds = "b"\n'
        '[[columns]]\nfile = "angle[{j}]"\nquantity = "q"\nunit = "rad"\n'
        '[[columns]]\nfile = "load[{j}]"\nquantity = "tau"\nunit = "Nm"\n'
    )
    log = read_log(path, columns=columns)
    np.testing.assert_allclose(log.q, _motion()[1], atol=1e-9)
    np.testing.assert_allclose(np.diff(log.time), 0.004, atol=1e-9)
    columns.write_text(columns.read_text().replace('"b"', '"c"'))
    with pytest.raises(InputError, match="no columns 'a' and 'c'"):
        read_log(path, columns=columns)
    columns.write_text(columns.read_text().replace('"c"', '"b"\nunit = "ms"'))
    with pytest.raises(InputError, match="nanoseconds beyond a column in ms"):
        read_log(path, columns=columns)


def test_lists_and_stamps_that_cannot_be_are_refused(tmp_path: Path) -> None:
    path = _written(tmp_path)
    lines = path.read_text().split("\n")
    short = lines[5].replace(", ", " , ", 1)
    torn = short.rsplit(", ", 1)[0] + ']"'
    path.write_text("\n".join([*lines[:5], torn, *lines[6:]]))
    with pytest.raises(InputError, match=r"line 6: found .*expected a list of 3 numbers"):
        read_log(path)
    first = lines[1].split(",", 2)
    path.write_text("\n".join([lines[0], f"{first[0]},1000000000,{first[2]}", *lines[2:]]))
    with pytest.raises(InputError, match=r"nanosec is 1000000000 in line 2, expected nanoseconds"):
        read_log(path)
    # a second topic with the same joints
    path.write_text(
        "\n".join(line + ("," + line.split(",", 2)[2] if line else "") for line in lines).replace(
            "effort,name,position,velocity,effort",
            "effort,/b/name,/b/position,/b/velocity,/b/effort",
        )
    )
    with pytest.raises(InputError, match=r"are both the position of joint 1"):
        read_log(path)


def test_a_list_over_several_cells_keeps_its_brackets(tmp_path: Path) -> None:
    """Of every row's first and last joint the cell was no number."""
    time, q, tau = _motion()
    names = ["time_s", *(f"{of} (J{j})" for of in ("Angle", "Torque") for j in (1, 2, 3))]
    lines = [",".join(names)]
    for k, at in enumerate(time):
        lists = [f"({', '.join(f'{v:.9f}' for v in row)})" for row in (q[k], tau[k])]
        lines.append(f"[{at:.3f}, {', '.join(lists)}]")
    path = tmp_path / "log.csv"
    path.write_text("\n".join(lines) + "\n")
    columns = tmp_path / "map.toml"
    columns.write_text(
        '[[columns]]\nfile = "Angle (J{j})"\nquantity = "q"\nunit = "rad"\n'
        '[[columns]]\nfile = "Torque (J{j})"\nquantity = "tau"\nunit = "Nm"\n'
    )
    log = read_log(path, columns=columns)
    np.testing.assert_allclose(log.q, q, atol=1e-9)
    np.testing.assert_allclose(log.tau, tau, atol=1e-8)


def test_positions_that_count_from_1_are_the_joints_from_the_first(tmp_path: Path) -> None:
    """They were "joint 2, joint 3, joint 4", and no joints of the robot's."""
    time, q, tau = _motion()
    names = ["time", *(f"{of}_{j}" for of in ("position", "effort") for j in (1, 2, 3))]
    path = tmp_path / "log.csv"
    np.savetxt(path, np.column_stack([time, q, tau]), "%.9f", ",", header=",".join(names))
    log = read_log(path, names=["base", "elbow", "wrist"])
    np.testing.assert_allclose(log.q, q, atol=1e-9)
    np.testing.assert_allclose(log.tau, tau, atol=1e-8)


@pytest.mark.parametrize("start", [0.0, 0.9])
def test_zeros_behind_a_record_are_left_out(tmp_path: Path, start: float) -> None:
    """An array longer than the record: the time fell back to zero, and the log was refused."""
    time, q, tau = _motion()
    whole = np.column_stack([time - time[0] + start, q, tau])
    rows = np.vstack([whole, np.zeros((25, whole.shape[1]))])
    names = ["time_s", *(f"q{j}_rad" for j in (1, 2, 3)), *(f"tau{j}_Nm" for j in (1, 2, 3))]
    path = tmp_path / "log.csv"
    np.savetxt(path, rows, "%.9f", ",", header=",".join(names))
    log = read_log(path)
    np.testing.assert_allclose(log.time, whole[:, 0], atol=1e-9)
    np.testing.assert_allclose(log.tau, tau, atol=1e-8)


@pytest.mark.parametrize("form", ["bagpy", "rostopic echo -p"])
@pytest.mark.parametrize("filled_in", [True, False])
def test_the_stamp_of_a_message_counts_and_not_when_it_was_got(
    form: str, filled_in: bool, tmp_path: Path
) -> None:
    """Messages came 2 to 6 ms late: half of the torque that was modelled was noise of their
    times. Where a driver leaves its stamps at zero, the recorder's are what there is."""
    time, q, tau = _motion()
    got = time + 0.002 + 0.001 * np.random.default_rng(1).uniform(0.0, 1.9, COUNT)
    whole, beyond = np.divmod(np.round(time * 1e9), 1e9)
    if not filled_in:
        whole = beyond = 0.0 * whole
    values = np.column_stack([q, tau])
    if form == "bagpy":
        header = "Time,header.stamp.secs,header.stamp.nsecs,name"
        header += "".join(f",{word}_{j}" for word in ("position", "effort") for j in range(3))
        heads = [
            f'{t + START:.6f},{w + START * filled_in:.0f},{b:.0f},"{NAMES}"'
            for t, w, b in zip(got, whole, beyond, strict=True)
        ]
    else:
        header = "%time,field.header.stamp"
        header += "".join(f",field.{word}{j}" for word in ("position", "effort") for j in range(3))
        heads = [
            f"{(t + START) * 1e9:.0f},{(START * filled_in + w) * 1e9 + b:.0f}"
            for t, w, b in zip(got, whole, beyond, strict=True)
        ]
    path = tmp_path / "log.csv"
    rows = [",".join((head, *map(str, row))) for head, row in zip(heads, values, strict=True)]
    path.write_text("\n".join([header, *rows]) + "\n")
    expected = time if filled_in else got
    found = read_log(path).time
    np.testing.assert_allclose(found - found[0], expected - expected[0], atol=2e-6)
