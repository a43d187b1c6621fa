# SPDX-License-Identifier: GPL-2.0-or-later
"""Starts the Snakemake workflow, unless a file of configuration is missing or cannot be used.

Run it by `scripts/run.sh workflow [options of snakemake]`. Snakemake itself would end by a
traceback, and after kill -9 want its lock to be removed by hand.
"""

import argparse
import fcntl
import os
import re
import sys
from pathlib import Path

import sweeping  # noqa: F401  (makes parts of membrane importable without YADE)
from membrane.commands import plain_errors

with plain_errors("workflow"):
    from sweeping.config import check_file

SNAKEFILE = Path(__file__).resolve().parent / "workflow" / "Snakefile"


def config_files(options):
    """Files of configuration that options of snakemake name."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--configfile", "--configfiles", nargs="*", action="extend", default=[])
    return parser.parse_known_args(options)[0].configfile


def check_cores(options):
    """Raise ValueError if options ask snakemake for less than one core: it would wait for ever."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("-c", "--cores", "-j", "--jobs", nargs="?", action="append", default=[])
    for number in parser.parse_known_args(options)[0].cores:
        if number and re.fullmatch(r"-?\d+", number) and int(number) < 1:
            raise ValueError(f"{number} cores or jobs: must be at least 1")


def lock(options):
    """Hold a lock in the folder in which snakemake works, until this process ends, however it does.

    It stands for Snakemake's own, which a killed one leaves behind. Plans alone need none.

    Raises
    ------
    RuntimeError
        If another workflow runs there.
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("-n", "--dry-run", "--dryrun", action="store_true")
    parser.add_argument("-d", "--directory", type=Path, default=Path())
    asked, _ = parser.parse_known_args(options)
    if asked.dry_run:
        return
    folder = asked.directory / ".snakemake"
    folder.mkdir(parents=True, exist_ok=True)
    handle = os.open(folder / "workflow.lock", os.O_RDWR | os.O_CREAT)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise RuntimeError(f"another workflow is running in {asked.directory.resolve()}") from None
    os.set_inheritable(handle, True)  # snakemake holds it; it does not hand it on to its jobs


def main():
    """Check, and become snakemake."""
    options = sys.argv[1:] or ["--cores", "all"]
    check_cores(options)
    for path in config_files(options):
        check_file(path)
    lock(options)
    command = ["snakemake", "--snakefile", str(SNAKEFILE), "--nolock", "--rerun-incomplete"]
    os.execvp(command[0], command + options)


with plain_errors("workflow"):
    main()
