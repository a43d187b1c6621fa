# SPDX-License-Identifier: GPL-2.0-or-later
"""The engines that move a membrane."""

from dataclasses import dataclass, field

import numpy as np
from yade import wrapper as yade

from ..progress import warn
from . import contacts, hub, spool

PATHS = ("law2", "fused")
NODE_MASK = 1 << 29  # of nodes of a MembraneIntegrator
# What NewtonIntegrator moves: all but facets of the spool and nodes of a MembraneIntegrator.
INTEGRATED = NODE_MASK - 1 - spool.SPOOL_MASK
TOUCHING_MASK = NODE_MASK - 1  # of nodes that touch other bodies: they touch whatever has a mask

LEDGER_PERIOD = 20  # at most so many steps between two looks at all energies


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
    forces = getattr(yade, "MembraneIntegrator" if fused else "MembraneForceEngine")(
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
        laws = [yade.Law2_MembraneGeom_MembranePhys_Buckling()]
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
        geometry = [yade.Ig2_MembraneNode_MembraneNode_MembraneGeom()]
        physics = [yade.Ip2_MembraneMat_MembraneMat_MembranePhys(membrane=membrane)]
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
        node_pairs = yade.Ig2_MembraneNode_MembraneNode_MembraneGeom()
        geometry = [*contacts.geometry(), node_pairs]
        physics.append(yade.Ip2_FrictMat_FrictMat_FrictPhys())
        # A facet's torque must be that about its place: a FreeHub takes it.
        laws.append(yade.Law2_ScGeom_FrictPhys_CundallStrack(sphericalBodies=False))
    facets = [i for i in driven if isinstance(scene.bodies[i].shape, yade.Facet)]
    turning = spool.turning(facets, touching, omega)
    turned = sorted(set(driven).difference(facets))
    free_hub = []
    if hub_inertia is not None:
        free_hub = [hub.add(forces, turned, turning, hub_inertia, omega)]
        turned = []  # the hub turns them
    rotation = yade.RotationEngine(
        ids=turned,
        angularVelocity=omega,
        rotationAxis=(0, 0, 1),
        rotateAroundZero=True,
        zeroPoint=(0, 0, 0),
        dead=not turned,
    )
    centrifugal = yade.CentrifugalField(membrane=membrane, omega=omega, dead=True)
    newton = yade.NewtonIntegrator(damping=0, gravity=gravity, mask=INTEGRATED)
    ledger = yade.MembraneLedger(
        forces=forces, gravity=gravity, period=min(exchange_period, LEDGER_PERIOD) if fused else 1
    )
    # With no other body that moves, a fused membrane needs none of YADE's loops over bodies.
    newton.dead = fused and not set(others).difference(facets)
    resetter = yade.ForceResetter(dead=newton.dead and not laws)
    watch = []
    if energy_tolerance is not None:
        watch = [yade.MembraneWatch(ledger=ledger, tolerance=energy_tolerance)]
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
    moving = membrane, forces, centrifugal, rotation, turning, newton, ledger
    others = watch[0] if watch else None, resetter, list(driven), free_hub[0] if free_hub else None
    return MembraneScene(*moving, *others)


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
    newton, ledger = found["NewtonIntegrator"], found["MembraneLedger"]
    moving = forces.membrane, forces, found["CentrifugalField"], rotation, turning, newton, ledger
    driven = [*turning.ids, *rotation.ids, *on_hub]
    others = found.get("MembraneWatch"), found["ForceResetter"], driven, free
    return MembraneScene(*moving, *others)


def sort_interactions():
    """Let YADE take interactions one by one in the order of their ids, which costs time.

    Then a saved scene goes on bit for bit also while tethers touch the spool, and sides that are
    interactions add up alike in every run: several threads would share them out by chance.
    """
    for engine in yade.Omega().engines:
        if isinstance(engine, yade.InteractionLoop):
            engine.loopOnSortedInteractions = True
            engine.ompThreads = 1
