# SPDX-License-Identifier: GPL-2.0-or-later
"""Reads tables of scalars over time, as output.HistoryWriter writes them. Needs no YADE, no VTK."""

import csv
import io
import math

import numpy as np

from .files import BadFile, read_text, shown


def read_history(path, wanted=None):
    """Columns of a .csv file as HistoryWriter makes them: dict of (S,) float by name.

    Parameters
    ----------
    path : path
    wanted : collection of str, optional
        Names of the columns to read, where there are such; others may hold anything. Default: all.

    Raises
    ------
    BadFile
        If it is no complete table, under names that differ, with finite numbers in these columns.
    """
    text = read_text(path)
    if not text.endswith("\n"):
        raise BadFile(path, f"line {text.count(chr(10)) + 1}", "is cut off")
    table = csv.reader(io.StringIO(text, newline=""), strict=True)
    try:
        names = next(table)
        if not all(names) or len(set(names)) < len(names) or any(map(is_value, names)):
            raise BadFile(path, "line 1", "must name every column, each otherwise")
        chosen = {name: i for i, name in enumerate(names) if wanted is None or name in wanted}
        if len(chosen) == len(names):
            values = _numbers(text, len(names))
            if values is not None:
                return dict(zip(names, values))
        rows = list(table)
    except csv.Error as error:
        raise BadFile(path, "", f"is no table: {error}") from None
    for number, row in enumerate(rows, start=2):
        if len(row) != len(names):
            raise BadFile(path, f"line {number}", f"has {len(row)} values for {len(names)} columns")
        for name, value in zip(names, row):
            if name in chosen and not is_value(value):
                reason = f"is {shown(value)}; must be a finite number"
                raise BadFile(path, f"line {number}, {shown(name)[1:-1]}", reason)
    return {name: np.array([row[i] for row in rows], dtype=float) for name, i in chosen.items()}


def _numbers(text, columns):
    """Columns (`columns`, S) of a table of finite numbers, read at once; None if it is none."""
    _, *rows, _ = text.split("\n")
    content = ",".join(rows)
    if "_" in content or any(row.count(",") != columns - 1 for row in rows):
        return None
    try:
        table = np.array(list(map(float, content.split(",")))).reshape(len(rows), columns)
    except ValueError:
        return None
    return table.T.copy() if np.isfinite(table).all() else None


def is_value(text):
    """Whether a text is a finite number, written as others than Python write it, too."""
    try:
        return "_" not in text and math.isfinite(float(text))
    except ValueError:
        return False
