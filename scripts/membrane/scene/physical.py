# SPDX-License-Identifier: GPL-2.0-or-later
"""What alpha, alpha_c, beta and zeta of the paper are in SI, on the mesh that they are for."""

from math import sqrt
from typing import Any

import numpy as np
from yade import wrapper as yade

from ..geometry import side_lengths, side_rows, triangle_areas, unique_sides
from ..parameters import PHYSICAL, SceneParts, attributes


def physical_parameters(mesh: Any, p: SceneParts) -> dict[str, float]:
    """The lengths [m] and the time [s] by which a film buckles, is creased and damped on any mesh.

    Those that `p` gives, and for each that it does not what its number means on the mesh: with
    the mean length L of fold lines' sides (without such, of all) and the mean height l of the
    triangles there, l_b = L / sqrt(alpha (1 - nu2)) and L* = l / (beta (1 - nu2)); the damping
    time is 2 zeta sqrt(k m) over k, summed over the film's sides. 0: none.

    Parameters
    ----------
    mesh : object
        With nodes (N, 3) [m], triangles (T, 3) and creases (C, 2).
    p : SceneParameters or RunParameters
    """
    sides, sides_of, _ = unique_sides(mesh.triangles)
    creases = np.asarray(mesh.creases, dtype=int).reshape(-1, 2)
    folds = side_rows(sides, creases) if len(creases) else np.arange(len(sides))
    lengths = side_lengths(mesh.nodes, sides)
    heights = 2 * triangle_areas(mesh.nodes, mesh.triangles)[:, None] / lengths[sides_of]
    length, height = lengths[folds].mean(), heights[np.isin(sides_of, folds)].mean()
    plate = 1 - p.poisson**2
    found = {
        "buckling_length": _over(length, sqrt(p.alpha * plate)),
        "crease_buckling_length": _over(length, sqrt(p.alpha_crease * plate)),
        "crease_length": _over(height, p.beta * plate),
        "damping_time": _damping_time(mesh, p),
    }
    return {name: getattr(p, name) or found[name] for name in PHYSICAL}


def _over(length, number):
    """0 where a number is 0: there is nothing of the kind."""
    return float(length / number) if number else 0.0


def _damping_time(mesh, p):
    """Time [s] of damping zeta, over all sides of a film of springs."""
    if not p.zeta or p.damping_time:
        return 0.0
    used, triangles = np.unique(mesh.triangles, return_inverse=True)  # not nodes of tethers
    springs = yade.Membrane(
        material=yade.MembraneMat(**attributes("MembraneMat", p)),
        nodes=mesh.nodes[used],
        triangles=triangles.reshape(-1, 3),
        allowNegativeStiffness=True,
    )
    stiffness = np.maximum(springs.stiffnesses, 0.0)
    masses = np.array(springs.masses)[np.array(springs.sides)].mean(axis=1)
    return float(2 * p.zeta * np.sqrt(stiffness * masses).sum() / stiffness.sum())
