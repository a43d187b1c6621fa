# SPDX-License-Identifier: GPL-2.0-or-later
"""Path fused beside path law2: the same sheet, the same forces."""

from . import AT_LEAST, FUSED, LAW2
from .cases import LAW2_SHARE, PERIODS, label, plan, steps_of
from .sheet import SIDES
from .turns import ratio_entry, take_turns
from .workers import workers

WORK = 2e7  # nodes times steps of a turn of the fused path
LEAST, SIDE = 8.0, SIDES[0]  # the target, and the sheet that it is for


def measure(settings):
    """Entries of how many times faster the fused path is."""
    if not {FUSED, LAW2} <= set(settings.paths):
        settings.tell("paths: only one is to be measured")
        return []
    return [e for side in settings.sizes(SIDES[:3]) for e in measure_sheet(side, settings)]


def measure_sheet(side, settings):
    """Entries for one sheet on one thread."""
    nodes, found = side * side, []
    settings.tell(f"fused and law2 on {nodes} nodes")
    for everything in (False, True):
        fused = [(FUSED, everything, period) for period in PERIODS]
        slow = (LAW2, everything, 1)
        with workers({c: plan(side, 1, *c) for c in (*fused, slow)}) as started:
            takers = {}
            for case, worker in started.items():
                share = LAW2_SHARE if case == slow else 1.0
                steps = steps_of(share * settings.work(WORK), nodes)
                takers[case] = lambda w=worker, s=steps: w.measure(s)["seconds"]
            times = take_turns(takers, settings.rounds)
        for case in fused:
            wanted = {"target": LEAST, "bound": AT_LEAST} if side == SIDE else {}
            name = f"law2 over {label(*case)}"
            found.append(ratio_entry(name, times[slow], times[case], nodes, **wanted))
    return found
