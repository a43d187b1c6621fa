# SPDX-License-Identifier: GPL-2.0-or-later
"""What a job of yade-batch is to do: its row of the table."""

import difflib
import os
from dataclasses import fields
from numbers import Real

from yade import utils
from yade.wrapper import Omega

from .files import shown
from .parameters import SailParameters


def batch_row(**others):
    """Parameters and name of this job of yade-batch; none outside a batch.

    Parameters
    ----------
    **others
        Further columns that the table may have, with defaults.

    Returns
    -------
    parameters : dict
        Of SailParameters.
    others : dict
    name : str or None
        Its description.

    Raises
    ------
    ValueError
        If the table has a column that nobody knows, or the row a value that cannot be read.
    """
    place = os.environ.get("YADE_BATCH")
    if not place:
        return {}, others, None
    file, _, line = place.rpartition(":")
    defaults = {item.name: item.default for item in fields(SailParameters)}
    row = utils.TableParamReader(file).paramDict().get(int(line), {})
    _check_columns(file, row, {**defaults, **others})
    try:
        utils.readParamsFromTable(noTableOk=False, **defaults, **others)
    except (NameError, SyntaxError, TypeError, ValueError, ArithmeticError) as error:
        values = " ".join(text for name, text in row.items() if name != "description")
        raise ValueError(
            f"{file}, line {line}: '{values}' cannot be read ({error}); words stand in quotes"
        ) from error
    from yade.params import table

    for name, default in others.items():
        value = getattr(table, name)
        wanted = Real if isinstance(default, Real) else (str, type(None))
        if not isinstance(value, wanted):
            kind = "a number" if wanted is Real else "a text in quotes"
            raise ValueError(f"{file}, line {line}: {name} = {shown(value)} must be {kind}")
    return (
        {name: getattr(table, name) for name in defaults},
        {name: getattr(table, name) for name in others},
        Omega().tags["description"],
    )


def folder_of(description):
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
            raise ValueError(f"{file}: there is no parameter of the column's name '{name}'{meant}")
