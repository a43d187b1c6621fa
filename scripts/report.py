# SPDX-License-Identifier: GPL-2.0-or-later
"""Writes report.html from the other results of runs: `scripts/run.sh report FOLDER ...`."""

import argparse
from pathlib import Path

from membrane.commands import plain_errors

with plain_errors("report"):
    from membrane import report


def main():
    """Do it for each folder; sys.exit with one sentence if that cannot be."""
    parser = argparse.ArgumentParser(prog="report", description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="output of a run")
    for folder in parser.parse_args().folders:
        with plain_errors("report"):
            made = [report.write_report(folder)]
        for path in made:
            print(path)


main()
