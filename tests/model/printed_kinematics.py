"""The paper's kinematic equations 2-26 and 36 exactly as printed, and the corrected ones; numpy,
angles in rad."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

D1 = 0.615
A1 = 0.1
A2 = 0.705
A3 = 0.135
D4 = 0.755
D7 = 0.085
X_T = 0.24
Y_T = 0.0
Z_T = 0.162


@dataclass(frozen=True)
class Angles:
    """Sines and cosines by the paper's names."""

    s1: float
    c1: float
    s2: float
    c2: float
    s3: float
    c3: float
    s4: float
    c4: float
    s5: float
    c5: float
    s6: float
    c6: float
    s23: float
    c23: float

    @classmethod
    def of(cls, q: Array) -> Angles:
        values = [f(angle) for angle in q for f in (np.sin, np.cos)]
        return cls(*values, np.sin(q[1] - q[2]), np.cos(q[1] - q[2]))


def eq_2(a: float, alpha: float, d: float, theta: float) -> Array:
    ct = np.cos(theta)
    st = np.sin(theta)
    ca = np.cos(alpha)
    sa = np.sin(alpha)
    return np.array(
        [
            [ct, -st, 0, a],
            [st * ca, ct * ca, -sa, -d * sa],
            [st * sa, ct * sa, ca, d * ca],
            [0, 0, 0, 1],
        ]
    )


def eq_3(v: Angles) -> Array:
    return np.array([[v.c1, -v.s1, 0, 0], [v.s1, v.c1, 0, 0], [0, 0, 1, D1], [0, 0, 0, 1]])


def eq_4(v: Angles) -> Array:
    return np.array([[v.s2, v.c2, 0, A1], [0, 0, 1, 0], [v.c2, -v.s2, 0, 0], [0, 0, 0, 1]])


def eq_5(v: Angles) -> Array:
    return np.array([[v.c23, v.s23, 0, A2], [-v.s23, v.c23, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def eq_6_printed(v: Angles) -> Array:
    return np.array([[v.c4, v.s4, 0, A3], [0, 0, 1, D4], [-v.s4, -v.c4, 0, 0], [0, 0, 0, 1]])


def eq_6(v: Angles) -> Array:
    return np.array([[v.c4, -v.s4, 0, A3], [0, 0, 1, D4], [-v.s4, -v.c4, 0, 0], [0, 0, 0, 1]])


def eq_7(v: Angles) -> Array:
    return np.array([[-v.c5, v.s5, 0, 0], [0, 0, -1, 0], [-v.s5, -v.c5, 0, 0], [0, 0, 0, 1]])


def eq_8(v: Angles) -> Array:
    return np.array([[v.c6, -v.s6, 0, 0], [0, 0, -1, 0], [v.s6, v.c6, 0, 0], [0, 0, 0, 1]])


def eq_9(v: Angles) -> Array:
    return np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, D7], [0, 0, 0, 1]])


def eq_12(v: Angles) -> Array:
    return np.array([[0, 0, 1, X_T], [0, 1, 0, Y_T], [-1, 0, 0, Z_T], [0, 0, 0, 1]])


def eq_15(v: Angles) -> float:
    return v.s1 * v.s4 * v.s5 - v.c1 * v.c3 * v.c5 + v.c1 * v.c4 * v.s3 * v.s5


def eq_16(v: Angles) -> float:
    return (
        v.c1 * v.c6 * v.s3 * v.s4
        - v.c4 * v.c6 * v.s1
        + v.c1 * v.c3 * v.s5 * v.s6
        + v.c5 * v.s1 * v.s4 * v.s6
        + v.c1 * v.c4 * v.c5 * v.s3 * v.s6
    )


def eq_17(v: Angles) -> float:
    return (
        v.c1 * v.s3 * v.s4 * v.s6
        - v.c1 * v.c3 * v.c6 * v.s5
        - v.c5 * v.c6 * v.s1 * v.s4
        - v.c4 * v.s1 * v.s6
        - v.c1 * v.c4 * v.c5 * v.c6 * v.s3
    )


def eq_18(v: Angles) -> float:
    return v.c4 * v.s1 * v.s3 * v.s5 - v.c3 * v.c5 * v.s1 - v.c1 * v.s4 * v.s5


def eq_19(v: Angles, last_of_third: float | None = None) -> float:
    """`last_of_third`: the factor printed as s_q1 that is s_q4."""
    return (
        v.c1 * v.c4 * v.c6
        - v.c1 * v.c5 * v.s4 * v.s6
        + v.c6 * v.s1 * v.s3 * (v.s4 if last_of_third is None else last_of_third)
        + v.c3 * v.s1 * v.s5 * v.s6
        + v.c4 * v.c5 * v.s1 * v.s3 * v.s6
    )


def eq_19_printed(v: Angles) -> float:
    return eq_19(v, v.s1)


def eq_20(v: Angles) -> float:
    return (
        v.c1 * v.c4 * v.s6
        + v.c1 * v.c5 * v.c6 * v.s4
        - v.c3 * v.c6 * v.s1 * v.s5
        + v.s1 * v.s3 * v.s4 * v.s6
        - v.c4 * v.c5 * v.c6 * v.s1 * v.s3
    )


def eq_21(v: Angles) -> float:
    return v.c5 * v.s3 + v.c3 * v.c4 * v.s5


def eq_22(v: Angles) -> float:
    return v.c3 * v.c6 * v.s4 - v.s3 * v.s5 * v.s6 + v.c3 * v.c4 * v.c5 * v.s6


def eq_22_printed(v: Angles) -> float:
    return v.c3 * v.c6 * v.s6 - v.s3 * v.s5 * v.s6 + v.c3 * v.c4 * v.c5 * v.s6


def eq_23(v: Angles) -> float:
    return v.c3 * v.s4 * v.s6 + v.c6 * v.s3 * v.s5 - v.c3 * v.c4 * v.c5 * v.c6


def eq_24(v: Angles, y_T: float = Y_T) -> float:
    return (
        A1 * v.c1
        + D4 * v.c1 * v.c3
        + A2 * v.c1 * v.s2
        + A3 * v.c1 * v.s3
        + (D7 + Z_T) * (v.c1 * v.c3 * v.c5 - v.s1 * v.s4 * v.s5 - v.c1 * v.c4 * v.s3 * v.s5)
        + X_T
        * (
            v.c1 * v.s3 * v.s4 * v.s6
            - v.c1 * v.c3 * v.c6 * v.s5
            - v.c5 * v.c6 * v.s1 * v.s4
            - v.c4 * v.s1 * v.s6
            - v.c1 * v.c4 * v.c5 * v.c6 * v.s3
        )
        + y_T
        * (
            v.c1 * v.c6 * v.s3 * v.s4
            - v.c4 * v.c6 * v.s1
            + v.c1 * v.c3 * v.s5 * v.s6
            + v.c5 * v.s1 * v.s4 * v.s6
            + v.c1 * v.c4 * v.c5 * v.s3 * v.s6
        )
    )


def eq_25(v: Angles, y_T: float = Y_T, third_of_last: float | None = None) -> float:
    """`third_of_last`: the factor printed as c_q1 that is s_q1."""
    return (
        A1 * v.s1
        + D4 * v.c3 * v.s1
        + A2 * v.s1 * v.s2
        + A3 * v.s1 * v.s3
        + (D7 + Z_T) * (v.c3 * v.c5 * v.s1 + v.c1 * v.s4 * v.s5 - v.c4 * v.s1 * v.s3 * v.s5)
        + X_T
        * (
            v.c1 * v.c4 * v.s6
            + v.c1 * v.c5 * v.c6 * v.s4
            - v.c3 * v.c6 * v.s1 * v.s5
            + v.s1 * v.s3 * v.s4 * v.s6
            - v.c4 * v.c5 * v.c6 * v.s1 * v.s3
        )
        + y_T
        * (
            v.c1 * v.c4 * v.c6
            - v.c1 * v.c5 * v.s4 * v.s6
            + v.c6 * v.s1 * v.s3 * v.s4
            + v.c3 * v.s1 * v.s5 * v.s6
            + v.c4 * v.c5 * (v.s1 if third_of_last is None else third_of_last) * v.s3 * v.s6
        )
    )


def eq_25_printed(v: Angles, y_T: float = Y_T) -> float:
    return eq_25(v, y_T, v.c1)


def eq_26_printed(v: Angles, y_T: float = Y_T) -> float:
    return (
        D1
        + A2 * v.c2
        + A3 * v.c3
        - (D7 + Z_T) * (v.c5 * v.s3 + v.c3 * v.c4 * v.s5)
        + X_T * (v.c3 * v.s4 * v.s6 + v.c6 * v.s3 * v.s5 - v.c3 * v.c4 * v.c5 * v.c6)
        + y_T * (v.c3 * v.c6 * v.s4 - v.s3 * v.s5 * v.s6 + v.c3 * v.c4 * v.c5 * v.s6)
    )


def eq_26(v: Angles, y_T: float = Y_T) -> float:
    return eq_26_printed(v, y_T) - D4 * v.s3


def eq_36(v: Angles) -> float:
    """Left side."""
    c2 = v.c2
    s2 = v.s2
    c3 = v.c3
    s3 = v.s3
    return (
        c2 * s3 * A1 * A3
        + (c2 * c3 + s2 * s3) * A1 * D4
        + (c3 * c2**2 + s2 * s3 * c2) * A2 * A3
        + (s3 + c2 * c3 * s2) * A2 * D4
        + c2 * A3**2
        + (s2 + 2 * c2 * c3 * s3) * A3 * D4
        + (c2 * c3**2 + s2 * s3 * c3) * (D4**2 - A3**2)
        - c3 * s2 * A1 * A3
        - c3 * A2 * A3
        - c2**2 * s3 * A2 * D4
        - 2 * c3**2 * s2 * A3 * D4
    )
