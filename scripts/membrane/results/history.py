# SPDX-License-Identifier: GPL-2.0-or-later
"""Reads tables of scalars over time, as output.HistoryWriter writes them. Needs no YADE, no VTK."""

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np

from ..files import BadFile, is_value, read_text, shown


def read_history(path: str | Path) -> dict[str, np.ndarray]:
    """Columns of a .csv file as HistoryWriter makes them: dict of (S,) float by name.

    BadFile if it is no complete table, under names that differ, with finite numbers.
    """
    text = read_text(path)
    if not text.endswith("\n"):
        raise BadFile(path, f"line {text.count(chr(10)) + 1}", "is cut off")
    table = csv.reader(io.StringIO(text, newline=""), strict=True)
    try:
        names = next(table)
        values = _numbers(text, len(names)) if _are_names(names) else None
        if values is not None:
            return dict(zip(names, values))
        return columns_of(path, names, list(enumerate(table, start=2)), names)
    except csv.Error as error:
        raise BadFile(path, "", f"is no table: {error}") from None


def columns_of(
    path: str | Path, names: Any, rows: Any, wanted: Any, first: Any = 1
) -> dict[str, np.ndarray]:
    """Columns of a table that has been read: dict of (S,) float by name.

    `rows` are pairs of the number of the line and its cells, texts. Only columns of names that are
    `wanted` are given, where there are such; others may hold anything. `first` is the number of the
    line that holds the `names`. BadFile if names are missing or alike, or values are missing or no
    finite numbers.
    """
    if not _are_names(names):
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


def _are_names(names):
    """Whether these can be the names of columns: all there, each otherwise, none a number."""
    return all(names) and len(set(names)) == len(names) and not any(map(is_value, names))


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
