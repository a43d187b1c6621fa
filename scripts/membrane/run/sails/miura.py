# SPDX-License-Identifier: GPL-2.0-or-later
"""A Miura-ori sheet, read from a FOLD file, spins and is unfolded by masses at its corners.

The sheet flies free in thin air, as in the paper's chamber: it keeps its angular momentum but for
the drag, and turns the slower the wider it is open.
"""

import sys
from dataclasses import dataclass
from pathlib import Path

from ...parameters import with_defaults
from ..kind import FinishedSail
from .sheet import AnySheet, PatternParameters

INSTANTS = (0.0, 0.015, 0.03, 0.05, 0.1, 1.0)  # s


def _pattern():
    """The FOLD file beside the commands, or in the sources."""
    scripts = [Path(sys.argv[0]).resolve().parent]
    scripts += [folder / "scripts" for folder in Path(__file__).resolve().parents]
    files = [folder / "patterns" / "miura.fold" for folder in scripts]
    return str(next((file for file in files if file.exists()), files[0]))


@dataclass(frozen=True)
@with_defaults(
    file=_pattern(),
    size=0.019,
    omega=60.0,
    beta=1.0,
    zeta=0.1,
    air_density=1.2e-3,
    shapes_interval=5e-3,
)
class MiuraParameters(PatternParameters, sail="miura"):
    """Film and air are the paper's."""


class Miura(AnySheet):
    """See the module."""

    title = "a Miura-ori sheet that flies free, unfolded by masses at its corners"
    parameters = MiuraParameters

    def instants(self, run: FinishedSail) -> tuple:
        """It opens early."""
        return INSTANTS


KIND = Miura()
