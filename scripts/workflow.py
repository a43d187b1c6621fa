# SPDX-License-Identifier: GPL-2.0-or-later
"""Starts the Snakemake workflow, unless a file of configuration is missing or cannot be used.

Run it by `scripts/run.sh workflow [options of snakemake]`. Snakemake itself would end by a
traceback.
"""

import argparse
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


def main():
    """Check, and become snakemake."""
    options = sys.argv[1:] or ["--cores", "all"]
    check_cores(options)
    for path in config_files(options):
        check_file(path)
    command = ["snakemake", "--snakefile", str(SNAKEFILE), "--rerun-incomplete", *options]
    os.execvp(command[0], command)


with plain_errors("workflow"):
    main()
