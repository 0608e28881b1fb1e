"""`egm_log`: what a controller streams by EGM as a log, piece by piece as it comes.

EGM tells the axis angles, its own reference and test signals. The joint torques have to be among
these: the controller is set up to send them, ABB's EGM has no field of their own for them. Nothing
is answered, so the arm is watched, not guided.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from queue import Empty, SimpleQueue
from socket import socket
from time import monotonic
from urllib.parse import urlsplit

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import ColumnMap, Log, load_column_map
from irb2400_ctrl.measurement.read_log import log_of
from irb2400_ctrl.measurement.table import Table
from irb2400_ctrl.planners.programs.egm.egm_messages import CLOCK, RobotMessage, decode_robot
from irb2400_ctrl.planners.programs.egm.egm_socket import PORT, listening

SCHEME = "egm"
PIECE = 1.0
"""[s] of the controller's clock that are given on together"""
LOOK = 0.2
"""[s] after which the listener asks whether it is still wanted"""


def egm_log(
    place: str,
    columns: Path | None = None,
    names: Sequence[str] | None = None,
    *,
    quiet: float = 10.0,
    on_ready: Callable[[int], None] = lambda port: None,
) -> Iterator[Log]:
    """A controller's messages until it falls silent.

    Columns are `time_s`, `q1_deg`…, `q1_ref_deg`… and `signal1`…; without a map the first test
    signals are the joint torques [Nm], and are called `tau1_Nm`….

    Args:
        place: `egm://HOST[:PORT]`: the controller's address, the port of this machine it sends to.
        columns: what the test signals are (torques in per cent, currents), as in `read_log`.
        names: of the robot's joints.
        quiet: ends when no newer message came for so long [s].
        on_ready: called with the port once it is open.

    Raises:
        InputError: no such address, nobody sends, or the messages hold no torques.
    """
    controller, port = _parts(place)
    given = None if columns is None else load_column_map(columns)
    heard: SimpleQueue[bytes] = SimpleQueue()
    over = threading.Event()
    with listening(controller, port=port) as (wire, named):
        # of its own: nothing is lost while a piece is worked on
        ear = threading.Thread(target=_listen, args=(wire, named, heard, over), daemon=True)
        ear.start()
        on_ready(wire.getsockname()[1])
        try:
            yield from _pieces(heard, quiet, lambda rows: _log(place, rows, given, names))
        finally:
            over.set()
            ear.join()


Rows = list[tuple[int, RobotMessage]]


def _parts(place: str) -> tuple[str, int]:
    try:
        parts = urlsplit(place)
        port = PORT if parts.port is None else parts.port
        known = parts.scheme == SCHEME and parts.path in {"", "/"}
    except ValueError:
        known = False
    if not known or not parts.hostname:
        raise InputError(f"found {place}, expected egm://HOST or egm://HOST:PORT")
    return parts.hostname, port


def _listen(wire: socket, named: str, into: SimpleQueue[bytes], over: threading.Event) -> None:
    wire.settimeout(LOOK)
    while not over.is_set():
        try:
            data, sender = wire.recvfrom(4096)
        except OSError:
            # nothing came; or Windows tells here that somebody did not take what was sent
            continue
        if sender[0] == named:
            into.put(data)


def _pieces(heard: SimpleQueue[bytes], quiet: float, log: Callable[[Rows], Log]) -> Iterator[Log]:
    """Messages as logs; what came twice, late or torn is passed over."""
    rows: Rows = []
    clock: int | None = None
    deadline = monotonic() + quiet
    while True:
        try:
            message = decode_robot(heard.get(timeout=max(0.0, deadline - monotonic())))
        except Empty:
            break
        except InputError:
            continue
        step = 1 if clock is None else (message.time_ms - clock) % CLOCK
        if not 0 < step < CLOCK // 2:
            continue
        clock = message.time_ms if clock is None else clock + step
        rows.append((clock, message))
        if clock - rows[0][0] >= 1e3 * PIECE:
            yield log(rows)
            rows = []
        deadline = monotonic() + quiet
    if clock is None:
        raise InputError(
            f"no EGM message came within {quiet:g} s; expected a controller that runs "
            "EGMStreamStart or EGMRunJoint (does its UDPUC device name this machine and port?)"
        )
    if len(rows) > 1:
        yield log(rows)


def _log(place: str, rows: Rows, given: ColumnMap | None, names: Sequence[str] | None) -> Log:
    first = rows[0][1]
    n = len(first.q_deg)
    if given is None and len(first.signals) < n:
        raise InputError(
            f"{place}: found {len(first.signals)} test signals in the messages, expected the "
            f"torques of the {n} joints there: EGM tells none of its own. Set up the controller to "
            "send them, or watch a log that it records"
        )
    columns = {"time_s": np.array([clock for clock, _ in rows]) / 1e3}
    heads = {"q{}_deg": "q_deg", "q{}_ref_deg": "q_planned_deg"}
    heads["tau{}_Nm" if given is None else "signal{}"] = "signals"
    for head, field in heads.items():
        values = [getattr(message, field) for _, message in rows]
        if len({len(value) for value in values}) > 1:
            raise InputError(f"{place}: found {field} of changing length, expected {n} joints")
        count = n if given is None and field == "signals" else len(values[0])
        for j, column in zip(range(count), np.array(values).T, strict=False):
            columns[head.format(j + 1)] = column
    return log_of(Table(Path(place), columns), given, names)
