# SPDX-License-Identifier: GPL-2.0-or-later
"""Reads tables of scalars over time, as output.HistoryWriter writes them. Needs no YADE, no VTK."""

import csv
import io
import math

import numpy as np

from .files import BadFile, read_text, shown


def read_history(path):
    """Columns of a .csv file as HistoryWriter makes them: dict of (S,) float by name.

    Raises
    ------
    BadFile
        If it is no complete table, under names that differ, with finite numbers.
    """
    text = read_text(path)
    if not text.endswith("\n"):
        raise BadFile(path, f"line {text.count(chr(10)) + 1}", "is cut off")
    try:
        names, *rows = csv.reader(io.StringIO(text, newline=""), strict=True)
    except csv.Error as error:
        raise BadFile(path, "", f"is no table: {error}") from None
    return columns_of(path, names, list(enumerate(rows, start=2)), names)


def columns_of(path, names, rows, wanted, first=1):
    """Columns of a table that has been read: dict of (S,) float by name.

    Parameters
    ----------
    path : path
    names : list of str
    rows : list of (int, list of str)
        Number of the line, and its cells.
    wanted : collection of str
        Names of the columns to give, where there are such; others may hold anything.
    first : int
        Number of the line that holds the names.

    Raises
    ------
    BadFile
        If names are missing or alike, or values are missing or no finite numbers.
    """
    if not all(names) or len(set(names)) < len(names) or any(map(is_value, names)):
        raise BadFile(path, f"line {first}", "must name every column, each otherwise")
    chosen = {name: i for i, name in enumerate(names) if name in wanted}
    for number, row in rows:
        if len(row) != len(names):
            raise BadFile(path, f"line {number}", f"has {len(row)} values for {len(names)} columns")
        for name, i in chosen.items():
            if not is_value(row[i]):
                reason = f"is {shown(row[i])}; must be a finite number"
                raise BadFile(path, f"line {number}, {shown(name)[1:-1]}", reason)
    return {name: np.array([row[i] for _, row in rows], dtype=float) for name, i in chosen.items()}


def is_value(text):
    """Whether a text is a finite number, written as others than Python write it, too."""
    try:
        return "_" not in text and math.isfinite(float(text))
    except ValueError:
        return False
