# SPDX-License-Identifier: GPL-2.0-or-later
"""The curve to be met: read from a table, cut to its early part, its noise estimated."""

from dataclasses import dataclass

import numpy as np

from . import COLUMNS

FEWEST = 12  # times


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
    """Target from a CSV file with a header, as history.csv; other columns are not looked at.

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
    ValueError
        If a column is missing, a number is not finite, a curve is flat, or times do not grow or
        are too few.
    """
    table = np.atleast_1d(np.genfromtxt(path, delimiter=",", names=True))
    found = table.dtype.names or ()
    columns = tuple(columns) or tuple(name for name in COLUMNS if name in found)
    missing = [name for name in ("time", *columns) if name not in found]
    if missing or not columns:
        wanted = ", ".join(missing) or " or ".join(COLUMNS)
        raise ValueError(f"{path}: has no column {wanted}")
    table = table[table["time"] <= until]
    values = np.array([table[name] for name in columns])
    if len(table) < FEWEST:
        raise ValueError(
            f"{path}: has {len(table)} times up to {until:g} s; must be at least {FEWEST}"
        )
    if not (np.isfinite(values).all() and np.isfinite(table["time"]).all()):
        raise ValueError(f"{path}: has values that are not numbers")
    if table["time"][0] < 0 or np.any(np.diff(table["time"]) <= 0):
        raise ValueError(f"{path}: times must be >= 0, the release, and grow")
    if not np.ptp(values, axis=1).all():
        raise ValueError(f"{path}: a curve does not vary")
    return Target(table["time"], columns, values, noise_of(values))
