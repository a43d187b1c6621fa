# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper's scene: the small-scale sail is folded, spun up, released and deploys.

Many times by `yade-batch table.txt scripts/deploy.py` with parameters as the table's columns.
"""

import argparse
import contextlib
from pathlib import Path

from yade import utils

from ..results.unfinished import new_results
from ..run import sail
from ..view import report, window
from .batch import batch_row, folder_of
from .options import add_out, from_arguments, parse


def command_line():
    """Parsed sys.argv."""
    parser = argparse.ArgumentParser(
        prog="deploy", description="Fold, spin up and deploy the paper's solar sail."
    )
    add_out(parser, text="output folder (default: out; in a batch out/CASE)")
    parser.add_argument("--no-pictures", action="store_true", help="draw no pictures")
    parser.add_argument("--no-report", action="store_true", help="write no report.html")
    parser.add_argument(
        "--animation", action="store_true", help="also render sail.mp4 and sail.gif (Xvfb, ffmpeg)"
    )
    parser.add_argument(
        "--watch", action="store_true", help="show the run in YADE's window, and leave it open"
    )
    return parse(parser)


def main():
    """Deploy the sail; sys.exit with one sentence if that cannot be."""
    arguments = command_line()
    overrides, _, case = batch_row()
    out = arguments.out or (Path("out") / folder_of(case) if case else Path("out"))
    parameters = from_arguments(arguments, overrides)
    look = window.Watch() if arguments.watch else sail.look_away
    films = []
    with new_results(out) as part:
        summary = sail.deploy(
            parameters,
            part,
            pictures=not arguments.no_pictures,
            page=not arguments.no_report,
            look=look,
        )
        if arguments.animation:
            from ..view.animation import animate  # loads VTK's renderer

            films = animate(part)
    found, wall = summary["measures"], summary["wall_time"]
    reached = found["time_of_rate_0.9"]
    print(
        f"Deployment rate {found['final_deployment_rate']:.3f} at {parameters.duration:g} s, "
        + (f"above 0.9 from {reached:.3f} s on" if reached else "never above 0.9")
        + f"; spin-up {wall['spin_up']:.1f} s, run {wall['run']:.1f} s of wall time."
    )
    print("Look at:")
    shown = [] if arguments.no_pictures else ["shapes.png", "deployment.png"]
    if not arguments.no_report and (out / report.PAGE).exists():
        shown.append(report.PAGE)
    shown += [film.name for film in films]
    for name in [*shown, "history.csv", "summary.json", "shapes/film.pvd", "shapes/sides.pvd"]:
        print(f"  {out / name}")
    if arguments.watch:
        print("Close the window to end.")
        with contextlib.suppress(KeyboardInterrupt):  # Ctrl-C ends it, too
            look.wait()
    utils.waitIfBatch()
