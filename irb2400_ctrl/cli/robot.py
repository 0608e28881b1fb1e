"""`irb2400 robot show|check|import|new|export`: the description of the arm."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from irb2400_ctrl.cli import robot_in
from irb2400_ctrl.cli.options import OutOption, output_file, output_folder, robots_named
from irb2400_ctrl.cli.summary import Summary, answers, wrote
from irb2400_ctrl.wording import counted

if TYPE_CHECKING:
    from irb2400_ctrl.robot import Robot
    from irb2400_ctrl.robot.joint import Joint

app = typer.Typer(
    help="show, check, import, write anew or export a robot",
    no_args_is_help=True,
    rich_markup_mode=None,
)
app.command("import", short_help="a robot file from URDF, MJCF or a DH table")(robot_in.import_)
app.command("new", short_help="a commented template, to fill in")(robot_in.new)
EXPORT_MARGIN = 1e-3
"""smallest second moment of a body over its largest, in an exported file [-]"""
COLUMNS: tuple[tuple[str, int, Callable[[Joint], float | None]], ...] = (
    ("speed [deg/s]", 0, lambda joint: joint.limits.speed_deg_s),
    ("acceleration [deg/s2]", 0, lambda joint: joint.limits.acceleration_deg_s2),
    ("torque [Nm]", 0, lambda joint: joint.limits.torque_Nm),
    ("gear [-]", 2, lambda joint: joint.transmission.gear_ratio if joint.transmission else None),
    ("static [Nm]", 1, lambda joint: joint.friction.static_Nm),
    ("Coulomb [Nm]", 1, lambda joint: joint.friction.coulomb_Nm),
    ("viscous [Nm s/rad]", 2, lambda joint: joint.friction.viscous_Nms_rad),
    ("Stribeck [rad/s]", 4, lambda joint: joint.friction.stribeck_rad_s),
)
"""of the table of `robot show`: head, decimals, and the number, None where it is unknown"""
RobotArgument = Annotated[
    str,
    typer.Argument(
        metavar="ROBOT", help="A robot file (TOML) or a name.", autocompletion=robots_named
    ),
]


@app.command(short_help="joints, limits, friction, links, tool, effects")
@answers
def show(robot: RobotArgument = "irb2400") -> Summary:
    """Print the robot: joints, limits, friction, links, tool, effects."""
    import numpy as np

    from irb2400_ctrl.robot import load_robot

    arm = load_robot(robot)
    holds = f"{counted(arm.n, 'joint')}, {counted(len(arm.effects), 'effect')}"
    print(f"{arm.name}: {holds}. Source: {arm.source}")
    wide = max(10, *(len(joint.name) for joint in arm.joints))
    print(f"{'joint':<{wide}}   range [deg]    {'  '.join(head for head, _, _ in COLUMNS)}")
    for joint in arm.joints:
        low, high = joint.limits.range_deg
        cells = [_cell(of(joint), len(head), digits) for head, digits, of in COLUMNS]
        print(f"{joint.name:<{wide}} {low:>6.0f} … {high:<6.0f} {'  '.join(cells)}")
    bodies = [(link.name, link.body) for link in arm.links]
    if arm.tool is not None:
        bodies.append((f"tool ({arm.tool.name})", arm.tool.body))
    wide = max(24, *(len(name) for name, _ in bodies))
    print(f"{'link':<{wide}} mass [kg] centre of mass [mm]")
    for name, body in bodies:
        com = ", ".join(f"{1e3 * c:.1f}" for c in body.com_m)
        print(f"{name:<{wide}} {body.mass_kg:>9.2f} {com}")
    if arm.tool is not None:
        x, y, z = 1e3 * np.array(arm.X_FT[:3, 3])
        print(f"TCP in the flange frame: {x:.0f}, {y:.0f}, {z:.0f} mm")
    print(f"prior, one standard deviation: {arm.uncertainty.says()}")
    for line in arm.assumptions():
        print(line)
    for effect in arm.effects:
        place = f" on joint {effect.joint}" if effect.joint else ""
        print(f"effect {effect.kind}{place}: {effect.parameters()}")
    facts = arm.model_dump(mode="json", exclude_none=True)
    return Summary(facts | {"assumptions": arm.assumptions()})


@app.command(short_help="what in the description cannot be so")
@answers
def check(
    robot: RobotArgument = "irb2400",
    project: Annotated[
        Path | None,
        typer.Option(
            metavar="OUT.toml", help="Write the nearest physically consistent robot there."
        ),
    ] = None,
    symmetry_plane: Annotated[
        Path | None,
        typer.Option(
            metavar="OUT.toml", help="Write the robot with the centres of mass of eqs. 37-42 there."
        ),
    ] = None,
) -> Summary:
    """Say in plain words what in the description cannot be so."""
    from irb2400_ctrl.robot import load_robot

    arm = load_robot(robot)
    for path, option in ((project, "--project"), (symmetry_plane, "--symmetry-plane")):
        if path is not None:
            output_file(path, option)
    facts = _print_bodies(arm)
    _print_assumed_limits(arm)
    if project is not None:
        _write_nearest_consistent(arm, project)
    if symmetry_plane is not None:
        _write_symmetric(arm, symmetry_plane)
    return Summary(facts, [path for path in (project, symmetry_plane) if path is not None])


@app.command(short_help="URDF or MJCF for other programs")
@answers
def export(
    out: OutOption,
    robot: RobotArgument = "irb2400",
    format: Annotated[
        Literal["urdf", "mjcf"], typer.Option(help="URDF, or MJCF with the coupling as a tendon.")
    ] = "urdf",
    as_is: Annotated[
        bool, typer.Option("--as-is", help="Keep mass data that no real body can have.")
    ] = False,
) -> Summary:
    """Write the robot as URDF or MJCF, its bodies such that a simulator accepts them; its head says
    what is left out."""
    import re

    from irb2400_ctrl.model.consistency import LEAST_MASS_KG, project, with_masses
    from irb2400_ctrl.robot import load_robot
    from irb2400_ctrl.robot.mjcf_export import left_out, save_mjcf
    from irb2400_ctrl.robot.urdf_export import save_urdf

    arm = load_robot(robot)
    weighed, bare = (arm, []) if as_is else with_masses(arm)
    written = weighed if as_is else project(weighed, EXPORT_MARGIN)[0]
    effects = left_out(arm) if format == "mjcf" else sorted({one.kind for one in arm.effects})
    _print_left_out(arm, format, effects)
    if bare:
        print(
            f"{', '.join(bare)} has no mass in the robot file: {1e3 * LEAST_MASS_KG:g} g is "
            "assumed, simulators refuse a moving body without one (--as-is leaves it out)"
        )
    if written != weighed:
        print(
            "mass data moved strictly inside what real bodies can have, as simulators ask for "
            "(--as-is keeps them)"
        )
    if written != arm:
        _print_torque_differences(arm, written)
    name = re.sub(r"\W+", "_", arm.name).strip("_").lower()
    save = {"urdf": (save_urdf, "urdf"), "mjcf": (save_mjcf, "xml")}[format]
    path = save[0](written, output_folder(out) / f"{name}.{save[1]}")
    facts = {
        "name": arm.name,
        "format": format,
        "assumptions": arm.assumptions(),
        "effects_left_out": effects,
        "mass_data_moved": written != weighed,
        "massless_bodies": bare,
    }
    return wrote(facts, [path])


def _print_left_out(arm: Robot, format: str, effects: list[str]) -> None:
    """What of the robot file the exported one does not say."""
    from irb2400_ctrl.robot.urdf_export import friction_left_out

    for line in arm.assumptions():
        print(line)
    if effects:
        print(f"left out, the format has no place for them: {', '.join(effects)}")
    if arm.friction_known[:, 0].any():
        print("left out, the format has no place for it: static friction and its transition speed")
    if format == "mjcf":
        print("left out, the format has no place for them: speed limits")
    elif arm.coupled:
        lost = ", ".join(friction_left_out(arm))
        print(
            f"left out: the coupling, and the friction of {lost}; the joints are link angles A q, "
            "the head says how to use it"
        )


def _print_bodies(arm: Robot) -> dict[str, Any]:
    """Which bodies could exist, and whether that matters to the torques; the same as facts."""
    from irb2400_ctrl.model import consistency
    from irb2400_ctrl.model.plausibility import plausibility, too_dense
    from irb2400_ctrl.model.positive_definite import certify

    bodies = consistency.report(arm)
    wide = max([18, *(len(body.name) for body in bodies)])
    print(
        f"{'body':<{wide}} {'principal moments [kg m2]':<29}  triangle slack [kg m2]  "
        "pseudo-inertia, least [kg m2]"
    )
    for body in bodies:
        moments = " ".join(f"{value:9.5f}" for value in body.principal_moments)
        verdict = "" if body.consistent else "  impossible"
        print(
            f"{body.name:<{wide}} {moments}  {body.triangle_slack:22.5f}  "
            f"{body.pseudo_inertia:29.5f}{verdict}"
        )
    issues = consistency.check(arm)
    notes = [*plausibility(arm), *arm.assumptions()]
    for note in notes:
        print(note)
    certificate = certify(arm)
    word = "is positive definite" if certificate.shown else "is not shown to be positive definite"
    print(f"the mass matrix {word} over the whole joint box: {certificate.reason}")
    if arm.weightless:
        same_torques = "no link has mass: only kinematics can be asked of this arm"
    elif issues:
        same_torques = _realisable(arm)
    else:
        so_dense = ", if there were matter so dense" if too_dense(arm) else ""
        same_torques = f"every body could exist{so_dense}"
    print(same_torques)
    return {
        "name": arm.name,
        "bodies": [asdict(body) | {"consistent": body.consistent} for body in bodies],
        "issues": [asdict(issue) for issue in issues],
        "notes": notes,
        "positive_definite": certificate.shown,
        "positive_definite_reason": certificate.reason,
        "realisable": same_torques,
    }


def _realisable(arm: Robot) -> str:
    """Whether other bodies make the torques of bodies that could not exist."""
    from irb2400_ctrl.model.realisable import realise

    found = realise(arm)
    if found.exists:
        return "other bodies, which could exist, make the same torques"
    return (
        "no set of bodies that could exist makes exactly these torques "
        f"(the best leaves an eigenvalue of {found.margin:.3g} in a pseudo-inertia)"
    )


def _print_assumed_limits(arm: Robot) -> None:
    for joint in arm.joints:
        limit = joint.limits.torque_Nm
        if limit is not None and "assumption" in joint.limits.torque_source:
            print(f"{joint.name}: torque limit {limit:.0f} Nm is an {joint.limits.torque_source}")


def _write_nearest_consistent(arm: Robot, path: Path) -> None:
    from irb2400_ctrl.model import consistency
    from irb2400_ctrl.robot import save_robot

    nearest, distance = consistency.project(arm)
    save_robot(nearest, path)
    print(f"written: {path}, second moments of the bodies moved by {distance:.4g} kg m2 in all")
    _print_torque_differences(arm, nearest)


def _write_symmetric(arm: Robot, path: Path) -> None:
    from irb2400_ctrl.model.symmetry import com_in_symmetry_plane
    from irb2400_ctrl.robot import save_robot

    symmetric = com_in_symmetry_plane(arm)
    save_robot(symmetric, path)
    print(f"written: {path}, centres of mass in the planes of symmetry")
    _print_torque_differences(arm, symmetric)


def _cell(value: float | None, width: int, digits: int) -> str:
    """A number of the table, or a question mark for what is unknown."""
    return f"{'?':>{width}}" if value is None else f"{value:>{width}.{digits}f}"


def _print_torque_differences(arm: Robot, other: Robot) -> None:
    from irb2400_ctrl.model.standard_motions import torque_differences

    head = "torque difference to the file as given, largest on standard motions [Nm]"
    print(f"{head}\n{'joint':<24}" + " ".join(f"{j:>8}" for j in range(1, 1 + arm.n)))
    for motion, largest in torque_differences(arm, other).items():
        print(f"{motion:<24}" + " ".join(f"{value:8.3f}" for value in largest))
