# SPDX-License-Identifier: GPL-2.0-or-later
"""The page report.html of a run: the sail in 3-D, to be played and turned, beside its curves.

The page is one file that needs no network. `viewer.html` beside this module is its empty form,
made by `scripts/run.sh viewer` from the sources in viewer/; here a run's results are put into it.
"""

import base64
import json
from dataclasses import fields as parameter_fields
from pathlib import Path
from typing import Any

import numpy as np

from ..files import BadFile, replace_text
from ..geometry import crease_angles
from ..measures import EVERY, MILLIJOULES, in_plots, table
from ..results import own
from ..results.finished_run import read_run
from ..results.output import read_frame
from ..results.unfinished import name_of

PAGE = "report.html"
TEMPLATE = Path(__file__).with_name("viewer.html")
PLACE = "__RUN__"
LARGEST = 40e6  # of the results in the page [bytes]; a larger run shows fewer of its shapes

# What triangles may be coloured by: name of the field, label, unit, factor from SI, meaning.
FIELDS = (
    ("side_strain", "side strain", "10⁻⁶", 1e6, "mean of a triangle's sides"),
    ("tension", "tension", "mN", 1e3, "mean of a triangle's sides"),
    ("buckled", "buckled sides", "%", 100.0, "share of a triangle's sides"),
    ("crease_angle", "crease angle", "deg", 180 / np.pi, "0 folded, 180 flat or no fold line"),
)
# Those of a film of plane stress.
FILM_FIELDS = (
    ("film_state", "film state", "-", 1.0, "0 taut, 1 wrinkled, 2 slack"),
    ("first_stress", "first stress", "kPa", 1e-3, "larger principal stress"),
)


class NoViewer(RuntimeError):
    """The viewer has not been built."""


def write_report(folder: Path | str) -> Path:
    """Write `folder`/report.html from the other results of a finished run, and return its Path.

    They are summary.json, history.csv and shapes/; OSError if one is missing. NoViewer if the
    viewer has not been built.
    """
    folder = Path(folder)
    if not TEMPLATE.is_file():
        raise NoViewer("its viewer is not built; `scripts/run.sh viewer` builds it, with npm")
    before, after = TEMPLATE.read_text(encoding="utf-8").split(PLACE)
    # "<" could end the page's script.
    content = json.dumps(run_data(folder), allow_nan=False).replace("<", "\\u003c")
    page = folder / PAGE
    own.add_to_list(folder, [PAGE])
    replace_text(page, before + content + after)
    return page


def run_data(folder: Path | str) -> dict[str, Any]:
    """What the page shows of a run, as plain lists, numbers and packed arrays (see `_pack`)."""
    run = read_run(folder)
    triangles = len(run.triangles)
    first, there = read_frame(run.shapes[0][1])
    nodes = len(first)
    fields = FIELDS + tuple(field for field in FILM_FIELDS if field[0] in there)
    per_shape = 6 * nodes + len(fields) * triangles + len(run.creases)
    shapes = thinned(run.shapes, per_shape)
    positions, data = zip(*[_frame(path, nodes, triangles, fields) for _, path in shapes])
    frames = np.array(positions)
    times = [time for time, _ in shapes]
    creases = (run.triangles, run.creases, run.crease_signs)
    angles = np.array([crease_angles(frame, *creases) for frame in frames])
    return {
        "name": name_of(folder),
        "times": times,
        "turned": run.turned(times).tolist(),
        "positions": _lengths(frames),
        "triangles": _pack(run.triangles, np.uint32),
        "fields": [_field(data, *about) for about in fields],
        "creases": _pack(run.creases, np.uint32),
        "creaseSigns": run.crease_signs.tolist(),
        "creaseAngles": _levels(np.degrees(angles), 0.0, 180.0),
        "cables": _pack(run.cables, np.uint32),
        "tips": run.tips.tolist(),
        "spool": run.spool and dict(zip(("radius", "height"), run.spool)),
        **_curves(run.history),
        "tables": [_measures(run.summary, nodes), _parameters(run.parameters)],
    }


def _frame(path, nodes, triangles, wanted):
    """Positions and wanted fields of a shape; BadFile if it is not one of this sail."""
    positions, data = read_frame(path)
    if len(positions) != nodes or not np.isfinite(positions).all():
        raise BadFile(path, "", f"must hold {nodes} nodes at finite positions")
    for name, *_ in wanted:
        if name not in data or len(data[name]) != triangles or not np.isfinite(data[name]).all():
            raise BadFile(path, name, f"must be {triangles} finite values")
    return positions, data


def thinned(shapes: list, per_shape: int, largest: float = LARGEST) -> list:
    """Every n-th of the `shapes`, the last one included, so that the page does not grow too large.

    Each takes `per_shape` bytes; all together `largest`, which is exceeded by large meshes, of
    which two shapes are kept.
    """
    keep = max(2, int(largest / per_shape))
    return shapes[:: -max(1, -(-len(shapes) // keep))][::-1]


def _pack(values, kind):
    """An array as base64 of its bytes in C order, little-endian."""
    packed = np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<"))
    return base64.b64encode(packed.tobytes()).decode()


def _lengths(values):
    """Lengths [m] of any shape as 16-bit integers, rounded to within half of `unit` [m]."""
    unit = float(np.abs(values).max()) / np.iinfo(np.int16).max
    return {"unit": unit, "data": _pack(np.rint(values / unit), np.int16)}


def _levels(values, low, high):
    """Values of any shape as 256 levels from `low` to `high`; those outside go to the ends."""
    share = np.clip((np.asarray(values) - low) / (high - low), 0, 1)
    return {"low": low, "high": high, "data": _pack(np.rint(255 * share), np.uint8)}


def _field(data, name, label, unit, factor, meaning):
    """A field of the triangles over all shapes, in the unit shown."""
    values = factor * np.array([fields[name] for fields in data], dtype=float)
    low, high = _range(name, values)
    cut = bool(np.min(values) < low or np.max(values) > high)
    about = {"name": name, "label": label, "unit": unit, "meaning": meaning, "cut": cut}
    return {**about, **_levels(values, low, high)}


def _range(name, values):
    """Where the colours of a field begin and end, in the unit shown."""
    if name == "buckled":
        return 0.0, 100.0
    if name == "crease_angle":
        return 0.0, 180.0
    if name == "film_state":
        return 0.0, 2.0
    # The film shortens a thousand times as much as it stretches; the scale is the taut film's.
    taut = values[values > 0]
    high = float(f"{np.percentile(taut, 95):.1e}") if len(taut) else 1.0
    return (-high if name == "side_strain" else 0.0), high


def _curves(history):
    """The curves and their times, six digits each."""

    def shorten(values):
        return [float(f"{value:.6g}") for value in values]

    curves = []
    for title, unit, factor, lines in in_plots(EVERY, history):
        if unit == "J" and max(np.abs(history[m.name]).max() for m in lines) < 1:
            unit, factor = MILLIJOULES
        drawn = [
            {"label": m.label, "minor": m.minor, "values": shorten(factor * history[m.name])}
            for m in lines
        ]
        curves.append({"label": title, "unit": unit, "lines": drawn})
    return {"historyTimes": shorten(history["time"]), "curves": curves}


def _measures(summary, nodes):
    """Table of the main measures."""
    found = summary.get("measures")
    rows = [["nodes", str(nodes), "-"], *table(found if isinstance(found, dict) else {})]
    return {"title": "Measures", "head": ["measure", "value", "unit"], "rows": rows}


def _parameters(p):
    """Table of all parameters; values that are not the default carry it behind."""
    rows = []
    for item in parameter_fields(p):
        value, unit = getattr(p, item.name), item.metadata["unit"]
        text = _number(value)
        if value != item.default:
            text += f" (default {_number(item.default)})"
        rows.append([item.name, text, unit, f"{item.metadata['text']} ({item.metadata['source']})"])
    return {"title": "Parameters", "head": ["parameter", "value", "unit", "meaning"], "rows": rows}


def _number(value):
    return f"{value:g}" if type(value) is float else str(value)
