"""How much faster, or how much more economical, is a motion whose geometry between the way-points
is left free?"""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.planners.trajectory_optimisation.optimise_motion import optimise_motion

robot = irb.load_robot("irb2400")
model = irb.Model(robot)
waypoints = np.radians(
    [
        [0, -20, 10, 0, 60, 0],
        [40, 10, -10, 30, 40, -60],
        [20, 25, -25, -20, 70, 0],
        [-30, -5, 20, 10, 50, 50],
    ]
)
fast = optimise_motion(robot, waypoints)
thrifty = optimise_motion(robot, waypoints, objective="energy")
for found in (fast, thrifty):
    assert found.reference is not None
    print(f"least {found.objective}: {found.message}")
    print(f"  duration {found.duration:.3f} s, fixed spline {found.reference.duration:.3f} s")
    print(
        f"  energy {found.motion.energy.sum():.0f} J, fixed spline "
        f"{found.reference.energy.sum():.0f} J"
    )
    print("  peak torque [Nm]", found.motion.peak_torque.round(0), "of", robot.tau_max)
    print(f"  certified: torque {found.motion.checked.torque_ratio:.6f} of its limit at most")

fig, axes = plt.subplots(2, 2, figsize=(10, 6), sharex=True, constrained_layout=True)
shown = (("fixed spline", fast.reference), ("free geometry", fast.motion))
for column, (title, part) in zip(axes.T, shown, strict=True):
    assert part is not None
    time = np.linspace(0, part.duration, 1500)
    _, q, qd, qdd = part.certificate.law.motion(part.certificate.path, time)
    column[0].plot(time, np.degrees(q))
    column[0].set(title=f"{title}: {part.duration:.3f} s", ylabel="angle [deg]")
    column[1].plot(time, model.inverse_dynamics(q, qd, qdd) / robot.tau_max, lw=0.9)
    column[1].axhline(1, color="k", lw=0.5)
    column[1].axhline(-1, color="k", lw=0.5)
    column[1].set(xlabel="time [s]", ylabel="torque / limit [-]")
axes[0, 0].legend([f"axis {j + 1}" for j in range(robot.n)], fontsize=7, ncols=2)
fig.savefig("optimise_01_free_geometry.png", dpi=110)
