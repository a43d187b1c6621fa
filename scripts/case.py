# SPDX-License-Identifier: GPL-2.0-or-later
"""One case of the paper's scene, whole or not at all, as part of a sweep or alone.

Run it by `scripts/run.sh case --out DIR [options]`, or by `yade -n -x scripts/case.py --out DIR
[options]`, again if it was killed: it goes on from its last checkpoint. In a batch of yade-batch
the options are columns of the table. Exits with 0 for a case that is complete or has diverged.
"""

import argparse

from membrane.batch import batch_row
from membrane.case_folder import COMPLETE
from membrane.commands import folder, plain_errors
from membrane.parameters import from_arguments, parse

with plain_errors("case"):
    from membrane.case import run_case


def command_line():
    """Parsed sys.argv."""
    parser = argparse.ArgumentParser(
        prog="case", description="Deploy the paper's solar sail; leave all results or none."
    )
    parser.add_argument(
        "--out", type=folder, metavar="DIR", help="folder of the case; it appears at the end"
    )
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


with plain_errors("case", "stopped by Ctrl-C; run again it goes on"):
    main()
