"""Dry friction that turns over within an angle too small to be a fault: every contact has it.

Contacts stick before they slide, so that the friction of a sound joint follows a reversal a little
late, where the file's law jumps. It is the same curve as that of a hysteresis, many times narrower;
left out of the base, a delay, a hysteresis or a law of the speed would take its place.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.contacts import Contacts
from irb2400_ctrl.diagnosis.preparation.fading_friction import fading_friction
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.measurement.prepared_log import PreparedLog

TURNED_OVER = (1.5, 3.0)
"""times the width of its contacts (at least a usual one), over which the friction of a joint may
turn over; it may as well over that of the arm's"""


def sticking_contacts(
    bases: Bases, motion: PreparedLog, friction: Array, contacts: Contacts
) -> Array:
    """Columns F_j (z_jk - sgn qd_j) with z_jk of Dahl models as narrow as the contacts of the arm
    and `TURNED_OVER`, joint by joint, then those of `fading_friction`, shape (m, n, n k) [Nm].

    Args:
        friction: dry friction F of each joint, or how much it may have, shape (n,) [Nm].
        contacts: over which angle the friction of this arm turns over.
    """
    columns = np.zeros((len(motion.time), motion.n, motion.n, 1 + len(TURNED_OVER)))
    for j in range(motion.n):
        wider = [times * contacts.at(j + 1) for times in TURNED_OVER]
        widths = [{"width_rad": width} for width in (contacts.width, *wider)]
        for k, law in enumerate(bases.columns("hysteresis", j + 1, motion, widths, filtered=False)):
            columns[:, j, j, k] = friction[j] * law.values[:, 0].sum(axis=1)
    fading = fading_friction(bases.robot, motion)
    return np.concatenate([columns.reshape(len(motion.time), motion.n, -1), fading], axis=2)
