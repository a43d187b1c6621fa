# SPDX-License-Identifier: GPL-2.0-or-later
"""The central spool: a cylinder of YADE facets about the z axis (paper, section 3.3)."""

from collections.abc import Sequence
from math import cos, hypot, pi, sin
from typing import Any

from yade import utils
from yade.wrapper import FrictMat, Omega, SpoolRotation

SPOOL_MASK = 1 << 28  # of the facets, which SpoolRotation moves: NewtonIntegrator leaves them alone
COLOUR = (0.45, 0.48, 0.55)  # otherwise YADE picks a random one
VERLET_DISTANCE = 2e-3  # of the collider [m]


def turning(facets: Sequence[int], touching: Sequence[int], omega: float) -> Any:
    """SpoolRotation that turns the spool at `omega` about +z [rad/s]; dead if there are no facets.

    `facets` and `touching` are ids of the spool's facets and of the bodies that may touch it.
    """
    bodies = Omega().bodies
    corners = [bodies[i].state.pos + v for i in facets for v in bodies[i].shape.vertices]
    radius = max((hypot(c[0], c[1]) for c in corners), default=0.0)
    thickest = max((bodies[i].shape.radius for i in touching), default=0.0)
    return SpoolRotation(
        ids=list(facets),
        touching=list(touching),
        angularVelocity=omega,
        reach=radius + thickest + VERLET_DISTANCE / 2,
        sweep=VERLET_DISTANCE / 2,
        dead=not len(facets),
    )


def add_spool(
    radius: float = 0.025,
    height: float = 0.06,
    facets: int = 36,
    young: float = 1e6,
    friction_angle: float = 0.3,
) -> list[int]:
    """Add the spool to the scene; returns the ids of its facets.

    Parameters
    ----------
    radius, height : float
        Of the cylinder through the facets' corners, from -height/2 to height/2 [m], > 0.
    facets : int
        Flat faces around the axis, >= 3; each is two triangles.
    young : float
        Of the contact with tether masses [Pa], > 0. Half as stiff as 2 young times their radius.
    friction_angle : float
        Between tethers and spool [rad], >= 0.

    Raises
    ------
    ValueError
        Naming the parameter and its range, if one is out of range.
    """
    for name, value in {"radius": radius, "height": height, "young": young}.items():
        if not value > 0:
            raise ValueError(f"spool: {name} = {value} must be > 0")
    if facets < 3:
        raise ValueError(f"spool: facets = {facets} must be >= 3")
    if friction_angle < 0:
        raise ValueError(f"spool: friction_angle = {friction_angle} rad must be >= 0")
    scene = Omega()
    material = FrictMat(young=young, poisson=0.3, frictionAngle=friction_angle, density=1000)
    scene.materials.append(material)
    angles = [2 * pi * k / facets for k in range(facets + 1)]
    rim = [(radius * cos(a), radius * sin(a)) for a in angles]
    half = height / 2
    ids = []
    for (x1, y1), (x2, y2) in zip(rim, rim[1:]):
        low1, low2, high1, high2 = (x1, y1, -half), (x2, y2, -half), (x1, y1, half), (x2, y2, half)
        for corners in ((low1, low2, high2), (low1, high2, high1)):
            facet = utils.facet(corners, material=material, mask=SPOOL_MASK, color=COLOUR)
            ids.append(scene.bodies.append(facet))
    return ids
