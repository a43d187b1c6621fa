# SPDX-License-Identifier: GPL-2.0-or-later
"""Measures the speed of the plugin and writes reference/bench.json.

Run it by `scripts/run.sh bench [options]`, or by `yade -n -x scripts/bench.py [options]`. All
that is compared is measured turn by turn in one run: on one thread in processor time, on several
in wall time, while the machine does nothing else. Targets are reported, not asserted: the exit
status is 0 whenever the measurements were possible.
"""

import argparse
import datetime
import importlib
import sys
from pathlib import Path

from membrane.commands import count, plain_errors
from membrane.progress import announcer

SCRIPTS = Path(sys.argv[0]).resolve().parent  # YADE keeps __file__ for itself
sys.path.append(str(SCRIPTS))

with plain_errors("bench"):
    import benchmarks
    from benchmarks import lammps, results
    from benchmarks.quiet import Quiet
    from membrane.sail import versions

MODULES = {
    "loops": "functors and engine of path law2 beside YADE's own sphere contact",
    "springs": "sheets beside bare springs in LAMMPS, one thread",
    "paths": "path fused beside path law2",
    "sizes": "time, memory and building a node, from a thousand nodes to a million",
    "deployment": "the paper's sail, fold to fullest",
    "threads": "two threads beside one, and beside LAMMPS on two",
    "roofline": "kernels beside the limits of one core; instructions and cache misses",
}
RESULTS = SCRIPTS.parent / "reference" / "bench.json"


def command_line():
    """Parsed sys.argv."""
    about = "; ".join(f"{name}: {text}" for name, text in MODULES.items())
    parser = argparse.ArgumentParser(
        prog="bench", description=__doc__.splitlines()[0], epilog=about
    )
    parser.add_argument(
        "--only",
        nargs="+",
        choices=MODULES,
        metavar="MODULE",
        default=list(MODULES),
        help="run only these; the others keep their results in the file",
    )
    parser.add_argument(
        "--no-deployment", action="store_true", help="leave out the paper's deployment"
    )
    parser.add_argument("--rounds", type=count, default=7, help="of each comparison (default 7)")
    parser.add_argument(
        "--patience",
        type=float,
        default=120.0,
        help="time that a module may lose by waiting for a machine without other work, and by "
        "repeating what was disturbed [s] (default 120)",
    )
    parser.add_argument(
        "--quick", action="store_true", help="small sizes and short turns; write no file"
    )
    arguments = parser.parse_args()
    if arguments.rounds < 1:
        parser.error(f"--rounds {arguments.rounds}: must be at least 1")
    return arguments


def made_with():
    """Versions of everything, the machine, and the date."""
    used = versions()
    del used["threads"]
    return {
        **used,
        "lammps": lammps.version(),
        "processor": results.processor(),
        "date": datetime.date.today().isoformat(),
    }


def main():
    """Measure, print the tables, write the file; returns the exit status."""
    arguments = command_line()
    tell = announcer("bench")
    settings = benchmarks.Settings(
        rounds=arguments.rounds,
        quick=arguments.quick,
        quiet=Quiet(tell),
        tell=tell,
    )
    left_out = ["deployment"] if arguments.no_deployment else []
    chosen = [name for name in MODULES if name in arguments.only and name not in left_out]
    made_of, met = results.commit(), []
    for number, name in enumerate(chosen, start=1):
        tell(f"{number} of {len(chosen)}, {name}: {MODULES[name]}")
        settings.quiet.patience = arguments.patience
        try:
            found = importlib.import_module(f"benchmarks.{name}").measure(settings)
        except RuntimeError as error:
            print(f"bench: {name}: {error}", file=sys.stderr)
            return 1
        print("\n".join(results.table(name, found)), flush=True)
        met += [entry.holds for entry in found if entry.bound]
        if not arguments.quick:
            rows = results.as_rows(name, found, made_of)
            results.save(RESULTS, name, rows, made_with(), list(MODULES))
    print(f"{sum(met)} of {len(met)} targets are met.")
    if not arguments.quick:
        print(f"Results are in {RESULTS}")
    tell("done")
    return 0


with plain_errors("bench"):
    sys.exit(main())
