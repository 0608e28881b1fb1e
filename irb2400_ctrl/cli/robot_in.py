"""`irb2400 robot import|new`: a robot file from another format, or from a template."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irb2400_ctrl.cli.options import output_file
from irb2400_ctrl.cli.summary import Summary, answers, wrote
from irb2400_ctrl.wording import counted

if TYPE_CHECKING:
    from irb2400_ctrl.robot.importing import Payload

RobotFile = Annotated[
    Path, typer.Option("--out", metavar="ARM.toml", help="The robot file to write.")
]


@answers
def import_(
    path: Annotated[Path, typer.Argument(metavar="FILE", help="URDF, MJCF, or DH table (CSV).")],
    out: RobotFile,
    base_link: Annotated[str | None, typer.Option(help="Link to start from; default root.")] = None,
    tool_link: Annotated[
        str | None, typer.Option(help="Link that ends the arm; default its tool frame.")
    ] = None,
    parallelogram: Annotated[
        bool, typer.Option(help="Axis 3 is driven over a parallelogram: theta3 = q3 - q2.")
    ] = False,
    coupling: Annotated[
        list[str] | None,
        typer.Option(metavar="I,J,FACTOR", help="theta_I = q_I + FACTOR q_J; may be given again."),
    ] = None,
    payload_kg: Annotated[float | None, typer.Option(help="Load on the flange.", min=0.0)] = None,
    payload_com_mm: Annotated[
        str | None, typer.Option(metavar="X,Y,Z", help="Its centre of mass in the flange frame.")
    ] = None,
    convention: Annotated[
        str | None, typer.Option(help="Of a DH table: standard or modified.")
    ] = None,
    meshes: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FOLDER", help="Where meshes and package:// paths are; may be given again."
        ),
    ] = None,
    outline: Annotated[
        bool, typer.Option(help="Read the shapes of the links: what the arm may not touch with.")
    ] = True,
) -> Summary:
    """Make a robot file from another format; says what was unknown and what looks wrong."""
    from irb2400_ctrl.cell import with_kept_apart
    from irb2400_ctrl.model.plausibility import plausibility
    from irb2400_ctrl.robot import save_robot
    from irb2400_ctrl.robot.importing import import_robot

    terms = [_coupling(text) for text in coupling or []]
    if parallelogram:
        terms.append((3, 2, -1.0))
    found = import_robot(
        path,
        base=base_link,
        tip=tool_link,
        coupling=tuple(terms),
        payload=_payload(payload_kg, payload_com_mm),
        convention=convention,
        meshes=tuple(meshes or ()),
        outline=outline,
    )
    arm, of_outline = with_kept_apart(found.robot)
    save_robot(arm, output_file(out))
    notes = [*found.notes, *of_outline, *arm.assumptions()]
    checks = plausibility(arm)
    said = [*(f"note: {note}" for note in notes), *(f"check: {note}" for note in checks)]
    print("\n".join([f"{arm.name}: {counted(arm.n, 'joint')}", *said]))
    facts = {"name": arm.name, "joints": arm.n, "notes": notes, "checks": checks}
    return wrote(facts, [out])


@answers
def new(out: RobotFile) -> Summary:
    """Write a commented template of a robot file; it loads as it is."""
    from importlib import resources

    from irb2400_ctrl.errors import InputError
    from irb2400_ctrl.files import write_atomic

    if output_file(out).exists():
        raise InputError(
            f"--out {out}: found it already, expected a new name: the template would replace it"
        )
    text = (resources.files("irb2400_ctrl") / "robot" / "template.toml").read_text("utf-8")
    return wrote({}, [write_atomic(out, text)])


def _payload(mass_kg: float | None, com_mm: str | None) -> Payload | None:
    from irb2400_ctrl.errors import InputError
    from irb2400_ctrl.robot.importing import Payload

    if mass_kg is None and com_mm is not None:
        raise InputError(
            f"--payload-com-mm: found {com_mm!r} and no mass, expected --payload-kg beside it"
        )
    x, y, z = (value / 1e3 for value in _numbers("--payload-com-mm", com_mm or "0,0,0"))
    return None if mass_kg is None else Payload(mass_kg, (x, y, z))


def _numbers(option: str, text: str) -> tuple[float, float, float]:
    from irb2400_ctrl.errors import InputError

    try:
        a, b, c = (float(part) for part in text.split(","))
    except ValueError as error:
        raise InputError(f"{option}: found {text!r}, expected three numbers a,b,c") from error
    return a, b, c


def _coupling(text: str) -> tuple[int, int, float]:
    from irb2400_ctrl.errors import InputError

    i, j, factor = _numbers("--coupling", text)
    if not (i.is_integer() and j.is_integer()):
        raise InputError(f"--coupling: found {text!r}, expected the numbers of two joints first")
    return int(i), int(j), factor
