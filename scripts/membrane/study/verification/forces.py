# SPDX-License-Identifier: GPL-2.0-or-later
"""Every force of the plugin against reference/forces.py and against differences of its energy.

The sail of the paper, tethers and tip masses with it, stands in random states (fixed seeds): flat,
crumpled, buckled, folded, each turned somewhere. A second sail has its nodes moved about in the
flat state, so that neighbouring triangles differ in height. Nothing moves: the engines run without
an integrator and what they add to O.forces is read.
"""

from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import membrane
import numpy as np
from membrane import scene
from membrane.mesh import sail_mesh, tip_masses
from membrane.mesh.fold import fold
from numpy.typing import ArrayLike
from yade import wrapper as yade

from ..sources import paper
from . import Check, at_most, recorded

YOUNG, POISSON, DENSITY, THICKNESS = 3.2e9, 0.34, 1420.0, 7.5e-6
ALPHA, ALPHA_CREASE = 100.0, 1000.0
CABLE_STIFFNESS, CABLE_DENSITY = 200.0, 2e-4
TIP_MASS = 0.36e-3
BETA, GAMMA, ZETA, AIR_DENSITY = 30.0, 100.0, 0.02, 1.2e-3
OMEGA = 6 * np.pi
TURNED = 0.9  # another natural angle [rad]
STRONG = 1.0  # damping ratio at which tethers would push

AGREEMENT = 1e-12  # of plugin and reference, over the largest value
SHORTENING = 1e-11  # the same for L0 - l_cr: 1e-4 of the lengths, whose last digit is 2e-12 of it
DIFFERENCE = 1e-8  # of force and difference of energy, over the largest force
STRAIN_STEP, CREASE_STEP, FIELD_STEP = 1e-6, 5e-6, 1e-3  # of those differences [m]
LOWEST = 2e-3  # height [m] of a crease's triangles under which that step is too long
STRETCH = 3e-3  # of tethers of the flat sail
ASKED = 500  # nodes of each state at which energies are differenced
# Two bounds of the README's assumptions act at some nodes only. These are told apart from all
# others, each compared over its own largest force, and there the bounds' effect is recorded: on
# levers of creases whose height or length is collapsed, and on the damping of tethers that shorten
# so fast that it exceeds their tension.
CREASES, DAMPING = "creases (7), (8), {}, theta0 {:g}", "damping (9), zeta {:g}"
TOGETHER = "all together, zeta {:g}"
HEIGHTS = ("height_c", "height_d")
AT_COLLAPSED, AT_PUSHED = ", at collapsed creases", ", at tethers it would push"
AT_EITHER, EFFECT = ", at either", ": effect of the bound"

Options = dict[str, tuple[dict, tuple[int, ...]]]  # of the sail, and seeds, by its name
Pairs = dict[str, tuple[Any, Any]]  # by title: the plugin's, the reference's

FAST: Options = {"sail": ({}, (0,)), "uneven sail": ({"jitter": 3e-3}, (0,))}
FULL: Options = {
    "sail": ({}, (0, 1, 2)),
    "uneven sail": ({"jitter": 3e-3}, (0, 1, 2)),
    "sail, refine 2": ({"refine": 2}, (0,)),
}
# Effects of the bounds when last looked at, in the states of FAST and of FULL; how often they act.
LAST_EFFECTS = {
    DAMPING.format(STRONG) + AT_PUSHED + EFFECT: (0.5153, 0.6109),
    CREASES.format("paper", 0) + AT_COLLAPSED + EFFECT: (0.5930, 0.5960),
    CREASES.format("paper", TURNED) + AT_COLLAPSED + EFFECT: (0.5930, 0.5960),
    CREASES.format("conservative", 0) + AT_COLLAPSED + EFFECT: (0.8826, 0.8826),
    CREASES.format("conservative", TURNED) + AT_COLLAPSED + EFFECT: (0.8824, 0.8824),
    "creases of bounded length: share": (0.003053, 0.002599),
    "creases of bounded height: share": (0.004884, 0.004084),
    "tethers pushed: share": (0.2719, 0.2494),
}
CHANGE = 0.1  # of those numbers, from which on they are no longer the same


@dataclass
class State:
    """Positions (N, 3) [m] and velocities (N, 3) [m/s] of the sail's nodes."""

    positions: np.ndarray
    velocities: np.ndarray


class StandingSail:
    """The paper's sail in the scene, and the same data for the reference.

    `jitter` [m]: so far do nodes of the film lie from their place in the flat `mesh`, in `rest`
    (N, 3) [m]. By the reference: rest `lengths` and `critical` ones [m] and `stiffness` [N/m] (S,)
    of the `sides` (S, 2), of which some are a `cable` (S,); `masses` (N,) [kg]; `creases` (C, 4),
    nodes A, B, C, D, and `inside` (C,), as paper.crease_angle wants it.
    """

    def __init__(self, jitter: float = 0.0, refine: int = 1) -> None:
        self.omega = yade.Omega()
        self.omega.reset()
        self.mesh = mesh = sail_mesh(refine=refine)
        self.rest = mesh.nodes.copy()
        rng = np.random.default_rng(7)
        self.rest[: mesh.film_size, :2] += jitter * rng.uniform(-1, 1, (mesh.film_size, 2))
        point_masses = tip_masses(mesh, TIP_MASS)
        self.net = scene.add_membrane(
            self.rest,
            mesh.triangles,
            mesh.creases,
            mesh.crease_signs,
            mesh.cables,
            material=scene.film(YOUNG, POISSON, DENSITY, THICKNESS),
            pointMasses=point_masses.tolist(),
            alpha=ALPHA,
            alphaCrease=ALPHA_CREASE,
            cableStiffness=CABLE_STIFFNESS,
            cableDensity=CABLE_DENSITY,
        )
        self.states = [self.omega.bodies[i].state for i in self.net.bodyIds]
        self.loop = yade.InteractionLoop(
            [membrane.Ig2_MembraneNode_MembraneNode_MembraneGeom()],
            [membrane.Ip2_MembraneMat_MembraneMat_MembranePhys(membrane=self.net)],
            [membrane.Law2_MembraneGeom_MembranePhys_Buckling()],
        )
        self._ask_the_reference(point_masses)

    def _ask_the_reference(self, point_masses):
        mesh, rest = self.mesh, self.rest
        self.sides = np.array(self.net.sides)
        shares = paper.side_stiffness(rest, mesh.triangles, YOUNG, POISSON, THICKNESS)
        pairs, cables, creased = (
            [tuple(sorted(pair)) for pair in ends.tolist()]
            for ends in (self.sides, mesh.cables, mesh.creases)
        )
        if sorted(pairs) != sorted({*shares, *cables}):
            raise RuntimeError("the plugin's sides are not those of the triangles and the cables")
        self.cable = np.array([pair in cables for pair in pairs])
        _, self.lengths = paper.side_geometry(rest, self.sides)
        self.stiffness = CABLE_STIFFNESS / self.lengths
        self.stiffness[~self.cable] = [shares[pair] for pair in pairs if pair not in cables]
        alpha = np.where([pair in creased for pair in pairs], ALPHA_CREASE, ALPHA)
        self.critical = paper.critical_length(self.lengths, alpha * ~self.cable, THICKNESS)
        self.masses = (
            paper.node_masses(rest, mesh.triangles, DENSITY, THICKNESS)
            + paper.cable_masses(rest, mesh.cables, CABLE_DENSITY)
            + point_masses
        )
        self.creases = paper.crease_nodes(mesh.triangles, mesh.creases)
        # Triangles run counter-clockwise seen from above, where a mountain sticks out.
        self.inside = -mesh.crease_signs

    def shapes(self) -> list[str]:
        """Names of the SHAPES that this sail can take; the folded one is made for the even mesh."""
        return [name for name in SHAPES if name != "folded" or np.all(self.rest == self.mesh.nodes)]

    def place(self, state: State) -> None:
        """Put the bodies into a State."""
        for body, x, v in zip(self.states, state.positions.tolist(), state.velocities.tolist()):
            body.pos, body.vel = x, v

    def forces(self, *engines: yade.Engine) -> np.ndarray:
        """Forces (N, 3) [N] that engines add in the present state."""
        self.omega.engines = [yade.ForceResetter(), *engines]
        self.omega.step()
        return np.array([self.omega.forces.f(i, True) for i in self.net.bodyIds])

    def engine(self, **options: Any) -> membrane.MembraneForceEngine:
        """A MembraneForceEngine of this sail."""
        return membrane.MembraneForceEngine(membrane=self.net, forceTimeStep=True, **options)


# --- states ---


def turned(rng: np.random.Generator, positions: np.ndarray) -> np.ndarray:
    """Positions (N, 3) [m] turned at random and moved by some centimetres."""
    matrix, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    matrix *= np.sign(np.linalg.det(matrix))
    return positions @ matrix.T + 0.05 * rng.normal(size=3)


def flat(sail: StandingSail, rng: np.random.Generator) -> np.ndarray:
    """The flat sail, its nodes off by a tenth of a millimetre, those of tethers by a micrometre.

    Tethers are stretched by so much that the last digit of a length is 1e-13 of the tension.
    """
    off = np.full((len(sail.rest), 1), 1e-4)
    moved = sail.rest.copy()
    for tether in sail.mesh.cables.reshape(4, -1, 2):
        nodes, corner = tether[:, 0], tether[-1, 1]
        off[[*nodes, corner]] = 1e-6
        moved[nodes] += STRETCH * (sail.rest[nodes] - sail.rest[corner])
    return moved + off * rng.normal(size=moved.shape)


def crumpled(sail: StandingSail, rng: np.random.Generator) -> np.ndarray:
    """Nodes off by a quarter of a cell: creases at any angle."""
    return sail.rest + 5e-3 / sail.mesh.refine * rng.normal(size=sail.rest.shape)


def buckled(sail: StandingSail, rng: np.random.Generator) -> np.ndarray:
    """Compressed by 3 %, stretched by 1 % across, with waves out of the plane."""
    x, y, _ = sail.rest.T
    waves = 4e-3 * np.sin(2 * np.pi * x / 0.07) * np.cos(2 * np.pi * y / 0.11)
    bent = np.column_stack([0.97 * x, 1.01 * y, waves])
    return bent + 1e-5 * rng.normal(size=bent.shape)


def folded(sail: StandingSail, rng: np.random.Generator) -> np.ndarray:
    """The folded sail, shaken by as much as its layers lie apart: some pass through each other."""
    return fold(sail.mesh) + 1e-4 * rng.normal(size=sail.rest.shape)


def collapsed(sail: StandingSail, rng: np.random.Generator) -> np.ndarray:
    """The flat sail with some creases whose C is almost on AB, and some with B almost at A."""
    moved = flat(sail, rng)
    chosen = sail.creases[:: len(sail.creases) // 9]
    frame = paper.crease_frame(moved, chosen)
    for index, (a, b, c, _) in enumerate(chosen):
        if index % 2:
            moved[b] = moved[a] + 0.02 * (moved[b] - moved[a])
        else:
            moved[c] -= 0.98 * frame["height_c"][index] * frame["up_c"][index]
    return moved


SHAPES = {shape.__name__: shape for shape in (flat, crumpled, buckled, folded, collapsed)}


def random_state(sail: StandingSail, shape: str, seed: int = 0) -> State:
    """State of one of SHAPES, turned, with velocities of some metres a second."""
    rng = np.random.default_rng([seed, list(SHAPES).index(shape)])
    positions = turned(rng, SHAPES[shape](sail, rng))
    return State(positions, 3.0 * rng.normal(size=positions.shape))


# --- plugin against reference ---


def difference(found: ArrayLike, expected: ArrayLike) -> float:
    """Largest difference of two arrays over the largest value of the expected one [-]."""
    found, expected = np.asarray(found), np.asarray(expected)
    largest = np.abs(expected).max()
    if found.shape != expected.shape or not largest > 0:
        raise RuntimeError(f"nothing to compare: {found.shape}, {expected.shape}, {largest}")
    return float(np.abs(found - expected).max() / largest)


def rest_pairs(sail: StandingSail) -> Pairs:
    """What follows from the rest state: {title: (plugin's, reference's)}."""
    net = sail.net
    shortening = np.array(net.restLengths) - net.criticalLengths
    return {
        "masses of nodes (4)": (net.masses, sail.masses),
        "masses of bodies (4)": ([state.mass for state in sail.states], sail.masses),
        "rest lengths": (net.restLengths, sail.lengths),
        "stiffnesses (5)": (net.stiffnesses, sail.stiffness),
        "L0 - l_cr (6)": (shortening, sail.lengths - sail.critical),
    }


def scalar_pairs(sail: StandingSail, state: State) -> Pairs:
    """Tensions, angles and energies in a State: {title: (plugin's, reference's)}."""
    sail.place(state)
    x = state.positions
    _, length = paper.side_geometry(x, sail.sides)
    springs = length, sail.lengths, sail.critical, sail.stiffness
    angles = paper.crease_angle(x, sail.creases, sail.inside)
    pairs = {
        "tensions (3), (6)": (sail.net.tensions(), paper.side_tension(*springs)),
        "strain energy": (sail.net.elasticEnergy(), paper.side_energy(*springs).sum()),
        "crease angles": (sail.engine(beta=BETA).creaseAngles(), angles),
    }
    for theta0 in (0.0, TURNED):
        film = YOUNG, THICKNESS, BETA, GAMMA, theta0
        expected = paper.crease_energy(x, sail.rest, sail.creases, sail.inside, *film).sum()
        engine = sail.engine(beta=BETA, gamma=GAMMA, theta0=theta0, creaseLaw="conservative")
        pairs[f"crease energy, theta0 {theta0:g}"] = (engine.creaseEnergy(), expected)
    return pairs


def collapsed_creases(
    sail: StandingSail, state: State, names: Sequence[str] = ("length", *HEIGHTS)
) -> np.ndarray:
    """Which creases (C,) bool of a State are collapsed: one of these names is bounded."""
    now = paper.crease_frame(state.positions, sail.creases)
    rest = paper.crease_frame(sail.rest, sail.creases)
    shares = [now[name] / rest[name] for name in names]
    return np.min(shares, axis=0) < paper.COLLAPSED


def crease_pairs(sail: StandingSail, state: State, **bound: Any) -> Pairs:
    """Forces (N, 3) [N] of the creases by both laws: {title: (plugin's, reference's)}.

    bound: nothing, or `collapsed` of the reference.
    """
    sail.place(state)
    pairs = {}
    for law in ("paper", "conservative"):
        function = getattr(paper, f"crease_forces_{law}")
        for beta, gamma, theta0 in ((BETA, GAMMA, 0.0), (3.0, 7.0, TURNED)):
            engine = sail.engine(beta=beta, gamma=gamma, theta0=theta0, creaseLaw=law)
            film = YOUNG, THICKNESS, beta, gamma, theta0
            places = state.positions, sail.rest, sail.creases, sail.inside
            expected = function(*places, *film, **bound)
            pairs[CREASES.format(law, theta0)] = (sail.forces(engine), expected)
    return pairs


def damping_pairs(sail: StandingSail, state: State, **bound: Any) -> Pairs:
    """Forces (N, 3) [N] of damping: {title: (plugin's, reference's)}.

    bound: nothing, or `may_push` of the reference.
    """
    sail.place(state)
    pairs = {}
    for zeta in (ZETA, STRONG):
        sides = sail.sides, sail.lengths, sail.stiffness, sail.masses, zeta, sail.cable
        expected = paper.damping_forces(state.positions, state.velocities, *sides, **bound)
        pairs[DAMPING.format(zeta)] = (sail.forces(sail.engine(zeta=zeta)), expected)
    return pairs


def force_pairs(sail: StandingSail, state: State) -> Pairs:
    """Forces (N, 3) [N] of each term in a State: {title: (plugin's, reference's)}."""
    sail.place(state)
    x, v = state.positions, state.velocities
    sides = paper.side_forces(x, sail.sides, sail.lengths, sail.critical, sail.stiffness)
    damping = damping_pairs(sail, state)
    drag = paper.drag_forces(x, v, sail.mesh.triangles, AIR_DENSITY)
    creases = crease_pairs(sail, state)
    pairs = {
        "sides (3), (6)": (sail.forces(sail.loop), sides),
        **creases,
        **damping,
        "drag (10)": (sail.forces(sail.engine(airDensity=AIR_DENSITY)), drag),
    }
    for zeta in (ZETA, STRONG):
        everything = sail.engine(beta=BETA, gamma=GAMMA, zeta=zeta, airDensity=AIR_DENSITY)
        added = creases[CREASES.format("paper", 0)], damping[DAMPING.format(zeta)]
        total = sides + drag + sum(expected for _, expected in added)
        pairs[TOGETHER.format(zeta)] = (sail.forces(sail.loop, everything), total)
    return pairs


def pushed_tethers(sail: StandingSail, state: State, zeta: float) -> np.ndarray:
    """Which sides (S,) bool are taut tethers whose damping by zeta would exceed their tension."""
    direction, length = paper.side_geometry(state.positions, sail.sides)
    ends = state.velocities[sail.sides]
    rate = paper.dot(ends[:, 1] - ends[:, 0], direction)
    damping = rate * paper.damping_coefficient(sail.stiffness, sail.masses, sail.sides, zeta)
    tension = paper.side_tension(length, sail.lengths, sail.critical, sail.stiffness)
    return sail.cable & (length > sail.lengths) & (tension + damping < 0)


def bounded_nodes(sail: StandingSail, state: State, title: str) -> tuple[np.ndarray, str]:
    """Where bounds act on the forces of a `title` in a State: nodes (N,) bool, and their name."""
    nodes = np.arange(len(sail.rest))
    low = np.isin(nodes, sail.creases[collapsed_creases(sail, state)])
    if title.startswith("creases"):
        return low, AT_COLLAPSED
    for zeta in (ZETA, STRONG):
        if title in (DAMPING.format(zeta), TOGETHER.format(zeta)):
            pushed = np.isin(nodes, sail.sides[pushed_tethers(sail, state, zeta)])
            alone = title == DAMPING.format(zeta)
            return (pushed, AT_PUSHED) if alone else (low | pushed, AT_EITHER)
    return np.zeros(len(nodes), dtype=bool), ""


def state_differences(sail: StandingSail, state: State) -> dict[str, float]:
    """Differences of plugin and reference in a State: {title: [-]}.

    Forces at nodes where bounds act are told apart from the others.
    """
    differences = {title: difference(*pair) for title, pair in scalar_pairs(sail, state).items()}
    for title, (found, expected) in force_pairs(sail, state).items():
        there, where = bounded_nodes(sail, state, title)
        differences[title] = difference(found[~there], expected[~there])
        if there.any():
            differences[title + where] = difference(found[there], expected[there])
    return differences


def bound_effects(sail: StandingSail, state: State) -> dict[str, float]:
    """What the bounds change in a State where they act: {title: [-]}.

    The largest difference of the plugin's forces and those of the equations, without bounds, over
    the largest of the latter at these nodes.
    """
    pairs = crease_pairs(sail, state, collapsed=0.0) | damping_pairs(sail, state, may_push=True)
    effects = {}
    for title, (found, without) in pairs.items():
        there, where = bounded_nodes(sail, state, title)
        if there.any():
            effects[title + where + EFFECT] = difference(found[there], without[there])
    return effects


def law_difference(sail: StandingSail) -> float:
    """Difference [-] of the two crease laws in the flat rest state, natural angle 0."""
    sail.place(State(sail.rest, np.zeros_like(sail.rest)))
    engines = (sail.engine(beta=BETA, creaseLaw=law) for law in ("paper", "conservative"))
    return difference(*(sail.forces(engine) for engine in engines))


def branches(sail: StandingSail, state: State) -> dict[str, int]:
    """How many sides and creases a State has on each branch of their laws."""
    _, length = paper.side_geometry(state.positions, sail.sides)
    theta = paper.crease_angle(state.positions, sail.creases, sail.inside)
    below = length < sail.critical
    found = {
        "sides stretched": np.sum(~sail.cable & ~below),
        "sides buckled": np.sum(~sail.cable & below),
        "tethers taut": np.sum(sail.cable & ~below),
        "tethers slack": np.sum(sail.cable & below),
        "creases open": np.sum((theta > 0) & (theta < np.pi)),
        "creases passed through": np.sum(theta < 0),
        "creases beyond flat": np.sum(theta > np.pi),
        "creases of bounded length": np.sum(collapsed_creases(sail, state, ["length"])),
        "creases of bounded height": np.sum(collapsed_creases(sail, state, HEIGHTS)),
        "tethers pushed": np.sum(pushed_tethers(sail, state, STRONG)),
    }
    return {branch: int(count) for branch, count in found.items()}


# --- forces against differences of energy ---


def gradient(
    sail: StandingSail, state: State, energy: Callable[[], float], nodes: np.ndarray, step: float
) -> np.ndarray:
    """Minus the gradient (n, 3) [N] of energy() [J] at `nodes` (n,), by moving bodies.

    Central differences of fourth order: those of one and of two `step` [m].
    """
    sail.place(state)
    forces = np.empty((len(nodes), 3))
    for (row, node), axis in product(enumerate(nodes), range(3)):
        at = {}
        for steps in (-2, -1, 1, 2):
            moved = state.positions[node] + steps * step * np.eye(3)[axis]
            sail.states[node].pos = moved.tolist()
            at[steps] = energy()
        forces[row, axis] = -(8 * (at[1] - at[-1]) - (at[2] - at[-2])) / (12 * step)
        sail.states[node].pos = state.positions[node].tolist()
    return forces


def energy_difference(
    sail: StandingSail,
    state: State,
    engine: yade.Engine,
    energy: Callable[[], float],
    step: float,
    kinks: np.ndarray,
    most: int = ASKED,
) -> tuple[float, int]:
    """Error of an engine's forces against its energy [-], and the number of nodes asked.

    Not asked are the nodes `kinks`, across which differences by `step` [m] say nothing; of more
    others than `most`, only some.
    """
    sail.place(state)
    forces = sail.forces(engine)
    nodes = np.setdiff1d(np.arange(len(forces)), kinks)
    nodes = nodes[:: 1 + len(nodes) // most]
    return difference(forces[nodes], gradient(sail, state, energy, nodes, step)), len(nodes)


def side_kinks(sail: StandingSail, state: State) -> np.ndarray:
    """Nodes of sides whose energy has a kink nearby: they are about to buckle or become taut."""
    _, length = paper.side_geometry(state.positions, sail.sides)
    return sail.sides[np.abs(length - sail.critical) < 2.5 * STRAIN_STEP]


def crease_kinks(sail: StandingSail, state: State) -> np.ndarray:
    """Nodes of creases whose energy has a kink nearby, or whose triangles are too low."""
    frame = paper.crease_frame(state.positions, sail.creases)
    theta = paper.crease_angle(state.positions, sail.creases, sail.inside)
    lowest = np.minimum(frame["height_c"], frame["height_d"])
    # A node moves by two steps, which changes the angle by no more than:
    lever = 1 + np.max(np.abs([frame["foot_c"], frame["foot_d"]]), axis=0)
    reach = 5 * CREASE_STEP * lever / lowest
    cut = np.minimum(theta + 0.5 * np.pi, 1.5 * np.pi - theta)
    near = (np.abs(theta) < reach) | (cut < reach) | (lowest < LOWEST)
    return sail.creases[near | collapsed_creases(sail, state)]


def energy_differences(sail: StandingSail, state: State) -> dict[str, tuple[float, int]]:
    """{title: (error [-], number of nodes asked)} of all conservative forces in a State."""
    sides = sail.loop, sail.net.elasticEnergy, STRAIN_STEP, side_kinks(sail, state)
    found = {"sides": energy_difference(sail, state, *sides)}
    kinks = crease_kinks(sail, state)
    for theta0 in (0.0, TURNED):
        law = sail.engine(beta=BETA, gamma=GAMMA, theta0=theta0, creaseLaw="conservative")
        about: tuple = law, law.creaseEnergy, CREASE_STEP, kinks
        found[f"creases, conservative, theta0 {theta0:g}"] = energy_difference(sail, state, *about)
    field = membrane.CentrifugalField(membrane=sail.net, omega=OMEGA)
    about = field, field.energy, FIELD_STEP, np.array([]), 100
    found["centrifugal field"] = energy_difference(sail, state, *about)
    return found


# --- checks ---


Worst = dict[str, list[tuple]]  # by title: (error or effect [-], label of the state, …)


def bound_checks(full: bool, effects: Worst, seen: Counter, states: int) -> list[Check]:
    """Recorded checks of what the bounds change and how often they act in so many states.

    `seen` are the sums of `branches`.
    """
    numbers = {}
    for title, results in effects.items():
        effect, label = max(results)
        source = f"reference/forces.py without it; in {len(results)} of {states} states, most: "
        numbers[title] = effect, source + label
    creases = sum(seen[f"creases {at}"] for at in ("open", "passed through", "beyond flat"))
    for branch, of_all in (
        ("creases of bounded length", creases),
        ("creases of bounded height", creases),
        ("tethers pushed", seen["tethers taut"]),
    ):
        source = f"{seen[branch]} of {of_all}, in {states} states"
        numbers[f"{branch}: share"] = seen[branch] / of_all, source
    last = {title: LAST_EFFECTS[title][full] for title in numbers}
    return [
        recorded(title, value, last[title], CHANGE * last[title], source)
        for title, (value, source) in numbers.items()
    ]


def checks(full: bool) -> list[Check]:
    """Checks of all forces, over all sails and states; `full`, three seeds and a refined sail."""
    agreement: Worst = defaultdict(list)
    effects: Worst = defaultdict(list)
    energies: Worst = defaultdict(list)
    laws, states = {}, 0
    seen: Counter = Counter()
    for name, (options, seeds) in (FULL if full else FAST).items():
        sail = StandingSail(**options)
        laws[name] = law_difference(sail)
        for title, pair in rest_pairs(sail).items():
            agreement[title].append((difference(*pair), name))
        for shape, seed in product(sail.shapes(), seeds):
            state, label = random_state(sail, shape, seed), f"{name}, {shape}"
            for title, error in state_differences(sail, state).items():
                agreement[title].append((error, label))
            for title, effect in bound_effects(sail, state).items():
                effects[title].append((effect, label))
            for title, (error, asked) in energy_differences(sail, state).items():
                energies[title].append((error, label, asked))
            seen.update(branches(sail, state))
            states += 1
    empty = [branch for branch, count in seen.items() if not count]
    if empty:
        raise RuntimeError(f"the {states} states have no {', no '.join(empty)}")

    found = []
    for title, results in agreement.items():
        error, label = max(results)
        source = f"reference/forces.py; worst of {len(results)}: {label}"
        most = SHORTENING if title.startswith("L0") else AGREEMENT
        found.append(at_most(f"{title}: plugin - reference", error, most, source))
    found += bound_checks(full, effects, seen, states)
    for title, results in energies.items():
        error, label, _ = max(results)
        source = (
            f"central differences of energy at {sum(asked for *_, asked in results)} nodes "
            f"away from kinks; worst of {len(results)}: {label}"
        )
        found.append(at_most(f"{title}: force + gradient of energy", error, DIFFERENCE, source))
    even = max(error for name, error in laws.items() if not name.startswith("uneven"))
    source = "model.md: the laws agree where heights are equal and theta0 = 0"
    return [*found, at_most("creases, flat: paper - conservative", even, AGREEMENT, source)]
