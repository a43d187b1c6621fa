# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper's scene: the small-scale sail is folded, spun up, released and deploys.

Run it by `scripts/run.sh deploy [options]`, or by `yade -n -x scripts/deploy.py [options]`, or
many times by `yade-batch table.txt scripts/deploy.py` with parameters as the table's columns.
"""

import argparse
import contextlib
import os
import sys
from dataclasses import fields
from pathlib import Path

from membrane import sail, window
from membrane.parameters import SailParameters, add_arguments, from_arguments
from yade import utils
from yade.wrapper import Omega


def command_line():
    """Parsed sys.argv."""
    parser = argparse.ArgumentParser(
        prog="deploy", description="Fold, spin up and deploy the paper's solar sail."
    )
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="output folder (default: out, in a batch out/CASE)"
    )
    parser.add_argument("--no-pictures", action="store_true", help="draw no pictures")
    parser.add_argument(
        "--watch", action="store_true", help="show the run in YADE's window, and leave it open"
    )
    add_arguments(parser)
    return parser.parse_args()


def batch_row():
    """Parameters and name of this job of yade-batch; none outside a batch."""
    if not os.environ.get("YADE_BATCH"):
        return {}, None
    defaults = {item.name: item.default for item in fields(SailParameters)}
    utils.readParamsFromTable(noTableOk=False, **defaults)
    from yade.params import table

    return {name: getattr(table, name) for name in defaults}, Omega().tags["description"]


def main():
    """Deploy the sail; sys.exit with one sentence if that cannot be."""
    arguments = command_line()
    overrides, case = batch_row()
    folder = arguments.out or (Path("out") / case.replace("/", "_") if case else Path("out"))
    try:
        parameters = from_arguments(arguments, overrides)
        look = window.Watch() if arguments.watch else sail.look_away
        summary = sail.deploy(parameters, folder, not arguments.no_pictures, look)
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"deploy: {error}")
    found, wall = summary["measures"], summary["wall_time"]
    reached = found["time_of_rate_0.9"]
    print(
        f"Deployment rate {found['final_deployment_rate']:.3f} at {parameters.duration:g} s, "
        + (f"above 0.9 from {reached:.3f} s on" if reached else "never above 0.9")
        + f"; spin-up {wall['spin_up']:.1f} s, run {wall['run']:.1f} s of wall time."
    )
    print("Look at:")
    shown = [] if arguments.no_pictures else ["shapes.png", "deployment.png"]
    for name in [*shown, "history.csv", "summary.json", "shapes/film.pvd", "shapes/sides.pvd"]:
        print(f"  {folder / name}")
    if arguments.watch:
        print("Close the window to end.")
        with contextlib.suppress(KeyboardInterrupt):  # Ctrl-C ends it, too
            look.wait()


main()
utils.waitIfBatch()
