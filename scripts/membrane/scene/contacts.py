# SPDX-License-Identifier: GPL-2.0-or-later
"""Ordinary contacts of a membrane's nodes with other bodies, by YADE's own functors."""

from collections.abc import Sequence
from typing import Any

from yade import wrapper as yade

from . import spool

# Shapes that a node, which is a sphere to YADE, can touch: their bounds and geometry.
SHAPES = {
    "Sphere": (yade.Bo1_Sphere_Aabb, yade.Ig2_Sphere_Sphere_ScGeom),
    "Facet": (yade.Bo1_Facet_Aabb, yade.Ig2_Facet_Sphere_ScGeom),
    "Wall": (yade.Bo1_Wall_Aabb, yade.Ig2_Wall_Sphere_ScGeom),
    "Box": (yade.Bo1_Box_Aabb, yade.Ig2_Box_Sphere_ScGeom),
}


def check(bodies: Sequence[int], integrated: int) -> None:
    """Refuse what nodes would fall through, or what would not move.

    Of `bodies`, ids of those that are not nodes; `integrated` is the mask of NewtonIntegrator.
    ValueError names the first body that has bounds but cannot be touched, or that nothing would
    move.
    """
    for body in (yade.Omega().bodies[i] for i in bodies):
        if body.isClump:
            continue
        about = f"set_engines: touching: body #{body.id}"
        kinds = tuple(getattr(yade, name) for name in SHAPES)
        if body.bounded and body.shape is not None and not isinstance(body.shape, kinds):
            raise ValueError(
                f"{about} is a {type(body.shape).__name__}, which nodes cannot touch; they can "
                f"touch a {', '.join(SHAPES)}; if nothing should touch it, set its bounded to False"
            )
        if body.bounded and not isinstance(body.mat, yade.FrictMat):
            raise ValueError(
                f"{about} has the material {type(body.mat).__name__}; it must have a FrictMat, "
                "or bounded=False"
            )
        if body.bounded and not body.mask & (integrated | spool.SPOOL_MASK):
            raise ValueError(f"{about} has the mask {body.mask}, with which it touches nothing")
        if body.dynamic and not body.mask & integrated:
            raise ValueError(
                f"{about} has the mask {body.mask}, so that NewtonIntegrator would not move it; "
                f"give it a bit of {integrated}"
            )


def collider(nodes: int) -> Any:
    """Collider of nodes of the mask `nodes` with other bodies.

    Nodes do not meet one another, nor facets of the spool: looking at such pairs would take time.
    """
    apart = spool.SPOOL_MASK  # of two bodies of one mask that has this bit
    if any(b.mask & apart and b.mask not in (nodes, apart) for b in yade.Omega().bodies):
        apart = 0  # else bodies of that mask would not touch one another
    return yade.InsertionSortCollider(
        [bounds() for bounds, _ in SHAPES.values()],
        verletDist=spool.VERLET_DISTANCE,
        targetInterv=-1,
        avoidSelfInteractionMask=apart,
    )


def geometry() -> list:
    """New functors for the geometry of such contacts."""
    return [functor() for _, functor in SHAPES.values()]
