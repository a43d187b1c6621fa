# SPDX-License-Identifier: GPL-2.0-or-later
"""Time and memory a node from a thousand nodes to a million."""

from . import AT_MOST, FUSED, LAW2, Entry
from .cases import LAW2_SHARE, PERIODS, label, plan, steps_of
from .sheet import SIDES
from .turns import entry, ratio_entry, take_turns
from .workers import Worker, workers

WORK = 2e7  # nodes times steps of a turn of the fused path
MOST_GROWTH, MOST_MEMORY = 1.5, 1000.0  # [-], [bytes]
BUILDING = {
    "added": "adding 100,000 nodes",
    "build": "building 100,000 nodes up to the first step",
}
LARGEST = {FUSED: SIDES[-1], LAW2: SIDES[-2]}  # law2 takes gigabytes and minutes at a million


def measure(settings):
    """Entries for each path, all forces on, one thread."""
    return [e for path in settings.paths for e in measure_path(path, settings)]


def measure_path(path, settings):
    """Entries for one path: time and memory a node, and time to build."""
    case = (path, True, max(PERIODS) if path == FUSED else 1)
    sides = [side for side in settings.sizes(SIDES) if side <= LARGEST[path]]
    settings.tell(f"{path}: {', '.join(str(side * side) for side in sides)} nodes")
    work = settings.work(WORK) * (1 if path == FUSED else LAW2_SHARE)
    with workers({side: plan(side, 1, *case) for side in sides}) as started:
        answers = take_turns(
            {
                side: lambda w=worker, s=steps_of(work, side * side): w.measure(s)
                for side, worker in started.items()
            },
            settings.rounds,
        )
    found = []
    for side, given in answers.items():
        found += entries(side, case, given, answers[sides[0]], settings)
    return found


def entries(side, case, given, smallest, settings):
    """Entries of one size from its answers `given`, beside those of the `smallest`."""
    path, nodes = case[0], side * side
    each = [1e9 / nodes * answer["seconds"] for answer in given]
    small = [1e9 / smallest[0]["nodes"] * answer["seconds"] for answer in smallest]
    found = [entry(f"sizes: {label(*case)}", each, "ns a node and step", nodes)]
    if given is not smallest:
        wanted = {"target": MOST_GROWTH, "bound": AT_MOST} if path == FUSED else {}
        name = f"{label(*case)}, time of a node over that at {smallest[0]['nodes']} nodes"
        found.append(ratio_entry(name, each, small, nodes, **wanted))
    if nodes >= 1e4:  # less drowns in what YADE itself takes
        a_part = {text: 1e5 / nodes * given[0][key] for key, text in BUILDING.items()}
        found += [Entry(f"{path}: {text}", a_part[text], "s", nodes) for text in a_part]
        settings.tell(f"{path}: memory of {nodes} nodes")
        found += memory(path, nodes, given[-1], bodies(side))
    return found


def bodies(side):
    """What a worker with nothing but YADE's own bodies answers."""
    worker = Worker("bodies", side=side)
    try:
        return worker.measure(1)
    finally:
        worker.close()


def memory(path, nodes, given, alone):
    """Entries of the memory of a node beside that of its body, now and at most."""
    wanted = {"target": MOST_MEMORY, "bound": AT_MOST} if path == FUSED else {}
    own = (alone["memory"] - alone["before"]) / nodes
    now = (given["memory"] - given["before"]) / nodes - own
    peak = (given["peak"] - given["before"]) / nodes - own
    return [
        Entry("memory of YADE's own body", own, "bytes a node", nodes),
        Entry(f"{path}: memory beside the bodies", now, "bytes a node", nodes, **wanted),
        Entry(f"{path}: most memory ever, beside the bodies", peak, "bytes a node", nodes),
    ]
