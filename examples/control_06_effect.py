"""What is it worth to tell the controller of an effect? A balancer, a worn gear, hysteresis and a
payload on twenty arms, known or not."""

import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.simulation import from_angles, make_loop, perturbed_robot

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
    # the true arms also differ in masses and friction, as arms do
    arms = [perturbed_robot(robot, seed=seed).with_effects(effect) for seed in range(20)]
    for known, errors in ((robot, before), (robot.with_effects(effect), after)):
        loop = make_loop(known, "computed_torque", plant=arms[0])
        runs = [loop.run(motion, plant=arm) for arm in arms]
        errors.append([1e3 * np.sqrt(np.mean(run.tcp_error**2)) for run in runs])
    better = np.array(before[-1]) / after[-1]
    print(
        f"{name:13} unknown {np.median(before[-1]):.2f} mm rms, known {np.median(after[-1]):.2f} "
        f"({min(after[-1]):.2f} to {max(after[-1]):.2f}); better on {(better > 1).sum()} of 20 "
        f"arms, by a factor of {np.median(better):.1f} in the median"
    )
place = np.arange(len(effects))
figure, axes = plt.subplots(figsize=(7, 4))
for side, errors, label in ((-0.2, before, "unknown to the controller"), (0.2, after, "known")):
    low, middle, high = (np.percentile(errors, share, axis=1) for share in (0, 50, 100))
    axes.bar(place + side, middle, 0.4, label=label, yerr=[middle - low, high - middle], capsize=3)
axes.set_xticks(place, list(effects))
axes.set(ylabel="TCP error [mm rms]", title="Computed torque, median and range of 20 arms")
axes.grid(axis="y", alpha=0.3)
axes.legend()
figure.tight_layout()
figure.savefig("control_06_effect.png", dpi=120)
