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
from collections.abc import Iterator, Mapping, Sequence
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
from numpy.typing import ArrayLike
from yade import wrapper as yade

from ..sources import paper as reference
from .common import TWO_TRIANGLES, Model, O, figure, kinetic, publish, two_triangles

YOUNG, THICKNESS, DENSITY = 3.2e9, 7.5e-6, 1420.0
BENDING = reference.bending_stiffness(YOUNG, THICKNESS)  # E J [N m]; times beta, of a crease
GAMMA, LENGTH = 100.0, 0.02
SAIL_VALUES = (
    "kinetic energy [J]",
    "largest speed of a node [m/s]",
    "largest force of a crease on an apex [N]",
    "lowest height / rest [-]",
)
HEADER = "part; case; x; x means; value; value means"
CORNER = DENSITY * THICKNESS * LENGTH**2 * np.sqrt(0.75) / 6  # kg, of an apex
MIDDLE = np.array([0.5 * LENGTH, 0.0, 0.0])  # of the crease of `two_triangles` [m]
HEIGHTS = np.logspace(-5.5, -2, 8)  # m
LENGTHS = {"rest": "C0", "current": "C3"}  # colours
LAWS = {"paper": "-", "conservative": "--"}  # lines
NATURAL = {"pi/2": 0.5 * np.pi, "pi": np.pi}  # theta0 [rad]
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
Curves = dict[Any, tuple[np.ndarray, ...]]  # by law and what else is varied
Ranges = dict[float, tuple[float, float, int]]  # what `angle_range` returns, by beta


def listed(
    part: str, case: str, means: str, x: Sequence | np.ndarray, values: Mapping[str, ArrayLike]
) -> list[list]:
    """Rows of the table: at each of `x` (S,), which `means` that, the `values` (S,) by meaning."""
    columns = zip(*map(np.atleast_1d, values.values()))
    return [
        [part, case, at, means, value, text]
        for at, row in zip(x, columns)
        for text, value in zip(values, row)
    ]


def collapse(
    lengths: str, beta: float, heights: np.ndarray, step: float = 5e-6, steps: int = 400
) -> np.ndarray:
    """Largest speed (H,) [m/s] of an apex let go at theta = pi/2 at `heights` (H,) [m], in NumPy.

    Equilateral triangles of 20 mm, (7) with `rest` or `current` lengths, three nodes held.
    """
    height = LENGTH * np.sqrt(0.75)
    x = np.array([two_triangles(0.5 * np.pi, (h, height), LENGTH) for h in heights])
    whole = np.tile(two_triangles(np.pi, (height, height), LENGTH), (len(heights), 1))
    creases = np.arange(len(whole)).reshape(-1, 4)
    rest, inside = reference.crease_frame(whole, creases), -np.ones(len(heights))
    v, largest = np.zeros((len(heights), 3)), np.zeros(len(heights))
    for _ in range(steps):
        nodal, *_ = forces_by_hand(x.reshape(-1, 3), creases, inside, rest, beta, lengths)
        v += step / CORNER * nodal.reshape(x.shape)[:, 2]
        x[:, 2] += step * v
        largest = np.maximum(largest, np.linalg.norm(v, axis=1))
    return largest


def collapse_by_hand(lengths: str, beta: float, heights: np.ndarray) -> np.ndarray:
    """Speed (H,) [m/s] from the work of (7) along the arc from theta = pi/2 to 0."""
    work = beta * BENDING * LENGTH * np.pi**2 / 8
    reach = heights if lengths == "current" else 0.75 * LENGTH**2 / heights
    return np.sqrt(2 * work / reach / CORNER)


def forces_by_hand(
    x: np.ndarray, creases: np.ndarray, inside: np.ndarray, rest: dict, beta: float, lengths: str
) -> tuple[np.ndarray, float, float]:
    """Forces of (7) and (8) in NumPy at positions `x` (N, 3) [m], with these `lengths` in (7).

    `creases` and `inside` are as in reference.crease_angle, `rest` is the crease_frame at rest.
    Returns the forces on the nodes (N, 3) [N], the largest one on an apex [N], and the lowest
    height over its rest value [-].
    """
    now = reference.crease_frame(x, creases)
    theta = reference.angle_of(now, inside)
    frame = now if lengths == "current" else rest
    moment = beta * BENDING * np.where(theta >= 0, 1.0, GAMMA) * frame["length"] * theta
    on_apex, largest, lowest = [], 0.0, np.inf
    for apex, sign in (("c", 1), ("d", -1)):
        height = "height_" + apex
        size = sign * inside * moment / np.maximum(frame[height], 1e-12) ** 2  # no 0/0
        on_apex.append(size[:, None] * now["normal_" + apex])
        largest = max(largest, float(np.abs(size).max()))
        lowest = min(lowest, float((now[height] / rest[height]).min()))
    nodal = reference.crease_balance(x, creases, now, rest, *on_apex, reference.COLLAPSED)
    return nodal, largest, lowest


@contextmanager
def creases_by_hand(
    mesh: SailMesh, built: scene.MembraneScene, beta: float, lengths: str
) -> Iterator[list[tuple[float, float]]]:
    """In the block (7) and (8) in NumPy make the forces of a sail's creases, and the plugin none.

    Unless `lengths`, those in (7), are `plugin`: its own creases. Yields a list to which each step
    adds largest force on an apex [N] and lowest height over its rest value [-].
    """
    seen: list[tuple[float, float]] = []
    if lengths == "plugin":
        yield seen
        return
    creases = reference.crease_nodes(mesh.triangles, mesh.creases)
    rest = reference.crease_frame(mesh.nodes, creases)

    def put():
        x = built.last_positions()
        nodal, largest, lowest = forces_by_hand(x, creases, -mesh.crease_signs, rest, beta, lengths)
        seen.append((largest, lowest))
        for i, force in zip(built.membrane.bodyIds, nodal.tolist()):
            O.forces.addF(i, force)

    built.forces.beta = 0.0
    __main__.put_crease_forces = put  # PyRunner looks there
    runner = yade.PyRunner(command="put_crease_forces()", iterPeriod=1, initRun=True)
    engines = O.engines
    at = next(i for i, e in enumerate(engines) if isinstance(e, type(built.forces)))
    O.engines = [*engines[: at + 1], runner, *engines[at + 1 :]]
    try:
        yield seen
    finally:
        del __main__.put_crease_forces


@np.errstate(all="ignore")
def sail_run(
    case: Case, lengths: str, seconds: float, row: float = 2e-3
) -> tuple[np.ndarray, np.ndarray]:
    """Run the paper's sail from its release, with creases by the plugin or `creases_by_hand`.

    Parameters
    ----------
    case : Case
    lengths : str
        `plugin`: its own creases; `rest`, `current`: those in (7), by hand.
    seconds, row : float
        [s]; it ends before if it has blown up. Time between rows [s].

    Returns
    -------
    rows : (S, 5) float
        Time [s], kinetic energy [J], largest speed of a node [m/s]; since the row before: largest
        force of a crease on an apex [N] and lowest height over its rest value [-].
    frames : (S, N, 3) float
        Positions [m].
    """
    beta, zeta, refine = case
    start = SailParameters(refine=refine, as_printed=refine > 1)
    sail, built = begin(replace(start, beta=beta, zeta=zeta), equilibrium(start), ledger=False)
    stride, between, looks = round(LOOK / O.dt), round(row / LOOK), round(seconds / LOOK)
    rows: list[list[float]] = []
    frames, told = [], 0
    with creases_by_hand(sail.mesh, built, beta, lengths) as seen:
        for look in range(1, looks + 1):
            try:
                scene.advance(stride)
            except RuntimeError:  # numbers overflowed between two looks
                lowest = min([1.0, *(height for _, height in seen[told:])])
                rows.append([look * LOOK, np.inf, np.inf, np.inf, lowest])
                break
            v = np.array([O.bodies[i].state.vel for i in built.membrane.bodyIds])
            energy = kinetic(built.masses(), v)
            last = look == looks or not energy < (BLOWN_UP * rows[0][1] if rows else np.inf)
            if look % between == 0 or last:
                force, height = zip((0.0, 1.0), *seen[told:])
                speed = float(np.linalg.norm(v, axis=1).max())
                rows.append([look * LOOK, energy, speed, max(force), min(height)])
                frames.append(built.positions())
                told = len(seen)
            if last:
                break
    assert lengths == "plugin" or len(seen) >= (round(rows[-1][0] / LOOK) - 1) * stride
    return np.array(rows), np.array(frames)


def blown_up(rows: np.ndarray) -> bool:
    """Whether rows of `sail_run` end by its kinetic energy."""
    return not rows[-1, 1] < BLOWN_UP * rows[0, 1]


def case_name(case: Case) -> str:
    """Name of a run of the sail."""
    beta, zeta, refine = case
    return f"beta = {beta:g}, zeta = {zeta:g}" + (f", refine = {refine}" if refine > 1 else "")


def angle_range(beta: float, seconds: float) -> tuple[float, float, int]:
    """Lowest and highest angle [rad] of the sail's creases, and how often one passed the cut."""
    _, built = begin(SailParameters(beta=beta), equilibrium(SailParameters()), ledger=False)
    seen = [built.forces.creaseAngles()]
    for _ in range(round(seconds / LOOK)):
        scene.advance(round(LOOK / O.dt))
        seen.append(built.forces.creaseAngles())
    passes = np.sum(np.abs(np.diff(seen, axis=0)) > np.pi)
    return float(np.min(seen)), float(np.max(seen)), int(passes)


# --- a pair ---


def force_and_energy(law: str, theta0: float, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force (S,) [N] of the plugin on C along its opening direction, and energy (S,) [J].

    At angles (S,) [rad], which may lie beyond the cut at 3 pi/2: the pair is turned on.
    """
    model = pair(beta=30.0, theta0=theta0, crease_law=law)
    found = []
    for theta in angles:
        x = two_triangles(theta)
        model.balance(x)
        opening = np.cross([1.0, 0, 0], x[2] - MIDDLE) / np.linalg.norm(x[2] - MIDDLE)
        # Sides are at rest: all of the force is the crease's.
        held = np.array(O.forces.permF(model.net.bodyIds[2]))
        found.append((-float(held @ opening), model.forces.creaseEnergy()))
    force, energy = np.transpose(found)
    return force, energy


def pair(rest: np.ndarray = two_triangles(np.pi), buckling: bool = True, **engine: Any) -> Model:
    """A Model of two triangles on a crease, with nodes at `rest` (4, 3) [m]."""
    alphas = {"alphaCrease": 100.0} if buckling else {"alpha": 1e12, "alphaCrease": 1e12}
    crease: dict = {"creases": [(0, 1)], "crease_signs": [1], **alphas}
    return Model(rest, TWO_TRIANGLES, engine=engine, **crease)


def opening(model: Model, start: np.ndarray) -> np.ndarray:
    """Velocities (4, 3) [m/s] of a pair that opens at `start` (4, 3) [m], its centre at rest.

    Those of the apexes over LENGTH are the rate of theta/2, 1/s, apart from the centre's motion.
    """
    spin = np.zeros((4, 3))
    for apex, sign in ((2, 1.0), (3, -1.0)):
        spin[apex] = sign * np.cross([1.0, 0, 0], start[apex] - MIDDLE)
    return spin - np.average(spin, axis=0, weights=model.masses)


def follow(
    model: Model,
    share: float,
    seconds: float,
    start: np.ndarray,
    velocities: ArrayLike | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """All energy [J] and the angle [rad] of a pair's crease in each step, both (S,).

    It begins at `start` (4, 3) [m] with `velocities` (4, 3) [m/s], default 0, and goes on for
    `seconds` in steps of `share` of the estimate.
    """
    model.place(start, velocities)
    O.dt = share * model.forces.criticalTimeStep()
    ledger = model.start_ledger()
    totals, angles = [], []
    for _ in range(int(seconds / O.dt)):
        scene.advance(1)
        totals.append(ledger.total + ledger.crease)
        angles.append(model.forces.creaseAngles(model.forces.lastPositions())[0])
    return np.array(totals), np.array(angles)


def swing(share: float, law: str, seconds: float = 0.05) -> tuple[float, np.ndarray]:
    """Largest relative error of the energy, and angles (S,) [rad], of a pair that swings freely."""
    model, start = pair(beta=300.0, crease_law=law), two_triangles(2.0)
    velocities = 3.0 / LENGTH * opening(model, start)
    totals, angles = follow(model, share, seconds, start, velocities)
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
    model = pair(buckling=False, beta=beta, theta0=theta0, crease_law=law)
    totals, angles = follow(model, share, seconds, two_triangles(theta0 - amplitude))
    angles -= theta0
    at = np.flatnonzero(angles[:-1] * angles[1:] < 0)
    zeros = (at + angles[at] / (angles[at] - angles[at + 1])) * O.dt
    error = np.nan  # of less than a period
    if len(zeros) > 2:
        last = 2 * ((len(zeros) - 1) // 2)
        found = np.pi * last / (zeros[last] - zeros[0])
        stiffness = beta * BENDING  # l_AB over the height is 1
        error = float(found / swing_frequency(model.masses, stiffness, theta0) - 1)
    return float(np.abs(totals / totals[0] - 1).max()), error


def turn_through_cut(law: str, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """A free pair, beta = 30, thrown open through the cut, where it turns on and on.

    Returns the angle [rad] without the cut, and the sum of all energies over K [-], both (S,).
    """
    beta = 30.0
    model = pair(buckling=False, beta=beta, crease_law=law)
    start = two_triangles(1.4 * np.pi)
    spin = opening(model, start)
    spin *= np.sqrt(5 * beta * BENDING / kinetic(model.masses, spin))
    totals, angles = follow(model, 0.2, seconds, start, spin)
    return np.unwrap(angles), totals / (beta * BENDING)


def momentum(
    law: str, ratio: float, zeta: float, seconds: float, samples: int = 100
) -> tuple[np.ndarray, np.ndarray]:
    """Angular momentum of a free pair with heights 1 : ratio, over time; NaN once it has blown up.

    Divided by the moment of inertia times 1/s, it is a spin rate [rad/s].
    """
    heights = (0.02, 0.02 * ratio)
    model = pair(two_triangles(np.pi, heights), beta=300.0, crease_law=law, zeta=zeta)
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
    for lengths, beta in product(LENGTHS, (30.0,) if quick else (3.0, 30.0, 300.0)):
        speeds[lengths, beta] = collapse(lengths, beta, HEIGHTS)
        values = {
            "largest speed of the apex (NumPy) [m/s]": speeds[lengths, beta],
            "by hand, from pi/2 to 0 [m/s]": collapse_by_hand(lengths, beta, HEIGHTS),
        }
        rows += listed("lengths", f"{lengths}, beta = {beta:g}", "height [m]", HEIGHTS, values)
    return speeds


def measure_sail(quick: bool, rows: list[list]) -> tuple[Runs, dict[Case, np.ndarray]]:
    """Runs {(case, lengths): rows} of the sail, and {case: distances (S,) [m]}.

    Distances are the largest ones of a node in the control from that in the plugin's own run.
    """
    runs, distances, row = {}, {}, 1e-3 if quick else 2e-3
    for case, seconds in ((SAIL[1][0], 2e-3),) if quick else SAIL:
        _, frames = sail_run(case, "plugin", seconds, row)
        current, _ = sail_run(case, "current", seconds, row)
        # The control need run no longer than up to the row at which the other has ended.
        count = int(np.ceil(current[-1, 0] / row - 1e-9))
        control, copies = sail_run(case, "rest", count * row, row)
        distances[case] = np.linalg.norm(copies - frames[:count], axis=2).max(axis=1)
        runs[case, "rest"], runs[case, "current"] = control, current
        for lengths, found in (("rest", control), ("current", current)):
            where = "sail", f"{lengths}, {case_name(case)}", "time [s]", found[:, 0]
            rows += listed(*where, dict(zip(SAIL_VALUES, found.T[1:])))
            if lengths == "rest":
                text = "largest distance from the plugin's own run [m]"
                rows += listed(*where, {text: distances[case]})
    return runs, distances


def measure_law(quick: bool, rows: list[list]) -> Curves:
    """Angles (S,) [rad] and forces (S,) [N] by law and theta0."""
    angles = np.linspace(-0.499, 1.499, 25 if quick else 81) * np.pi
    angles = np.sort(np.append(angles, [-1e-6, 1e-6]))
    curves: Curves = {}
    for law, theta0 in product(LAWS, (0.0, 0.5 * np.pi)):
        curves[law, theta0] = angles, force_and_energy(law, theta0, angles)[0]
        values = {"force on C [N]": curves[law, theta0][1]}
        rows += listed("law", f"{law}, theta0 = {theta0:.4g}", "theta [rad]", angles, values)
    return curves


def measure_swings(quick: bool, rows: list[list]) -> tuple[dict, dict]:
    """Energy errors by (law, share), and errors of energy and frequency about theta0."""
    shares = (0.5,) if quick else (0.8, 0.4, 0.2, 0.1)
    means, through, about = "step / estimate [-]", {}, {}
    for law, share in product(LAWS, shares):
        through[law, share], seen = swing(share, law, 0.005 if quick else 0.05)
        text = f"energy error, angles {seen.min():.3g} ... {seen.max():.3g} rad [-]"
        rows += listed("swing", law, means, [share], {text: through[law, share]})
    for law, theta0, size in product(LAWS, ("pi", "pi/2"), (0.02,) if quick else (0.02, 1.0)):
        for share in shares:
            found = swing_about(NATURAL[theta0], law, share, size, 0.03 if quick else 0.06)
            about[law, theta0, size, share] = found
            values = dict(zip(("energy error [-]", "frequency / by hand - 1 [-]"), found))
            case = f"{law}, theta0 = {theta0}, swing {size:g} rad"
            rows += listed("about", case, means, [share], values)
    return through, about


def measure_cut(quick: bool, rows: list[list]) -> tuple[Curves, Curves]:
    """Angles, forces and energies by law and theta0 around the cut; and free pairs by law."""
    angles = np.linspace(1.2, 1.8, 13 if quick else 61) * np.pi
    angles = np.sort(np.append(angles, 1.5 * np.pi + np.array([-1e-6, 1e-6])))
    curves: Curves = {}
    turns: Curves = {}
    for law in LAWS:
        for theta0 in (0.0, 0.5 * np.pi):
            force, energy = force_and_energy(law, theta0, angles)
            curves[law, theta0] = angles, force, energy
            where = "cut", f"{law}, theta0 = {theta0:.4g}", "theta [rad], turned on beyond 3 pi/2"
            rows += listed(*where, angles, {"force on C [N]": force, "crease energy [J]": energy})
        turns[law] = turned, energy = turn_through_cut(law, 0.002 if quick else 0.01)
        picks = np.linspace(0, len(turned) - 1, 10 if quick else 200).astype(int)
        where = "cut", f"{law}, free pair, theta0 = 0", "theta [rad] without the cut"
        rows += listed(*where, turned[picks], {"all energy / K [-]": energy[picks]})
    return curves, turns


def measure_range(quick: bool, rows: list[list]) -> Ranges:
    """What `angle_range` returns, by beta."""
    texts = "lowest theta [rad]", "highest theta [rad]", "times a crease passed the cut [-]"
    ranges = {}
    for beta in (30.0,) if quick else (30.0, 3.0, 0.3):
        ranges[beta] = angle_range(beta, 2e-3 if quick else 0.2)
        rows += listed("range", "paper", "beta [-]", [beta], dict(zip(texts, ranges[beta])))
    return ranges


def measure_momentum(quick: bool, rows: list[list]) -> Curves:
    """What `momentum` returns, by law, ratio of heights and zeta."""
    ratios = (1.0, 2.0) if quick else (1.0, 1.25, 1.5, 2.0, 3.0)
    spins: Curves = {}
    for law, ratio, zeta in product(LAWS, ratios, (0.0, 0.1)):
        spins[law, ratio, zeta] = _, spin = momentum(law, ratio, zeta, 0.01 if quick else 0.1)
        values = {"largest spin rate that came from nothing [rad/s]": spin.max()}
        where = "momentum", f"{law}, zeta = {zeta:g}", "ratio of heights [-]", [ratio]
        rows += listed(*where, values)
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

    drawing, axes = figure(columns=2, rows=4)
    draw_lengths(axes[0], speeds)
    draw_sail(axes[1], axes[2], runs)
    draw_law(axes[3], curves)
    draw_swings(axes[4], *swings)
    draw_momentum(axes[5], spins)
    draw_cut(axes[6], cuts, ranges)
    draw_turns(axes[7], turns)
    publish("creases", quick, HEADER, rows, drawing)
    return " ".join(
        (
            about_lengths(speeds, runs, distances),
            about_angles(curves, *swings),
            about_cut(cuts, turns, ranges),
            about_momentum(spins),
        )
    )


def about_lengths(speeds: dict, runs: Runs, distances: dict[Case, np.ndarray]) -> str:
    """A sentence on the lengths in (7)."""
    slow, fast = (speeds[lengths, 30.0] for lengths in LENGTHS)
    found = []
    for case in distances:
        rest, current = (runs[case, lengths] for lengths in LENGTHS)
        time = current[-1, 0]
        end = f"blows up at {time:.4g} s" if blown_up(current) else f"holds for {time:.3g} s"
        found.append(
            f"{case_name(case)}: {end}, lowest height {current[:, 4].min():.2g} of rest, largest "
            f"force {current[:, 3].max():.2g} N (with rest lengths {rest[:, 4].min():.2g} and "
            f"{rest[:, 3].max():.2g} N; control off the plugin by {distances[case][0]:.0e} m at "
            f"{rest[0, 0]:.0e} s)"
        )
    return (
        f"(7) at beta = 30 throws the apex of a triangle collapsed to {1e6 * HEIGHTS[0]:.2g} um "
        f"out at {fast[0]:.3g} m/s with current lengths, at {slow[0]:.2g} m/s with rest lengths "
        f"(NumPy; {fast.max():.3g} and {slow.max():.2g} m/s at most over all heights up to 10 mm). "
        f"The sail with current lengths, {'; '.join(found)}."
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
        color, marker = LENGTHS[lengths], {3.0: "v", 30.0: "o", 300.0: "^"}[beta]
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
        name = f"{law}, theta0 = {theta0 / np.pi:g} pi"
        axis.plot(angles / np.pi, force, LAWS[law], label=name)
    axis.set(xlabel="theta / pi [-]", ylabel="force on C, opening [N]")
    axis.set_yscale("symlog", linthresh=1e-5)
    axis.set_yticks([-1e-3, -1e-4, 0, 1e-4, 1e-3, 1e-2, 1e-1])
    for at in (-0.5, 0, 1, 1.5):
        axis.axvline(at, color="k", linewidth=0.5)
    axis.legend(fontsize=7)


def draw_swings(axis: Axes, through: dict, about: dict) -> None:
    """Error of the energy of swings through 0 and about pi, over the step."""
    for law, style in LAWS.items():
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
            axis.plot(times[1:], spin[1:] + 1e-16, LAWS[law], label=f"{law}, 1 : {ratio:g}")
    axis.set(xlabel="time [s]", ylabel="angular momentum / inertia [rad/s]", yscale="log")
    axis.legend(fontsize=6)


def draw_cut(axis: Axes, cuts: Curves, ranges: Ranges) -> None:
    """Force and energy on both sides of the cut, and the sail's highest angles."""
    stiffness = 30.0 * BENDING
    for (law, theta0), (angles, force, energy) in cuts.items():
        style = {"linestyle": LAWS[law], "alpha": 1 if theta0 == 0 else 0.5}
        name = f"{law}, theta0 = {theta0 / np.pi:g} pi"
        axis.plot(angles / np.pi, energy / stiffness, color="C0", **style)
        axis.plot(angles / np.pi, force * LENGTH / stiffness, color="C1", label=name, **style)
    for i, (beta, (_, high, _)) in enumerate(ranges.items()):
        axis.axvline(high / np.pi, color=f"C{i + 2}", label=f"highest, sail at beta = {beta:g}")
    axis.set(xlabel="theta / pi, turned on beyond the cut at 1.5 [-]")
    axis.set(ylabel="moment (orange), energy (blue) / K [-]")
    axis.legend(fontsize=6)


def draw_turns(axis: Axes, turns: Curves) -> None:
    """Energy of a free pair that turns through the cut."""
    for law, style in LAWS.items():
        turned, energy = turns[law]
        axis.plot(turned / np.pi, energy, style, label=law)
    gain = (GAMMA - 9) * np.pi**2 / 8  # gamma (pi/2)²/2 - (3 pi/2)²/2
    axis.set_title(f"free pair that opens and turns on; by hand {gain:.1f} K a turn", fontsize=8)
    axis.set(xlabel="theta / pi, without the cut [-]", ylabel="all energy / K [-]")
    axis.legend(fontsize=7)
