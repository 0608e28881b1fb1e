"""Which motion to record next? Friction that grows with the load, or more friction of the ordinary
kind?"""

from importlib import resources
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.excitation import Budget, excite
from irb2400_ctrl.measurement import read_log, recorded_motion
from irb2400_ctrl.simulation import Sensors, perturbed_robot, simulate

robot = irb.load_robot("irb2400")
# an arm a few per cent off its data sheet, whose axis 3 has 0.02 Nm more friction per Nm of load
arm = perturbed_robot(robot, seed=4).with_effects(LIBRARY["load_friction"].of(3, coefficient=0.02))

# the motion that tells load_friction from its look-alikes, within the limits of the robot; searched
# longer by default
plan = excite(
    robot, "load_friction", joint=3, seconds=30.0, budget=Budget(pool=24, rounds=1, mutations=8)
)
print("\n".join(plan.lines()))
plan.write("next_motion")  # trajectory.csv, and a RAPID program

usual = recorded_motion(
    read_log(Path(str(resources.files("irb2400_ctrl") / "data" / "arm" / "identification.csv.gz")))
)
motions = {"usual motion": usual, "planned motion": plan.trajectory()}
model = irb.Model(robot)
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4))
for (name, motion), color in zip(motions.items(), ("tab:red", "tab:blue"), strict=True):
    run = simulate(
        robot, motion, "feedforward_pid", plant=arm, sensors=Sensors(torque_noise_Nm=1.0), seed=4
    )
    found = diagnose(robot, run.log()).findings[0]
    lead = f"{found.effect.kind} leads by {found.margin:.0f} nats"
    print(f"{name:14} {lead} before the next best explanation, confidence {found.confidence:.2f}")
    load = model.inverse_dynamics(motion.q, motion.qd, motion.qdd, friction=False)[:, 2]
    right.plot(load, np.degrees(motion.qd[:, 2]), ".", ms=1, color=color, label=f"{name}: {lead}")
right.set(
    xlabel="load of axis 3 [Nm]",
    ylabel="speed of axis 3 [deg/s]",
    title="why: where the motions go",
    ylim=(-110, 150),
)
place = np.arange(len(plan.table))
for shift, k, name, color in (
    (0.2, 0, "usual motion", "tab:red"),
    (-0.2, 1, "planned motion", "tab:blue"),
):
    left.barh(place + shift, [row.distance[k] for row in plan.table], 0.4, color=color, label=name)
left.set_yticks(place, [row.pair for row in plan.table], fontsize="small")
left.set(xlabel="distance [standard deviations]", title="how far the look-alikes are apart")
for axis in (left, right):
    axis.grid(alpha=0.3)
    axis.legend(fontsize="small", markerscale=8)
figure.tight_layout()
figure.savefig("diagnosis_02_next_motion.png", dpi=120)
