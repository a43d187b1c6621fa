# SPDX-License-Identifier: GPL-2.0-or-later
"""Any sheet as a spinning sail: a FOLD crease pattern or a mesh of gmsh, run and recorded.

The sail starts flat, or in the pattern's folded form, turning as a whole; it flies free, or its
hub is driven. Its centre of mass lies on the spin axis.
"""

from dataclasses import asdict, dataclass, field, fields, replace
from math import ceil, pi
from pathlib import Path

import numpy as np
from yade import wrapper as yade_classes

from . import Membrane, measures, plots, scene
from .files import write_json
from .fold_format import FoldFile, FoldFrame, fold_angles, read_fold, write_fold
from .geometry import area_vectors, crease_angles, crossings, side_rows, triangle_areas
from .mesh import tip_masses
from .msh import read_msh
from .parameters import RUN, SailParameters, check, check_steps, parameter
from .pattern_mesh import default_size, mesh_pattern
from .patterns import crease_pattern, nearest_pose
from .progress import warn
from .record import LEDGER_UNITS, Recorder
from .sail import Stopwatch, add_membrane, check_step, counts, instants, last_good_saved, march
from .sail import nearest, set_engines, versions, write_page
from .sheet_words import about_slow_sides, doubts

SHEET, SPIN = "sheet", "spin"
MOST_FINER = 100_000  # triangles of a mesh that is made finer than asked for, about
REMESH = ": remesh, or set allowNegativeStiffness"  # what Membrane says of too flat a triangle
STEP = 0.5  # of the critical one, by default
TURN_STEP = 0.05  # rad: what the sail turns in a step, at most, by default
TURN = np.radians(20)  # by which the outline turns at a corner, at least
UNITS = {
    "time": "s",
    "mean_radius": "m",
    "tip_radius": "m",
    "projected_area": "-",
    "height": "m",
    "mean_crease_angle": "rad",
    "spin_rate": "rad/s",
    **LEDGER_UNITS,
}


def _as_in_the_paper(name, **changes):
    """A parameter of the paper's sail, with another default maybe."""
    (known,) = [item for item in fields(SailParameters) if item.name == name]
    return field(default=changes.get("default", known.default), metadata=known.metadata)


@dataclass(frozen=True)
class PatternParameters:
    """Parameters of a sail from a file; those with names as in SailParameters mean the same."""

    unit: float = parameter(0.0, "m", SHEET, "length of the file's unit; 0: as the file says")
    size: float = parameter(0.0, "m", SHEET, "length of the mesh's sides; 0: some 800 triangles")
    start_frame: int = parameter(
        -1, "-", SHEET, "frame to start from; -1: the first folded form, if any", least=-1
    )
    flat: bool = parameter(False, "-", SHEET, "start flat even if there is a folded form")

    omega: float = parameter(6 * pi, "rad/s", SPIN, "spin rate at the start")
    hub_radius: float = parameter(
        0.0,
        "m",
        SPIN,
        "nodes this near the axis turn steadily, as those of a mesh's group 'hub' do; "
        "0, and no such group: the sail flies free",
    )
    tip_mass: float = parameter(0.36e-3, "kg", SPIN, "mass at each tip")
    tips: str = parameter(
        "corners",
        "-",
        SPIN,
        "where the tip masses are: at a mesh's group 'tips' or else the corners of the outline, "
        "or at the nodes farthest from the axis",
        choices=("corners", "farthest", "none"),
    )
    gravity: float = parameter(0.0, "m/s2", SPIN, "along -z")

    thickness: float = _as_in_the_paper("thickness")
    young: float = _as_in_the_paper("young")
    poisson: float = _as_in_the_paper("poisson")
    density: float = _as_in_the_paper("density")
    theta0: float = _as_in_the_paper("theta0")
    alpha: float = _as_in_the_paper("alpha")
    alpha_crease: float = _as_in_the_paper("alpha_crease", default=100.0)
    beta: float = _as_in_the_paper("beta", default=3.0)
    gamma: float = _as_in_the_paper("gamma")
    zeta: float = _as_in_the_paper("zeta")
    # The law as printed is no gradient where triangles at a crease are not equally high.
    crease_law: str = _as_in_the_paper("crease_law", default="conservative")
    air_density: float = _as_in_the_paper("air_density", default=0.0)

    dt: float = parameter(0.0, "s", RUN, "time step; 0: half the critical one")
    duration: float = _as_in_the_paper("duration")
    history_interval: float = _as_in_the_paper("history_interval")
    shapes_interval: float = _as_in_the_paper("shapes_interval")
    energy_tolerance: float = _as_in_the_paper("energy_tolerance")
    path: str = _as_in_the_paper("path")
    exchange_period: int = _as_in_the_paper("exchange_period")
    force_time_step: bool = _as_in_the_paper("force_time_step")

    def __post_init__(self):
        check(self)


@dataclass(frozen=True, eq=False)
class PatternSail:
    """A sheet placed on the spin axis. N nodes.

    Attributes
    ----------
    nodes : (N, 3) float, node
        Rest positions [m].
    triangles, creases, crease_signs
        As of a SheetMesh.
    start : (N, 3) float, node
        Positions to start from [m].
    tips, hub : (n,) int, node
        With tip masses; driven.
    lines : tuple
        Sides (E, 2) and FOLD letters (E,) of the mesh.
    used : tuple of str
        Names of the file's groups that are tips or hub.
    """

    nodes: np.ndarray
    triangles: np.ndarray
    creases: np.ndarray
    crease_signs: np.ndarray
    start: np.ndarray
    tips: np.ndarray
    hub: np.ndarray
    lines: tuple
    used: tuple = ()


def read_sheet(path, p):
    """The SheetMesh of a .fold or .msh file.

    Parameters
    ----------
    path : path
    p : PatternParameters
        Of which unit, size and start_frame count.

    Raises
    ------
    ValueError
        In one sentence that names the file, if it cannot be made into a sheet.
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind not in (".fold", ".msh"):
        raise ValueError(f"{path}: must be a crease pattern (.fold) or a mesh of gmsh (.msh)")
    if kind == ".msh":
        if p.start_frame >= 0 or p.size:
            raise ValueError(f"{path}: a .msh file has neither frames nor a mesh size to choose")
        return read_msh(path, p.unit or 1.0)
    content = read_fold(path)
    try:
        pattern = crease_pattern(
            content, p.unit or None, None if p.start_frame < 0 else p.start_frame, p.flat
        )
        return _meshed(pattern, p)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _meshed(pattern, p):
    """The SheetMesh of a pattern, finer than asked for if only that makes no triangle too flat."""
    size = p.size or default_size(pattern.area)
    asked = mesh_pattern(pattern, size)
    if not _is_too_flat(asked, p):
        return asked
    for finer in (size / 2, size / 4):
        if pattern.area / finer**2 > MOST_FINER / 2.3:
            break
        sheet = mesh_pattern(pattern, finer)
        if not _is_too_flat(sheet, p):
            note = (
                f"with sides of {size:.3g} m a triangle would be too flat: they are made "
                f"{finer:.3g} m long, which gives {len(sheet.triangles)} triangles"
            )
            return replace(sheet, notes=(*sheet.notes, note))
    return asked  # which `build` refuses


def _is_too_flat(sheet, p):
    """Whether equation (5) gives a side of a SheetMesh a negative stiffness."""
    film = scene.film(p.young, p.poisson, p.density, p.thickness)
    try:
        Membrane(material=film, nodes=sheet.nodes, triangles=sheet.triangles)
    except ValueError as error:
        return REMESH in str(error)
    return False


def place(sheet, p):
    """Put a SheetMesh on the spin axis, choose its tips and its hub by PatternParameters `p`.

    Returns
    -------
    PatternSail

    Raises
    ------
    ValueError
        If no node lies within the hub's radius.
    """
    named = p.tips == "corners" and len(sheet.groups.get("tips", ())) > 0
    tips = sheet.groups["tips"] if named else _tips(sheet, p.tips)
    mass = _node_masses(sheet, p, tips)
    nodes = sheet.nodes - np.average(sheet.nodes, axis=0, weights=mass)
    folded = sheet.start is not None and not p.flat
    start = nearest_pose(sheet.start, nodes, mass) if folded else nodes
    hub = _hub(sheet, nodes, p.hub_radius)
    used = ("hub", "tips") if named else ("hub",)
    mesh = nodes, sheet.triangles, sheet.creases, sheet.crease_signs
    return PatternSail(*mesh, start, tips, hub, sheet.lines(), used)


def _hub(sheet, nodes, radius):
    """Nodes (n,) that are driven, of `nodes` (N, 3) [m] placed on the axis."""
    named = np.asarray(sheet.groups.get("hub", ()), dtype=int)
    if radius == 0:
        return named
    away = np.hypot(nodes[:, 0], nodes[:, 1])
    if radius < away.min():
        raise ValueError(
            f"hub_radius = {radius} m: no node is that near the axis; the nearest is at "
            f"{away.min():.4g} m"
        )
    return np.union1d(named, np.flatnonzero(away <= radius))


def _tips(sheet, choice):
    """Nodes (n,) that bear tip masses."""
    if choice == "none":
        return np.empty(0, dtype=int)
    around = sheet.rim
    away = sheet.nodes - sheet.nodes.mean(axis=0)
    radius = np.hypot(away[:, 0], away[:, 1])
    corners = outline_corners(sheet.nodes[:, :2], around)
    if choice == "farthest" or not len(corners):
        return around[radius[around] > (1 - 1e-6) * radius[around].max()]
    return corners


def outline_corners(points, among):
    """The nodes (n,) of `among` at corners of the convex outline of `points` (N, 2).

    Counter-clockwise; where the outline turns by less than 20 degrees there is no corner. Of nodes
    at the same place, as beside a cut, one is taken.
    """
    order = sorted(among.tolist(), key=lambda i: tuple(points[i]))
    tiny = 1e-9 * np.ptp(points[among], axis=0).max() ** 2

    def half(ids):  # Andrew's monotone chain
        chain = []
        for i in ids:
            while len(chain) > 1 and _turn(points, *chain[-2:], i)[0] <= tiny:
                chain.pop()
            if not chain or np.any(points[chain[-1]] != points[i]):
                chain.append(i)
        return chain[:-1]

    ring = half(order) + half(order[::-1])
    turns = [
        np.arctan2(*_turn(points, ring[k - 1], ring[k], ring[(k + 1) % len(ring)]))
        for k in range(len(ring))
    ]
    return np.array([i for i, turn in zip(ring, turns) if turn > TURN], dtype=int)


def _turn(points, a, b, c):
    """Cross and dot product of a -> b and b -> c."""
    (x, y), (u, v) = points[b] - points[a], points[c] - points[b]
    return x * v - y * u, x * u + y * v


def _node_masses(sheet, p, tips):
    """Masses (N,) [kg] of film and tips, equation (4)."""
    areas = triangle_areas(sheet.nodes, sheet.triangles)
    masses = np.zeros(len(sheet.nodes))
    np.add.at(masses, sheet.triangles, p.density * p.thickness * areas[:, None] / 3)
    masses[tips] += p.tip_mass
    return masses


def build(sail, p):
    """Put a PatternSail into the (empty) scene, at its start and turning; returns MembraneScene."""
    try:
        membrane = add_membrane(sail, sail.start, p)
    except ValueError as error:
        refused, remesh, _ = str(error).partition(REMESH)
        advice = "; mesh it otherwise, a crease pattern by another --size" if remesh else ""
        raise ValueError(refused + advice) from None
    made = set_engines(membrane, p, driven=[membrane.bodyIds[i] for i in sail.hub])
    made.hold(sail.hub)
    return made


class PatternRecorder(Recorder):
    """Recorder with measures that make sense for any sail."""

    units = UNITS

    def __init__(self, folder, sail, made):
        super().__init__(folder, sail, made, 0.0)
        self._mass = made.masses()
        self._flat_area = triangle_areas(sail.nodes, sail.triangles).sum()

    def measured(self, time, x):
        """Measures of the shape `x` (N, 3) [m] by name; UNITS has their units."""
        radius = np.hypot(x[:, 0], x[:, 1])
        inertia = np.sum(self._mass * radius**2)
        mesh = self.mesh
        angles = crease_angles(x, mesh.triangles, mesh.creases, mesh.crease_signs)
        return {
            "mean_radius": float(np.average(radius, weights=self._mass)),
            "tip_radius": float(np.mean(radius[mesh.tips if len(mesh.tips) else slice(None)])),
            "projected_area": float(area_vectors(x, mesh.triangles)[:, 2].sum() / self._flat_area),
            "height": float(np.ptp(x[:, 2])),
            "mean_crease_angle": float(angles.mean()) if len(angles) else pi,
            "spin_rate": float(self.sail.ledger.angularMomentum / inertia),
        }


def fly(sheet, p, folder, pictures=True, shown=None, page=True):
    """Run a sheet as a spinning sail and write the results into `folder`.

    Parameters
    ----------
    sheet : SheetMesh
    p : PatternParameters
    folder : path
        Made if missing.
    pictures : bool
        Draw shapes.png and history.png.
    shown : sequence of float, optional
        Up to six times [s] to show in shapes.png; default: up to the fullest deployment.
    page : bool
        Write report.html, as `sail.deploy` does.

    Returns
    -------
    dict
        What is written to summary.json, and `wall_time`, which has a file of its own.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    watch = Stopwatch()
    sail = place(sheet, p)
    made = build(sail, p)
    critical = made.forces.criticalTimeStep()
    steps = _steps(p, critical)
    check_step(steps.dt, critical, p)
    film = made.membrane
    springs = (np.array(a) for a in (film.sides, film.stiffnesses, film.masses))
    for doubt in [*doubts(sheet), *about_slow_sides(sheet.nodes, *springs, p.zeta)]:
        warn(doubt)
    yade_classes.Omega().dt = steps.dt
    scene.release(made, p.omega, [])
    made.rotation.dead, made.spool.dead = not len(sail.hub), True
    recorder = PatternRecorder(folder, sail, made)
    watch.lap("build")
    try:
        with last_good_saved(made, folder, yade_classes.Omega().iter):
            march(steps, recorder, lambda row: f"area {row['projected_area']:.3f}")
    finally:
        recorder.close()
    wall = watch.lap("run")
    history = recorder.columns()
    export(sail, recorder, made, p, folder / "sail.fold")
    if pictures:
        draw(sail, recorder, history, folder, shown)
    momentum = history["angular_momentum"] - history["angular_impulse"]
    crossed = len(crossings(recorder.frames[-1], sail.lines[0], sail.triangles))
    if crossed:
        warn(f"layers cross at the end: {crossed} times a side passes through a triangle")
    summary = {
        "parameters": asdict(p),
        "versions": versions(),
        "mesh": {
            **counts(sail, made.membrane),
            "tips": sail.tips.tolist(),
            "hub": sail.hub.tolist(),
            "film_mass": p.density * p.thickness * made.membrane.area,
        },
        "critical_time_step": critical,
        "dt": steps.dt,
        "measures": {
            **{f"final_{name}": float(history[name][-1]) for name in list(UNITS)[1:7]},
            "largest_projected_area": float(history["projected_area"].max()),
            "time_of_area_0.9": measures.first_time_above(
                history["time"], history["projected_area"], 0.9
            ),
            "largest_energy": float(history["kinetic_energy"].max()),
            **measures.energy_errors(history),
            "largest_change_of_angular_momentum": float(np.ptp(momentum)),
            "final_crossings": crossed,
        },
    }
    write_json(folder / "summary.json", summary)
    write_json(folder / "wall_time.json", wall)
    if page:
        write_page(folder)
    return {**summary, "wall_time": wall}


@dataclass(frozen=True)
class _Steps:
    """What `march` asks for, with steps and rows that end at the duration."""

    dt: float
    history_interval: float
    shapes_interval: float
    duration: float


def _steps(p, critical):
    """_Steps by PatternParameters, not longer than asked for, with the `critical` step [s] or not.

    Raises
    ------
    ValueError
        If there are no or too many steps.
    """
    if not 0 < p.duration >= p.dt:
        raise ValueError(
            f"duration = {p.duration} s: must be > 0" + (f" and >= dt = {p.dt} s" * (p.dt > 0))
        )
    longest = min(p.dt or STEP * critical, p.duration)
    if not p.dt and p.omega > 0:
        longest = min(longest, TURN_STEP / p.omega)
    check_steps(p.duration, longest)
    rows = _parts(p.duration, max(p.history_interval, longest))
    interval = p.duration / rows
    return _Steps(interval / _parts(interval, longest), interval, p.shapes_interval, p.duration)


def _parts(whole, most):
    """Into how many equal parts to divide `whole`, so that none is longer than `most`."""
    return max(1, ceil(whole / most * (1 - 1e-9)))


def draw(sail, recorder, history, folder, shown=None):
    """Write history.png, and shapes.png with the shapes nearest to the times `shown` [s]."""
    columns = {
        "projected_area": "projected area\nover flat area [-]",
        "tip_radius": "radius of the tips [m]",
        "mean_crease_angle": "mean crease\nangle [deg]",
        "spin_rate": "spin rate [rad/s]",
    }
    degrees = {"mean_crease_angle": np.degrees(history["mean_crease_angle"])}
    plots.plot_history({**history, **degrees}, columns, folder / "history.png")
    times = np.array(recorder.frame_times)
    if shown is None:
        areas = [area_vectors(x, sail.triangles)[:, 2].sum() for x in recorder.frames]
        widest = int(np.argmax(areas))
        # A sheet that starts flat is widest at the start: then all of the run is shown.
        picks = instants(times, widest if areas[widest] > 1.01 * areas[0] else len(times) - 1)
    else:
        picks = nearest(times, shown)
    frames = [recorder.frames[i] for i in picks]
    plots.plot_sheets(frames, sail.triangles, sail.tips, folder / "shapes.png", times[picks])


def export(sail, recorder, made, p, path):
    """Write the mesh and its recorded shapes as a FOLD file of several frames.

    The key frame is the flat mesh: creases M and V, all other sides inside the film J, its edge B.
    What only this package knows stands under keys of the namespace `membrane:`.
    """
    sides, letters = sail.lines
    rows = side_rows(sides, sail.creases)
    faces = tuple(sail.triangles)
    made_of = {name: getattr(p, name) for name in ("young", "poisson", "density", "thickness")}
    shared = {"edges": sides, "letters": letters, "faces": faces, "unit": "m"}
    flat = np.ptp(sail.nodes[:, 2]) == 0
    key_frame = FoldFrame(
        coords=sail.nodes,
        classes=("creasePattern",),
        attributes=("2D" if flat else "3D", "joins"),
        title="flat",
        custom={
            "membrane:material": made_of,
            "vertices_membrane:pointMass": tip_masses(sail, p.tip_mass).tolist(),
            "vertices_membrane:mass": made.masses().tolist(),
            "edges_membrane:kind": ["crease" if c in "MV" else "film" for c in letters],
            "membrane:hub": sail.hub.tolist(),
        },
        **shared,
    )
    frames = [key_frame]
    for now, x in zip(recorder.frame_times, recorder.frames):
        angles = np.zeros(len(sides))
        bent = crease_angles(x, sail.triangles, sail.creases, sail.crease_signs)
        angles[rows] = fold_angles(bent, sail.crease_signs)
        letters_now = letters.copy()
        # Faces that have passed through each other are bent the other way than the pattern says.
        letters_now[rows] = np.where(
            angles[rows] == 0, letters[rows], np.where(angles[rows] < 0, "M", "V")
        )
        same = np.array_equal(letters_now, letters)
        frames.append(
            FoldFrame(
                coords=x,
                angles=angles,
                classes=("foldedForm",),
                attributes=("3D", "joins"),
                title=f"t = {now:.6g} s",
                custom={**key_frame.custom, "membrane:time": now},
                **{**shared, "letters": letters if same else letters_now},
            )
        )
    texts = {"file_creator": "membrane"}
    write_fold(path, FoldFile(tuple(frames), texts, ("singleModel", "animation")))
