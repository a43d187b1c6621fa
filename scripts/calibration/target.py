# SPDX-License-Identifier: GPL-2.0-or-later
"""The curve to be met: read from a table, cut to its early part, its noise estimated."""

from dataclasses import dataclass

import numpy as np
from membrane.files import BadFile

from . import COLUMNS
from .table import read_table

FEWEST = 12  # times
# What no curve reaches in its own unit, and which unit it probably has.
BEYOND = {"phase_difference": (np.pi, "degrees"), "deployment_rate": (1.5, "percent")}


@dataclass(frozen=True)
class Target:
    """Curves that a run shall follow.

    Attributes
    ----------
    times : (S,) float
        Since the release [s], growing.
    columns : tuple of str
        Names of the C curves, of COLUMNS.
    values : (C, S) float
        In the units of COLUMNS.
    noise : (C,) float
        Standard deviation of what changes from one time to the next without reason.
    """

    times: np.ndarray
    columns: tuple
    values: np.ndarray
    noise: np.ndarray


def noise_of(values):
    """Standard deviation of white noise on smooth curves (C, S), from their third differences."""
    return np.sqrt(np.mean(np.diff(values, n=3, axis=1) ** 2, axis=1) / 20)


def read_target(path, columns=(), until=0.1):
    """Target from a table with a header, as history.csv; other columns may hold anything.

    Parameters
    ----------
    path : path
        Table with the column `time` [s] and one or more of COLUMNS.
    columns : sequence of str
        Those to use; default: all of COLUMNS that the table has.
    until : float
        Later times are left out [s].

    Returns
    -------
    Target

    Raises
    ------
    BadFile
        If it is no table, a column is missing, a number is not finite, a curve is flat or seems to
        be in another unit, or times do not grow or are too few.
    """
    found = read_table(path, ("time", *(columns or COLUMNS)))
    columns = tuple(columns) or tuple(name for name in COLUMNS if name in found)
    missing = [name for name in ("time", *columns) if name not in found]
    if missing or not columns:
        wanted = ", ".join(missing) or " or ".join(COLUMNS)
        raise BadFile(path, "line 1", f"has no column {wanted}")
    early = found["time"] <= until
    times, values = found["time"][early], np.array([found[name][early] for name in columns])
    if len(times) < FEWEST:
        reason = f"has {len(times)} times up to {until:g} s, not {FEWEST}; times are in s"
        raise BadFile(path, "", reason)
    if times[0] < 0 or np.any(np.diff(times) <= 0):
        raise BadFile(path, "", "times must be >= 0, the release, and grow")
    for name, curve in zip(columns, values):
        most, unit = BEYOND[name]
        if np.max(np.abs(curve)) > most:
            reached = curve[np.argmax(np.abs(curve))]
            there = "" if COLUMNS[name] == "-" else f" {COLUMNS[name]}"
            raise BadFile(
                path,
                name,
                f"reaches {reached:.4g}{there}, and no sail more than {most:.3g}{there}: are these "
                f"{unit}?",
            )
    if not np.ptp(values, axis=1).all():
        raise BadFile(path, "", "a curve does not vary")
    return Target(times, columns, values, noise_of(values))
