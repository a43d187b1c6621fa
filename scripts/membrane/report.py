# SPDX-License-Identifier: GPL-2.0-or-later
"""The page report.html of a run: the sail in 3-D, to be played and turned, beside its curves.

The page is one file that needs no network. `viewer.html` beside this module is its empty form,
made by `scripts/run.sh viewer` from the sources in viewer/; here a run's results are put into it.
"""

import base64
import json
from dataclasses import fields as parameter_fields
from pathlib import Path

import numpy as np

from .geometry import crease_angles
from .mesh import mesh_of
from .output import list_series, read_frame, read_history
from .parameters import SailParameters
from .unfinished import name_of

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

# Plots: label, unit, factor from SI, lines as (column of history.csv, label).
CURVES = (
    ("deployment rate", "-", 1.0, [("deployment_rate", "rate")]),
    (
        "phase difference",
        "deg",
        180 / np.pi,
        [
            ("phase_difference", "mean"),
            *[(f"phase_difference_{tip}", f"tip {tip}") for tip in range(4)],
        ],
    ),
    (
        "energy",
        "mJ",
        1e3,
        [
            ("spool_work", "spool work"),
            ("kinetic_energy", "kinetic"),
            ("elastic_energy", "elastic"),
            ("crease_energy", "creases"),
            ("damping_work", "damping work"),
        ],
    ),
)

# Measures of summary.json: name, label, unit, factor from SI.
MEASURES = (
    ("final_deployment_rate", "deployment rate at the end", "-", 1.0),
    ("largest_deployment_rate", "largest deployment rate", "-", 1.0),
    ("time_of_rate_0.9", "deployment rate above 0.9 from", "s", 1.0),
    ("largest_lag", "largest lag of the tips", "deg", 180 / np.pi),
    ("time_of_largest_lag", "time of the largest lag", "s", 1.0),
    ("return_time", "tips back at the spool's angle", "s", 1.0),
    ("largest_spool_work", "largest work of the spool", "mJ", 1e3),
    ("largest_energy_imbalance", "largest energy imbalance", "mJ", 1e3),
)


class NoViewer(RuntimeError):
    """The viewer has not been built."""


def write_report(folder):
    """Write `folder`/report.html from the other results in this folder.

    Parameters
    ----------
    folder : path
        Of a finished run, with summary.json, history.csv and shapes/.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    NoViewer
        If the viewer has not been built.
    OSError
        If a result is missing.
    """
    folder = Path(folder)
    if not TEMPLATE.is_file():
        raise NoViewer("its viewer is not built; `scripts/run.sh viewer` does it, with npm")
    before, after = TEMPLATE.read_text().split(PLACE)
    # "<" could end the page's script.
    content = json.dumps(run_data(folder), allow_nan=False).replace("<", "\\u003c")
    page = folder / PAGE
    page.write_text(before + content + after)
    return page


def run_data(folder):
    """What the page shows of a run, as plain lists, numbers and packed arrays (see `_pack`)."""
    summary = json.loads((folder / "summary.json").read_text())
    p = SailParameters(**summary["parameters"])
    mesh = mesh_of(p)
    per_shape = 6 * len(mesh.nodes) + len(FIELDS) * len(mesh.triangles) + len(mesh.creases)
    shapes = thinned(list_series(folder / "shapes" / "film.pvd"), per_shape)
    positions, data = zip(*[read_frame(path) for _, path in shapes])
    frames = np.array(positions)
    creases = (mesh.triangles, mesh.creases, mesh.crease_signs)
    angles = np.array([crease_angles(frame, *creases) for frame in frames])
    return {
        "name": name_of(folder),
        "times": [time for time, _ in shapes],
        "positions": _lengths(frames),
        "triangles": _pack(mesh.triangles, np.uint32),
        "fields": [_field(data, *about) for about in FIELDS],
        "creases": _pack(mesh.creases, np.uint32),
        "creaseSigns": mesh.crease_signs.tolist(),
        "creaseAngles": _levels(np.degrees(angles), 0.0, 180.0),
        "cables": _pack(mesh.cables, np.uint32),
        "tips": mesh.tips.tolist(),
        "spool": {"radius": p.spool_radius, "height": p.spool_height, "omega": p.omega},
        **_curves(read_history(folder / "history.csv")),
        "tables": [_measures(summary), _parameters(p)],
    }


def thinned(shapes, per_shape, largest=LARGEST):
    """Every n-th of the `shapes`, the last one included, so that the page does not grow too large.

    Parameters
    ----------
    shapes : list
    per_shape : int
        Bytes of each.
    largest : float
        Of all together [bytes]; exceeded by large meshes, of which two shapes are kept.
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
    # The film shortens a thousand times as much as it stretches; the scale is the taut film's.
    taut = values[values > 0]
    high = float(f"{np.percentile(taut, 95):.1e}") if len(taut) else 1.0
    return (-high if name == "side_strain" else 0.0), high


def _curves(history):
    """The curves and their times, six digits each."""

    def shorten(values):
        return [float(f"{value:.6g}") for value in values]

    curves = [
        {
            "label": label,
            "unit": unit,
            "lines": [
                {
                    "label": name,
                    "minor": name.startswith("tip "),
                    "values": shorten(factor * history[column]),
                }
                for column, name in lines
            ],
        }
        for label, unit, factor, lines in CURVES
    ]
    return {"historyTimes": shorten(history["time"]), "curves": curves}


def _measures(summary):
    """Table of the main measures."""
    rows = [["nodes", str(summary["mesh"]["nodes"]), "-"]]
    for name, label, unit, factor in MEASURES:
        value = summary["measures"][name]
        rows.append([label, "never" if value is None else f"{factor * value:.4g}", unit])
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
