# SPDX-License-Identifier: GPL-2.0-or-later
"""Reads tables of scalars over time, as output.HistoryWriter writes them. Needs no YADE, no VTK."""

import csv
import io
import math

import numpy as np

from .files import BadFile, read_text, shown


def read_history(path):
    """Columns of a .csv file of HistoryWriter: dict of (S,) float by name.

    Raises
    ------
    BadFile
        If it is no complete table of finite numbers under names that differ.
    """
    text = read_text(path)
    if not text.endswith("\n"):
        raise BadFile(path, f"line {text.count(chr(10)) + 1}", "is cut off")
    try:
        names, *rows = csv.reader(io.StringIO(text, newline=""), strict=True)
    except csv.Error as error:
        raise BadFile(path, "", f"is no table: {error}") from None
    if not all(names) or len(set(names)) < len(names) or any(map(is_value, names)):
        raise BadFile(path, "line 1", "must name every column, each otherwise")
    for number, row in enumerate(rows, start=2):
        if len(row) != len(names):
            raise BadFile(path, f"line {number}", f"has {len(row)} values for {len(names)} columns")
        for name, value in zip(names, row):
            if not is_value(value):
                reason = f"is {shown(value)}; must be a finite number"
                raise BadFile(path, f"line {number}, {shown(name)[1:-1]}", reason)
    table = np.array(rows, dtype=float).reshape(-1, len(names))
    return {name: table[:, i] for i, name in enumerate(names)}


def is_value(text):
    """Whether a text is a finite number, written as others than Python write it, too."""
    try:
        return "_" not in text and math.isfinite(float(text))
    except ValueError:
        return False
