# SPDX-License-Identifier: GPL-2.0-or-later
"""The engines that move a membrane."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from yade import wrapper as yade

from ..parameters import SceneParameters, SceneParts, attributes
from ..progress import warn
from . import contacts, hub, spool

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

    membrane: Any
    forces: Any
    field: Any
    rotation: Any
    spool: Any
    newton: Any
    ledger: Any
    watch: Any = None
    resetter: Any = None
    driven: list = field(default_factory=list)
    hub: Any = None

    def positions(self) -> np.ndarray:
        """Present positions of the nodes, (N, 3) [m]."""
        bodies = yade.Omega().bodies
        return np.array([bodies[i].state.pos for i in self.membrane.bodyIds])

    def place(self, positions: np.ndarray) -> None:
        """Put the nodes at `positions` (N, 3) [m]."""
        bodies = yade.Omega().bodies
        for i, x in zip(self.membrane.bodyIds, positions.tolist()):
            bodies[i].state.pos = x

    @property
    def fused(self) -> bool:
        """Whether the nodes are moved by a MembraneIntegrator."""
        return hasattr(self.forces, "exchangePeriod")

    def last_positions(self) -> np.ndarray:
        """Positions of the nodes as the last step's forces saw them, (N, 3) [m]."""
        return np.frombuffer(self.forces.lastPositionsBytes()).reshape(-1, 3)

    def masses(self) -> np.ndarray:
        """Masses of the nodes, (N,) [kg]."""
        return np.array(self.membrane.masses)

    def hold(self, nodes: Iterable[int], held: bool = True) -> None:
        """Hold `nodes` (ids in the mesh) where they are; `held` False: let them go."""
        bodies, ids = yade.Omega().bodies, self.membrane.bodyIds
        for node in nodes:
            bodies[ids[node]].state.blockedDOFs = "xyzXYZ" if held else "XYZ"


def set_engines(
    membrane: Any,
    parameters: SceneParts = SceneParameters(),
    *,
    driven: Sequence[int] = (),
    touching: Sequence[int] = (),
) -> MembraneScene:
    """Set O.engines to those that a membrane needs; each that a scene does without is left out.

    Parameters
    ----------
    membrane : Membrane
    parameters : SceneParameters or RunParameters
        Of creases, air, hub and engines, and the damping. On path "law2" sides are interactions,
        nodes move by NewtonIntegrator: the reference. On path "fused" a MembraneIntegrator does the
        same, several times faster, and the membrane's interactions are removed; the ledger's
        energies are brought up to date as seldom as bodies, but at least every LEDGER_PERIOD
        steps, for the watch.
    driven : sequence of int
        Ids of bodies that turn about z: spool facets, ends of tethers. With hub_inertia > 0 they
        belong to a hub that turns freely, a FreeHub, and begins at omega.
    touching : sequence of int
        Ids of the membrane's bodies that touch other bodies: any sphere, facet, wall or box of
        material FrictMat, now or later, by YADE's usual contact. Nodes do not touch one another.
        Empty: no collider at all.

    Returns
    -------
    MembraneScene

    Raises
    ------
    ValueError
        Naming the body that is not a node, or could not be touched.
    """
    p, scene = parameters, yade.Omega()
    others = []
    if len(scene.bodies) > len(membrane.bodyIds):
        others = sorted({body.id for body in scene.bodies}.difference(membrane.bodyIds))
    _check_touching(membrane, touching, [i for i in others if i not in driven])
    _settle_sides(membrane, p.path)
    if touching:
        contacts.check(others, INTEGRATED)
        for body in (scene.bodies[i] for i in touching):
            body.bounded, body.mask = True, TOUCHING_MASK

    fused = p.path == "fused"
    forces = _forces(membrane, p)
    gravity = (0, 0, -p.gravity)
    facets = [i for i in driven if isinstance(scene.bodies[i].shape, yade.Facet)]
    turning = spool.turning(facets, touching, p.omega)
    turned = sorted(set(driven).difference(facets))
    free = None
    if p.hub_inertia > 0:
        free = hub.add(forces, turned, turning, p.hub_inertia, p.omega)
        turned = []  # the hub turns them
    loop = _interaction_loop(membrane, fused, touching)
    newton = yade.NewtonIntegrator(damping=0, gravity=gravity, mask=INTEGRATED)
    # With no other body that moves, a fused membrane needs none of YADE's loops over bodies.
    newton.dead = fused and not set(others).difference(facets)
    period = min(p.exchange_period, LEDGER_PERIOD) if fused else 1
    ledger = yade.MembraneLedger(forces=forces, gravity=gravity, period=period)
    watch = None
    if p.energy_tolerance > 0:
        watch = yade.MembraneWatch(ledger=ledger, tolerance=p.energy_tolerance)
    made = MembraneScene(
        membrane=membrane,
        forces=forces,
        field=yade.CentrifugalField(membrane=membrane, omega=p.omega, dead=True),
        rotation=_rotation(turned, p.omega),
        spool=turning,
        newton=newton,
        ledger=ledger,
        watch=watch,
        resetter=yade.ForceResetter(dead=newton.dead and not loop),
        driven=list(driven),
        hub=free,
    )
    collider = contacts.collider(TOUCHING_MASK) if touching else None
    first = made.resetter, turning, collider, made.rotation, loop, made.field
    scene.engines = [e for e in (*first, forces, newton, free, ledger, watch) if e is not None]
    return made


def _check_touching(membrane, touching, others):
    """Refuse bodies that are not nodes; warn of `others` that nothing would touch."""
    strangers = set(touching).difference(membrane.bodyIds)
    if strangers:
        raise ValueError(
            f"set_engines: touching: body #{min(strangers)} is not a node of the membrane"
        )
    untouched = [i for i in others if yade.Omega().bodies[i].bounded]
    if untouched and not touching:
        warn(f"nothing of the membrane touches body #{untouched[0]}: name nodes in `touching`")


def _settle_sides(membrane, path):
    """Sides are interactions on path "law2" only."""
    if path == "fused":
        membrane.removeInteractions()
        return
    if not membrane.hasInteractions:
        membrane.addInteractions()
    for body in (yade.Omega().bodies[i] for i in membrane.bodyIds):
        if body.mask == NODE_MASK:  # a MembraneIntegrator had them
            body.mask = 1


def _forces(membrane, p):
    """The forces engine of a path, with the attributes that parameters `p` set."""
    kinds = ["MembraneForceEngine", *(["MembraneIntegrator"] if p.path == "fused" else [])]
    values = {name: value for kind in kinds for name, value in attributes(kind, p).items()}
    return getattr(yade, kinds[-1])(membrane=membrane, **values)


def _rotation(bodies, omega):
    """Engine that turns bodies about z."""
    return yade.RotationEngine(
        ids=bodies,
        angularVelocity=omega,
        rotationAxis=(0, 0, 1),
        rotateAroundZero=True,
        zeroPoint=(0, 0, 0),
        dead=not bodies,
    )


def _interaction_loop(membrane, fused, touching):
    """YADE's loop over sides and contacts; None where there are neither."""
    if fused and not touching:
        return None
    # Also where the sides are no interactions: should they become some, YADE would end for want of
    # these, before the forces engine can refuse them.
    geometry = [yade.Ig2_MembraneNode_MembraneNode_MembraneGeom()]
    laws = [yade.Law2_MembraneGeom_MembranePhys_Buckling()]
    physics = [] if fused else [yade.Ip2_MembraneMat_MembraneMat_MembranePhys(membrane=membrane)]
    if touching:
        geometry = [*contacts.geometry(), *geometry]
        physics.append(yade.Ip2_FrictMat_FrictMat_FrictPhys())
        # A facet's torque must be that about its place: a FreeHub takes it.
        laws.append(yade.Law2_ScGeom_FrictPhys_CundallStrack(sphericalBodies=False))
    return yade.InteractionLoop(geometry, physics, laws)


def renew_collider() -> None:
    """Put a new collider in the place of the one that `set_engines` made, if any.

    It counts how often it was loaded: otherwise two saves of the same state would differ.
    """
    omega = yade.Omega()
    old = yade.InsertionSortCollider
    omega.engines = [
        contacts.collider(TOUCHING_MASK) if isinstance(e, old) else e for e in omega.engines
    ]


def loaded() -> MembraneScene:
    """The MembraneScene of a scene that `set_engines` made and O.load brought back.

    Its only membrane counts; `driven` lists bodies as its engines do.
    """
    found: dict[str, Any] = {}
    for engine in yade.Omega().engines:
        found.setdefault(type(engine).__name__, engine)
    forces = found.get("MembraneIntegrator") or found["MembraneForceEngine"]
    rotation, turning = found["RotationEngine"], found["SpoolRotation"]
    free = found.get("FreeHub")
    on_hub = [forces.membrane.bodyIds[node] for node in free.nodes] if free else []
    return MembraneScene(
        membrane=forces.membrane,
        forces=forces,
        field=found["CentrifugalField"],
        rotation=rotation,
        spool=turning,
        newton=found["NewtonIntegrator"],
        ledger=found["MembraneLedger"],
        watch=found.get("MembraneWatch"),
        resetter=found["ForceResetter"],
        driven=[*turning.ids, *rotation.ids, *on_hub],
        hub=free,
    )


def sort_interactions() -> None:
    """Let YADE take interactions one by one in the order of their ids, which costs time.

    Then a saved scene goes on bit for bit also while tethers touch the spool, and sides that are
    interactions add up alike in every run: several threads would share them out by chance.
    """
    for engine in yade.Omega().engines:
        if isinstance(engine, yade.InteractionLoop):
            engine.loopOnSortedInteractions = True
            engine.ompThreads = 1
