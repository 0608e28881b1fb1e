"""What does an elastic gear on axis 1 do to the margins, and does it swing as in the paper's Fig.
12a? Twenty arms that differ from their model by a few per cent, each with a gear of its own."""

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import ArrayLike

import irb2400_ctrl as irb
from irb2400_ctrl.controllers import controller
from irb2400_ctrl.controllers.linear import LinearLoop
from irb2400_ctrl.controllers.timing import Timing
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.simulation import Simulation, Trajectory, make_loop, perturbed_robot

robot = irb.load_robot("irb2400")
pose = np.array([0.0, 0.3, -0.1, 0.3, 0.9, -0.2])
block = controller("feedforward_pid", robot)
rng = np.random.default_rng(12)
arms = [perturbed_robot(robot, seed=seed) for seed in range(20)]
stiffnesses = np.geomspace(3e4, 1e6, len(arms))
# nobody publishes the rotor's inertia either: an assumption
inertias = rng.uniform(10.0, 20.0, len(arms))


def elastic(arm: irb.Robot, stiffness: float, inertia: float) -> irb.Robot:
    """The arm with an elastic gear on axis 1."""
    return arm.with_effects(
        LIBRARY["elastic_joint"].of(1, stiffness_Nm_rad=stiffness, damping_ratio=0.03),
        LIBRARY["rotor_inertia"].of(1, inertia_kgm2=inertia),
    )


def move(angle: float, duration: float) -> Trajectory:
    """Axis 1 alone, at constant speed between two quick ramps, as in the paper's single-axis
    tests."""
    time = np.linspace(0, duration, int(250 * duration) + 1)
    ramp = 0.15
    speed = angle / (duration - ramp)
    qd = speed * np.clip(np.minimum(time, duration - time) / ramp, 0, 1)
    qdd = np.gradient(qd, time)
    q = np.concatenate([[0], np.cumsum(0.5 * (qd[1:] + qd[:-1]) * np.diff(time))])
    unit = np.eye(6)[0]
    return Trajectory(time, pose + np.outer(q, unit), np.outer(qd, unit), np.outer(qdd, unit))


def told(values: ArrayLike) -> str:
    """Median of the arms, and their range."""
    return f"{np.median(values):.1f} ({np.min(values):.1f} to {np.max(values):.1f})"


soft = [
    elastic(arm, k, inertia) for arm, k, inertia in zip(arms, stiffnesses, inertias, strict=True)
]
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.5))
colours = plt.cm.viridis(np.linspace(0, 0.9, len(arms)))
for kind, drawn in (("rigid", arms), ("elastic", soft)):
    loops = [LinearLoop(arm, block, pose, Timing()) for arm in drawn]
    margins = [loop.joint(1) for loop in loops]
    print(
        f"{kind}: {sum(loop.stable for loop in loops)} of {len(loops)} arms stable; delay margin "
        f"{told([1e3 * m.delay for m in margins])} ms, phase margin "
        f"{told([np.degrees(m.phase) for m in margins])} deg"
    )
    for k, (loop, colour) in enumerate(zip(loops, colours, strict=True)):
        style = {"color": colour} if kind == "elastic" else {"color": "k", "ls": "--", "lw": 0.5}
        label = f"{kind}, {stiffnesses[k]:.0e} Nm/rad" if kind == "elastic" else "rigid"
        ends = (0, len(loops) - 1) if kind == "elastic" else (0,)
        style["label"] = label if k in ends else None
        left.loglog(loop.omega, np.abs(loop.sensitivity[:, 0, 0]), **style)
left.set(
    xlabel="frequency [rad/s]",
    ylabel="|S| of axis 1 [-]",
    title="Sensitivity",
    xlim=(3, None),
    ylim=(1e-2, 10),
)
left.legend()
motion = move(0.8, 1.0)
even = slice(300, 800)


def swing(run: Simulation) -> float:
    """Torque of axis 1 at constant speed without what changes slowly [Nm rms]."""
    time = run.time[even]
    torque = run.tau[even, 0]
    return float(np.std(torque - np.polyval(np.polyfit(time, torque, 3), time)))


swings = {}
for kind, drawn in (("rigid", arms), ("elastic", soft)):
    loop = make_loop(robot, "feedforward_pid", plant=drawn[0])
    runs = [loop.run(motion, plant=arm, hold=0.4) for arm in drawn]
    swings[kind] = np.array([swing(run) for run in runs])
    right.plot(runs[6].time, runs[6].tau[:, 0], label=f"{kind}, arm 7", lw=0.8)
yielding = stiffnesses < 2e5
print(
    f"at constant speed the torque of axis 1 swings by {told(swings['elastic'][yielding])} Nm rms "
    f"on {yielding.sum()} gears below 2e5 Nm/rad, by {told(swings['elastic'][~yielding])} Nm on "
    f"the stiffer ones, by {told(swings['rigid'])} Nm on rigid arms"
)
right.set(
    xlabel="time [s]", ylabel="torque of axis 1 [Nm]", title="Single-axis move (as in Fig. 12a)"
)
right.legend()
for axes in (left, right):
    axes.grid(alpha=0.3)
figure.tight_layout()
figure.savefig("control_03_elasticity.png", dpi=120)
