# SPDX-License-Identifier: GPL-2.0-or-later
"""Deploys a sail: the paper's, another kind's, or one made from a file.

Many times by `yade-batch table.txt scripts/deploy.py` with parameters as the table's columns; a
column `sail` names another sail than the paper's.
"""

import argparse
import contextlib
import sys
from pathlib import Path
from typing import Any

from yade import utils

from ..measures import table
from ..results.own import RUN
from ..results.unfinished import RESULTS, new_results
from ..run import driver
from ..run.sails import SAILS
from ..view import window
from .batch import batch_row, batch_sail, folder_of
from .options import add_out, chosen_sail, from_arguments, parse, sails_text

PLACES = {"square": "", "sheet": ""}  # below out/; of other kinds their names
STAGES = {"spin_up": "spin-up", "run": "run", "pictures": "pictures"}


def command_line(kind: Any, words: list[str]) -> argparse.Namespace:
    """Parsed words of the command line."""
    parser = argparse.ArgumentParser(
        prog=Path(sys.argv[0]).stem, description="Deploy a solar sail.", epilog=sails_text()
    )
    add_out(parser, text="output folder (default: out, or out/SAIL; in a batch out/CASE)")
    parser.add_argument("--no-pictures", action="store_true", help="draw no pictures")
    parser.add_argument("--no-report", action="store_true", help="write no report.html")
    parser.add_argument(
        "--animation", action="store_true", help="also render sail.mp4 and sail.gif (Xvfb, ffmpeg)"
    )
    parser.add_argument(
        "--watch", action="store_true", help="show the run in YADE's window, and leave it open"
    )
    return parse(parser, kind, words)


def main(sail: str = "square") -> None:
    """Deploy a sail, by default of some kind; sys.exit with one sentence if that cannot be."""
    column = batch_sail()
    words = [*([column] if column else []), *sys.argv[1:]]
    kind, words = chosen_sail(words, sail)
    overrides, case = batch_row(kind)
    arguments = command_line(kind, words)
    p = from_arguments(arguments, overrides, kind)
    out = arguments.out or Path(
        "out", folder_of(case) if case else PLACES.get(kind.sail, kind.sail)
    )
    made = SAILS[kind.sail].sail(p)
    if made.words:
        print(made.words, flush=True)
    look: Any = window.Watch() if arguments.watch else driver.look_away
    with new_results(out) as part:
        pictures, page = not arguments.no_pictures, not arguments.no_report
        summary = driver.deploy(p, part, pictures, page=page, look=look, sail=made)
        if arguments.animation:
            from ..view.animation import animate  # loads VTK's renderer

            animate(part)
    tell(summary, out)
    if arguments.watch:
        print("Close the window to end.")
        with contextlib.suppress(KeyboardInterrupt):  # Ctrl-C ends it, too
            look.wait()
    utils.waitIfBatch()


def tell(summary: dict, out: Path) -> None:
    """Say what came of a run, and which files it left in the folder `out`."""
    rows = table(summary["measures"])
    width = max(len(label) for label, *_ in rows)
    for label, value, unit in rows:
        print(f"{label:{width}}  {value} {'' if unit == '-' else unit}".rstrip())
    wall = summary["wall_time"]
    spent = (f"{wall[stage]:.1f} s of {word}" for stage, word in STAGES.items() if stage in wall)
    print(f"Wall time: {', '.join(spent)}.")
    print("Look at:")
    for name in (*RESULTS[RUN], "shapes/film.pvd", "shapes/sides.pvd"):
        if (out / name).is_file():
            print(f"  {out / name}")
