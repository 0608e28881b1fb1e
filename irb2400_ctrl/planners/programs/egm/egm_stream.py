"""Stream a plan to an ABB controller by Externally Guided Motion: joint positions and speeds, 250
times a second.

EGM takes positions and speeds, never torques: the controller's own servo follows them with its own
lag. The controller opens the conversation (RAPID: EGMSetupUC, EGMActJoint, EGMRunJoint;
docs/programs_out.md) and sends an EgmRobot by UDP each cycle; every one of them is answered with
where the plan is on the controller's own clock.
"""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.egm import egm_messages as proto
from irb2400_ctrl.planners.programs.egm.egm_follower import EgmFollower
from irb2400_ctrl.planners.programs.egm.egm_report import EgmError, EgmOptions, EgmReport
from irb2400_ctrl.planners.programs.egm.egm_socket import PORT, listening
from irb2400_ctrl.typed import typed

__all__ = ["PORT", "EgmError", "EgmFollower", "EgmOptions", "EgmReport", "stream"]


@typed
def stream(
    follower: EgmFollower,
    *,
    controller: str = "127.0.0.1",
    host: str | None = None,
    port: int = PORT,
    should_stop: Callable[[], bool] = lambda: False,
    on_ready: Callable[[int], None] = lambda port: None,
) -> EgmReport:
    """Answer the controller's messages on a UDP port until the plan is done.

    Args:
        controller: its address. Datagrams from elsewhere are not looked at; the first message
            that can be read from there binds the stream to its port as well.
        host, port: where to listen; the controller's UDPUC device names this machine (port 0: any
            free one). Default: only the address of this machine that faces the controller.
        should_stop: asked at every message; True slows down along the path and ends.
        on_ready: called with the port once it is open.

    Raises:
        InputError: no such address, or it cannot be listened on.
        EgmError: nobody calls, the controller falls silent, or what `EgmFollower.answer` raises.
    """
    options = follower.options
    with listening(controller, host, port) as (wire, named):
        on_ready(wire.getsockname()[1])
        # until EGM runs it may take long; from then on each message must follow the last one soon
        deadline = monotonic() + options.connect_timeout
        peer = None
        while not follower.done:
            try:
                left = deadline - monotonic()
                if left <= 0:
                    raise TimeoutError
                wire.settimeout(left)
                data, sender = wire.recvfrom(4096)
            except TimeoutError as error:
                raise follower.failure(_silence(follower, peer is not None)) from error
            if sender[0] != named or peer not in (None, sender):
                continue
            try:
                message = proto.decode_robot(data)
            except InputError:
                # somebody else's datagram, or a torn one: the next message makes up for it
                continue
            peer = sender
            if should_stop():
                follower.stop()
            answer = follower.answer(message)
            if answer is None:
                # the same message again and again is as good as silence
                continue
            wire.sendto(proto.encode_sensor(answer), sender)
            if follower.running:
                deadline = monotonic() + options.timeout
    return follower.report()


def _silence(follower: EgmFollower, called: bool) -> str:
    """Why waiting for a message has an end."""
    options = follower.options
    if follower.running:
        return f"no message for {options.timeout:.3f} s"
    if called:
        return f"the controller calls but EGM did not run within {options.connect_timeout:.1f} s"
    return f"no controller called within {options.connect_timeout:.1f} s (UDPUC address and port?)"
