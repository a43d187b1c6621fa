# SPDX-License-Identifier: GPL-2.0-or-later
"""The film of plane stress and tension field, and arms on a hub, against closed forms.

Membranes settle in YADE, by the fused engine with local damping, until their forces balance; the
reactions of the nodes that are held are compared with closed forms of wrinkled membranes. Forces
in all states of the film are compared with reference/forces.py.
"""

from collections.abc import Mapping
from math import log, pi, radians, sqrt

import numpy as np
from membrane import scene
from membrane.mesh import sheet_mesh
from membrane.mesh.fold import fold
from yade import wrapper as yade

from ..sources import paper
from . import Check, at_most, order, sheets
from .forces import StandingSail

YOUNG, POISSON, DENSITY, THICKNESS = 3.2e9, 0.34, 1420.0, 7.5e-6
STIFF = YOUNG * THICKNESS  # [N/m]
SMALL = 1e-5  # strains, so that the closed forms of small strains hold
BALANCED = 1e-5  # forces that are left, over the largest: slack film is long in coming to rest
CELLS, FAST_CELLS = (10, 20, 40), (10, 20)
STRIPS = (0.2, 0.3, 0.4, 0.45)  # M / (P H)
# a / b: w(b) spin^2 / g. Of 0.05 and 0.1 the small cells at the hub take too many steps.
DISKS = {0.2: 1.7059, 0.5: 0.6873}

Held = Mapping[int, str]  # directions in which a node is held, as "xz"


def settle(
    nodes: np.ndarray,
    triangles: np.ndarray,
    places: np.ndarray,
    held: Held,
    omega: float = 0.0,
    gravity: float = 0.0,
    balanced: float = BALANCED,
    **film: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Positions (N, 3) [m] at rest and what the film's forces (N, 3) [N] there are.

    From `places` (N, 3) [m], in a frame that turns at omega [rad/s], under gravity [m/s2] along
    -z. RuntimeError if forces do not balance in a million steps.
    """
    world = yade.Omega()
    world.reset()
    net = scene.add_membrane(
        nodes, triangles, positions=places, interactions=False, film="plane_stress", **film
    )
    about: dict = {"path": "fused", "exchange_period": 1000, "energy_tolerance": 0}
    made = scene.set_engines(net, scene.SceneParameters(omega=omega, gravity=gravity, **about))
    made.ledger.dead, made.newton.damping = True, 0.3
    made.field.dead = not omega
    bodies = [world.bodies[i] for i in net.bodyIds]
    free = np.ones((len(nodes), 3), dtype=bool)
    for node, directions in held.items():
        bodies[node].state.blockedDOFs = directions + "XYZ"
        free[node] = [axis not in directions for axis in "xyz"]
    world.dt = 0.7 * made.forces.criticalTimeStep()
    masses = np.array(net.masses)[:, None]
    for _ in range(500):
        scene.advance(2000)
        x = made.positions()
        forces = film_forces(net, x)
        outside = masses * (omega**2 * x * [1, 1, 0] - [0, 0, gravity])
        left = np.abs((forces + outside)[free]).max()
        if left < balanced * np.abs(forces).max():
            return x, forces
    raise RuntimeError(f"film: {left:.1e} N of {np.abs(forces).max():.1e} N do not balance")


def film_forces(net: yade.Membrane, x: np.ndarray) -> np.ndarray:
    """Forces (N, 3) [N] of a membrane's sides and film on its nodes at positions (N, 3) [m]."""
    sides = np.array(net.sides)
    direction, _ = paper.side_geometry(x, sides)
    return paper.pull_together(len(x), sides, direction, np.array(net.tensions(x)))


# --- a strip pulled and bent in its plane ---


def bent_strip(ratio: float, cells: int) -> float:
    """Error of E h H2 curvature / (2 P) of a strip, with M / (P H) about `ratio` [-].

    Its ends are turned rigidly about the line at which it becomes slack; so many cells are taut.
    """
    height, columns = 0.1, 4
    slack = (3 * ratio - 0.5) * height
    cells = round(cells / (1 - slack / height))
    nodes, triangles = sheet_mesh(cells + 1, columns + 1, height / cells)
    x, y, _ = nodes.T
    curvature = SMALL / (height - slack)
    places = nodes + np.column_stack([x * curvature * (y - slack), 0 * x, 0 * x])
    ends = np.flatnonzero((x == 0) | (x == x.max()))
    held = {**dict.fromkeys(range(len(nodes)), "z"), **dict.fromkeys(ends.tolist(), "xz")}
    _, forces = settle(nodes, triangles, places, held)
    pulled = -forces[x == x.max(), 0]
    tension = pulled.sum()
    moment = pulled @ (y[x == x.max()] - height / 2)
    found = STIFF * height**2 * curvature / (2 * tension)
    return found * (1.5 - 3 * moment / (tension * height)) ** 2 - 1


# --- rings ---


def ring(inner: float, outer: float, cells: int, around: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (N, 3) [m], circle by circle from the inner one, and triangles (T, 3) of a ring.

    Cells grow with the radius; diagonals run either way by turns.
    """
    radii = np.geomspace(inner, outer, cells + 1)
    angles = 2 * pi * np.arange(around) / around
    radius, angle = (axis.ravel() for axis in np.meshgrid(radii, angles, indexing="ij"))
    nodes = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), 0 * radius])
    i, j = (axis.ravel() for axis in np.mgrid[:cells, :around])
    a, d = i * around + j, i * around + (j + 1) % around
    b, c = a + around, d + around
    return nodes, sheets.halves((a, b, c, d), (i + j) % 2 == 1)


def pulled_ring(outer: float, pull: float, cells: int) -> tuple[float, float]:
    """Errors of the pull on both edges of a ring from radius 1, wrinkled within a circle.

    `pull` [N/m] at the inner edge for 1 N/m at the outer one, scaled to small strains; both edges
    take the displacements of the closed form.
    """
    ratio = 1 / pull
    edge = outer**2 * (ratio - sqrt(ratio**2 - 1 / outer**2))
    scale = SMALL * STIFF / pull
    inward = -pull * scale / STIFF * (POISSON + log(edge))
    hoop = (1 - (edge / outer) ** 2) / (1 + (edge / outer) ** 2)
    outward = outer * scale / STIFF * (hoop - POISSON)
    around = 4 * cells
    nodes, triangles = ring(1.0, outer, cells, around)
    radius = np.linalg.norm(nodes, axis=1)
    moved = inward + (outward - inward) * (radius - 1) / (outer - 1)
    places = nodes * (1 + moved / radius)[:, None]
    edges = {**dict.fromkeys(range(around), "xyz")}
    edges |= dict.fromkeys(range(len(nodes) - around, len(nodes)), "xyz")
    held = {**dict.fromkeys(range(len(nodes)), "z"), **edges}
    _, forces = settle(nodes, triangles, places, held)
    radial = np.einsum("ij,ij->i", forces, nodes) / radius
    inner_pull = radial[:around].sum() / (2 * pi)
    outer_pull = -radial[-around:].sum() / (2 * pi * outer)
    return inner_pull / (pull * scale) - 1, outer_pull / scale - 1


def hanging_disk(ratio: float, cells: int) -> float:
    """w(b) spin^2 / g [-] of a disk that is clamped on a hub of `ratio` its radius and spins."""
    radius, omega = 0.2, 240.0  # strains of 1e-3
    gravity = 1e-3 * radius * omega**2 / DISKS[ratio]
    nodes, triangles = ring(ratio * radius, radius, cells, 4 * cells)
    held = dict.fromkeys(range(4 * cells), "xyz")
    x, _ = settle(nodes, triangles, nodes, held, omega, gravity, 1e-7, bucklingLength=1e-5)
    return float(-x[-4 * cells :, 2].mean() * omega**2 / gravity)


# --- arms of a tether and a mass on a hub ---


def swung(
    spin: float, angle: float, arms: int, inertia: float, duration: float
) -> tuple[float, float, float, float]:
    """When arms first lie along the radius [s]; how far they go to the other side [rad]; the
    least and the largest spin of the hub [rad/s].

    Arms of 10 m with 1 kg begin at rest to the hub, at an `angle` [rad] to the radius, 0.5 m from
    its axis, and swing for a duration [s]. inertia [kg m2] of a hub that turns freely; 0: driven.
    """
    omega = yade.Omega()
    omega.reset()
    turn = 2 * pi * np.arange(arms) / arms
    roots = 0.5 * np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
    tips = roots + 10 * np.column_stack([np.cos(turn + angle), np.sin(turn + angle), 0 * turn])
    nodes = np.concatenate([roots, tips])
    net = scene.add_membrane(
        nodes,
        np.empty((0, 3), dtype=int),
        cables=np.column_stack([np.arange(arms), arms + np.arange(arms)]),
        cableStiffness=1e7,
        cableDensity=0,
        pointMasses=[1e-9] * arms + [1.0] * arms,
        interactions=False,
    )
    p = scene.SceneParameters(path="fused", omega=spin, hub_inertia=inertia, energy_tolerance=0)
    made = scene.set_engines(net, p, driven=list(net.bodyIds[:arms]))
    made.hold(range(arms))
    scene.set_spin(made, spin)
    omega.dt = 1e-4
    before, least, most, farthest = angle, spin, spin, 0.0
    crossed = np.nan
    for step in range(1, 100_000):
        scene.advance(10)
        x = made.positions()
        span = x[arms] - x[0]
        now = float(np.arctan2(np.cross(x[0], span)[2], x[0] @ span))
        farthest = max(farthest, -now * np.sign(angle))
        if made.hub:
            least, most = min(least, made.hub.spin), max(most, made.hub.spin)
        if np.isnan(crossed) and before * now <= 0:
            crossed = 10 * omega.dt * (step - now / (now - before))
        if omega.time > duration:
            break
        before = now
    return float(crossed), farthest, least, most


# --- checks ---


def force_checks() -> list[Check]:
    """Forces and energies of the film against the second implementation, in all its states."""
    sail = StandingSail()
    rest, mesh = sail.rest[: sail.mesh.film_size], sail.mesh
    rng = np.random.default_rng(3)
    film = scene.film(YOUNG, POISSON, DENSITY, THICKNESS)
    worst = {"forces": 0.0, "energy": 0.0}
    for length in (0.0, 2.26e-3):
        yade.Omega().reset()
        net = scene.add_membrane(
            rest,
            mesh.triangles,
            material=film,
            interactions=False,
            film="plane_stress",
            bucklingLength=length,
        )
        law = YOUNG, POISSON, THICKNESS, net.bucklingStress
        folded = fold(mesh)[: len(rest)]
        for start, off in ((rest, 1e-4), (rest, 5e-3), (folded, 1e-4)):
            x = start + off * rng.normal(size=rest.shape)
            expected, energy = paper.film_forces(x, rest, mesh.triangles, *law)
            error = np.abs(film_forces(net, x) - expected).max() / np.abs(expected).max()
            worst["forces"] = max(worst["forces"], error)
            for body, place in zip(net.bodyIds, x.tolist()):
                yade.Omega().bodies[body].state.pos = place
            worst["energy"] = max(worst["energy"], abs(net.elasticEnergy() / energy - 1))
    source = "reference/forces.py, by deformation gradients; flat, crumpled, folded"
    return [
        at_most(f"film, {name}: plugin - reference", e, 1e-12, source) for name, e in worst.items()
    ]


def wrinkle_checks(cells: tuple[int, ...]) -> list[Check]:
    """Strips and rings on meshes of so many cells across."""
    found = []
    finest = cells[-1]
    within = 0.01 if finest >= 40 else 0.03
    for ratio in STRIPS:
        errors = [bent_strip(ratio, n) for n in cells]
        name = f"bent strip, M/PH = {ratio:g}, {finest} cells taut"
        source = "Stein & Hedgepeth: E h H2 curvature / (2 P) = (3/2 - 3 M / PH)^-2"
        found.append(Check(f"{name}: curvature", 1 + errors[-1], 1.0, within, source))
        found.append(Check(f"{name}: order", order(errors), 2.0, 0.5, source))
    for outer, pull in ((10.0, 4.0), (5.0, 3.0)):
        off = pulled_ring(outer, pull, finest)
        for k, edge in enumerate(("inner", "outer")):
            name = f"ring to {outer:g}, {finest} cells, pull {pull:g}: {edge} edge"
            source = "wrinkled to R_o2 [t - sqrt(t2 - 1 / R_o2)], t = T_o / (T_i R_i)"
            found.append(Check(name, 1 + off[k], 1.0, within, source))
    return found


def petal_check(refine: int) -> Check:
    """A petal whose outer edge is pulled, against plane-stress finite elements on its mesh."""
    nodes, triangles, inner, outer = sheets.petal(refine)
    places = nodes.copy()
    places[outer, 0] += sheets.PULL
    held = dict.fromkeys(range(len(nodes)), "z")
    held |= dict.fromkeys([*inner.tolist(), *outer.tolist()], "xyz")
    _, forces = settle(nodes, triangles, places, held, bucklingLength=1e-5)
    matrix = sheets.film_matrix(nodes, triangles)
    _, reaction = sheets.petal_answers(matrix, nodes, inner, outer)
    name = f"petal, refine {refine}: reaction, film / finite elements"
    return Check(name, -forces[outer, 0].sum() / reaction, 1.0, 0.005, sheets.CONSTANT_STRAIN)


def disk_checks(full: bool) -> list[Check]:
    """Spinning disks on hubs, across which gravity pulls."""
    cells, within = (24, 0.005) if full else (8, 0.03)
    source = "equilibrium of a spinning membrane without bending, small slope"
    return [
        Check(
            f"disk on a hub, a/b = {r:g}: w(b) spin2 / g",
            hanging_disk(r, cells),
            w,
            within * w,
            source,
        )
        for r, w in DISKS.items()
        if full or r == 0.2
    ]


def arm_checks() -> list[Check]:
    """Arms on driven and on free hubs."""
    driven, *_ = swung(2.0, radians(80), 1, 0.0, 4.5)
    free, farthest, least, most = swung(2.0, radians(-80), 4, 10.0, 2.6)
    source = "FILM.md, section 8: straight arms on a hub, integrated"
    rows = (
        ("arm on a driven hub: quarter period", driven, 3.9953, "s"),
        ("four arms on a free hub: first along the radius", free, 0.6363, "s"),
        ("four arms on a free hub: largest angle", farthest, radians(80), "rad"),
        ("four arms on a free hub: least spin", least, -1.608, "rad/s"),
        ("four arms on a free hub: largest spin", most, 5.315, "rad/s"),
    )
    return [Check(name, value, t, 1e-3 * abs(t), source, unit) for name, value, t, unit in rows]


def checks(full: bool) -> list[Check]:
    """All of the film's checks; `full`, finer meshes and all disks."""
    cells = CELLS if full else FAST_CELLS
    return [
        *force_checks(),
        *wrinkle_checks(cells),
        petal_check(4 if full else 1),
        *disk_checks(full),
        *arm_checks(),
    ]
