# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs a grid over any parameters of any sail, by default the paper's Table 2; makes one report.

Every parameter takes one value or more: several are an axis of the grid. Cases that are there
already are not run again. `sweep report DIR` only reports, of cases as scripts/case.py leaves
them; it needs no YADE.
"""

import argparse
import os
import sys
from dataclasses import fields
from pathlib import Path

from ..files import BadFile
from ..parameters import RunParameters, read_values
from ..results.case_folder import COMPLETE, DAMAGED, DIVERGED, identity, look
from ..study.sweep import grid, jobs
from ..study.sweep.report import report
from .options import add_arguments, add_checkpoints, add_file, add_out, chosen_sail, count, file
from .options import folder, sails_text

ON_SLURM = 100  # jobs at once, unless told otherwise


class _Parser(argparse.ArgumentParser):
    """Of words of a command line or, where it is given, of a file."""

    source = None

    def error(self, message):
        if self.source:
            raise BadFile(self.source, "", message)
        super().error(message)


def command_line(words: list[str]) -> tuple[argparse.Namespace, type[RunParameters], dict]:
    """What is asked for, the class of parameters, and values (list) of those given, by name."""
    split = bool(words) and not words[0].startswith("-")
    first, rest = words[:split], words[split:]
    asking = argparse.ArgumentParser(prog="sweep", add_help=False, allow_abbrev=False)
    asking.add_argument("--config", type=file)
    path = asking.parse_known_args(rest)[0].config
    configured: list = []
    if path:
        from ..study.sweep.config import config_words  # needs a package of its own

        sail, configured = config_words(path)
        first = first or [sail] * bool(sail)
    kind, first = chosen_sail(first)
    parser, found = _parser(kind), None
    if path:
        parser.source = path
        found = parser.parse_args([*first, *configured])
        try:
            grid.check_values(kind, _given(kind, found))
        except ValueError as error:
            raise BadFile(path, "", str(error)) from None
        parser.source = None
    found = parser.parse_args([*first, *rest], found)
    return found, kind, _given(kind, found)


def _given(kind, arguments):
    """Values of parameters among parsed arguments; a switch without a value is true."""
    told = {item.name: getattr(arguments, item.name, None) for item in fields(kind)}
    return {name: values or [True] for name, values in told.items() if values is not None}


def _parser(kind):
    parser = _Parser(
        prog="sweep",
        description=__doc__,
        epilog=sails_text(),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    add_out(parser, Path("out", "sweep" if kind.sail == "square" else f"sweep_{kind.sail}"))
    parser.add_argument("--config", metavar="FILE", help="YAML of sail, grid, options and others")
    parser.add_argument("--dry-run", action="store_true", help="only list the cases")
    parser.add_argument("--slurm", action="store_true", help="submit the cases to Slurm")
    text = f"cores that the cases share, or jobs on Slurm (default: all cores, or {ON_SLURM})"
    parser.add_argument("-j", "--jobs", type=count, metavar="N", help=text)
    for name, default, text in (
        ("threads", 1, "of each case"),
        ("memory", 1000, "of each case on Slurm [MB]"),
        ("minutes", 60, "of each case on Slurm"),
    ):
        text = f"{text} (default {default})"
        parser.add_argument(f"--{name}", type=count, default=default, metavar="N", help=text)
    text = "neither pictures nor pages of single cases"
    parser.add_argument("--no-pictures", action="store_true", help=text)
    add_checkpoints(parser)
    add_file(parser)
    add_arguments(parser, kind, several=True)
    return parser


def main() -> int:
    """Sweep or report; returns the exit status."""
    if sys.argv[1:2] == ["report"]:
        parser = argparse.ArgumentParser(prog="sweep report", description="Report what is there.")
        parser.add_argument("folder", type=folder, help="folder of the sweep, or of the cases")
        return tell_report(parser.parse_args(sys.argv[2:]).folder)
    asked, kind, given = command_line(sys.argv[1:])
    base = read_values(asked.parameters, kind) if asked.parameters is not None else {}
    cases, out = grid.grid(kind, given, base), asked.out.absolute()
    grid.refuse_other_results(out)
    if asked.dry_run:
        for name, p in cases.items():
            print(f"{name}: {look(out / grid.CASES / name, identity(p)).state}")
        return 0
    asked.jobs = asked.jobs or (ON_SLURM if asked.slurm else len(os.sched_getaffinity(0)))
    with jobs.alone(out, asked.slurm, tell):
        grid.plan(out, cases)
        jobs.run(out, cases, asked, tell)
        return tell_report(out)


def tell(line: str) -> None:
    """Tell the user a line."""
    print(f"sweep: {line}", file=sys.stderr, flush=True)


def tell_report(out: Path) -> int:
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
