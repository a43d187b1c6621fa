# SPDX-License-Identifier: GPL-2.0-or-later
"""The sheet on the fused path beside the bare springs of the same sheet in LAMMPS."""

import tempfile
from functools import partial
from pathlib import Path

from . import AT_MOST, Entry, Settings, lammps
from .cases import PERIODS, clock, fused_cases, label, plan, steps
from .sheet import SIDES, square_sheet
from .turns import entry, ratio_entry, take_turns
from .workers import workers

MOST = {False: 0.5, True: 1.0}  # all forces or not; for the longest period


def measure(settings: Settings) -> list[Entry]:
    """Entries for three sizes on one thread."""
    return [e for side in settings.sizes(SIDES[:3]) for e in measure_sheet(side, 1, settings)]


def measure_sheet(side: int, threads: int, settings: Settings) -> list[Entry]:
    """Entries for one sheet: times of LAMMPS and of each case, and ratios."""
    if not lammps.available():
        raise RuntimeError("there is no LAMMPS (lmp); scripts/run.sh bench installs it")
    nodes, sheet = side * side, square_sheet(side)
    settings.tell(f"LAMMPS and fused on {nodes} nodes, {threads} thread{'s' * (threads > 1)}")
    many, plans = steps(settings, nodes), {c: plan(side, threads, *c) for c in fused_cases()}
    with tempfile.TemporaryDirectory() as name, workers(plans) as started:
        folder = Path(name)
        lammps.write_data(sheet, folder / "sheet.data")
        takers: dict = {None: lambda: lammps.loop_time(lammps.run(folder, many, threads), threads)}
        takers |= {case: partial(w.timed, many, clock(threads)) for case, w in started.items()}
        times = take_turns(takers, settings.rounds, settings.quiet, wait=threads > 1)

    bare = times.pop(None)
    each = [1e9 / nodes * seconds for seconds in bare]
    found = [entry("LAMMPS, bare springs", each, "ns a node and step", nodes, threads=threads)]
    for case, taken in times.items():
        each = [1e9 / nodes * seconds for seconds in taken]
        found.append(entry(label(*case), each, "ns a node and step", nodes, threads=threads))
        _, everything, period = case
        wanted: dict = {}
        if period == max(PERIODS):
            wanted = {"target": MOST[everything], "bound": AT_MOST}
        name = f"{label(*case)}, over LAMMPS"
        found.append(ratio_entry(name, taken, bare, nodes, threads=threads, **wanted))
    return settings.quiet.mark(found)
