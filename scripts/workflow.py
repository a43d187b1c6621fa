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
    from membrane.parameters import check_name
    from sweeping.config import check_file, check_words

SNAKEFILE = Path(__file__).resolve().parent / "workflow" / "Snakefile"


def asked(options):
    """What options of snakemake ask for: files of configuration, cores, the folder to work in.

    Attributes of the result are `configfile`, `config` and `cores` (lists of str) and `directory`
    (Path).
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--configfile", "--configfiles", nargs="*", action="extend", default=[])
    parser.add_argument("-C", "--config", nargs="*", action="extend", default=[])
    parser.add_argument("-c", "--cores", "-j", "--jobs", nargs="?", action="append", default=[])
    parser.add_argument("-d", "--directory", type=Path, default=Path())
    return parser.parse_known_args(options)[0]


def is_plan(options):
    """Whether snakemake will only tell what it would do: -n, also as in -np, or --dry-run."""
    return any(re.fullmatch(r"-p?n[a-z]*|--dry-?run", option) for option in options)


def check_cores(cores):
    """Raise ValueError if snakemake is asked for less than one core: it would wait for ever."""
    for number in cores:
        if number and re.fullmatch(r"-?\d+", number) and int(number) < 1:
            raise ValueError(f"{number} cores or jobs: must be at least 1")


def lock(directory):
    """Hold a lock in the folder in which snakemake works, until this process ends, however it does.

    It stands for Snakemake's own, which a killed one leaves behind.

    Raises
    ------
    RuntimeError
        If another workflow runs there.
    """
    folder = directory / ".snakemake"
    folder.mkdir(parents=True, exist_ok=True)
    handle = os.open(folder / "workflow.lock", os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise RuntimeError(f"another workflow is running in {directory.resolve()}") from None
    os.set_inheritable(handle, True)  # snakemake holds it; it does not hand it on to its jobs


def main():
    """Check, and become snakemake."""
    options = sys.argv[1:] or ["--cores", "all"]
    wanted = asked(options)
    check_cores(wanted.cores)
    check_name(wanted.directory)
    for path in wanted.configfile:
        check_name(path)
        check_file(path)
    check_words(wanted.config)
    if not is_plan(options):
        lock(wanted.directory)
    command = ["snakemake", "--snakefile", str(SNAKEFILE), "--nolock", "--rerun-incomplete"]
    os.execvp(command[0], command + options)


with plain_errors("workflow"):
    main()
