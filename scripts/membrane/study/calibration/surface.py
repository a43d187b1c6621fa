# SPDX-License-Identifier: GPL-2.0-or-later
"""The fine search: a quadratic surface through the curves of many runs, and what it leaves open.

Of curves that scatter from run to run, the best single run is partly luck. A surface through runs
that are farther apart than the scatter matters evens it out, and what the runs are off the surface
tells the scatter itself.
"""

from dataclasses import dataclass
from typing import Any
from itertools import combinations_with_replacement

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import qmc

HALF = 0.5  # half the width of the region that a surface describes, of a logarithm
NEW = 18  # runs that are added for a surface
ROUNDS = 3  # surfaces, each about what the one before has found
EDGE = 0.9  # of the half width; an estimate farther out wants another surface
LEAST = 0.05  # share of the slopes' squares that must not be scatter, for the rest to be divided by


@dataclass(frozen=True)
class Region:
    """Where a surface holds: `low` <= point <= `high`, (d,) logarithms both."""

    low: np.ndarray
    high: np.ndarray

    @classmethod
    def about(cls, point: Any, low: np.ndarray, high: np.ndarray) -> "Region":
        """Region about a point, pushed inside the bounds `low` and `high` (d,)."""
        low, high = np.asarray(low), np.asarray(high)
        middle = np.clip(point, np.minimum(low + HALF, high), np.maximum(high - HALF, low))
        return cls(np.maximum(middle - HALF, low), np.minimum(middle + HALF, high))

    def holds(self, points: np.ndarray) -> np.ndarray:
        """Which of points (n, d) lie inside: (n,) bool."""
        return np.all((points >= self.low) & (points <= self.high), axis=1)

    def scaled(self, points: np.ndarray) -> np.ndarray:
        """Points (n, d) as -1 to 1 from `low` to `high`."""
        return (2 * np.atleast_2d(points) - self.low - self.high) / (self.high - self.low)


class Surface:
    """Least squares of runs by a polynomial of second degree in the logarithms.

    `points` (n, d) are logarithms of the parameters, inside the Region, and `curves` (n, C, S).
    Then `residuals` (n, C, S) are those of the runs, `freedom` is runs less coefficients, and
    `scatter` (C, S) the standard deviation of a run about the surface.
    """

    def __init__(self, region: Any, points: np.ndarray, curves: Any) -> None:
        self.region, self.points = region, np.asarray(points)
        terms = self._terms(self.points)
        self.freedom = len(points) - terms.shape[1]
        if self.freedom < 1 or np.linalg.matrix_rank(terms) < terms.shape[1]:
            raise RuntimeError(f"{len(points)} runs are too few for a surface: others diverged")
        self._coefficients = np.tensordot(np.linalg.pinv(terms), curves, 1)
        self._inverse = np.linalg.inv(terms.T @ terms)
        self.residuals = curves - np.tensordot(terms, self._coefficients, 1)
        self.scatter = np.sqrt(np.sum(self.residuals**2, axis=0) / self.freedom)

    def _terms(self, points):
        z = self.region.scaled(points)
        products = combinations_with_replacement(range(z.shape[1]), 2)
        return np.column_stack([np.ones(len(z)), z, *(z[:, i] * z[:, j] for i, j in products)])

    def __call__(self, point: np.ndarray) -> np.ndarray:
        """Curves (C, S) at a point (d,)."""
        return np.tensordot(self._terms(point)[0], self._coefficients, 1)

    def _steps(self, point):
        """Terms (d, p) of the derivatives at a point; exact, as all is quadratic."""
        half = 0.5 * (self.region.high - self.region.low)
        pairs = zip(np.diag(half), half)
        differences = (
            (self._terms(point + step)[0] - self._terms(point - step)[0]) / (2 * h)
            for step, h in pairs
        )
        return np.array(list(differences))

    def slopes(self, point: Any) -> np.ndarray:
        """Derivatives (d, C, S) of the curves by the logarithms."""
        return np.tensordot(self._steps(point), self._coefficients, 1)

    def leverage(self, point: Any) -> Any:
        """Variance of the surface at a point (d,) over that of a run [-]."""
        terms = self._terms(point)[0]
        return float(terms @ self._inverse @ terms)

    def slope_leverage(self, point: Any) -> Any:
        """Covariance (d, d) of the slopes at a point over the variance of a run [-]."""
        steps = self._steps(point)
        return steps @ self._inverse @ steps.T


@dataclass(frozen=True)
class Estimate:
    """What a target tells.

    The covariance (d, d) is of scatter of runs, noise of the target, and lack of fit, the mean
    square of target - surface over what scatter and noise explain: about 1 or less if the model can
    follow the target. The covariance is enlarged by it where it exceeds 1.
    """

    point: np.ndarray  #: (d,), logarithms of the parameters
    covariance: np.ndarray  #: (d, d), of the logarithms
    lack_of_fit: float  #: [-]

    @property
    def sigma(self) -> np.ndarray:
        """Standard deviations (d,) of the logarithms."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> float:
        """Between the first and the last parameter [-]; 1 if there is but one."""
        return float(self.covariance[0, -1] / (self.sigma[0] * self.sigma[-1]))


def estimate(surface: Any, target: Any) -> Estimate:
    """Weighted least squares of the target by the surface, within its region.

    The covariance is that of the linear estimator P = A^-1 J' about the solution, J the weighted
    slopes and A = J'J less what the scatter of the runs adds to it: slopes that are no steeper
    than scatter tell nothing. P applied to the residuals of the runs, whose errors at different
    times belong together, gives what one run's scatter does to the estimate; that is enlarged by
    n / (n - 2) for having been found with n degrees of freedom, the variance of Student's t. The
    noise of the target is white. Both are enlarged by the lack of fit as the Particle Data Group
    does (Review of Particle Physics, section 5.2.2).
    """
    noise = np.broadcast_to(target.noise[:, None], target.values.shape)
    scatter = np.sqrt(np.mean(surface.scatter**2, axis=1, keepdims=True))
    weight = 1 / np.hypot(np.hypot(scatter, noise), 1e-9 * np.ptp(target.values))
    point = _solve(surface, target, weight)

    slopes = _weighted_slopes(surface, point, weight)
    power = np.sum((weight * surface.scatter) ** 2)
    estimator = _inverse(slopes.T @ slopes, power * surface.slope_leverage(point)) @ slopes.T
    off = (weight * surface.residuals).reshape(len(surface.points), -1) @ estimator.T
    freedom = surface.freedom
    of_runs = off.T @ off / freedom * (1 + surface.leverage(point)) * freedom / max(freedom - 2, 1)
    of_noise = (estimator * (weight * noise).ravel() ** 2) @ estimator.T
    left = weight * (surface(point) - target.values)
    lack = float(np.sum(left**2) / (left.size - len(point)))
    return Estimate(point, max(1.0, lack) * (of_runs + of_noise), lack)


def _weighted_slopes(surface, point, weight):
    """Slopes at a point as a matrix (C S, d)."""
    return (weight * surface.slopes(point)).reshape(len(point), -1).T


def _solve(surface, target, weight):
    """Point (d,) of the surface's region with the least weighted squares."""
    region = surface.region

    def residual(point):
        return (weight * (surface(point) - target.values)).ravel()

    starts = np.vstack([0.5 * (region.low + region.high), surface.points])
    start = min(starts, key=lambda point: np.sum(residual(point) ** 2))
    inside = 1e-6 * (region.high - region.low)
    return least_squares(
        residual,
        np.clip(start, region.low + inside, region.high - inside),
        lambda point: _weighted_slopes(surface, point, weight),
        bounds=(region.low, region.high),
        x_scale="jac",
    ).x


def _inverse(squares, scatter):
    """(squares - scatter)^-1, (d, d), where at least LEAST of `squares` is taken to be left."""
    root = np.linalg.cholesky(squares)
    half = np.linalg.inv(root)
    shares, vectors = np.linalg.eigh(np.eye(len(root)) - half @ scatter @ half.T)
    return half.T @ (vectors / np.maximum(shares, LEAST)) @ vectors.T @ half


def refine(
    simulate: Any, target: Any, point: Any, low: np.ndarray, high: np.ndarray, seed: int = 0
) -> tuple[Surface, Estimate]:
    """The last Surface about `point`, moved until the estimate lies inside, and its Estimate.

    `simulate` is a Deployments or another callable with its attributes `points` and `curves`.
    `point` (d,) is where to begin, between bounds `low` and `high` (d,), all logarithms; `seed` is
    of the added runs.
    """
    for turn in range(ROUNDS):
        region = Region.about(point, low, high)
        cube = qmc.LatinHypercube(len(point), seed=seed + turn).random(NEW)
        simulate(qmc.scale(cube, region.low, region.high))
        inside = region.holds(simulate.points)
        surface = Surface(region, simulate.points[inside], simulate.curves[inside])
        found = estimate(surface, target)
        away = np.abs(region.scaled(found.point)[0])
        bound = at_bound(found.point, low, high)
        if np.all((away < EDGE) | bound):
            break
        point = found.point
    return surface, found


def at_bound(point: Any, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Which parameters (d,) lie at a bound: (d,) bool."""
    room = 0.01 * (np.asarray(high) - low)
    return (point - low < room) | (high - point < room)
