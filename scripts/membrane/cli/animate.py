# SPDX-License-Identifier: GPL-2.0-or-later
"""Renders sail.mp4 and sail.gif from the shapes of runs: `scripts/run.sh animate FOLDER ...`."""

import argparse

from ..view import animation
from .options import folder


def main() -> None:
    """Do it for each folder; sys.exit with one sentence if that cannot be."""
    parser = argparse.ArgumentParser(prog="animate", description=__doc__)
    parser.add_argument("folders", nargs="+", type=folder, metavar="FOLDER", help="output of a run")
    for place in parser.parse_args().folders:
        for path in animation.animate(place):
            print(path)
