# SPDX-License-Identifier: GPL-2.0-or-later
"""Measures the speed of the plugin and writes reference/bench.json.

All that is compared is measured turn by turn in one run: on one thread in processor time, on
several in wall time, while the machine does nothing else. Targets are reported, not asserted: the
exit status is 0 whenever the measurements were possible.
"""

import argparse
import datetime
import importlib
import sys

from ..progress import announcer
from ..run.driver import versions
from ..study import benchmarks
from ..study.benchmarks import lammps, results
from ..study.benchmarks.quiet import Quiet
from ..study.sources import REFERENCE
from .options import add_only, count

MODULES = {
    "loops": "functors and engine of path law2 beside YADE's own sphere contact",
    "springs": "sheets beside bare springs in LAMMPS, one thread",
    "paths": "path fused beside path law2",
    "sizes": "time, memory and building a node, from a thousand nodes to a million",
    "deployment": "the paper's sail, fold to fullest",
    "threads": "two threads beside one, and beside LAMMPS on two",
    "roofline": "kernels beside the limits of one core; instructions and cache misses",
}
RESULTS = REFERENCE / "bench.json"


def command_line() -> argparse.Namespace:
    """Parsed sys.argv."""
    about = "; ".join(f"{name}: {text}" for name, text in MODULES.items())
    parser = argparse.ArgumentParser(
        prog="bench", description=__doc__.splitlines()[0], epilog=about
    )
    add_only(parser, MODULES, "run only these; the others keep their results in the file")
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
    return parser.parse_args()


def made_with() -> dict:
    """Versions of everything, the machine, and the date."""
    used = versions()
    del used["threads"]
    return {
        **used,
        "lammps": lammps.version(),
        "processor": results.processor(),
        "date": datetime.date.today().isoformat(),
    }


def main() -> int:
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
            found = importlib.import_module(f"membrane.study.benchmarks.{name}").measure(settings)
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
