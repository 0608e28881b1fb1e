"""The most probable numbers of an arm given its logs, bodies physically consistent.

    minimise  sum_j (theta^T H_j theta - 2 g_j^T theta) / (sigma_j^2 f_j)
              + (theta - mean)^T P(kappa) (theta - mean),      theta = (phi(x), beta),  beta_k >= 0

with phi of bodies that can exist (`consistent_fit`), sigma_j the rms of what is left on joint j,
f_j how many samples of it say the same thing (integrated correlation), and kappa the widths of the
bodies, of a Student-t: kappa^2 (nu + gamma) = nu kappa_0^2 + |off|^2 with gamma the numbers of the
body that the logs tell (MacKay 1992).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.identification.fitting.consistent_fit import consistent_minimum, possible
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.fitting.prior import DEGREES_OF_FREEDOM, Prior

MOST_WIDTH = 30.0
"""masses off by 60 %, centres by 15 cm: beyond it something else moves the arm"""
SETTLED = 0.02
"""relative change of noise and widths at which they are done"""
LEAST_WIDTH = 1.0
"""of a body, as a share of what the file states: it is not taken for surer than that"""

DOUBT = 3.0
"""how much wider a width may as well be: a Student-t of `DEGREES_OF_FREEDOM` leaves 1 in 40 above
sqrt(4 / 0.48) = 2.9 times the usual one"""


@dataclass(frozen=True)
class Estimate:
    """Numbers of the columns, their covariance, the noise that is left and the bodies' widths.

    Args:
        theta: (p,); covariance: (p, p); sigma: (n,) [Nm]; kappa: (n,).
        usual: the scale about which the widths lie.
    """

    theta: Array
    covariance: Array
    sigma: Array
    kappa: Array
    usual: float = 1.0


@dataclass(frozen=True)
class FitProblem:
    """What the numbers of an arm follow from.

    Args:
        sums: of recordings; prior: of the robot file.
        correlation: f, samples per independent one, of each joint, shape (n,).
        positive: columns whose numbers cannot be negative, mask (p,).
    """

    sums: Moments
    prior: Prior
    correlation: Array
    positive: Mask

    def estimate(
        self,
        *,
        consistent: bool = True,
        kappa: Array | None = None,
        sigma: Array | None = None,
        start: Estimate | None = None,
        alike: bool = False,
        rounds: int = 15,
    ) -> Estimate:
        """Fit.

        Args:
            consistent: whether bodies must be possible ones.
            kappa: fixed widths; default fitted.
            sigma: fixed noise [Nm], shape (n,); default what is left.
            start: whose noise and widths to begin with.
            alike: whether the widths lie about a scale of their own, not about what the file
                states: bodies of one file may be alike wrong, and what a log hardly shows then is
                as doubtful as what it shows.
            rounds: of numbers, noise and widths in turn, at most.
        """
        n = len(self.prior.bodies)
        data = self.sums.summed()
        whole = replace(self, sums=data)
        count = np.maximum(data.count[0], 1.0)
        mean_square = data.c[0] / count
        widths = np.ones(n) if kappa is None else kappa
        noise = np.sqrt(np.maximum(mean_square, 1e-12)) if sigma is None else sigma
        if start is not None:
            widths = start.kappa
            noise = start.sigma
        # what no sample asks for stays where the file has it: a barrier would move it
        asked = self.positive & (np.einsum("npp->p", data.H[0]) > 0.0)
        theta = _start(self.prior, asked)
        covariance = np.zeros((len(theta), len(theta)))
        usual = 1.0
        bounded = np.flatnonzero(asked)
        for turn in range(rounds):
            A, b = whole._normal_equations(noise, widths)
            covariance = scaled_inverse(A)
            if consistent:
                theta = consistent_minimum(A, b, n, bounded, theta, near=turn > 0)
            else:
                theta = covariance @ b
            # what the numbers took from the residual is noise too: N less those that a joint
            # determined
            taken = np.einsum("npq,pq->n", data.H[0], covariance)
            left = (data.squared_error(theta)[0] + taken) / count
            before = np.concatenate([noise, widths])
            if sigma is None:
                noise = np.sqrt(np.maximum(left, 1e-12 * mean_square + 1e-18))
            if kappa is None:
                usual = _usual_width(widths) if alike else 1.0
                widths = _widths(self.prior, theta, covariance, widths, usual)
            # a noise that still falls has not yet let the logs speak
            if np.abs(np.log(np.concatenate([noise, widths]) / before)).max() < SETTLED:
                break
        return Estimate(theta, covariance, noise, widths, usual)

    def averaged(self, numbers: Estimate) -> Estimate:
        """The estimate with numbers halfway to those of widths `DOUBT` times as large.

        The most probable widths are one value of many, and the mean over them errs less than either
        end (Bates, Granger 1969). Bodies that can exist are a cone: halfway between two is one too.
        """
        kappa = DOUBT * numbers.kappa
        wider = self.estimate(kappa=kappa, start=replace(numbers, kappa=kappa))
        return replace(numbers, theta=0.5 * (numbers.theta + wider.theta))

    def unbounded_minimum(self, like: Estimate) -> Array:
        """theta without bounds, with the noise and widths of another estimate, shape (p,)."""
        A, b = self._normal_equations(like.sigma, like.kappa)
        return np.asarray(scaled_inverse(A) @ b)

    def log_evidence(self, like: Estimate) -> float:
        """How probable the torques are for this layout, whatever its numbers are [nats].

        Laplace's integral over theta (exact without bounds), at the widths of an estimate.
        """
        A, b = self._normal_equations(like.sigma, like.kappa)
        mean = self.prior.mean
        precision = self.prior.precision(like.kappa)
        square = float((self.sums.c.sum(axis=0) / like.sigma**2 / self.correlation).sum())
        square += float(mean @ precision @ mean - b @ scaled_inverse(A) @ b)
        half = 0.5 * DEGREES_OF_FREEDOM
        relative = like.kappa / like.usual
        widths = -2.0 * (half + 1.0) * np.log(relative) - half / relative**2
        widths -= 2.0 * np.log(like.usual)
        count = self.sums.count.sum(axis=0)
        spread = 2.0 * float((count * np.log(like.sigma) / self.correlation).sum())
        sizes = spread + np.linalg.slogdet(A)[1] - np.linalg.slogdet(precision)[1]
        return float(-0.5 * (square + sizes) + widths.sum())

    def _normal_equations(self, sigma: Array, widths: Array) -> tuple[Array, Array]:
        """A, b of 1/2 theta^T A theta - b^T theta."""
        weight = 1.0 / (sigma**2 * self.correlation)
        precision = self.prior.precision(widths)
        A = np.einsum("n,bnpq->pq", weight, self.sums.H) + precision
        b = np.einsum("n,bnp->p", weight, self.sums.g) + precision @ self.prior.mean
        return A, b


def _widths(prior: Prior, theta: Array, covariance: Array, widths: Array, usual: float) -> Array:
    """kappa of each body from how far it went and how many of its numbers the logs tell, (n,)."""
    nu = DEGREES_OF_FREEDOM
    moved = prior.distance(theta)
    open_still = (prior.distance(theta, covariance) - moved) / widths**2
    told = np.maximum(10.0 - open_still, 0.0)
    spread = np.sqrt((nu * usual**2 + moved) / (nu + told))
    return np.asarray(np.clip(spread, LEAST_WIDTH, MOST_WIDTH))


def _usual_width(kappa: Array) -> float:
    """The most probable scale of widths about it, kappa_0^2 = n / sum kappa_i^-2, one at least."""
    return max(1.0, float(1.0 / np.sqrt(np.mean(kappa**-2.0))))


def _start(prior: Prior, positive: Mask) -> Array:
    """The prior's mean, moved strictly inside what is possible."""
    n = len(prior.bodies)
    theta = prior.mean.copy()
    theta[: 10 * n] = possible(theta[: 10 * n].reshape(n, 10)).ravel()
    places = np.flatnonzero(positive)
    theta[places] = np.maximum(theta[places], 1e-2 * np.sqrt(prior.drives[places - 10 * n]))
    return theta


def scaled_inverse(A: Array) -> Array:
    """Inverse of a positive definite matrix whose rows are of very different sizes."""
    size = 1.0 / np.sqrt(np.diag(A))
    return np.asarray(np.linalg.inv(A * size[:, None] * size) * size[:, None] * size)
