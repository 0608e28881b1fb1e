"""What is it worth to tell the controller of an effect? A balancer, a worn gear and a payload,
known or not."""

import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.simulation import from_angles, perturbed_robot, simulate

robot = irb.load_robot("irb2400")
effects = {
    "balancer": LIBRARY["balancer"].of(2, torque_Nm=250.0),
    "gear ripple": LIBRARY["gear_ripple"].of(4, amplitude_Nm=5.0, order=12.0),
    "hysteresis": LIBRARY["hysteresis"].of(3, amplitude_Nm=25.0, width_rad=0.02),
    "payload 8 kg": LIBRARY["payload"].of(None, mass_kg=8.0, com_m=(0.05, 0.0, 0.15)),
}
time = np.linspace(0, 4, 81)
swing = np.sin(1.5 * time)[:, None] ** 2 * np.array([0.8, 0.5, -0.4, 1.2, 0.6, -1.0])
motion = from_angles(time, swing + np.array([-0.3, 0.1, 0.0, 0.2, 0.6, -0.2]))
before = []
after = []
for name, effect in effects.items():
    # the true arm also differs in masses and friction, as arms do
    plant = perturbed_robot(robot, seed=4).with_effects(effect)
    for known, errors in ((robot, before), (robot.with_effects(effect), after)):
        run = simulate(known, motion, "computed_torque", plant=plant)
        errors.append(1e3 * np.sqrt(np.mean(run.tcp_error**2)))
    print(f"{name:13} unknown {before[-1]:.2f} mm rms, known {after[-1]:.2f} mm rms")
place = np.arange(len(effects))
figure, axes = plt.subplots(figsize=(7, 4))
axes.bar(place - 0.2, before, 0.4, label="unknown to the controller")
axes.bar(place + 0.2, after, 0.4, label="known")
axes.set_xticks(place, list(effects))
axes.set(ylabel="TCP error [mm rms]", title="Computed torque")
axes.grid(axis="y", alpha=0.3)
axes.legend()
figure.tight_layout()
figure.savefig("control_06_effect.png", dpi=120)
