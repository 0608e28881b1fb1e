"""`irb2400 robot show|check|export`: the description of the arm."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(help="Show, check or export a robot description.", no_args_is_help=True)
RobotArgument = Annotated[str, typer.Argument(metavar="ROBOT", help="A robot file (TOML) or a name.")]


@app.command()
def show(robot: RobotArgument = "irb2400") -> None:
    """Print the robot: joints, limits, friction, links, tool, effects."""
    import numpy as np

    from irb2400_ctrl.robot import load_robot

    arm = load_robot(robot)
    print(f"{arm.name}: {arm.n} joints, {len(arm.effects)} effects. Source: {arm.source}")
    print("joint        range deg      speed deg/s  torque Nm  Fs Nm  Fc Nm  Fv Nms/rad  wst rad/s")
    for joint in arm.joints:
        low, high = joint.limits.range_deg
        f = joint.friction
        print(
            f"{joint.name:<10} {low:>6.0f} … {high:<6.0f} {joint.limits.speed_deg_s:>10.0f} "
            f"{joint.limits.torque_Nm:>10.0f} {f.static_Nm:>6.1f} {f.coulomb_Nm:>6.1f} "
            f"{f.viscous_Nms_rad:>11.2f} {f.stribeck_rad_s:>10.4f}"
        )
    print("link        mass kg   centre of mass mm")
    bodies = [(link.name, link.body) for link in arm.links]
    if arm.tool is not None:
        bodies.append((f"tool ({arm.tool.name})", arm.tool.body))
    for name, body in bodies:
        com = ", ".join(f"{1e3 * c:.1f}" for c in body.com_m)
        print(f"{name:<24} {body.mass_kg:>7.2f}   {com}")
    if arm.tool is not None:
        x, y, z = 1e3 * np.array(arm.X_FT[:3, 3])
        print(f"TCP in the flange frame: {x:.0f}, {y:.0f}, {z:.0f} mm")
    for effect in arm.effects:
        place = f" on joint {effect.joint}" if effect.joint else ""
        print(f"effect {effect.kind}{place}: {effect.parameters()}")
