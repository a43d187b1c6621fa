# SPDX-License-Identifier: GPL-2.0-or-later
"""A membrane's motion: steps, the forces of a state, spin-up and release."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from yade import wrapper as yade

from . import hub
from .engines import MembraneScene


def advance(steps: int, resumed: Any = None) -> None:
    """Run `steps` steps. Raises what an engine raised.

    `resumed`: the forces engine of a scene that was just loaded. It checks O.dt in its first step
    only if it would have done so without a stop: the critical time step changes with the state.
    """
    scene = yade.Omega()
    scene.stopAtIter = scene.iter + steps  # lets a MembraneIntegrator know when the run ends
    try:
        # O.run() would lose what an engine raises before O.wait() is called.
        if resumed and steps > 0:
            _first_step(resumed)
            steps -= 1
        yade.MembraneForceEngine.advance(steps)
    except BaseException:
        for engine in scene.engines:
            if isinstance(engine, yade.MembraneForceEngine):
                engine.writeBack()
        raise
    finally:
        scene.stopAtIter = 0


def _first_step(forces):
    """Run the first step after a load."""
    forced = forces.forceTimeStep
    forces.forceTimeStep = forced or yade.Omega().iter % forces.timeStepCheckPeriod != 0
    try:
        forces.advance(1)
    finally:
        forces.forceTimeStep = forced


def compute_forces(sail: MembraneScene) -> np.ndarray:
    """Forces (N, 3) [N] on a MembraneScene's nodes now, gravity apart: nothing moves.

    It takes a step of YADE in which neither integrator, rotation nor ledger takes part, nor any
    other membrane.
    """
    turning = yade.KinematicEngine, yade.SpoolRotation, yade.FreeHub
    kinds = (yade.NewtonIntegrator, *turning, yade.MembraneLedger)
    movers = []
    for engine in yade.Omega().engines:
        forces = isinstance(engine, yade.MembraneForceEngine)
        other = forces and engine.membrane.bodyIds != sail.membrane.bodyIds
        if other or isinstance(engine, kinds):
            movers.append(engine)
    were_dead = [engine.dead for engine in movers]
    for engine in movers:
        engine.dead = True
    if sail.fused:
        sail.forces.moveNodes = False
    try:
        yade.Omega().step()
        return np.array(sail.forces.nodeForces())
    finally:
        if sail.fused:
            sail.forces.moveNodes = True
        for engine, was_dead in zip(movers, were_dead):
            engine.dead = was_dead


def set_spin(sail: MembraneScene, omega: float, before: float = 0.5) -> None:
    """Let all nodes of a MembraneScene turn about z at `omega` [rad/s]: v = omega x r.

    The velocities are those of `before` steps ago [-]: the leapfrog's lie half a step before the
    positions. O.dt must be set.
    """
    scene = yade.Omega()
    angle = -before * omega * scene.dt
    for i in sail.membrane.bodyIds:
        state = scene.bodies[i].state
        x, y, _ = state.pos
        x, y = x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle)
        state.vel = (-omega * y, omega * x, 0.0)


def residual_energy(sail: MembraneScene, omega: float) -> float:
    """Kinetic energy of a MembraneScene in a frame turning at `omega` [rad/s], over the spin's [-].

    That of the spin is 1/2 sum m omega2 r2.
    """
    bodies = yade.Omega().bodies
    states = [bodies[i].state for i in sail.membrane.bodyIds]
    mass = sail.masses()
    speed2 = np.sum(np.array([s.vel for s in states]) ** 2, axis=1)
    radius2 = np.sum(np.array([s.pos for s in states])[:, :2] ** 2, axis=1)
    return float(np.sum(mass * speed2) / (omega**2 * np.sum(mass * radius2)))


def spin_up(
    sail: MembraneScene,
    omega: float,
    *,
    tolerance: float = 1e-6,
    damping: float = 0.3,
    batch: int = 2000,
    max_time: float = 5.0,
    on_batch: Callable | None = None,
    begun: dict | None = None,
    keep: Callable | None = None,
) -> dict:
    """Bring a MembraneScene to rest in a frame that turns at `omega` [rad/s] (paper, 3.3).

    Its guide nodes and tether ends must be held. Gives simulated "time" [s], "steps", "residual"
    [-].

    Parameters
    ----------
    tolerance : float
        Ends when `residual_energy` [-] has stayed below it for two batches, > 0.
    damping : float
        NewtonIntegrator's local damping meanwhile, in (0, 1).
    batch : int
        Steps between two looks, >= 1.
    max_time : float
        Simulated time [s] after which to give up.
    on_batch : callable, optional
        Called with (simulated time, residual) after each batch.
    begun : dict, optional
        What `keep` was given when the scene was saved that is now to go on.
    keep : callable, optional
        Called after each batch but the last, with a dict that a later `begun` takes.

    Raises
    ------
    RuntimeError
        If there is no equilibrium in `max_time`, or the residual energy exceeds 10.
    """
    scene = yade.Omega()
    engines = {sail.field: False, sail.rotation: True, sail.spool: True, sail.ledger: True}
    if sail.hub:
        engines[sail.hub] = True
    for engine, dead in engines.items():
        engine.dead = dead
    sail.field.omega = omega
    sail.newton.damping = damping
    sail.resetter.dead = False
    steps, calm = (begun["steps"], begun["calm"]) if begun else (0, 0)
    resumed = sail.forces if begun else None
    residual = float("inf")
    while calm < 2:
        if steps * scene.dt > max_time:
            raise RuntimeError(
                f"spin-up found no equilibrium in {max_time} s: residual energy {residual:.3g}, "
                f"wanted {tolerance:.3g}"
            )
        advance(batch, resumed)
        resumed = None
        steps += batch
        residual = residual_energy(sail, omega)
        if not residual < 10:
            raise RuntimeError(
                f"spin-up went wrong: after {steps} steps the nodes have {residual:.3g} times the "
                f"energy of the spin; try a step shorter than O.dt = {scene.dt:.3g} s"
            )
        calm = calm + 1 if residual < tolerance else 0
        if on_batch:
            on_batch(steps * scene.dt, residual)
        if keep and calm < 2:
            keep({"steps": steps, "calm": calm})
    return {"time": steps * scene.dt, "steps": steps, "residual": residual}


def release(sail: MembraneScene, omega: float, held: Sequence[int]) -> None:
    """Go over to the inertial frame and let the `held` nodes of the mesh go (paper, 3.3).

    At the release v = omega x r everywhere, `omega` in [rad/s]. The leapfrog's velocities lie half
    a step before, and follow from the accelerations of the nodes once they are free: v - a dt / 2.
    """
    sail.field.dead = True
    sail.newton.damping = 0
    sail.hold(held, False)
    scene = yade.Omega()
    set_spin(sail, omega, before=0)
    sail.forces.forgetVelocities()
    forces = compute_forces(sail)
    sail.forces.forgetVelocities()
    gravity = np.array(sail.newton.gravity)
    for i, force in zip(sail.membrane.bodyIds, forces):
        state = scene.bodies[i].state
        free = [axis not in state.blockedDOFs for axis in "xyz"]
        acceleration = free * (force / state.mass + gravity)
        state.vel = (np.array(state.vel) - 0.5 * scene.dt * acceleration).tolist()
    if sail.hub:
        hub.release(sail.hub, omega, forces)
    else:
        sail.rotation.dead = not sail.rotation.ids
    sail.spool.dead = not sail.spool.ids
    sail.ledger.dead = False
