# SPDX-License-Identifier: GPL-2.0-or-later
"""Two threads beside one."""

from . import AT_LEAST, FUSED
from .cases import LAW2_SHARE, PERIODS, label, plan, steps_of
from .sheet import SIDES
from .turns import ratio_entry, take_turns
from .workers import workers

WORK = 2e7  # nodes times steps of a turn of the fused path
LEAST = {SIDES[0]: 1.0, SIDES[1]: 1.6, SIDES[2]: 1.6}


def measure(settings):
    """Entries of how many times faster two threads are than one."""
    found = []
    for side in settings.sizes(LEAST):
        settings.tell(f"one thread and two on {side * side} nodes")
        for path in settings.paths:
            for everything in (False, True):
                case = (path, everything, max(PERIODS) if path == FUSED else 1)
                found.append(measure_case(side, case, settings))
    return found


def measure_case(side, case, settings):
    """The Entry for one sheet and case."""
    fused = case[0] == FUSED
    work = settings.work(WORK) * (1 if fused else LAW2_SHARE)
    steps = steps_of(work, side * side)
    with workers({threads: plan(side, threads, *case) for threads in (1, 2)}) as started:
        times = take_turns(
            {n: lambda w=w: w.measure(steps)["seconds"] for n, w in started.items()},
            settings.rounds,
        )
    wanted = {"target": LEAST[side], "bound": AT_LEAST} if fused else {}
    name = f"one thread over two, {label(*case)}"
    return ratio_entry(name, times[1], times[2], side * side, threads=2, **wanted)
