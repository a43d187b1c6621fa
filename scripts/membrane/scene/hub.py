# SPDX-License-Identifier: GPL-2.0-or-later
"""A hub that turns freely: it spins as the membrane's tethers let it, see FreeHub."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from yade import wrapper as yade

from ..measures import moment_of_inertia


def add(forces: Any, bodies: Sequence[int], spool: Any, inertia: float, omega: float) -> Any:
    """FreeHub that turns `bodies` of the membrane of `forces`, a MembraneForceEngine, by their ids.

    `spool` is the SpoolRotation of the hub's facets, left alone without any; `inertia` is about z
    [kg m2], without those bodies, >= 0; `omega` is the spin at the beginning [rad/s].
    """
    node = {body: i for i, body in enumerate(forces.membrane.bodyIds)}
    nodes = [node[body] for body in bodies]
    facets = {"spool": spool} if spool.ids else {}
    return yade.FreeHub(forces=forces, nodes=nodes, inertia=inertia, spin=omega, **facets)


def inertia(sail: Any, positions: np.ndarray) -> float:
    """Moment of inertia about z [kg m2] of a free hub and its membrane, nodes at (N, 3) [m]."""
    return sail.hub.inertia + moment_of_inertia(sail.masses(), np.asarray(positions))


def release(hub: Any, omega: float, forces: np.ndarray) -> None:
    """Let the hub go with spin `omega` [rad/s], under `forces` (N, 3) [N] on the membrane's nodes.

    The leapfrog's velocities lie half a step before the positions: that of the hub, too.
    """
    scene = yade.Omega()
    states = [scene.bodies[hub.forces.membrane.bodyIds[i]].state for i in hub.nodes]
    torque = sum(np.cross(s.pos, forces[i])[2] for i, s in zip(hub.nodes, states))
    hub.spin = omega - 0.5 * scene.dt * torque / hub.totalInertia
    turn = hub.spin * scene.dt
    chord = 2 * np.sin(0.5 * turn) / scene.dt
    c, s = np.cos(0.5 * turn), np.sin(0.5 * turn)
    for state in states:
        x, y, _ = state.pos
        state.vel = (-chord * (c * y - s * x), chord * (c * x + s * y), 0.0)
    hub.dead = False
