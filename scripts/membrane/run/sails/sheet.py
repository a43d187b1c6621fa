# SPDX-License-Identifier: GPL-2.0-or-later
"""Any sheet: a FOLD crease pattern or a mesh of gmsh, flat or in its folded form.

It starts turning as a whole; it flies free, or its hub is driven. Its centre of mass lies on the
spin axis.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ...measures import SHEET as MEASURES
from ...measures import SHEET_OUTCOMES, in_plots
from ...geometry import crossings
from ...mesh.fold_format import read_fold
from ...mesh.msh import read_msh
from ...mesh.pattern_mesh import default_size, mesh_pattern
from ...mesh.patterns import crease_pattern
from ...mesh.placing import place
from ...mesh.sheet_words import about_slow_sides, described, doubts
from ...parameters import SHEET, SPIN, RunParameters, attributes, changed, parameter, with_defaults
from ...progress import warn
from ...results.fold_series import write_series
from ...view import plots
from ..kind import FinishedSail, Kind, Sail

MOST_FINER = 100_000  # triangles of a mesh that is made finer than asked for, about
REMESH = ": remesh, or set allowNegativeStiffness"  # what Membrane says of too flat a triangle


@dataclass(frozen=True)
class Sheet:
    """The file of a sheet, and how it is put on the spin axis."""

    file: str = parameter("", "-", SHEET, "crease pattern (.fold) or mesh of gmsh (.msh)")
    unit: float = parameter(0.0, "m", SHEET, "length of the file's unit; 0: as the file says")
    size: float = parameter(0.0, "m", SHEET, "length of the mesh's sides; 0: some 800 triangles")
    start_frame: int = parameter(
        -1, "-", SHEET, "frame to start from; -1: the first folded form, if any", least=-1
    )
    flat: bool = parameter(False, "-", SHEET, "start flat even if there is a folded form")
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


# The law of creases as printed is no gradient where triangles at a crease are not equally high.
@dataclass(frozen=True)
@with_defaults(
    omega=changed(6 * np.pi, source=SPIN, text="spin rate at the start", above=False),
    gravity=changed(0.0, source=SPIN),
    alpha_crease=100.0,
    beta=3.0,
    crease_law="conservative",
    air_density=0.0,
)
class PatternParameters(RunParameters, Sheet, sail="sheet"):
    """Parameters of a sail from a file; those with names as in SailParameters mean the same."""


class AnySheet(Kind[PatternParameters]):
    """See the module."""

    title = "a crease pattern (.fold) or a mesh of gmsh (.msh)"
    parameters = PatternParameters
    measures = MEASURES
    outcomes = SHEET_OUTCOMES
    told = "projected_area"

    def sail(self, p: PatternParameters) -> Sail:
        """What lies in the file, on the axis."""
        return sail_of(read_sheet(p), p)

    def explained(self, refusal: str) -> str:
        """Meshing is the user's."""
        refused, remesh, _ = refusal.partition(REMESH)
        return refused + ("; mesh it otherwise, a crease pattern by another --size" * bool(remesh))

    def equip(self, sail: Sail, built: Any, p: PatternParameters) -> None:
        """Nothing is added; a side that makes the time step much shorter is told."""
        film = built.membrane
        springs = (np.array(a) for a in (film.sides, film.stiffnesses, film.masses))
        for doubt in about_slow_sides(sail.mesh.given, *springs, p.zeta, p.damping_time):
            warn(doubt)

    def draw(self, run: FinishedSail) -> None:
        """history.png and shapes.png."""
        draw_sheet(run, self.instants(run))

    def instants(self, run: FinishedSail) -> Sequence[float] | np.ndarray:
        """When shapes are shown [s]."""
        return while_it_opens(run)

    def leave(self, run: FinishedSail) -> dict:
        """sail.fold; how often layers cross at the end."""
        mesh, p = run.sail.mesh, run.parameters
        custom = {
            "membrane:material": attributes("MembraneMat", p),
            "vertices_membrane:pointMass": run.sail.point_masses.tolist(),
            "vertices_membrane:mass": run.built.masses().tolist(),
        }
        write_series(run.folder / "sail.fold", mesh, run.times.tolist(), run.frames, custom)
        crossed = len(crossings(run.frames[-1], mesh.lines[0], mesh.triangles))
        if crossed:
            warn(f"layers cross at the end: {crossed} times a side passes through a triangle")
        return {"final_crossings": crossed}


def draw_sheet(run: FinishedSail, instants: Sequence[float] | np.ndarray) -> None:
    """Draw history.png, and shapes.png at some instants [s], of a sail that SHEET measures."""
    columns = in_plots(MEASURES, run.history)
    plots.plot_history(run.history, columns, run.folder / "history.png")
    frames, times = run.show(instants)
    triangles, tips = run.sail.mesh.triangles, run.sail.tips
    plots.plot_sheets(frames, triangles, tips, run.folder / "shapes.png", times)


def while_it_opens(run: FinishedSail) -> np.ndarray:
    """Instants [s] up to the widest shape, or of all of the run."""
    areas = np.interp(run.times, run.history["time"], run.history["projected_area"])
    widest = int(np.argmax(areas))
    # A sheet that starts flat is widest at the start: then all of the run is shown.
    return run.until(widest if areas[widest] > 1.01 * areas[0] else -1)


def sail_of(sheet: Any, p: PatternParameters) -> Sail:
    """The Sail that is made of a SheetMesh.

    Raises
    ------
    ValueError
        If it has no hub where one is asked for.
    """
    placed = place(sheet, p)
    if p.hub_inertia and not len(placed.hub):
        raise ValueError(f"hub_inertia = {p.hub_inertia} kg m2: the sheet has no hub")
    words = f"{p.file}: {described(sheet, placed)}"
    about: dict = {"hub": placed.hub, "doubts": doubts(sheet), "words": words}
    return Sail(placed, placed.start, placed.tips, p.tip_mass, **about)


def read_sheet(p: PatternParameters) -> Any:
    """The SheetMesh of the file that PatternParameters name.

    Raises
    ------
    ValueError
        In one sentence that names the file, if it cannot be made into a sheet.
    """
    path = Path(p.file)
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
    return asked  # which the scene refuses


def _is_too_flat(sheet, p):
    """Whether equation (5) gives a side of a SheetMesh a negative stiffness."""
    from ... import Membrane, MembraneMat

    film = MembraneMat(**attributes("MembraneMat", p))
    try:
        Membrane(material=film, nodes=sheet.nodes, triangles=sheet.triangles, film=p.film)
    except ValueError as error:
        return REMESH in str(error)
    return False


KIND = AnySheet()
