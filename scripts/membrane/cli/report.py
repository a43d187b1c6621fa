# SPDX-License-Identifier: GPL-2.0-or-later
"""Writes report.html from the other results of runs: `scripts/run.sh report FOLDER ...`."""

import argparse

from ..view import report
from .options import folder


def main() -> None:
    """Do it for each folder; sys.exit with one sentence if that cannot be."""
    parser = argparse.ArgumentParser(prog="report", description=__doc__)
    parser.add_argument("folders", nargs="+", type=folder, metavar="FOLDER", help="output of a run")
    for place in parser.parse_args().folders:
        print(report.write_report(place))
