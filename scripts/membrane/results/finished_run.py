# SPDX-License-Identifier: GPL-2.0-or-later
"""A run of any sail, read back from its output folder: what pages and films show."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..files import BadFile, read_object, shown
from ..geometry import MOUNTAIN, VALLEY
from ..parameters import KINDS, RunParameters, Spool, from_values
from .output import list_series, read_cells, read_frame, read_history

TETHER = 2  # the series' field `kind`


@dataclass(frozen=True, eq=False)
class FinishedRun:
    """N nodes, T triangles, S shapes; arrays of int hold ids of nodes."""

    folder: Path
    parameters: RunParameters
    summary: dict  #: what is in summary.json
    history: dict  #: columns (R,) of history.csv by name
    shapes: list  #: times [s] and .vtu files, (float, Path)
    triangles: np.ndarray  #: (T, 3)
    creases: np.ndarray  #: (C, 2), fold lines
    crease_signs: np.ndarray  #: (C,), MOUNTAIN or VALLEY
    cables: np.ndarray  #: (K, 2), tethers
    tips: np.ndarray  #: (n,), with tip masses
    spool: tuple | None  #: its radius and height [m]
    has_hub: bool  #: whether nodes turn with a hub

    def turned(self, times: Any) -> np.ndarray:
        """Angles (n,) [rad] since the start by which hub or sail have turned at `times` (n,) [s].

        Of a sail that flies free it is the integral of its mean spin rate.
        """
        times, rows = np.asarray(times), self.history["time"]
        if "hub_angle" in self.history:
            angles = self.history["hub_angle"]
        elif self.has_hub:
            angles = self.parameters.omega * rows
        else:
            rates = self.history["spin_rate"]
            angles = np.append(0.0, np.cumsum(np.diff(rows) * (rates[1:] + rates[:-1]) / 2))
        return np.interp(times, rows, angles - angles[0])


def read_run(folder: str | Path) -> FinishedRun:
    """The FinishedRun of an output folder of `deploy`, `case`, `sail`, `miura` or `ikaros`.

    ValueError, in one sentence that names the file, if there is something wrong with it; OSError if
    one is missing.
    """
    folder = Path(folder)
    file = folder / "summary.json"
    summary = read_object(file)
    p = _parameters(file, summary)
    table = folder / "history.csv"
    history = read_history(table)
    if "time" not in history or not len(history["time"]):
        raise BadFile(table, "", "must have a column of times, and rows")
    shapes = list_series(folder / "shapes" / "film.pvd")
    lines = list_series(folder / "shapes" / "sides.pvd")
    triangles = read_cells(shapes[0][1], 3)
    sides = read_cells(lines[0][1], 2)
    nodes = len(read_frame(shapes[0][1])[0])
    mesh = summary.get("mesh")
    if not isinstance(mesh, dict) or mesh.get("nodes") != nodes:
        raise BadFile(file, "mesh", f"must be of {nodes} nodes, as the shapes are")
    fields = read_frame(lines[0][1])[1]
    for name in ("fold", "kind"):
        if name not in fields:
            raise BadFile(lines[0][1], name, "is missing")
    folds, kinds = fields["fold"], fields["kind"]
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
        _nodes(file, summary, "tips", nodes),
        (p.spool_radius, p.spool_height) if isinstance(p, Spool) else None,
        len(_nodes(file, summary, "hub", nodes)) > 0,
    )


def _parameters(file, summary):
    """Parameters of a kind of sail."""
    values, sail = summary.get("parameters"), summary.get("sail")
    if not isinstance(values, dict):
        raise BadFile(file, "parameters", "must be an object")
    if not (isinstance(sail, str) and sail in KINDS):
        raise BadFile(file, "sail", f"is {shown(sail)}; must be one of {', '.join(KINDS)}")
    return from_values(file, values, KINDS[sail])


def _nodes(file, summary, name, nodes):
    """Nodes (n,) of a name that a summary tells."""
    ids = summary["mesh"].get(name)
    if not isinstance(ids, list) or not all(type(i) is int and 0 <= i < nodes for i in ids):
        raise BadFile(file, f"mesh.{name}", f"must be a list of nodes, which are below {nodes}")
    return np.array(ids, dtype=int)
