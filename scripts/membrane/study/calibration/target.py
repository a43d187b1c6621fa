# SPDX-License-Identifier: GPL-2.0-or-later
"""The curve to be met: read from a table, cut to its early part, its noise estimated."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from membrane.files import BadFile

from . import columns_of, usual_columns
from .table import read_table

FEWEST = 12  # times
MEANT = {"rad": "degrees", "-": "percent"}  # by the unit that a curve should have


@dataclass(frozen=True)
class Target:
    """Curves that a run shall follow."""

    times: np.ndarray  #: (S,), since the release [s], growing
    columns: tuple  #: names of the C curves, of `columns_of`
    values: np.ndarray  #: (C, S), in the units of the measures
    noise: np.ndarray  #: (C,), standard deviation from one time to the next without reason


def noise_of(values: np.ndarray) -> np.ndarray:
    """Standard deviation of white noise on smooth curves (C, S), from their third differences."""
    return np.sqrt(np.mean(np.diff(values, n=3, axis=1) ** 2, axis=1) / 20)


def read_target(
    path: str | Path, columns: Sequence[str] = (), until: float = 0.1, sail: str = "square"
) -> Target:
    """Target from a table with a header, as history.csv; other columns may hold anything.

    It has the column `time` [s] and one or more curves, the measures of a kind of sail: `columns`
    names those to use, by default those of `usual_columns` that the table has. Times later than
    `until` [s] are left out. BadFile if it is no table, a column is missing, a number is not
    finite, a curve is flat or seems to be in another unit, or times do not grow or are too few.
    """
    usual, known = usual_columns(sail), columns_of(sail)
    found = read_table(path, ("time", *(columns or usual)))
    columns = tuple(columns) or tuple(name for name in usual if name in found)
    missing = [name for name in ("time", *columns) if name not in found]
    if missing or not columns:
        wanted = ", ".join(missing) or " or ".join(usual)
        raise BadFile(path, "line 1", f"has no column {wanted}")
    early = found["time"] <= until
    times, values = found["time"][early], np.array([found[name][early] for name in columns])
    if len(times) < FEWEST:
        reason = f"has {len(times)} times up to {until:g} s, not {FEWEST}; times are in s"
        raise BadFile(path, "", reason)
    if times[0] < 0 or np.any(np.diff(times) <= 0):
        raise BadFile(path, "", "times must be >= 0, the release, and grow")
    for name, curve in zip(columns, values):
        _check_unit(path, known[name], curve)
    if not np.ptp(values, axis=1).all():
        raise BadFile(path, "", "a curve does not vary")
    return Target(times, columns, values, noise_of(values))


def _check_unit(path, measure, curve):
    """BadFile if a curve (S,) of a Measure seems to be in another unit."""
    reached = curve[np.argmax(np.abs(curve))]
    if abs(reached) > measure.most:
        unit = "" if measure.unit == "-" else f" {measure.unit}"
        reason = f"reaches {reached:.4g}{unit}, and no sail more than {measure.most:.3g}{unit}"
        raise BadFile(path, measure.name, f"{reason}: are these {MEANT[measure.unit]}?")
