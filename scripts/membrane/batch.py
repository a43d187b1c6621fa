# SPDX-License-Identifier: GPL-2.0-or-later
"""What a job of yade-batch is to do: its row of the table."""

import os
from dataclasses import fields

from yade import utils
from yade.wrapper import Omega

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
    """
    if not os.environ.get("YADE_BATCH"):
        return {}, others, None
    defaults = {item.name: item.default for item in fields(SailParameters)}
    utils.readParamsFromTable(noTableOk=False, **defaults, **others)
    from yade.params import table

    return (
        {name: getattr(table, name) for name in defaults},
        {name: getattr(table, name) for name in others},
        Omega().tags["description"],
    )
