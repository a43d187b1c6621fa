# SPDX-License-Identifier: GPL-2.0-or-later
"""A sheet on the spin axis: its centre of mass, tips and hub."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..geometry import triangle_areas
from .patterns import nearest_pose

TURN = np.radians(20)  # by which the outline turns at a corner, at least


@dataclass(frozen=True, eq=False)
class PatternSail:
    """A SheetMesh placed on the spin axis. N nodes."""

    nodes: np.ndarray  #: (N, 3), rest positions [m]
    triangles: np.ndarray  #: as of a SheetMesh, and the creases
    creases: np.ndarray
    crease_signs: np.ndarray
    start: np.ndarray  #: (N, 3), to start from [m]
    tips: np.ndarray  #: (n,) nodes with tip masses
    hub: np.ndarray  #: (n,) nodes that are driven
    lines: tuple  #: sides (E, 2) and FOLD letters (E,) of the mesh
    given: np.ndarray  #: (N, 3), rest positions as in the file [m]
    used: tuple = ()  #: names of the file's groups that are tips or hub


def place(sheet: Any, p: Any) -> PatternSail:
    """Put a SheetMesh on the spin axis, choose its tips and its hub by PatternParameters `p`.

    ValueError if no node lies within the hub's radius.
    """
    named = p.tips == "corners" and len(sheet.groups.get("tips", ())) > 0
    tips = sheet.groups["tips"] if named else _tips(sheet, p.tips)
    mass = _node_masses(sheet, p, tips)
    nodes = sheet.nodes - np.average(sheet.nodes, axis=0, weights=mass)
    folded = sheet.start is not None and not p.flat
    start = nearest_pose(sheet.start, nodes, mass) if folded else nodes
    hub = _hub(sheet, nodes, p.hub_radius)
    used = ("hub", "tips") if named else ("hub",)
    mesh = nodes, sheet.triangles, sheet.creases, sheet.crease_signs
    return PatternSail(*mesh, start, tips, hub, sheet.lines(), sheet.nodes, used)


def _hub(sheet, nodes, radius):
    """Nodes (n,) that are driven, of `nodes` (N, 3) [m] placed on the axis."""
    named = np.asarray(sheet.groups.get("hub", ()), dtype=int)
    if radius == 0:
        return named
    away = np.hypot(nodes[:, 0], nodes[:, 1])
    if radius < away.min():
        raise ValueError(
            f"hub_radius = {radius} m: no node is that near the axis; the nearest is at "
            f"{away.min():.4g} m"
        )
    return np.union1d(named, np.flatnonzero(away <= radius))


def _tips(sheet, choice):
    """Nodes (n,) that bear tip masses."""
    if choice == "none":
        return np.empty(0, dtype=int)
    around = sheet.rim
    away = sheet.nodes - sheet.nodes.mean(axis=0)
    radius = np.hypot(away[:, 0], away[:, 1])
    corners = outline_corners(sheet.nodes[:, :2], around)
    if choice == "farthest" or not len(corners):
        return around[radius[around] > (1 - 1e-6) * radius[around].max()]
    return corners


def outline_corners(points: np.ndarray, among: np.ndarray) -> np.ndarray:
    """The nodes (n,) of `among` at corners of the convex outline of `points` (N, 2).

    Counter-clockwise; where the outline turns by less than 20 degrees there is no corner. Of nodes
    at the same place, as beside a cut, one is taken.
    """
    order = sorted(among.tolist(), key=lambda i: tuple(points[i]))
    tiny = 1e-9 * np.ptp(points[among], axis=0).max() ** 2

    def half(ids):  # Andrew's monotone chain
        chain: list = []
        for i in ids:
            while len(chain) > 1 and _turn(points, chain[-2], chain[-1], i)[0] <= tiny:
                chain.pop()
            if not chain or np.any(points[chain[-1]] != points[i]):
                chain.append(i)
        return chain[:-1]

    ring = half(order) + half(order[::-1])
    turns = [
        np.arctan2(*_turn(points, ring[k - 1], ring[k], ring[(k + 1) % len(ring)]))
        for k in range(len(ring))
    ]
    return np.array([i for i, turn in zip(ring, turns) if turn > TURN], dtype=int)


def _turn(points, a, b, c):
    """Cross and dot product of a -> b and b -> c."""
    (x, y), (u, v) = points[b] - points[a], points[c] - points[b]
    return x * v - y * u, x * u + y * v


def _node_masses(sheet, p, tips):
    """Masses (N,) [kg] of film and tips, equation (4)."""
    areas = triangle_areas(sheet.nodes, sheet.triangles)
    masses = np.zeros(len(sheet.nodes))
    np.add.at(masses, sheet.triangles, p.density * p.thickness * areas[:, None] / 3)
    masses[tips] += p.tip_mass
    return masses
