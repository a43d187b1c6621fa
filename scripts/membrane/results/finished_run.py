# SPDX-License-Identifier: GPL-2.0-or-later
"""A run of any sail, read back from its output folder: what pages and films show."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..files import BadFile, read_object
from ..geometry import MOUNTAIN, VALLEY
from ..mesh import mesh_of
from ..parameters import PatternParameters, SailParameters, from_values
from .output import list_series, read_cells, read_frame, read_history

TETHER = 2  # the series' field `kind`


@dataclass(frozen=True, eq=False)
class FinishedRun:
    """N nodes, T triangles, S shapes.

    Attributes
    ----------
    folder : Path
    parameters : SailParameters or PatternParameters
    summary : dict
        What is in summary.json.
    history : dict of (R,) float
        Columns of history.csv.
    shapes : list of (float, Path)
        Times [s] and .vtu files.
    triangles : (T, 3) int, node
    creases, crease_signs : (C, 2) int, node; (C,) int
        Fold lines, and MOUNTAIN or VALLEY.
    cables : (K, 2) int, node
        Tethers.
    tips : (n,) int, node
        With tip masses.
    spool : (float, float) or None
        Its radius and height [m].
    """

    folder: Path
    parameters: object
    summary: dict
    history: dict
    shapes: list
    triangles: np.ndarray
    creases: np.ndarray
    crease_signs: np.ndarray
    cables: np.ndarray
    tips: np.ndarray
    spool: tuple | None

    def turned(self, times):
        """Angles (n,) [rad] since the start by which hub or sail have turned at `times` (n,) [s].

        Of a sail that flies free it is the integral of its mean spin rate.
        """
        times, rows = np.asarray(times), self.history["time"]
        if "hub_angle" in self.history:
            angles = self.history["hub_angle"]
        elif self.spool or self.summary["mesh"]["hub"]:
            angles = self.parameters.omega * rows
        else:
            rates = self.history["spin_rate"]
            angles = np.append(0.0, np.cumsum(np.diff(rows) * (rates[1:] + rates[:-1]) / 2))
        return np.interp(times, rows, angles - angles[0])


def read_run(folder):
    """The FinishedRun of an output folder of `deploy`, `case`, `sail`, `miura` or `ikaros`.

    Raises
    ------
    ValueError
        In one sentence that names the file, if there is something wrong with it.
    OSError
        If one is missing.
    """
    folder = Path(folder)
    file = folder / "summary.json"
    summary = read_object(file)
    p = _parameters(file, summary.get("parameters"))
    table = folder / "history.csv"
    history = read_history(table)
    if "time" not in history or not len(history["time"]):
        raise BadFile(table, "", "must have a column of times, and rows")
    shapes = list_series(folder / "shapes" / "film.pvd")
    lines = list_series(folder / "shapes" / "sides.pvd")
    triangles = read_cells(shapes[0][1], 3)
    sides = read_cells(lines[0][1], 2)
    nodes = len(read_frame(shapes[0][1])[0])
    fields = read_frame(lines[0][1])[1]
    for name in ("fold", "kind"):
        if name not in fields:
            raise BadFile(lines[0][1], name, "is missing")
    folds, kinds = fields["fold"], fields["kind"]
    is_paper_sail = isinstance(p, SailParameters)
    return FinishedRun(
        folder,
        p,
        summary,
        history,
        shapes,
        triangles,
        sides[folds != 0],
        np.where(folds[folds != 0] > 0, MOUNTAIN, VALLEY),
        sides[kinds == TETHER],
        _paper_tips(file, p, nodes) if is_paper_sail else _tips(file, summary, nodes),
        (p.spool_radius, p.spool_height) if is_paper_sail else None,
    )


def _parameters(file, values):
    """Parameters of the paper's sail or of one made from a pattern."""
    if not isinstance(values, dict):
        raise BadFile(file, "parameters", "must be an object")
    kind = SailParameters if "outer_width" in values else PatternParameters
    return from_values(file, values, kind)


def _paper_tips(file, p, nodes):
    """Tips of the paper's sail, which must have so many nodes."""
    try:
        mesh = mesh_of(p)
    except ValueError as error:
        raise BadFile(file, "parameters", str(error)) from None
    if len(mesh.nodes) != nodes:
        raise BadFile(
            file, "parameters", f"are of {len(mesh.nodes)} nodes; the shapes have {nodes}"
        )
    return mesh.tips


def _tips(file, summary, nodes):
    """Tips that a summary tells."""
    mesh = summary.get("mesh")
    found = [mesh.get(name) for name in ("tips", "hub")] if isinstance(mesh, dict) else [None]
    for ids in found:
        if not isinstance(ids, list) or not all(type(i) is int and 0 <= i < nodes for i in ids):
            raise BadFile(file, "mesh", f"must tell tips and hub, nodes below {nodes}")
    return np.array(found[0], dtype=int)
