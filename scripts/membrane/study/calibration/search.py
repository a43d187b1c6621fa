# SPDX-License-Identifier: GPL-2.0-or-later
"""The coarse search: runs all over the bounds, and an emulator of their curves to search in.

The misfit has a long, curved and bumpy valley, for a stiffer crease and a later buckling do much
the same; a simplex of single runs gets stuck in it. But for their scatter, the curves themselves
are smooth functions of the parameters, so a spline through the curves of a few runs shows the
whole valley, and the global search costs no run.
"""

from typing import Any

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.optimize import differential_evolution
from scipy.stats import qmc

FIRST = 16  # runs all over the bounds, a power of 2 as Sobol's sequence wants
MOST = 8  # further runs, each where the emulator has its least misfit
CLOSE = 0.15  # of a logarithm: what is nearer to an earlier run ends the search
TOLERANCE = 0.005  # of the target's range: what emulator and scatter may be off
SMOOTHING = 1e-3  # of the spline, beside curves of the order of the target's range


def weights(target: Any) -> np.ndarray:
    """What differences from the target are divided by, (C, 1): noise and TOLERANCE."""
    span = np.ptp(target.values, axis=1)
    return np.hypot(target.noise, TOLERANCE * span)[:, None]


def misfit(curves: Any, target: Any) -> float:
    """Root mean square of curves - target (C, S) over `weights`; infinite for None."""
    if curves is None:
        return np.inf
    return float(np.sqrt(np.mean(((curves - target.values) / weights(target)) ** 2)))


def emulated_best(
    points: np.ndarray, curves: Any, target: Any, low: np.ndarray, high: np.ndarray, seed: int = 0
) -> np.ndarray:
    """Point (d,) between `low` and `high` where a spline through the runs is nearest to the target.

    `points` (n, d) are logarithms of the parameters of the runs, as the bounds (d,), `curves` are
    (n, C, S); `seed` is of the search.
    """
    span = np.ptp(target.values, axis=1)[:, None]
    scaled = (points - low) / (high - low)
    spline = RBFInterpolator(scaled, (curves / span).reshape(len(points), -1), smoothing=SMOOTHING)

    def value(at):
        emulated = spline(np.atleast_2d(at)).reshape(-1, *target.values.shape)[0]
        return misfit(span * emulated, target)

    unit = [(0.0, 1.0)] * points.shape[1]
    found = differential_evolution(value, unit, seed=seed, polish=False, tol=1e-4)
    return low + found.x * (high - low)


def search(
    simulate: Any, target: Any, low: np.ndarray, high: np.ndarray, seed: int = 0
) -> np.ndarray:
    """Point (d,) of the least misfit, roughly, between bounds `low` and `high` (d,), logarithms.

    `simulate` is a Deployments or another callable with its attributes `points` and `curves`;
    `seed` is of the points that are tried. RuntimeError if too many runs diverge.
    """
    simulate(qmc.scale(qmc.Sobol(len(low), seed=seed).random(FIRST), low, high))
    if len(simulate.points) < FIRST // 2:
        raise RuntimeError("most of the first runs diverged: narrow the bounds")
    for _ in range(MOST):
        point = emulated_best(simulate.points, simulate.curves, target, low, high, seed)
        near = np.min(np.linalg.norm(simulate.points - point, axis=1)) < CLOSE
        simulate([point])
        if near:
            break
    return point
