# SPDX-License-Identifier: GPL-2.0-or-later
"""Tables as programs for measurements and spreadsheets write them."""

import numpy as np

from pathlib import Path
from typing import Any

import csv

from membrane.files import BadFile, read_text
from membrane.results.history import columns_of


def read_table(path: str | Path, wanted: Any) -> dict[str, np.ndarray]:
    """Columns of a table with a header: dict of (S,) float by name.

    Commas, semicolons, tabs or blanks part the columns, as the header tells; blanks beside them,
    empty lines and a mark `#` before the header do not count. Where no comma parts them, numbers
    may have decimal commas. Columns of names that are `wanted` are read, where there are such;
    others may hold anything. BadFile if it is no table, or these hold something else than finite
    numbers.
    """
    text = read_text(path).replace("\r\n", "\n").replace("\r", "\n").split("\n")
    lines = [(number, line) for number, line in enumerate(text, start=1) if line.strip(" \t,;")]
    if not lines:
        raise BadFile(path, "", "is empty")
    (first, header), *lines = lines
    header = header.lstrip("# \t")
    delimiter = next((mark for mark in ";,\t" if mark in header), " ")
    try:
        names = _cells(header, delimiter)
        rows = [(number, _cells(line, delimiter)) for number, line in lines]
    except csv.Error as error:
        raise BadFile(path, "", f"is no table: {error}") from None
    _trim(names, 0)
    for number, row in rows:
        _trim(row, len(names))
        if delimiter == "," and len(row) > len(names):
            reason = f"has {len(row)} values for {len(names)} columns"
            advice = "where commas are decimal, semicolons must part the columns"
            raise BadFile(path, f"line {number}", f"{reason}; {advice}")
    chosen = [i for i, name in enumerate(names) if name in wanted]
    values = [row[i] for _, row in rows for i in chosen if i < len(row)]
    if delimiter != "," and not any("." in value for value in values):
        rows = [(number, [cell.replace(",", ".", 1) for cell in row]) for number, row in rows]
    return columns_of(path, names, rows, wanted, first)


def _cells(line, delimiter):
    """Cells of a line, without blanks round them."""
    line = " ".join(line.split()) if delimiter == " " else line
    (cells,) = csv.reader([line], delimiter=delimiter, skipinitialspace=True, strict=True)
    return [cell.strip() for cell in cells]


def _trim(cells, least):
    """Drop empty cells at the end, but keep as many as `least`."""
    while len(cells) > least and not cells[-1]:
        cells.pop()
