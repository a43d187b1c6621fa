# SPDX-License-Identifier: GPL-2.0-or-later
"""Creases: which lengths stand in (7), both laws over the angle, and the angular momentum they
pump.

Take `paper` with rest lengths for meshes with equal heights and theta0 = 0, as the paper's own;
`conservative` for any other mesh or natural angle; and neither where creases are so soft that they
turn through the cut of theta.

- `lengths`: the plugin takes rest lengths in (7). What current ones would do is shown by a small
  leapfrog in NumPy, outside the plugin: one triangle of a pair at a right angle, the other held,
  has its height collapsed, and its apex is let go; no sides. By hand: with current lengths the
  work of (7) on the way to theta = 0 is beta E J l pi²/8 divided by the height, without bound;
  with rest lengths it vanishes with the height.
- `sail`: the same on the paper's sail in YADE. All runs start from one equilibrium with the
  plugin's creases. Then its creases are switched off, and a PyRunner puts (7) and (8) by
  reference/forces.py on the nodes, with rest lengths (the control, held against the plugin's own
  run) or with current ones. A run ends where its kinetic energy is 100 times the first.
- `law`: force of the plugin over the angle, for both laws and two natural angles.
- `swing`: a free pair of equal triangles that swings through theta = 0; energy at three
  steps.
- `about`: the same pair, with sides that do not buckle, swings about theta0 = pi, flat, and about
  pi/2: energy and frequency against the closed form.
- `cut`: at theta = -pi/2 = 3 pi/2 the angle starts anew. Force and energy of a pair on both sides
  of it, and the energy of a free pair that turns through it again and again.
- `range`: how near to the cut the creases of the paper's sail come in its early deployment.
- `momentum`: a free pair of unequal triangles: angular momentum about its centre, which nothing
  outside changes.
"""

import __main__
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from membrane import scene
from membrane.mesh import SailMesh
from membrane.parameters import SailParameters
from membrane.study.verification.deployment import begin, equilibrium
from yade import wrapper as yade

from ..sources import paper as reference
from .common import TWO_TRIANGLES, Model, O, figure, folder, kinetic, save, two_triangles
from .common import write_table

YOUNG, THICKNESS, DENSITY = 3.2e9, 7.5e-6, 1420.0
GAMMA, LENGTH = 100.0, 0.02
SAIL_VALUES = (
    "kinetic energy [J]",
    "largest speed of a node [m/s]",
    "largest force of a crease on an apex [N]",
    "lowest height / rest [-]",
)
HEADER = ("part", "case", "x", "x means", "value", "value means")
CORNER = DENSITY * THICKNESS * LENGTH**2 * np.sqrt(0.75) / 6  # kg, of an apex
HEIGHTS = np.logspace(-5.5, -2, 8)  # m
LAWS = ("paper", "conservative")
UNBUCKLED = {"alpha": 1e12, "alphaCrease": 1e12}
LOOK = 1e-4  # s, between two looks at the sail's kinetic energy
# Cases, and seconds
SAIL = (
    ((3.0, 0.02, 1), 0.1),
    ((30.0, 0.02, 1), 0.1),
    ((30.0, 0.0, 1), 0.1),
    ((30.0, 0.0, 2), 0.15),
)
BLOWN_UP = 100.0  # times the kinetic energy in the first row

Case = tuple[float, float, int]  # beta, zeta, refine
Runs = dict[tuple[Case, str], np.ndarray]  # rows of `sail_run` by case and lengths
Distances = dict[Case, np.ndarray]
Curves = Mapping[Any, tuple[np.ndarray, ...]]  # by law and what else is varied
Ranges = dict[float, tuple[float, float, int]]  # what `angle_range` returns, by beta


def collapse(
    lengths: str, beta: float, heights: np.ndarray, step: float = 5e-6, steps: int = 400
) -> np.ndarray:
    """Largest speed (H,) [m/s] of an apex let go at theta = pi/2 at `heights` (H,) [m], in NumPy.

    Equilateral triangles of 20 mm, (7) with `rest` or `current` lengths, three nodes held.
    """
    height = LENGTH * np.sqrt(0.75)
    bending = beta * reference.bending_stiffness(YOUNG, THICKNESS)
    x = np.array([two_triangles(0.5 * np.pi, (h, height), LENGTH) for h in heights])
    whole = np.tile(two_triangles(np.pi, (height, height), LENGTH), (len(heights), 1))
    creases = np.arange(len(whole)).reshape(-1, 4)
    rest, inside = reference.crease_frame(whole, creases), -np.ones(len(heights))
    v, largest = np.zeros((len(heights), 3)), np.zeros(len(heights))
    for _ in range(steps):
        nodal, *_ = forces_by_hand(
            x.reshape(-1, 3), creases, inside, rest, bending, lengths == "current"
        )
        v += step / CORNER * nodal.reshape(x.shape)[:, 2]
        x[:, 2] += step * v
        largest = np.maximum(largest, np.linalg.norm(v, axis=1))
    return largest


def collapse_by_hand(lengths: str, beta: float, heights: np.ndarray) -> np.ndarray:
    """Speed (H,) [m/s] from the work of (7) along the arc from theta = pi/2 to 0."""
    work = beta * reference.bending_stiffness(YOUNG, THICKNESS) * LENGTH * np.pi**2 / 8
    reach = heights if lengths == "current" else 0.75 * LENGTH**2 / heights
    return np.sqrt(2 * work / reach / CORNER)


def forces_by_hand(
    x: np.ndarray,
    creases: np.ndarray,
    inside: np.ndarray,
    rest: dict,
    bending: float,
    current: bool,
) -> tuple[np.ndarray, float, float]:
    """Forces of (7) and (8) in NumPy, with rest or `current` lengths in (7).

    Parameters
    ----------
    x, creases, inside
        Positions (N, 3) [m] and others as in reference.crease_angle.
    rest : dict
        reference.crease_frame at rest.
    bending : float
        beta E J [N m].

    Returns
    -------
    nodal : (N, 3) float
        [N]
    largest : float
        Largest force on an apex [N].
    lowest : float
        Lowest height over its rest value [-].
    """
    now = reference.crease_frame(x, creases)
    theta = reference.angle_of(now, inside)
    lengths = now if current else rest
    moment = bending * np.where(theta >= 0, 1.0, GAMMA) * lengths["length"] * theta
    on_apex, largest, lowest = [], 0.0, np.inf
    for apex, sign in (("c", 1), ("d", -1)):
        height = "height_" + apex
        size = sign * inside * moment / np.maximum(lengths[height], 1e-12) ** 2  # no 0/0
        on_apex.append(size[:, None] * now["normal_" + apex])
        largest = max(largest, float(np.abs(size).max()))
        lowest = min(lowest, float((now[height] / rest[height]).min()))
    nodal = reference.crease_balance(x, creases, now, rest, *on_apex, reference.COLLAPSED)
    return nodal, largest, lowest


class CreaseForces:
    """Puts (7) and (8) in NumPy on the nodes of the paper's sail; to be called in every step.

    Parameters
    ----------
    mesh : SailMesh
    built : MembraneScene
    beta : float
    lengths : str
        Those in (7): `rest` or `current`.

    Attributes
    ----------
    largest : float
        Force on an apex [N] since it was last set to 0.
    lowest : float
        Height over its rest value [-] since it was last set to 1.
    calls : int
    """

    def __init__(
        self, mesh: SailMesh, built: scene.MembraneScene, beta: float, lengths: str
    ) -> None:
        self.forces, self.ids = built.forces, built.membrane.bodyIds
        self.creases = reference.crease_nodes(mesh.triangles, mesh.creases)
        self.inside = -mesh.crease_signs
        self.rest = reference.crease_frame(mesh.nodes, self.creases)
        self.bending = beta * reference.bending_stiffness(YOUNG, THICKNESS)
        self.current = lengths == "current"
        self.largest, self.lowest, self.calls = 0.0, 1.0, 0

    def __call__(self) -> None:
        x = np.array([(p[0], p[1], p[2]) for p in self.forces.lastPositions()])
        nodal, largest, lowest = forces_by_hand(
            x, self.creases, self.inside, self.rest, self.bending, self.current
        )
        self.largest, self.lowest = max(self.largest, largest), min(self.lowest, lowest)
        for i, force in zip(self.ids, nodal.tolist()):
            O.forces.addF(i, force)
        self.calls += 1


@contextmanager
def creases_by_hand(built: scene.MembraneScene, creases: CreaseForces) -> Iterator[None]:
    """In the block `creases` makes the forces of a sail's creases, and the plugin none."""
    built.forces.beta = 0.0
    __main__.put_crease_forces = creases  # PyRunner looks there
    runner = yade.PyRunner(command="put_crease_forces()", iterPeriod=1, initRun=True)
    engines = O.engines
    at = next(i for i, e in enumerate(engines) if isinstance(e, type(built.forces)))
    O.engines = [*engines[: at + 1], runner, *engines[at + 1 :]]
    try:
        yield
    finally:
        del __main__.put_crease_forces


def sail_run(
    case: Case, lengths: str, seconds: float, row: float = 2e-3
) -> tuple[np.ndarray, np.ndarray]:
    """Run the paper's sail from its release, with creases by the plugin or by CreaseForces.

    Parameters
    ----------
    case : Case
    lengths : str
        `plugin`: its own creases; `rest`, `current`: see CreaseForces.
    seconds : float
        [s]
    row : float
        Time between rows [s].

    Returns
    -------
    rows, frames
        As `watched` returns them.
    """
    beta, zeta, refine = case
    start = SailParameters(refine=refine)
    p = replace(start, beta=beta, zeta=zeta)
    sail, built = begin(p, equilibrium(start), ledger=False)
    creases = CreaseForces(sail.mesh, built, beta, lengths)
    if lengths == "plugin":
        return watched(built, creases, seconds, row)
    with creases_by_hand(built, creases):
        rows, frames = watched(built, creases, seconds, row)
    assert creases.calls >= (round(rows[-1, 0] / LOOK) - 1) * round(LOOK / p.dt)
    return rows, frames


@np.errstate(all="ignore")
def watched(
    built: scene.MembraneScene, creases: CreaseForces, seconds: float, row: float
) -> tuple[np.ndarray, np.ndarray]:
    """Run a sail for `seconds`, or until it has blown up, and tell of it every `row` [s].

    Returns
    -------
    rows : (S, 5) float
        Time [s], kinetic energy [J], largest speed of a node [m/s]; since the row before: largest
        force of a crease on an apex [N] and lowest height over its rest value [-].
    frames : (S, N, 3) float
        Positions [m].
    """
    masses, ids = built.masses(), built.membrane.bodyIds
    stride, between, looks = round(LOOK / O.dt), round(row / LOOK), round(seconds / LOOK)
    rows: list[list[float]] = []
    frames = []
    for look in range(1, looks + 1):
        try:
            scene.advance(stride)
        except RuntimeError:  # numbers overflowed between two looks
            rows.append([look * LOOK, np.inf, np.inf, np.inf, creases.lowest])
            break
        v = np.array([O.bodies[i].state.vel for i in ids])
        energy = kinetic(masses, v)
        last = look == looks or not energy < (BLOWN_UP * rows[0][1] if rows else np.inf)
        if look % between == 0 or last:
            speed = float(np.linalg.norm(v, axis=1).max())
            rows.append([look * LOOK, energy, speed, creases.largest, creases.lowest])
            frames.append(built.positions())
            creases.largest, creases.lowest = 0.0, 1.0
        if last:
            break
    return np.array(rows), np.array(frames)


def blown_up(rows: np.ndarray) -> bool:
    """Whether rows of `sail_run` end by its kinetic energy."""
    return not rows[-1, 1] < BLOWN_UP * rows[0, 1]


def sail_lengths(quick: bool) -> tuple[Runs, Distances]:
    """Runs {(case, lengths): rows} of the sail, and {case: distances (S,) [m]}.

    Distances are the largest ones of a node in the control from that in the plugin's own run.
    """
    runs, distances, row = {}, {}, 2e-3
    for case, seconds in SAIL[1:2] if quick else SAIL:
        if quick:
            seconds, row = 2e-3, 1e-3
        _, frames = sail_run(case, "plugin", seconds, row)
        current, _ = sail_run(case, "current", seconds, row)
        # The control need run no longer than up to the row at which the other has ended.
        rows = int(np.ceil(current[-1, 0] / row - 1e-9))
        control, copies = sail_run(case, "rest", rows * row, row)
        distances[case] = np.linalg.norm(copies - frames[:rows], axis=2).max(axis=1)
        runs[case, "rest"], runs[case, "current"] = control, current
    return runs, distances


def case_name(case: Case) -> str:
    """Name of a run of the sail."""
    beta, zeta, refine = case
    return f"beta = {beta:g}, zeta = {zeta:g}" + (f", refine = {refine}" if refine > 1 else "")


def angle_range(beta: float, seconds: float) -> tuple[float, float, int]:
    """Lowest and highest angle [rad] of the sail's creases, and how often one passed the cut."""
    _, built = begin(SailParameters(beta=beta), equilibrium(SailParameters()), ledger=False)
    before = np.array(built.forces.creaseAngles())
    lowest, highest, passes = before.min(), before.max(), 0
    for _ in range(round(seconds / LOOK)):
        scene.advance(round(LOOK / O.dt))
        now = np.array(built.forces.creaseAngles())
        lowest, highest = min(lowest, now.min()), max(highest, now.max())
        passes += int(np.sum(np.abs(now - before) > np.pi))
        before = now
    return float(lowest), float(highest), passes


# --- a pair ---


def law_curve(law: str, theta0: float, angles: np.ndarray) -> np.ndarray:
    """Force [N] of the plugin on C along its opening direction, at angles (S,) [rad]."""
    return force_and_energy(law, theta0, angles)[0]


def force_and_energy(law: str, theta0: float, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force (S,) [N] on C along its opening direction, and energy (S,) [J], at angles (S,) [rad].

    Angles may lie beyond the cut at 3 pi/2: the pair is turned on.
    """
    rest = two_triangles(np.pi)
    model = pair(rest, beta=30.0, theta0=theta0, crease_law=law)
    forces, energies = [], []
    for theta in angles:
        x = two_triangles(theta)
        model.balance(x)
        held = np.array(O.forces.permF(model.net.bodyIds[2]))
        arm = x[2] - [0.5 * LENGTH, 0, 0]
        opening = np.cross([1.0, 0, 0], arm) / np.linalg.norm(arm)
        # Sides are at rest: all of the force is the crease's.
        forces.append(-float(held @ opening))
        energies.append(model.forces.creaseEnergy())
    return np.array(forces), np.array(energies)


def pair(rest: np.ndarray, *, buckling: bool = True, **engine: Any) -> Model:
    """A Model of two triangles on a crease."""
    options: dict = {"alphaCrease": 100.0} if buckling else UNBUCKLED
    return Model(rest, TWO_TRIANGLES, creases=[(0, 1)], crease_signs=[1], engine=engine, **options)


def follow(model: Model, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """All energy [J] and the angle [rad] of a pair's crease in each step from now on, both (S,)."""
    ledger = model.start_ledger()
    totals, angles = [], []
    for _ in range(int(seconds / O.dt)):
        scene.advance(1)
        totals.append(ledger.total + ledger.crease)
        angles.append(model.forces.creaseAngles(model.forces.lastPositions())[0])
    return np.array(totals), np.array(angles)


def swing(share: float, law: str, seconds: float = 0.05) -> tuple[float, np.ndarray]:
    """Largest relative error of the energy, and angles (S,) [rad], of a pair that swings freely."""
    rest = two_triangles(np.pi)
    model = pair(rest, beta=300.0, crease_law=law)
    start = two_triangles(2.0)
    arm = (start[2] - [0.5 * LENGTH, 0, 0]) / LENGTH
    opening = np.cross([1.0, 0, 0], arm)
    velocities = np.zeros((4, 3))
    velocities[2] = 3.0 * opening
    velocities[3] = 3.0 * opening * [1, -1, 1]
    velocities -= np.average(velocities, axis=0, weights=model.masses)
    model.place(start, velocities)
    O.dt = share * model.forces.criticalTimeStep()
    totals, angles = follow(model, seconds)
    return float(np.abs(totals / totals[0] - 1).max()), angles


def swing_frequency(masses: np.ndarray, stiffness: float, theta0: float) -> float:
    """Angular frequency [rad/s] of small swings of a free pair about theta0 [rad].

    By hand: masses m at C and D, M at A and B, height H, psi = theta/2. The centre of mass is at
    rest, so T = H² psi'² (m M / (m + M) sin² psi + m cos² psi); V = K (2 psi - theta0)² / 2.
    """
    end, apex = masses[0], masses[2]
    half = 0.5 * theta0
    share = end / (apex + end) * np.sin(half) ** 2 + np.cos(half) ** 2
    return np.sqrt(2 * stiffness / (apex * LENGTH**2 * share))


def swing_about(
    theta0: float, law: str, share: float, amplitude: float, seconds: float
) -> tuple[float, float]:
    """Swing of a free pair, let go `amplitude` [rad] from theta0 [rad], that does not buckle.

    Returns the largest error of the energy over the swing's, and frequency over the closed form
    - 1 [-].
    """
    beta = 300.0
    model = pair(two_triangles(np.pi), buckling=False, beta=beta, theta0=theta0, crease_law=law)
    model.place(two_triangles(theta0 - amplitude))
    O.dt = share * model.forces.criticalTimeStep()
    totals, angles = follow(model, seconds)
    angles -= theta0
    at = np.flatnonzero(angles[:-1] * angles[1:] < 0)
    zeros = (at + angles[at] / (angles[at] - angles[at + 1])) * O.dt
    stiffness = beta * reference.bending_stiffness(YOUNG, THICKNESS)  # l_AB over the height is 1
    error = np.nan  # of less than a period
    if len(zeros) > 2:
        last = 2 * ((len(zeros) - 1) // 2)
        found = np.pi * last / (zeros[last] - zeros[0])
        error = float(found / swing_frequency(model.masses, stiffness, theta0) - 1)
    return float(np.abs(totals / totals[0] - 1).max()), error


def turn_through_cut(law: str, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """A free pair, beta = 30, thrown open through the cut, where it turns on and on.

    Returns the angle [rad] without the cut, and the sum of all energies over K [-], both (S,).
    """
    beta = 30.0
    stiffness = beta * reference.bending_stiffness(YOUNG, THICKNESS)
    model = pair(two_triangles(np.pi), buckling=False, beta=beta, crease_law=law)
    start = two_triangles(1.4 * np.pi)
    spin = np.zeros((4, 3))
    for apex, sign in ((2, 1.0), (3, -1.0)):
        spin[apex] = sign * np.cross([1.0, 0, 0], start[apex] - [0.5 * LENGTH, 0, 0])
    spin -= np.average(spin, axis=0, weights=model.masses)
    spin *= np.sqrt(5 * stiffness / kinetic(model.masses, spin))
    model.place(start, spin)
    O.dt = 0.2 * model.forces.criticalTimeStep()
    totals, angles = follow(model, seconds)
    return np.unwrap(angles), totals / stiffness


def momentum(
    law: str, ratio: float, zeta: float, seconds: float, samples: int = 100
) -> tuple[np.ndarray, np.ndarray]:
    """Angular momentum of a free pair with heights 1 : ratio, over time; NaN once it has blown up.

    Divided by the moment of inertia times 1/s, it is a spin rate [rad/s].
    """
    heights = (0.02, 0.02 * ratio)
    rest = two_triangles(np.pi, heights)
    model = pair(rest, beta=300.0, crease_law=law, zeta=zeta)
    start = two_triangles(1.5, heights)
    model.place(start)
    O.dt = 0.5 * model.forces.criticalTimeStep()
    stride = max(1, int(seconds / O.dt / samples))
    middle = np.average(start, axis=0, weights=model.masses)
    inertia = np.sum(model.masses * np.sum((start - middle) ** 2, axis=1))
    times, spins = [0.0], [0.0]
    for k in range(samples):
        try:
            scene.advance(stride)
        except RuntimeError:
            break
        v, x = model.velocities(), model.positions() - 0.5 * O.dt * model.velocities()
        spin = np.sum(model.masses[:, None] * np.cross(x, v), axis=0) / inertia
        times.append((k + 1) * stride * O.dt)
        spins.append(float(np.linalg.norm(spin)))
    return np.array(times), np.array(spins)


def measure_lengths(quick: bool, rows: list[list]) -> dict[tuple[str, float], np.ndarray]:
    """Speeds (H,) by lengths and beta of a collapsed triangle's apex."""
    speeds = {}
    for lengths in ("rest", "current"):
        for beta in (30.0,) if quick else (3.0, 30.0, 300.0):
            name = f"{lengths}, beta = {beta:g}"
            speeds[lengths, beta] = collapse(lengths, beta, HEIGHTS)
            hand = collapse_by_hand(lengths, beta, HEIGHTS)
            for height, speed, expected in zip(HEIGHTS, speeds[lengths, beta], hand):
                where = ["lengths", name, height, "height [m]"]
                rows.append([*where, speed, "largest speed of the apex (NumPy) [m/s]"])
                rows.append([*where, expected, "by hand, from pi/2 to 0 [m/s]"])
    return speeds


def measure_sail(quick: bool, rows: list[list]) -> tuple[Runs, Distances]:
    """What `sail_lengths` returns."""
    runs, distances = sail_lengths(quick)
    for (case, lengths), found in runs.items():
        where = ["sail", f"{lengths}, {case_name(case)}"]
        for time, *values in found:
            for value, text in zip(values, SAIL_VALUES):
                rows.append([*where, time, "time [s]", value, text])
        if lengths == "rest":
            text = "largest distance from the plugin's own run [m]"
            for time, distance in zip(found[:, 0], distances[case]):
                rows.append([*where, time, "time [s]", distance, text])
    return runs, distances


def measure_law(quick: bool, rows: list[list]) -> Curves:
    """Angles (S,) [rad] and forces (S,) [N] by law and theta0."""
    angles = np.sort(
        np.append(np.linspace(-0.499, 1.499, 25 if quick else 81) * np.pi, [-1e-6, 1e-6])
    )
    curves = {}
    for law in LAWS:
        for theta0 in (0.0, 0.5 * np.pi):
            curves[law, theta0] = angles, law_curve(law, theta0, angles)
            name = f"{law}, theta0 = {theta0:.4g}"
            for theta, force in zip(*curves[law, theta0]):
                rows.append(["law", name, theta, "theta [rad]", force, "force on C [N]"])
    return curves


def measure_swings(quick: bool, rows: list[list]) -> tuple[dict, dict]:
    """Energy errors by (law, share), and errors of energy and frequency about theta0."""
    shares = (0.5,) if quick else (0.8, 0.4, 0.2, 0.1)
    through, about = {}, {}
    for law in LAWS:
        for share in shares:
            through[law, share], seen = swing(share, law, 0.005 if quick else 0.05)
            text = f"energy error, angles {seen.min():.3g} ... {seen.max():.3g} rad [-]"
            rows.append(["swing", law, share, "step / estimate [-]", through[law, share], text])
    for law, theta0, size in product(LAWS, ("pi", "pi/2"), (0.02,) if quick else (0.02, 1.0)):
        for share in shares:
            angle = {"pi": np.pi, "pi/2": 0.5 * np.pi}[theta0]
            found = swing_about(angle, law, share, size, 0.03 if quick else 0.06)
            about[law, theta0, size, share] = found
            where = ["about", f"{law}, theta0 = {theta0}, swing {size:g} rad", share]
            for value, text in zip(found, ("energy error [-]", "frequency / by hand - 1 [-]")):
                rows.append([*where, "step / estimate [-]", value, text])
    return through, about


def measure_cut(quick: bool, rows: list[list]) -> tuple[Curves, Curves]:
    """Angles, forces and energies by law and theta0 around the cut; and free pairs by law."""
    angles = np.linspace(1.2, 1.8, 13 if quick else 61) * np.pi
    angles = np.sort(np.append(angles, 1.5 * np.pi + np.array([-1e-6, 1e-6])))
    curves, turns = {}, {}
    for law in LAWS:
        for theta0 in (0.0, 0.5 * np.pi):
            curves[law, theta0] = angles, *force_and_energy(law, theta0, angles)
            name = f"{law}, theta0 = {theta0:.4g}"
            for theta, force, energy in zip(*curves[law, theta0]):
                where = ["cut", name, theta, "theta [rad], turned on beyond 3 pi/2"]
                rows.append([*where, force, "force on C [N]"])
                rows.append([*where, energy, "crease energy [J]"])
        turns[law] = turn_through_cut(law, 0.002 if quick else 0.01)
        picks = np.linspace(0, len(turns[law][0]) - 1, 10 if quick else 200).astype(int)
        for theta, energy in zip(*(values[picks] for values in turns[law])):
            where = ["cut", f"{law}, free pair, theta0 = 0", theta, "theta [rad] without the cut"]
            rows.append([*where, energy, "all energy / K [-]"])
    return curves, turns


def measure_range(quick: bool, rows: list[list]) -> Ranges:
    """What `angle_range` returns, by beta."""
    ranges = {}
    for beta in (30.0,) if quick else (30.0, 3.0, 0.3):
        ranges[beta] = angle_range(beta, 2e-3 if quick else 0.2)
        texts = "lowest theta [rad]", "highest theta [rad]", "times a crease passed the cut [-]"
        for value, text in zip(ranges[beta], texts):
            rows.append(["range", "paper", beta, "beta [-]", value, text])
    return ranges


def measure_momentum(quick: bool, rows: list[list]) -> Curves:
    """What `momentum` returns, by law, ratio of heights and zeta."""
    spins = {}
    for law in LAWS:
        for ratio in (1.0, 2.0) if quick else (1.0, 1.25, 1.5, 2.0, 3.0):
            for zeta in (0.0, 0.1):
                times, spin = momentum(law, ratio, zeta, 0.01 if quick else 0.1)
                spins[law, ratio, zeta] = times, spin
                text = "largest spin rate that came from nothing [rad/s]"
                name = f"{law}, zeta = {zeta:g}"
                rows.append(["momentum", name, ratio, "ratio of heights [-]", spin.max(), text])
    return spins


def run(quick: bool) -> str:
    """Measure all parts; returns a line of text."""
    rows: list[list] = []
    speeds = measure_lengths(quick, rows)
    runs, distances = measure_sail(quick, rows)
    curves = measure_law(quick, rows)
    swings = measure_swings(quick, rows)
    cuts, turns = measure_cut(quick, rows)
    ranges = measure_range(quick, rows)
    spins = measure_momentum(quick, rows)
    out = folder(quick)
    write_table(out / "creases.csv", HEADER, rows)

    drawing, axes = figure(columns=2, rows=4)
    draw_lengths(axes[0, 0], speeds)
    draw_sail(axes[0, 1], axes[1, 0], runs)
    draw_law(axes[1, 1], curves)
    draw_swings(axes[2, 0], *swings)
    draw_momentum(axes[2, 1], spins)
    draw_cut(axes[3, 0], cuts, ranges)
    draw_turns(axes[3, 1], turns)
    save(drawing, out / "creases.png")
    return " ".join(
        (
            about_lengths(speeds, runs, distances),
            about_angles(curves, *swings),
            about_cut(cuts, turns, ranges),
            about_momentum(spins),
        )
    )


def about_lengths(speeds: dict, runs: Runs, distances: Distances) -> str:
    """A sentence on the lengths in (7)."""
    largest = {lengths: speeds[lengths, 30.0].max() for lengths in ("rest", "current")}
    found = []
    for case in distances:
        rest, current = (runs[case, lengths] for lengths in ("rest", "current"))
        end = (
            f"blows up at {current[-1, 0]:.4g} s"
            if blown_up(current)
            else f"holds for {current[-1, 0]:.3g} s"
        )
        found.append(
            f"{case_name(case)}: {end}, lowest height {current[:, 4].min():.2g} of rest, largest "
            f"force {current[:, 3].max():.2g} N (with rest lengths {rest[:, 4].min():.2g} and "
            f"{rest[:, 3].max():.2g} N; control off the plugin by {distances[case][0]:.0e} m at "
            f"{rest[0, 0]:.0e} s)"
        )
    return (
        f"(7) at beta = 30 throws the apex of a triangle collapsed to {1e6 * HEIGHTS[0]:.2g} um "
        f"out at {speeds['current', 30.0][0]:.3g} m/s with current lengths, at "
        f"{speeds['rest', 30.0][0]:.2g} m/s with rest lengths (NumPy; {largest['current']:.3g} and "
        f"{largest['rest']:.2g} m/s at most over all heights up to 10 mm). The sail with current "
        "lengths, " + "; ".join(found) + "."
    )


def about_angles(curves: Curves, through: dict, about: dict) -> str:
    """A sentence on theta = 0 and pi."""
    jump = {}
    for law in LAWS:
        angles, force = curves[law, 0.5 * np.pi]
        at = int(np.searchsorted(angles, 0.0))
        jump[law] = force[at - 1] / force[at]
    fine = min(share for _, share in through)
    flat = max(error for (_, theta0, *_), (error, _) in about.items() if theta0 == "pi")
    small = max(abs(off) for (*_, size, _), (_, off) in about.items() if size == 0.02)
    return (
        f"At theta = 0 with theta0 = pi/2 the force jumps {jump['paper']:.3g}-fold in `paper`, "
        f"{jump['conservative']:.3g}-fold in `conservative`; swinging through 0, the energy errs "
        f"by {through['conservative', fine]:.1e} at {fine:g} of the estimate. Flat is no special "
        f"angle: swinging through pi, it errs by {flat:.1e} at most, and small swings meet the "
        f"closed form to {small:.1e}."
    )


def about_cut(cuts: Curves, turns: Curves, ranges: Ranges) -> str:
    """A sentence on theta = -pi/2 = 3 pi/2."""
    _, force, energy = cuts["paper", 0.0]
    at = int(np.argmax(np.abs(np.diff(force))))
    turned, gained = turns["paper"][0], np.ptp(turns["paper"][1])
    passes = max(1, int((turned[-1] + 0.5 * np.pi) / (2 * np.pi)))
    seen = "; ".join(
        f"theta {low:.3g} ... {high:.3g}, {times} passes at beta = {beta:g}"
        for beta, (low, high, times) in ranges.items()
    )
    return (
        f"At the cut the force goes from {force[at]:.2g} to {force[at + 1]:.2g} N at beta = 30 and "
        f"the energy from {energy[at]:.2g} to {energy[at + 1]:.2g} J: a pair that opens through it "
        f"gains {gained / passes:.0f} K in each turn; on the sail: {seen}."
    )


def about_momentum(spins: Curves) -> str:
    """A sentence on angular momentum, and which law to take."""
    worst = {
        law: max(s.max() for (name, r, z), (_, s) in spins.items() if name == law and r > 1)
        for law in LAWS
    }
    return (
        f"Unequal heights spin a body up to {worst['paper']:.3g} rad/s with `paper`, "
        f"{worst['conservative']:.1e} with `conservative`: take `paper` for meshes with equal "
        "heights and theta0 = 0, as the paper's own, and `conservative` for any other; neither "
        "where creases turn through the cut"
    )


def draw_lengths(axis: Axes, speeds: dict) -> None:
    """Largest speed of a collapsed triangle's apex over its height."""
    for (lengths, beta), speed in speeds.items():
        color = "C0" if lengths == "rest" else "C3"
        marker = {3.0: "v", 30.0: "o", 300.0: "^"}[beta]
        name = f"{lengths} lengths, beta = {beta:g}"
        axis.loglog(HEIGHTS, speed, marker, color=color, markersize=4, label=name)
        axis.loglog(HEIGHTS, collapse_by_hand(lengths, beta, HEIGHTS), color=color, linewidth=0.6)
    axis.set(xlabel="height at the start [m]", ylabel="largest speed of the apex [m/s] (NumPy)")
    axis.set_title("lines: by hand", fontsize=8)
    axis.legend(fontsize=6)


def draw_sail(left: Axes, right: Axes, runs: Runs) -> None:
    """Kinetic energy of the sail, and largest force of a crease, over time."""
    colors = {case: f"C{i}" for i, case in enumerate(dict.fromkeys(case for case, _ in runs))}
    for (case, lengths), found in runs.items():
        style = {"color": colors[case], "linestyle": "--" if lengths == "rest" else "-"}
        name = case_name(case) if lengths == "current" else None
        left.semilogy(found[:, 0], found[:, 1], label=name, **style)
        right.semilogy(found[:, 0], found[:, 3], label=name, **style)
        if lengths == "current" and blown_up(found):
            left.plot(found[-1, 0], min(found[-1, 1], 1e6), "x", color=colors[case])
    left.set(xlabel="time after the release [s]", ylabel="kinetic energy of the sail [J]")
    right.set(xlabel="time after the release [s]", ylabel="largest force of a crease [N]")
    left.set_title("(7) with current lengths; dashed: rest lengths; x: blown up", fontsize=8)
    left.legend(fontsize=7)
    right.legend(fontsize=7)


def draw_law(axis: Axes, curves: Curves) -> None:
    """Force over the angle."""
    for (law, theta0), (angles, force) in curves.items():
        style = "-" if law == "paper" else "--"
        axis.plot(angles / np.pi, force, style, label=f"{law}, theta0 = {theta0 / np.pi:g} pi")
    axis.set(xlabel="theta / pi [-]", ylabel="force on C, opening [N]")
    axis.set_yscale("symlog", linthresh=1e-5)
    axis.set_yticks([-1e-3, -1e-4, 0, 1e-4, 1e-3, 1e-2, 1e-1])
    for at in (-0.5, 0, 1, 1.5):
        axis.axvline(at, color="k", linewidth=0.5)
    axis.legend(fontsize=7)


def draw_swings(axis: Axes, through: dict, about: dict) -> None:
    """Error of the energy of swings through 0 and about pi, over the step."""
    for law, style in zip(LAWS, ("-", "--")):
        curves = {f"{law}, through 0": {h: e for (name, h), e in through.items() if name == law}}
        for (name, theta0, size, share), (error, _) in about.items():
            if (name, theta0) == (law, "pi"):
                curves.setdefault(f"{law}, {size:g} rad about pi", {})[share] = error
        for (label, curve), marker in zip(curves.items(), "osv"):
            axis.loglog(list(curve), list(curve.values()), marker + style, label=label)
    axis.axvline(1.0, color="C3", label="estimate")
    axis.set(xlabel="step / estimate [-]", ylabel="error of a swinging pair's energy [-]")
    axis.legend(fontsize=6)


def draw_momentum(axis: Axes, spins: Curves) -> None:
    """Spin that came from nothing."""
    for (law, ratio, zeta), (times, spin) in spins.items():
        if zeta == 0.1:
            style = "-" if law == "paper" else "--"
            axis.plot(times[1:], spin[1:] + 1e-16, style, label=f"{law}, 1 : {ratio:g}")
    axis.set(xlabel="time [s]", ylabel="angular momentum / inertia [rad/s]", yscale="log")
    axis.legend(fontsize=6)


def draw_cut(axis: Axes, cuts: Curves, ranges: Ranges) -> None:
    """Force and energy on both sides of the cut, and the sail's highest angles."""
    stiffness = 30.0 * reference.bending_stiffness(YOUNG, THICKNESS)
    for (law, theta0), (angles, force, energy) in cuts.items():
        style = {"linestyle": "-" if law == "paper" else "--", "alpha": 1 if theta0 == 0 else 0.5}
        name = f"{law}, theta0 = {theta0 / np.pi:g} pi"
        axis.plot(angles / np.pi, energy / stiffness, color="C0", **style)
        axis.plot(angles / np.pi, force * LENGTH / stiffness, color="C1", label=name, **style)
    for i, (beta, (_, high, _)) in enumerate(ranges.items()):
        axis.axvline(high / np.pi, color=f"C{i + 2}", label=f"highest, sail at beta = {beta:g}")
    axis.set(
        xlabel="theta / pi, turned on beyond the cut at 1.5 [-]",
        ylabel="moment (orange), energy (blue) / K [-]",
    )
    axis.legend(fontsize=6)


def draw_turns(axis: Axes, turns: Curves) -> None:
    """Energy of a free pair that turns through the cut."""
    for law, style in zip(LAWS, ("-", "--")):
        turned, energy = turns[law]
        axis.plot(turned / np.pi, energy, style, label=law)
    gain = (GAMMA - 9) * np.pi**2 / 8  # gamma (pi/2)²/2 - (3 pi/2)²/2
    axis.set_title(f"free pair that opens and turns on; by hand {gain:.1f} K a turn", fontsize=8)
    axis.set(xlabel="theta / pi, without the cut [-]", ylabel="all energy / K [-]")
    axis.legend(fontsize=7)
