# SPDX-License-Identifier: GPL-2.0-or-later
"""From a mesh to a running YADE scene: bodies, engines, spin-up, release."""

from dataclasses import dataclass, field

import numpy as np
from yade import wrapper as yade

from . import _load, contacts, hub, spool
from .progress import stages, warn

LARGE = 100_000  # nodes: adding so many takes about a second, so that progress is shown
ADDING = {"rest state": 2, "bodies": 2, "interactions": 6}  # stages and their shares of the time

PATHS = ("law2", "fused")
NODE_MASK = 1 << 29  # of nodes of a MembraneIntegrator
# What NewtonIntegrator moves: all but facets of the spool and nodes of a MembraneIntegrator.
INTEGRATED = NODE_MASK - 1 - spool.SPOOL_MASK
TOUCHING_MASK = NODE_MASK - 1  # of nodes that touch other bodies: they touch whatever has a mask

LEDGER_PERIOD = 20  # at most so many steps between two looks at all energies

_plugin = _load.load()


@dataclass
class MembraneScene:
    """A membrane in the scene and the engines that move it.

    Attributes
    ----------
    membrane : Membrane
    forces : MembraneForceEngine
    field : CentrifugalField
        Dead except during spin-up.
    rotation : RotationEngine
        Turns the driven nodes; dead during spin-up.
    spool : SpoolRotation
        Turns the driven facets; dead during spin-up.
    newton : NewtonIntegrator
        Dead where only nodes of a fused membrane move; its gravity and damping count all the same.
    ledger : MembraneLedger
        Dead during spin-up.
    watch : MembraneWatch or None
        Stops a run that goes wrong; rests while the ledger is dead.
    resetter : ForceResetter
        Dead as long as a fused membrane is alone in the scene.
    driven : list of int
        Ids of the bodies that turn with the spool.
    hub : FreeHub or None
        Turns the driven bodies in place of `rotation`; dead during spin-up.
    """

    membrane: object
    forces: object
    field: object
    rotation: object
    spool: object
    newton: object
    ledger: object
    watch: object = None
    resetter: object = None
    driven: list = field(default_factory=list)
    hub: object = None

    def positions(self):
        """Present positions of the nodes, (N, 3) [m]."""
        bodies = yade.Omega().bodies
        return np.array([bodies[i].state.pos for i in self.membrane.bodyIds])

    def place(self, positions):
        """Put the nodes at `positions` (N, 3) [m]."""
        bodies = yade.Omega().bodies
        for i, x in zip(self.membrane.bodyIds, positions.tolist()):
            bodies[i].state.pos = x

    @property
    def fused(self):
        """Whether the nodes are moved by a MembraneIntegrator."""
        return hasattr(self.forces, "exchangePeriod")

    def last_positions(self):
        """Positions of the nodes as the last step's forces saw them, (N, 3) [m]."""
        return np.frombuffer(self.forces.lastPositionsBytes()).reshape(-1, 3)

    def masses(self):
        """Masses of the nodes, (N,) [kg]."""
        return np.array(self.membrane.masses)

    def hold(self, nodes, held=True):
        """Hold `nodes` (ids in the mesh) where they are; `held` False: let them go."""
        bodies, ids = yade.Omega().bodies, self.membrane.bodyIds
        for node in nodes:
            bodies[ids[node]].state.blockedDOFs = "xyzXYZ" if held else "XYZ"


def film(young=3.2e9, poisson=0.34, density=1420.0, thickness=7.5e-6):
    """Material of the film; the defaults are those of the paper's Table 1.

    Parameters
    ----------
    young : float
        Young's modulus E [Pa], > 0.
    poisson : float
        Poisson's ratio nu [-], in (-1, 0.5].
    density : float
        rho [kg/m3], > 0.
    thickness : float
        h [m], > 0.

    Returns
    -------
    MembraneMat

    Raises
    ------
    ValueError
        If one is out of range.
    """
    return _plugin["MembraneMat"](
        young=young, poisson=poisson, density=density, thickness=thickness
    )


def add_membrane(
    nodes,
    triangles,
    creases=(),
    crease_signs=(),
    cables=(),
    positions=None,
    material=None,
    radius=5e-4,
    interactions=True,
    **options,
):
    """Add a membrane to the scene: one sphere a node, one interaction a side.

    Parameters
    ----------
    nodes : (N, 3) float
        Rest positions [m].
    triangles : (T, 3) int
        Node ids, counter-clockwise seen from the top.
    creases : (C, 2) int
        Node ids of the sides on fold lines, each between two triangles.
    crease_signs : (C,) int
        +1 mountain, -1 valley, seen from the top.
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

    Returns
    -------
    Membrane

    Raises
    ------
    ValueError
        Naming the attribute and what must hold, if mesh, material or options cannot be used.
    """
    nodes = np.asarray(nodes, dtype=float)
    places = nodes if positions is None else np.asarray(positions, dtype=float)
    with stages("building", ADDING, silent=len(nodes) < LARGE) as begin:
        begin("rest state")
        membrane = _plugin["Membrane"](
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


def set_engines(
    membrane,
    *,
    path="law2",
    exchange_period=1,
    driven=(),
    touching=(),
    omega=0.0,
    hub_inertia=None,
    gravity=(0.0, 0.0, 0.0),
    beta=0.0,
    gamma=100.0,
    theta0=0.0,
    crease_law="paper",
    zeta=0.0,
    air_density=0.0,
    force_time_step=False,
    energy_tolerance=0.1,
):
    """Set O.engines to those that a membrane needs; each that a scene does without is left out.

    Parameters
    ----------
    membrane : Membrane
    path : "law2" or "fused"
        "law2": sides are interactions, nodes move by NewtonIntegrator; the reference. "fused": the
        same physics by MembraneIntegrator, several times faster; removes the membrane's
        interactions.
    exchange_period : int
        Of path "fused": steps between two updates of the bodies that touch nothing, >= 1; see
        MembraneIntegrator.exchangePeriod. The ledger's energies are brought up to date as seldom,
        but at least every LEDGER_PERIOD steps, for the watch.
    driven : sequence of int
        Ids of bodies that turn about z: spool facets, ends of tethers.
    touching : sequence of int
        Ids of the membrane's bodies that touch other bodies: any sphere, facet, wall or box of
        material FrictMat, now or later, by YADE's usual contact. Nodes do not touch one another.
        Empty: no collider at all.
    omega : float
        Rate at which the driven bodies turn [rad/s].
    hub_inertia : float, optional
        The driven bodies belong to a hub of this moment of inertia about z [kg m2] that turns
        freely: a FreeHub; `omega` is its spin when it begins. Default: they are driven at `omega`.
    gravity : 3 floats
        [m/s2].
    beta, gamma, zeta : float
        Stiffness of the creases, their penalty where faces have passed through each other, and
        damping ratio [-], >= 0; 0: none.
    theta0 : float
        Natural angle of the creases [rad], in [0, pi].
    crease_law : "paper" or "conservative"
        Equation (7) as printed, or the gradient of an energy.
    air_density : float
        [kg/m3], >= 0; 0: no drag.
    force_time_step : bool
        Run even above the critical time step.
    energy_tolerance : float or None
        Energy from nowhere, over all energy, that stops a run [-], > 0; None: no MembraneWatch.

    Returns
    -------
    MembraneScene

    Raises
    ------
    ValueError
        Naming the argument, if one is out of range, or the body that could not be touched.
    """
    if path not in PATHS:
        raise ValueError(f"set_engines: path = {path!r} must be one of {', '.join(PATHS)}")
    fused = path == "fused"
    scene = yade.Omega()
    own = {"exchangePeriod": exchange_period} if fused else {}
    forces = _plugin["MembraneIntegrator" if fused else "MembraneForceEngine"](
        membrane=membrane,
        beta=beta,
        gamma=gamma,
        theta0=theta0,
        creaseLaw=crease_law,
        zeta=zeta,
        airDensity=air_density,
        forceTimeStep=force_time_step,
        **own,
    )
    geometry, physics, laws, collider = [], [], [], []
    if touching or not fused:
        # Also where the sides are no interactions: should they become some, YADE would end for want
        # of it, before the forces engine can refuse them.
        laws = [_plugin["Law2_MembraneGeom_MembranePhys_Buckling"]()]
    others = []
    if len(scene.bodies) > len(membrane.bodyIds):
        others = sorted({body.id for body in scene.bodies}.difference(membrane.bodyIds))
    if fused:
        membrane.removeInteractions()
    else:
        if not membrane.hasInteractions:
            membrane.addInteractions()
        for body in (scene.bodies[i] for i in membrane.bodyIds):
            if body.mask == NODE_MASK:  # a MembraneIntegrator had them
                body.mask = 1
        geometry = [_plugin["Ig2_MembraneNode_MembraneNode_MembraneGeom"]()]
        physics = [_plugin["Ip2_MembraneMat_MembraneMat_MembranePhys"](membrane=membrane)]
    if not set(touching).issubset(membrane.bodyIds):
        stranger = min(set(touching).difference(membrane.bodyIds))
        raise ValueError(f"set_engines: touching: body #{stranger} is no node of the membrane")
    untouched = [i for i in others if i not in driven and scene.bodies[i].bounded]
    if untouched and not touching:
        warn(f"nothing of the membrane touches body #{untouched[0]}: name nodes in `touching`")
    if touching:
        contacts.check(others, INTEGRATED)
        for body in (scene.bodies[i] for i in touching):
            body.bounded, body.mask = True, TOUCHING_MASK
        collider = [contacts.collider(TOUCHING_MASK)]
        node_pairs = _plugin["Ig2_MembraneNode_MembraneNode_MembraneGeom"]
        geometry = [*contacts.geometry(), node_pairs()]
        physics.append(yade.Ip2_FrictMat_FrictMat_FrictPhys())
        # A facet's torque must be that about its place: a FreeHub takes it.
        laws.append(yade.Law2_ScGeom_FrictPhys_CundallStrack(sphericalBodies=False))
    facets = [i for i in driven if isinstance(scene.bodies[i].shape, yade.Facet)]
    turning = spool.turning(facets, touching, omega, _plugin["SpoolRotation"])
    turned = sorted(set(driven).difference(facets))
    free_hub = []
    if hub_inertia is not None:
        free_hub = [hub.add(_plugin["FreeHub"], forces, turned, turning, hub_inertia, omega)]
        turned = []  # the hub turns them
    rotation = yade.RotationEngine(
        ids=turned,
        angularVelocity=omega,
        rotationAxis=(0, 0, 1),
        rotateAroundZero=True,
        zeroPoint=(0, 0, 0),
        dead=not turned,
    )
    centrifugal = _plugin["CentrifugalField"](membrane=membrane, omega=omega, dead=True)
    newton = yade.NewtonIntegrator(damping=0, gravity=gravity, mask=INTEGRATED)
    ledger = _plugin["MembraneLedger"](
        forces=forces, gravity=gravity, period=min(exchange_period, LEDGER_PERIOD) if fused else 1
    )
    # With no other body that moves, a fused membrane needs none of YADE's loops over bodies.
    newton.dead = fused and not set(others).difference(facets)
    resetter = yade.ForceResetter(dead=newton.dead and not laws)
    watch = []
    if energy_tolerance is not None:
        watch = [_plugin["MembraneWatch"](ledger=ledger, tolerance=energy_tolerance)]
    scene.engines = [
        resetter,
        turning,
        *collider,
        rotation,
        *([yade.InteractionLoop(geometry, physics, laws)] if laws else []),
        centrifugal,
        forces,
        newton,
        *free_hub,
        ledger,
        *watch,
    ]
    return MembraneScene(
        membrane,
        forces,
        centrifugal,
        rotation,
        turning,
        newton,
        ledger,
        watch[0] if watch else None,
        resetter,
        list(driven),
        free_hub[0] if free_hub else None,
    )


def renew_collider():
    """Put a new collider in the place of the one that `set_engines` made, if any.

    It counts how often it was loaded, so that else two saves of one state would differ.
    """
    omega = yade.Omega()
    old = yade.InsertionSortCollider
    omega.engines = [
        contacts.collider(TOUCHING_MASK) if isinstance(e, old) else e for e in omega.engines
    ]


def loaded():
    """The MembraneScene of a scene that `set_engines` made and O.load brought back.

    Its only membrane counts; `driven` lists bodies as its engines do.
    """
    found = {}
    for engine in yade.Omega().engines:
        found.setdefault(type(engine).__name__, engine)
    forces = found.get("MembraneIntegrator") or found["MembraneForceEngine"]
    rotation, turning = found["RotationEngine"], found["SpoolRotation"]
    free = found.get("FreeHub")
    on_hub = [forces.membrane.bodyIds[node] for node in free.nodes] if free else []
    return MembraneScene(
        forces.membrane,
        forces,
        found["CentrifugalField"],
        rotation,
        turning,
        found["NewtonIntegrator"],
        found["MembraneLedger"],
        found.get("MembraneWatch"),
        found["ForceResetter"],
        [*turning.ids, *rotation.ids, *on_hub],
        free,
    )


def sort_interactions():
    """Let YADE take interactions one by one in the order of their ids, which costs time.

    Then a saved scene goes on bit for bit also while tethers touch the spool, and sides that are
    interactions add up alike in every run: several threads would share them out by chance.
    """
    for engine in yade.Omega().engines:
        if isinstance(engine, yade.InteractionLoop):
            engine.loopOnSortedInteractions = True
            engine.ompThreads = 1


def advance(steps, resumed=None):
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
        _plugin["MembraneForceEngine"].advance(steps)
    except BaseException:
        for engine in scene.engines:
            if isinstance(engine, _plugin["MembraneForceEngine"]):
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


def compute_forces(sail):
    """Forces (N, 3) [N] on a MembraneScene's nodes now, gravity apart: nothing moves.

    It takes a step of YADE in which neither integrator, rotation nor ledger takes part, nor any
    other membrane.
    """
    kinds = (
        yade.NewtonIntegrator,
        yade.KinematicEngine,
        _plugin["SpoolRotation"],
        _plugin["FreeHub"],
        _plugin["MembraneLedger"],
    )
    movers = []
    for engine in yade.Omega().engines:
        forces = isinstance(engine, _plugin["MembraneForceEngine"])
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


def set_spin(sail, omega, before=0.5):
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


def residual_energy(sail, omega):
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
    sail,
    omega,
    *,
    tolerance=1e-6,
    damping=0.3,
    batch=2000,
    max_time=5.0,
    on_batch=None,
    begun=None,
    keep=None,
):
    """Bring the sail to rest in a frame that turns at `omega` (paper, 3.3).

    Parameters
    ----------
    sail : MembraneScene
        Its guide nodes and tether ends must be held.
    omega : float
        Spin rate [rad/s].
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

    Returns
    -------
    dict
        simulated time [s], steps, residual [-].

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


def release(sail, omega, held):
    """Go over to the inertial frame and let the `held` nodes go (paper, 3.3).

    At the release v = omega x r everywhere. The leapfrog's velocities lie half a step before, and
    follow from the accelerations of the nodes once they are free: v - a dt / 2.

    Parameters
    ----------
    sail : MembraneScene
    omega : float
        Spin rate [rad/s].
    held : sequence of int
        Ids of nodes in the mesh, as the guide nodes.
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
        sail.rotation.dead = False
    sail.spool.dead = sail.ledger.dead = False
