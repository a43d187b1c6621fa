# SPDX-License-Identifier: GPL-2.0-or-later
"""Time, memory and building of a node on the fused path, from a thousand nodes to a million."""

from functools import partial

from . import AT_MOST, FUSED, Entry, Settings
from .cases import PERIODS, clock, label, plan, steps
from .sheet import SIDES
from .turns import entry, ratio_entry, take_turns
from .workers import Worker, workers

MOST_GROWTH, MOST_MEMORY = 1.5, 1000.0  # [-], [bytes]
CASE = (FUSED, True, max(PERIODS))
BUILDING = {
    "added": "adding 100,000 nodes",
    "build": "building 100,000 nodes up to the first step",
}


def measure(settings: Settings) -> list[Entry]:
    """Entries with all forces on, one thread."""
    sides = settings.sizes(SIDES)
    settings.tell(f"building and running {', '.join(str(side * side) for side in sides)} nodes")
    with workers({side: plan(side, 1, *CASE) for side in sides}) as started:
        answers = take_turns(
            {
                side: partial(worker.measure, steps(settings, side * side))
                for side, worker in started.items()
            },
            settings.rounds,
            settings.quiet,
        )
    smallest = answers[sides[0]]
    found = []
    for side, given in answers.items():
        found += times(side * side, given, smallest)
        if side > sides[0]:  # there all drowns in what YADE itself takes
            settings.tell(f"memory of {side * side} bodies")
            found += building(side * side, given[0]) + memory(side * side, given[-1], bodies(side))
    return settings.quiet.mark(found)


def times(nodes: int, given: list[dict], smallest: list[dict]) -> list[Entry]:
    """Entries of the time of a node, from the answers of a sheet and of the `smallest` one."""
    each = [1e9 / nodes * answer[clock(1)] for answer in given]
    found = [entry(f"sizes: {label(*CASE)}", each, "ns a node and step", nodes)]
    if given is smallest:
        return found
    small = [1e9 / smallest[0]["nodes"] * answer[clock(1)] for answer in smallest]
    name = f"{label(*CASE)}, time of a node over that at {smallest[0]['nodes']} nodes"
    wanted: dict = {"target": MOST_GROWTH, "bound": AT_MOST}
    return [*found, ratio_entry(name, each, small, nodes, **wanted)]


def building(nodes: int, given: dict) -> list[Entry]:
    """Entries of the time to build."""
    return [Entry(BUILDING[key], 1e5 / nodes * given[key], "s", nodes) for key in BUILDING]


def bodies(side: int) -> dict:
    """What a worker with nothing but YADE's own bodies answers."""
    worker = Worker("bodies", side=side)
    try:
        return worker.measure(1)
    finally:
        worker.close()


def memory(nodes: int, given: dict, alone: dict) -> list[Entry]:
    """Entries of the memory of a node beside that of its body, now and at most."""
    body = (alone["memory"] - alone["before"]) / nodes
    now = (given["memory"] - given["before"]) / nodes - body
    peak = (given["peak"] - given["before"]) / nodes - body
    unit = "bytes a node"
    wanted: dict = {"target": MOST_MEMORY, "bound": AT_MOST}
    return [
        Entry("memory of YADE's own body", body, unit, nodes),
        Entry("memory beside the bodies", now, unit, nodes, **wanted),
        Entry("most memory ever, beside the bodies", peak, unit, nodes),
    ]
