# SPDX-License-Identifier: GPL-2.0-or-later
"""What a job of yade-batch is to do: its row of the table."""

import difflib
import os
from dataclasses import fields
from typing import Any

from yade import utils
from yade.wrapper import Omega

from ..files import shown


def batch_sail() -> str:
    """The word of the column `sail` of this job's row, as of the command line; "" if none."""
    file, line = _place()
    word = _row(file, line).get("sail", "") if file else ""
    return word[1:-1] if word[:1] in ("'", '"') and word[-1:] == word[:1] else word


def batch_row(kind: Any) -> tuple[dict, str | None]:
    """Parameters of a class `kind` and name of this job of yade-batch; {} and None outside a batch.

    ValueError if the table has an unknown column, or the row a value that cannot be read.
    """
    file, line = _place()
    if not file:
        return {}, None
    defaults = {item.name: item.default for item in fields(kind)}
    row = _row(file, line)
    _check_columns(file, row, {**defaults, "sail": ""})
    try:
        utils.readParamsFromTable(noTableOk=False, sail="", **defaults)
    except (NameError, SyntaxError, TypeError, ValueError, ArithmeticError) as error:
        values = " ".join(text for name, text in row.items() if name != "description")
        raise ValueError(
            f"{file}, line {line}: '{values}' cannot be read ({error}); words must be in quotes"
        ) from error
    from yade.params import table

    return {name: getattr(table, name) for name in defaults}, Omega().tags["description"]


def _place():
    """File and line of this job's row; ("", "") outside a batch."""
    file, _, line = os.environ.get("YADE_BATCH", "").rpartition(":")
    return file, line


def _row(file, line):
    """Texts of a row by the names of columns."""
    return utils.TableParamReader(file).paramDict().get(int(line), {})


def folder_of(description: str) -> str:
    """Name of a folder for a row of this `description`; ValueError if that can be none."""
    name = description.replace("/", "_")
    if name in ("", ".", "..") or not name.isprintable():
        raise ValueError(f"description = {shown(description)} must be the name of a folder")
    return name


def _check_columns(file, row, known):
    """ValueError if a `row` of the table `file` has a column that is not among the `known`."""
    for name in row:
        if name not in known and name != "description" and not name.startswith("!"):
            near = difflib.get_close_matches(name, known, n=1)
            meant = f"; did you mean '{near[0]}'?" if near else ""
            raise ValueError(f"{file}: there is no parameter named '{name}'{meant}")
