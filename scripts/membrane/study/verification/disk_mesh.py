# SPDX-License-Identifier: GPL-2.0-or-later
"""Round meshes of triangles, and the stress that side tensions mean in them."""

from math import gamma

import numpy as np
from membrane import geometry

from ..sources import paper

MAP_STEPS = 400


def disk_mesh(cells: int, even: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """A hexagon of equilateral triangles, bent to a disk of radius 1 m.

    `cells`, >= 1, from the centre to the edge. `even`: bent by the conformal map, which keeps the
    angles; only the two triangles at each of the hexagon's corners, small ones, are far from
    equilateral. Else ring k gets its 6 k nodes at even distances on a circle of radius k/cells,
    and most triangles are sheared. Returns nodes (N, 3) [m], flat, about the origin, and triangles
    (T, 3), counter-clockwise.
    """
    reach = np.arange(-cells, cells + 1)
    i, j = (axis.ravel() for axis in np.meshgrid(reach, reach, indexing="ij"))
    inside = np.abs(i + j) <= cells
    number = np.full((2 * cells + 1, 2 * cells + 1), -1)
    number[inside.reshape(number.shape)] = np.arange(np.sum(inside))
    a, b = number[:-1, :-1].ravel(), number[1:, :-1].ravel()
    c, d = number[:-1, 1:].ravel(), number[1:, 1:].ravel()
    triangles = np.vstack([np.column_stack([a, b, c]), np.column_stack([b, d, c])])
    triangles = triangles[np.all(triangles >= 0, axis=1)]

    i, j = i[inside], j[inside]
    lattice = (i + np.exp(1j * np.pi / 3) * j) / cells
    ring = np.max(np.abs([i, j, i + j]), axis=0)
    if even:
        place = hexagon_to_disk(lattice)
        place[ring == cells] /= np.abs(place[ring == cells])
    else:
        place = hexagon_to_rings(lattice, ring / cells)
    return np.column_stack([place.real, place.imag, np.zeros(len(place))]), triangles


def hexagon_to_disk(z: np.ndarray) -> np.ndarray:
    """Conformal map of the hexagon with a corner at 1 to the unit disk: complex numbers (N,).

    By Schwarz and Christoffel dz/dw is proportional to (1 - w^6)^(-1/3); integrated from the
    centre straight to each point by the fourth-order Runge-Kutta method.
    """

    def slope(w: np.ndarray) -> np.ndarray:
        return (1 - w**6) ** (1 / 3)

    corner = gamma(1 / 6) * gamma(2 / 3) / gamma(5 / 6) / 6  # of the hexagon that has slope 1 at 0
    step = corner * z / MAP_STEPS
    w = np.zeros_like(z)
    for _ in range(MAP_STEPS):
        first = slope(w)
        second = slope(w + 0.5 * step * first)
        third = slope(w + 0.5 * step * second)
        w = w + step / 6 * (first + 2 * second + 2 * third + slope(w + step * third))
    return w


def hexagon_to_rings(z: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Each hexagon about the centre, (N,) complex, to a circle of `radius` (N,), evenly."""
    sector = np.floor(np.angle(z) / (np.pi / 3) + 1e-9)
    turned = z * np.exp(-1j * np.pi / 3 * sector)  # between the corners at 0 and 60 degrees
    share = turned.imag / np.sqrt(0.75) / np.where(radius > 0, radius, 1)
    return radius * np.exp(1j * np.pi / 3 * (sector + share))


def scatter(nodes: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """Sum of `values` (K, D) over equal entries of `nodes` (K,): (count, D)."""
    return np.column_stack([np.bincount(nodes, column, count) for column in values.T])


def side_stiffness(
    nodes: np.ndarray, triangles: np.ndarray, young: float, poisson: float, thickness: float
) -> np.ndarray:
    """Stiffness [N/m] by (5) that each triangle gives to its sides, (T, 3).

    Columns: sides (0, 1), (1, 2), (2, 0).
    """
    lengths = paper.side_lengths_of_triangles(nodes, triangles)
    opposite = paper.triangle_stiffness(lengths, young, poisson, thickness)
    return np.roll(opposite, 1, axis=1)  # the side opposite corner 2 is (0, 1)


def triangle_stress(
    nodes: np.ndarray, triangles: np.ndarray, shares: np.ndarray, rest: np.ndarray, thickness: float
) -> np.ndarray:
    """Stress [Pa] in the plane, (T, 2, 2), from the tensions of the sides (virial formula).

    Each triangle has three springs, its shares of the sides; with tension f, length L and unit
    vector n of each, the stress is the sum of f L n n over the three, divided by the volume.
    `nodes` and `rest` (N, 3) are present and rest positions [m], `shares` (T, 3) [N/m] from
    `side_stiffness`; `thickness` in m.
    """
    span = (np.roll(nodes[triangles], -1, axis=1) - nodes[triangles])[:, :, :2]
    rest_span = np.roll(rest[triangles], -1, axis=1) - rest[triangles]
    length = np.linalg.norm(span, axis=2)
    tension = shares * (length - np.linalg.norm(rest_span, axis=2))
    volume = thickness * geometry.triangle_areas(nodes, triangles)
    return np.einsum("ts,tsi,tsj->tij", tension / length, span, span) / volume[:, None, None]
