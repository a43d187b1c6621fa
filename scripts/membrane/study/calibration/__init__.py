# SPDX-License-Identifier: GPL-2.0-or-later
"""Calibration: parameters of a sail from measured curves of its early deployment.

Their logarithms are searched, for the curves depend on factors rather than on differences. Near-by
parameters give curves that jump about by a little: the folded sail comes to rest in slightly
different states, and from about 0.1 s after the release tiny differences grow. Everything here is
made for that scatter: steps are large beside it, and it counts in the uncertainty.

None of these modules needs YADE in its own process.
"""

from ...measures import HUB, LEDGER, Measure
from ...run.sails import SAILS

BOUNDS = {"alpha_crease": (10.0, 1000.0), "beta": (1.0, 100.0)}  # of what is searched by default
CHAOS = 0.12  # [s] after the release; later, single curves say little


def columns_of(sail: str) -> dict[str, Measure]:
    """Measures in the history of a kind of sail, by name: what curves can be of."""
    return {m.name: m for m in (*SAILS[sail].measures, *HUB, *LEDGER)}


def usual_columns(sail: str) -> list[str]:
    """Names of those that are followed where a table has them, unless told otherwise."""
    return [m.name for m in SAILS[sail].measures if m.plot and not m.minor]
