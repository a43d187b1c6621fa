# SPDX-License-Identifier: GPL-2.0-or-later
"""Leaves out each part of the model in turn: what it changes in the answer, and what time it costs.

Writes reference/parts.csv and prints advice.
"""

import argparse

from ..progress import announcer
from ..study import parts
from .options import count


def main() -> None:
    """Measure, write the table, print the advice."""
    parser = argparse.ArgumentParser(prog="parts", description=__doc__.splitlines()[0])
    parser.add_argument(
        "--rounds", type=count, default=3, help="pairs of runs that time a part (default 3)"
    )
    parser.add_argument("--steps", type=count, default=1000, help="steps of each (default 1000)")
    parser.add_argument(
        "--members", type=count, default=3, help="runs that give the spread, >= 2 (default 3)"
    )
    arguments = parser.parse_args()
    if arguments.members < 2:
        parser.error(f"--members {arguments.members}: must be at least 2")
    tell = announcer("parts")
    for line in parts.measure(arguments.rounds, arguments.steps, arguments.members, tell):
        print(line)
    print(f"Wrote {parts.TABLE}")
    tell("done")
