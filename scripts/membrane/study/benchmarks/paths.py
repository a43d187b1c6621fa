# SPDX-License-Identifier: GPL-2.0-or-later
"""Path fused beside path law2: the same sheet, the same forces."""

from functools import partial

from . import AT_LEAST, FUSED, LAW2, Entry, Settings
from .cases import FORCES, PERIODS, clock, label, plan, steps
from .sheet import SIDES
from .turns import ratio_entry, take_turns
from .workers import workers

LEAST, SIDE = 8.0, SIDES[0]  # the target, and the sheet that it is for


def measure(settings: Settings) -> list[Entry]:
    """Entries of how many times faster the fused path is."""
    return [e for side in settings.sizes(SIDES[:3]) for e in measure_sheet(side, settings)]


def measure_sheet(side: int, settings: Settings) -> list[Entry]:
    """Entries for one sheet on one thread."""
    nodes, found = side * side, []
    settings.tell(f"fused and law2 on {nodes} nodes")
    for everything in FORCES:
        fused = [(FUSED, everything, period) for period in PERIODS]
        slow = (LAW2, everything, 1)
        with workers({c: plan(side, 1, *c) for c in (*fused, slow)}) as started:
            takers = {}
            for case, worker in started.items():
                many = steps(settings, nodes, case[0])
                takers[case] = partial(worker.timed, many, clock(1))
            times = take_turns(takers, settings.rounds, settings.quiet)
        for case in fused:
            wanted = {"target": LEAST, "bound": AT_LEAST} if side == SIDE else {}
            name = f"law2 over {label(*case)}"
            found.append(ratio_entry(name, times[slow], times[case], nodes, **wanted))
    return settings.quiet.mark(found)
