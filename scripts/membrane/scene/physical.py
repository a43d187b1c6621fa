# SPDX-License-Identifier: GPL-2.0-or-later
"""What alpha, alpha_c, beta and zeta of the paper are in SI, on the mesh that they are for."""

from math import sqrt
from typing import Any

import numpy as np
from yade import wrapper as yade

from ..geometry import triangle_areas
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
    used, triangles = np.unique(mesh.triangles, return_inverse=True)  # not those of tethers
    springs = yade.Membrane(
        material=yade.MembraneMat(**attributes("MembraneMat", p)),
        nodes=mesh.nodes[used],
        triangles=triangles.reshape(-1, 3),
        allowNegativeStiffness=True,
    )
    nodes, sides = mesh.nodes, used[np.array(springs.sides)]
    creases = np.asarray(mesh.creases, dtype=int).reshape(-1, 2)
    folds = creases if len(creases) else sides
    length = float(np.linalg.norm(np.diff(nodes[folds], axis=1), axis=2).mean())
    plate = 1 - p.poisson**2
    found = {
        "buckling_length": _over(length, sqrt(p.alpha * plate)),
        "crease_buckling_length": _over(length, sqrt(p.alpha_crease * plate)),
        "crease_length": _over(_mean_height(mesh, folds), p.beta * plate),
        "damping_time": _damping_time(springs, p.zeta),
    }
    return {name: getattr(p, name) or found[name] for name in PHYSICAL}


def _over(length, number):
    """0 where a number is 0: there is nothing of the kind."""
    return length / number if number else 0.0


def _mean_height(mesh, folds):
    """Mean height [m] of the triangles over some sides (C, 2)."""
    wanted = {tuple(sorted(pair)) for pair in folds.tolist()}
    nodes, triangles = np.asarray(mesh.nodes), np.asarray(mesh.triangles)
    heights = []
    for corner in range(3):
        ends = np.sort(triangles[:, [corner - 2, corner - 1]], axis=1)
        beside = np.array([tuple(pair) in wanted for pair in ends.tolist()])
        spans = np.linalg.norm(np.diff(nodes[ends[beside]], axis=1), axis=2)[:, 0]
        heights.append(2 * triangle_areas(nodes, triangles)[beside] / spans)
    return float(np.concatenate(heights).mean())


def _damping_time(springs, zeta):
    """Time [s] of damping zeta, over all sides of a film of springs."""
    stiffness = np.maximum(springs.stiffnesses, 0.0)
    masses = np.array(springs.masses)[np.array(springs.sides)].mean(axis=1)
    return float(2 * zeta * np.sqrt(stiffness * masses).sum() / stiffness.sum())
