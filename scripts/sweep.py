# SPDX-License-Identifier: GPL-2.0-or-later
"""Sweeps over alpha_c and beta, by default the paper's Table 2, and makes one report.

`sweep.py run [options]`, in short `scripts/run.sh sweep [options]`, runs the cases that are not
there yet by yade-batch, and reports. `sweep.py report DIR` only reports, of finished cases as
scripts/case.py leaves them; it needs no YADE.
"""

import argparse
import os
import sys
from pathlib import Path

import sweeping  # noqa: F401  (makes parts of membrane importable without YADE)
from membrane.commands import count, folder, plain_errors

with plain_errors("sweep"):
    from membrane.case_folder import COMPLETE, DAMAGED, DIVERGED
    from membrane.parameters import TABLE_2_CASES, TABLE_2_DURATION, SailParameters
    from membrane.parameters import from_arguments, parse
    from sweeping import batch, grid
    from sweeping.report import report


def command_line():
    """Parsed sys.argv."""
    parser = argparse.ArgumentParser(prog="sweep", description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    run = commands.add_parser("run", help="run what is missing, and report")
    run.add_argument(
        "--out", type=folder, default=Path("out/sweep"), metavar="DIR", help="default: out/sweep"
    )
    run.add_argument(
        "-j",
        "--jobs",
        type=count,
        default=len(os.sched_getaffinity(0)),
        metavar="N",
        help="cases at once, each on one thread (default: the number of cores)",
    )
    run.add_argument(
        "--checkpoint-every",
        type=float,
        default=60.0,
        metavar="SECONDS",
        help="wall time between two checkpoints of a case (default 60)",
    )
    run.add_argument(
        "--no-pictures", action="store_true", help="neither pictures nor pages of single cases"
    )
    only = commands.add_parser("report", help="report what is there")
    only.add_argument("folder", type=folder, help="folder of the sweep, or of the cases")
    defaults = {"duration": TABLE_2_DURATION}
    return parse(run, several=TABLE_2_CASES, defaults=defaults, root=parser)


def main():
    """Sweep or report; returns the exit status."""
    arguments = command_line()
    if arguments.command == "report":
        return tell_report(arguments.folder)
    if not 0 <= arguments.checkpoint_every < float("inf"):
        raise ValueError("--checkpoint-every must be >= 0 and finite")
    axes = {name: getattr(arguments, name) for name in grid.AXES}
    for name in axes:
        setattr(arguments, name, getattr(SailParameters(), name))
    cases = grid.grid(from_arguments(arguments), **axes)
    out = arguments.out.absolute()
    grid.refuse_other_results(out)
    with batch.alone(out, tell):
        grid.plan(out, cases)
        batch.run(
            out,
            cases,
            min(arguments.jobs, len(cases)),
            arguments.checkpoint_every,
            not arguments.no_pictures,
            tell,
        )
        return tell_report(out)


def tell(line):
    """Tell the user a line."""
    print(f"sweep: {line}", file=sys.stderr, flush=True)


def tell_report(out):
    """Write the report and say what it says; returns 1 if a case is missing or damaged."""
    found = report(out)
    states = [status.state for status in found]
    complete, diverged = states.count(COMPLETE), states.count(DIVERGED)
    print(f"{complete} of {len(found)} cases are complete, {diverged} diverged.")
    for status in found:
        if status.state == DIVERGED:
            when = "in the spin-up" if status.time is None else f"at {status.time:.4g} s"
            print(f"  {status.name} diverged {when}, because: {status.reason}")
        elif status.state == DAMAGED:
            print(f"  {status.name} is damaged: {status.reason}")
        elif status.state != COMPLETE:
            print(f"  {status.name} is missing ({status.state}): {status.reason}")
    print(f"Look at {out / 'report.html'}")
    return 0 if complete + diverged == len(found) else 1


with plain_errors("sweep", "stopped; the same command goes on from here"):
    sys.exit(main())
