"""What a diagnosis says: findings, the augmented robot, errors before and after, and what a report
draws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from irb2400_ctrl.arrays import Array, Mask, rms
from irb2400_ctrl.diagnosis.at_rest import worse_at_rest
from irb2400_ctrl.diagnosis.finding import Finding, Unexplained
from irb2400_ctrl.diagnosis.log_errors import LogErrors
from irb2400_ctrl.diagnosis.numbers import Number
from irb2400_ctrl.diagnosis.preparation.metrics import Errors
from irb2400_ctrl.diagnosis.preparation.noise_test import NoiseTest, trimmed_rms
from irb2400_ctrl.diagnosis.sound_logs import LeftOut
from irb2400_ctrl.files import plain, write_json
from irb2400_ctrl.notebook import Displayed
from irb2400_ctrl.plausibility import LogProblem
from irb2400_ctrl.robot import Robot, save_robot

Verdict = Literal["explained", "nothing_missing", "unexplained", "log_not_understood"]
SCHEMA_VERSION = 2
NEAR_FLOOR = 3.0
"""times the noise floor that may be left on a joint of an explained log, or"""
LITTLE = 0.1
"""of its rms torque"""
SLOW = 1.2
"""times the floor that the spectrum of what is left shows above the motion's frequencies, below
which it is as strong there: noise with a colour (1.07 at most on three sound arms whose torque
sensors have it, 1.6 and more where a law was missing)"""
USUAL = 1.3
"""times what a reference leaves on stretches that its model had not seen"""
HALF = 0.5
"""of an error, below which what numbers that a reference leaves open leave of it is their doing"""
NEVER_NOISE = 2.0
"""times that, beyond which nothing left is noise, whatever the angles' noise may explain: parts of
four real arms against others of the same leave 1.56 at most (`benchmarks/real_injected.py` without
shares, and swapped)"""


@dataclass(frozen=True)
class Comparison:
    """One log against the robot as given and the robot with what was found; arrays (m, n) on a
    uniform grid.

    Args:
        known: samples that count for the errors.
        recalibrated: the robot with the numbers that explain the log best without further effects:
            those found beside effects would do worse alone.
        noise_floor: what a perfect model would leave on this log [Nm rms], (n,).
    """

    name: str
    time: Array
    measured: Array
    before: Array
    recalibrated: Array
    after: Array
    known: Mask
    error_before: Errors
    error_recalibrated: Errors
    error_after: Errors
    noise_floor: Array

    def to_json(self) -> dict[str, Any]:
        """As in findings.json."""
        return {
            "before": self.error_before.to_json(),
            "recalibrated": self.error_recalibrated.to_json(),
            "after": self.error_after.to_json(),
        }


@dataclass(frozen=True, repr=False)
class Diagnosis(Displayed):
    """The answer to: what does this log show that the robot's model lacks?

    Args:
        given, robot: as given, and with new parameters and the effects found.
        not_excited: joints (from 1) that hardly moved: nothing can be said about them.
        weak: why the answer is weaker than usual, in words; empty if it is not.
        log_problem: why the log was not understood; no effect was tried then.
        numbers: of the model that this arm has otherwise, or that its file lacks.
        change: whether `given` is a reference of this very arm.
        logs: errors on each log; left_out: logs that could not be used.
        before: what the reference logs showed; None without them.
        usual_error: RMSE of its model on stretches it had not seen [Nm], (n,).
        noise: what is left, held against what neighbouring samples disagree about; None where no
            effect was tried.
        nameless: joint (from 1) with so much that no name says that lesser names were taken back.
        unsettled: whether the search for names ended before it settled.
    """

    given: Robot
    robot: Robot
    findings: tuple[Finding, ...]
    unexplained: tuple[Unexplained, ...]
    recalibrated: Mapping[str, Any]
    identification: Comparison
    validation: Comparison | None
    not_excited: tuple[int, ...]
    weak: tuple[str, ...] = field(default=())
    log_problem: LogProblem | None = None
    numbers: tuple[Number, ...] = ()
    change: bool = False
    logs: tuple[LogErrors, ...] = ()
    left_out: tuple[LeftOut, ...] = ()
    before: Diagnosis | None = None
    usual_error: Array | None = None
    noise: NoiseTest | None = None
    nameless: int | None = None
    unsettled: bool = False

    @property
    def noise_floor(self) -> Array:
        """Rms of the torque noise per joint, shape (n,) [Nm]."""
        return self.identification.noise_floor

    @property
    def verdict(self) -> Verdict:
        """`unexplained` wins over `explained`: something is left that has no name, or names come
        and go with each other.

        What is more than noise is never called nothing.
        """
        if self.log_problem is not None:
            return "log_not_understood"
        if self.unexplained or self.nameless or (self.findings and self.left_over):
            return "unexplained"
        if self.worse_at_rest or self.unsettled:  # whatever was found
            return "unexplained"
        if self.findings:
            return "explained"
        return "unexplained" if self.beyond_noise else "nothing_missing"

    @property
    def worse_at_rest(self) -> tuple[int, ...]:
        """Resting joints (from 1) whose torque what was found makes wrong beyond friction."""
        compared = self.identification
        before = compared.error_before.rmse
        return worse_at_rest(self.given, self.not_excited, before, compared.error_after.rmse)

    @property
    def beyond_noise(self) -> tuple[int, ...]:
        """Joints (from 1) on which more is left than noise, and than the model usually leaves."""
        if self.noise is None:
            return ()
        left = self.identification.error_after.rmse
        coloured = [
            j for j in self.noise.by_means_alone if left[j - 1] < SLOW * self.noise_floor[j - 1]
        ]
        beyond = [j for j in self.noise.beyond if j not in coloured]
        if self.usual_rmse is not None:
            far = self.mostly_left > NEVER_NOISE * self.usual_rmse
            beyond += [int(j) + 1 for j in np.flatnonzero(far)]
        return self._that_count([*beyond, *self.noise.quick.joints])

    @property
    def left_over(self) -> tuple[int, ...]:
        """Joints (from 1) on which much is left after all that was found, or what is quicker than
        laws are compared on."""
        quick = () if self.noise is None else self.noise.quick.joints
        return self._that_count([*self.much_left, *quick])

    @property
    def much_left(self) -> tuple[int, ...]:
        """Joints (from 1) on which much more than noise is left, beside few samples."""
        return self._that_count(self._beyond_floor)

    @property
    def left_as_usual(self) -> tuple[int, ...]:
        """Joints (from 1) on which much more than noise is left, but no more than the model of this
        very arm leaves of any motion."""
        resting = {*self.much_left, *self.not_excited}
        return tuple(j for j in self._beyond_floor if j not in resting)

    @property
    def taken_up(self) -> tuple[int, ...]:
        """Joints (from 1) of which the model of this very arm leaves far more of this log than of
        its own, or more than twice what numbers that it leaves open make of it, and no name and no
        number says why: such numbers took it up."""
        if self.usual_rmse is None:
            return ()
        before = self.identification.error_before.rmse
        halved = self.identification.error_after.rmse < HALF * before
        far = before > np.where(halved, USUAL, NEVER_NOISE) * self.usual_rmse
        said: set[int | None] = {f.effect.joint for f in self.findings}
        said |= {u.joint for u in self.unexplained} | {*self.beyond_noise, *self.not_excited}
        told = [n for n in self.numbers if n.list == "changed" or not self.change]
        places = [n.place.split() for n in told]
        # a body, or what the whole arm has, is felt on all
        if None in said or any(place[0] != "joint" for place in places):
            return ()
        said |= {int(place[1]) for place in places}
        return tuple(int(j) + 1 for j in np.flatnonzero(far) if j + 1 not in said)

    @property
    def _beyond_floor(self) -> list[int]:
        size = rms(self.identification.measured)
        much = self.mostly_left > np.maximum(NEAR_FLOOR * self.least_floor, LITTLE * size)
        return [int(j) + 1 for j in np.flatnonzero(much)]

    def _that_count(self, joints: Sequence[int]) -> tuple[int, ...]:
        """Those (from 1) that move, and on which more is left than usual."""
        moving = set(joints) - set(self.not_excited)
        return tuple(j for j in sorted(moving) if self._news[j - 1])

    @property
    def mostly_left(self) -> Array:
        """Rms of what is left, beside the few samples at which a joint sticks, (n,) [Nm]."""
        compared = self.identification
        left = compared.measured - compared.after
        pairs = zip(left.T, compared.known.T, strict=True)
        return np.array([trimmed_rms(one[known]) for one, known in pairs])

    @property
    def least_floor(self) -> Array:
        """Noise that what is left is held against, (n,) [Nm]: fast misfit is none, as neighbouring
        samples tell where they were asked."""
        if self.noise is None:
            return self.noise_floor
        return np.minimum(self.noise_floor, self.noise.floor)

    @property
    def usual_rmse(self) -> Array | None:
        """What the model of this very arm leaves of any motion, noise with it, (n,) [Nm]; None
        where the file does not say."""
        if self.usual_error is not None:
            return self.usual_error
        if not self.given.usually_left.any():
            return None
        return np.asarray(np.hypot(self.given.usually_left, self.least_floor))

    @property
    def blunt(self) -> bool:
        """Whether the model of this very arm usually leaves so much more than noise of some joint
        that a change may hide in it."""
        usual = self.usual_rmse
        return usual is not None and bool((usual > NEVER_NOISE * self.least_floor).any())

    @property
    def _news(self) -> Mask:
        """Joints on which more is left than usual, (n,); all where that is not known."""
        if self.usual_error is not None:
            return np.asarray(self.identification.error_after.rmse > USUAL * self.usual_error)
        if self.usual_rmse is None:
            return np.ones(self.given.n, dtype=bool)
        return np.asarray(self.mostly_left > USUAL * self.usual_rmse)

    @property
    def error(self) -> dict[str, Any]:
        """Errors before and after, as in findings.json."""
        found: dict[str, Any] = {"identification": self.identification.to_json()}
        if self.validation is not None:
            found["validation"] = self.validation.to_json()
            found["validation_noise_floor_Nm"] = [float(v) for v in self.validation.noise_floor]
        found["noise_floor_Nm"] = [float(v) for v in self.noise_floor]
        if self.noise is not None:
            found["sample_noise_Nm"] = [float(v) for v in self.noise.floor]
        return found

    def to_json(self) -> dict[str, Any]:
        """The content of findings.json."""
        problem = {} if self.log_problem is None else {"log_problem": self.log_problem.to_json()}
        return {
            "schema_version": SCHEMA_VERSION,
            "verdict": self.verdict,
            **problem,
            "effects": [f.to_json() for f in self.findings],
            "numbers": [n.to_json() for n in self.numbers],
            "recalibrated": plain(dict(self.recalibrated)),
            "unexplained": [u.to_json() for u in self.unexplained],
            "beyond_noise": list(self.beyond_noise),
            "taken_up": list(self.taken_up),
            "error": self.error,
            "not_excited": list(self.not_excited),
            "weak": list(self.weak),
            "against": "reference" if self.change else "file",
            **({} if self.before is None else {"reference": self.before.what_was_there()}),
            "log": self.identification.name,
            "logs": [log.to_json() for log in self.logs],
            "left_out": [log.to_json() for log in self.left_out],
            "validation_log": None if self.validation is None else self.validation.name,
        }

    def what_was_there(self) -> dict[str, Any]:
        """Of a reference: what its logs showed already, as in findings.json."""
        return {
            "logs": [log.to_json() for log in self.logs],
            "left_out": [log.to_json() for log in self.left_out],
            "effects": [f.to_json() for f in self.findings],
            "unexplained": [u.to_json() for u in self.unexplained],
            "numbers": [n.to_json() for n in self.numbers],
        }

    def write(self, out: Path | str) -> tuple[Path, Path]:
        """Write findings.json and robot.toml into a folder; returns both paths."""
        out = Path(out)
        findings = write_json(out / "findings.json", self.to_json())
        return findings, save_robot(self.robot, out / "robot.toml")
