"""From a measured log to a better controller: what does this arm have that its model lacks, and
what is it worth?"""

from importlib import resources
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import export_package
from irb2400_ctrl.controllers import controller
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.measurement import read_log, recorded_motion
from irb2400_ctrl.simulation.close_the_loop import close_loop

# 1. two logs of one arm: a lively motion to learn from, another one to judge by
folder = Path(str(resources.files("irb2400_ctrl") / "data" / "arm"))
log, other = (read_log(folder / f"{name}.csv.gz") for name in ("identification", "validation"))
robot = irb.load_robot("irb2400")

# 2. what the model lacks, by name
found = diagnose(robot, log, validation=other)
print("verdict:", found.verdict)
for finding in found.findings:
    print(f"{finding.sentence} Confidence {finding.confidence:.2f}")
    for name, error in finding.standard_errors.items():
        print(f"   {name} {getattr(finding.effect, name):.3f}, standard error {error:.3f}")
    print("   not excluded:", ", ".join(finding.alternatives) or "nothing")

# 3. does it hold on the other motion? the error there, against the noise
compared = found.validation
errors = (compared.error_before, compared.error_recalibrated, compared.error_after)
for name, error in zip(("as given", "recalibrated", "as diagnosed"), errors, strict=True):
    print(f"robot {name:13} RMSE {error.rmse.round(2)} Nm")
print(f"noise floor              {found.noise_floor.round(2)} Nm")

# 4. the robot with the effect serves everything: here its controller, as C for a microcontroller
irb.save_robot(found.robot, "my_arm.toml")
mine = irb.load_robot("my_arm.toml")
verification = export_package(
    controller("computed_torque", mine), "my_controller", target="host", real="float"
)
print("C code equal to the model:", verification.passed)

# 5. the motion of the log again, with the controller of each description, on a simulated arm that
# has the effect
loop = close_loop(robot, mine, recorded_motion(log), controller="computed_torque")
for name, run in loop.runs.items():
    print(f"robot as {name:13} TCP error {1e3 * np.sqrt(np.mean(run.tcp_error**2)):.2f} mm rms")

curve = found.findings[0].curve
j = curve.joint - 1
figure, (left, middle, right) = plt.subplots(1, 3, figsize=(14, 4.5))
for name, tau, color in (
    ("as given", compared.before, "tab:red"),
    ("as diagnosed", compared.after, "tab:blue"),
):
    rest = np.where(compared.known[:, j], compared.measured[:, j] - tau[:, j], np.nan)
    left.plot(compared.time - compared.time[0], rest, color=color, lw=0.6, label=f"robot {name}")
left.set(
    xlabel="time [s]", ylabel="measured - predicted [Nm]", title=f"torque {j + 1}, the other motion"
)
middle.fill_between(
    np.degrees(curve.x), curve.low, curve.high, color="0.8", label="log, all else taken off (95 %)"
)
middle.plot(
    np.degrees(curve.x), curve.law, color="tab:blue", lw=1, label=found.findings[0].effect.kind
)
middle.set(
    xlabel=f"angle {j + 1} within one period [deg]", ylabel="torque [Nm]", title="the effect itself"
)
for name, run, color in (
    ("as given", loop.before, "tab:red"),
    ("as diagnosed", loop.after, "tab:blue"),
):
    error = np.degrees(run.q - run.q_ref)[:, j]
    right.plot(run.time, error, color=color, lw=0.6, label=f"controller from the robot {name}")
right.set(
    xlabel="time [s]", ylabel=f"error of joint {j + 1} [deg]", title="closed loop, computed torque"
)
for axis in (left, middle, right):
    axis.grid(alpha=0.3)
    axis.legend(fontsize="small", loc="upper center", bbox_to_anchor=(0.5, -0.16))
figure.tight_layout()
figure.savefig("diagnosis_01_close_the_loop.png", dpi=120)
