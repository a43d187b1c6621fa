# SPDX-License-Identifier: GPL-2.0-or-later
"""The plugin's sheet beside the bare springs of the same sheet in LAMMPS."""

import tempfile
from pathlib import Path

from . import AT_MOST, FUSED, lammps
from .cases import LAW2_SHARE, PERIODS, label, plans, steps_of
from .sheet import SIDES, square_sheet
from .turns import entry, ratio_entry, take_turns
from .workers import workers

WORK = 2e7  # nodes times steps of a turn: about 0.5 s of LAMMPS
MOST = {False: 0.5, True: 1.0}  # all forces or not


def measure(settings):
    """Entries for three sizes on one thread and on two."""
    if not lammps.available():
        raise RuntimeError("there is no LAMMPS (lmp); scripts/run.sh bench installs it")
    found = []
    for side in settings.sizes(SIDES[:3]):
        for threads in (1, 2):
            found += measure_sheet(side, threads, settings)
    return found


def measure_sheet(side, threads, settings):
    """Entries for one sheet: times of LAMMPS and of each case, and ratios."""
    nodes, sheet = side * side, square_sheet(side)
    settings.tell(f"LAMMPS and {', '.join(settings.paths)} on {nodes} nodes, {threads} thread(s)")
    steps = steps_of(settings.work(WORK), nodes)
    with tempfile.TemporaryDirectory() as name, workers(plans(settings, side, threads)) as started:
        folder = Path(name)
        lammps.write_data(sheet, folder / "sheet.data")
        takers = {None: lambda: lammps.loop_time(lammps.run(folder, steps, threads))}
        for case, worker in started.items():
            own = steps if case[0] == FUSED else steps_of(LAW2_SHARE * settings.work(WORK), nodes)
            takers[case] = lambda w=worker, s=own: w.measure(s)["seconds"]
        times = take_turns(takers, settings.rounds)

    bare = times.pop(None)
    each = [1e9 / nodes * seconds for seconds in bare]
    found = [entry("LAMMPS, bare springs", each, "ns a node and step", nodes, threads=threads)]
    for case, taken in times.items():
        each = [1e9 / nodes * seconds for seconds in taken]
        found.append(entry(label(*case), each, "ns a node and step", nodes, threads=threads))
        path, everything, period = case
        wanted = {}
        if path == FUSED and period == max(PERIODS):
            wanted = {"target": MOST[everything], "bound": AT_MOST}
        name = f"{label(*case)}, over LAMMPS"
        found.append(ratio_entry(name, taken, bare, nodes, threads=threads, **wanted))
    return found
