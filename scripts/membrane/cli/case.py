# SPDX-License-Identifier: GPL-2.0-or-later
"""One case of the paper's scene, whole or not at all, as part of a sweep or alone.

Run again after it was killed it goes on from its last checkpoint. In a batch of yade-batch the
options are columns of the table. Exits with 0 for a case that is complete or has diverged.
"""

import argparse

from ..results.case_folder import COMPLETE
from ..run.case import run_case
from .batch import batch_row
from .options import add_out, folder, from_arguments, parse


def command_line():
    """Parsed sys.argv."""
    parser = argparse.ArgumentParser(
        prog="case", description="Deploy the paper's solar sail; leave all results or none."
    )
    add_out(parser, text="folder of the case; it appears at the end")
    parser.add_argument(
        "--no-pictures", action="store_true", help="draw no pictures and write no report.html"
    )
    parser.add_argument(
        "--checkpoint-every",
        type=float,
        default=60.0,
        metavar="SECONDS",
        help="wall time between two checkpoints [s], >= 0 (default 60)",
    )
    return parse(parser)


def main():
    """Run the case; sys.exit with one sentence if that cannot be."""
    arguments = command_line()
    overrides, own, _ = batch_row(
        out=str(arguments.out or ""),
        no_pictures=arguments.no_pictures,
        checkpoint_every=arguments.checkpoint_every,
    )
    if not own["out"]:
        raise ValueError("--out is missing, the folder of the case")
    place = folder(own["out"])
    found = run_case(
        from_arguments(arguments, overrides),
        place,
        own["checkpoint_every"],
        pictures=not own["no_pictures"],
    )
    if found["outcome"] == COMPLETE:
        print(f"Complete: {place}")
    elif found["time"] is None:
        print(f"Diverged in the spin-up: {found['reason']}: {place}")
    else:
        print(f"Diverged {found['time']:.6g} s after the release: {found['reason']}: {place}")
