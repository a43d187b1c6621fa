# SPDX-License-Identifier: GPL-2.0-or-later
"""Two threads of the fused path beside one, and beside two of LAMMPS: in wall time."""

from functools import partial

from . import AT_LEAST, FUSED, Entry, Settings, springs
from .cases import FORCES, PERIODS, Case, label, plan, steps
from .sheet import SIDES
from .turns import entry, ratio_entry, take_turns
from .workers import workers

LEAST = {SIDES[0]: 0.97, SIDES[1]: 1.6, SIDES[2]: 1.6}  # the smallest: no slower, but for noise


def measure(settings: Settings) -> list[Entry]:
    """Entries of how many times faster two threads are than one, and than LAMMPS on two."""
    found = []
    for side in settings.sizes(LEAST):
        found += springs.measure_sheet(side, 2, settings)
        settings.tell(f"one thread and two on {side * side} nodes")
        for everything in FORCES:
            found += measure_case(side, (FUSED, everything, max(PERIODS)), settings)
    return found


def measure_case(side: int, case: Case, settings: Settings) -> list[Entry]:
    """Entries for one sheet and case."""
    nodes = side * side
    many = steps(settings, nodes)
    with workers({threads: plan(side, threads, *case) for threads in (1, 2)}) as started:
        times = take_turns(
            {n: partial(w.timed, many, "wall") for n, w in started.items()},
            settings.rounds,
            settings.quiet,
            wait=True,
        )
    name, unit = label(*case), "ns a node and step"
    found = [
        entry(f"threads: {name}", [1e9 / nodes * t for t in times[n]], unit, nodes, threads=n)
        for n in times
    ]
    wanted: dict = {"threads": 2, "target": LEAST[side], "bound": AT_LEAST}
    name = f"{name}, one thread over two"
    found.append(ratio_entry(name, times[1], times[2], nodes, **wanted))
    return settings.quiet.mark(found)
