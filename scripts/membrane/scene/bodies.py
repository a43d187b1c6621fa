# SPDX-License-Identifier: GPL-2.0-or-later
"""A membrane's bodies: its film, nodes and sides."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from yade import wrapper as yade

from ..progress import stages

LARGE = 100_000  # nodes: adding so many takes about a second, so that progress is shown
ADDING = {"rest state": 2, "bodies": 2, "interactions": 6}  # stages and their shares of the time


def film(
    young: float = 3.2e9, poisson: float = 0.34, density: float = 1420.0, thickness: float = 7.5e-6
) -> Any:
    """MembraneMat of the film; the defaults are those of the paper's Table 1.

    Young's modulus E [Pa], > 0; Poisson's ratio nu [-], in (-1, 0.5]; density rho [kg/m3], > 0;
    thickness h [m], > 0. ValueError if one is out of range.
    """
    return yade.MembraneMat(young=young, poisson=poisson, density=density, thickness=thickness)


def add_membrane(
    nodes: ArrayLike,
    triangles: ArrayLike,
    creases: ArrayLike = (),
    crease_signs: ArrayLike = (),
    cables: ArrayLike = (),
    positions: ArrayLike | None = None,
    material: Any = None,
    radius: float = 5e-4,
    interactions: bool = True,
    **options: Any,
) -> Any:
    """Add a Membrane to the scene: one sphere a node, one interaction a side.

    Parameters
    ----------
    nodes : (N, 3) float
        Rest positions [m].
    triangles : (T, 3) int
        Node ids, counter-clockwise seen from the top.
    creases, crease_signs : (C, 2) and (C,) int
        Node ids of sides on fold lines, each between two triangles; +1 mountain, -1 valley, seen
        from the top.
    cables : (K, 2) int
        Node ids of tether segments.
    positions : (N, 3) float, optional
        Where to put the nodes [m]; default: `nodes`.
    material : MembraneMat, optional
        Default: `film()`.
    radius : float
        Of the spheres [m], > 0; it counts only for contacts and for drawing.
    interactions : bool
        False: none, as the path "fused" needs none; path "law2" adds them later.
    **options
        Further attributes of Membrane: alpha, alphaCrease, pointMasses, cableStiffness, …

    Raises
    ------
    ValueError
        Naming the attribute and what must hold, if mesh, material or options cannot be used.
    """
    nodes = np.asarray(nodes, dtype=float)
    places = nodes if positions is None else np.asarray(positions, dtype=float)
    with stages("building", ADDING, silent=len(nodes) < LARGE) as begin:
        begin("rest state")
        membrane = yade.Membrane(
            material=material or film(),
            nodes=nodes,
            triangles=np.asarray(triangles, dtype=int),
            creases=np.asarray(creases, dtype=int),
            creaseSigns=np.asarray(crease_signs, dtype=int),
            cables=np.asarray(cables, dtype=int),
            **options,
        )
        begin("bodies")
        membrane.addBodies(places, radius)
        if interactions:
            begin("interactions")
            membrane.addInteractions()
    return membrane
