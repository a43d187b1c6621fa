# SPDX-License-Identifier: GPL-2.0-or-later
"""One run of any sail, whole or not at all, as part of a sweep or alone.

Run again after it was killed it goes on from its last checkpoint. Exits with 0 for a case that is
complete or has diverged.
"""

import argparse
import sys
from typing import Any

from ..results.case_folder import COMPLETE
from ..run.case import run_case
from .options import add_checkpoints, add_out, chosen_sail, from_arguments, parse, sails_text


def command_line(kind: Any, words: list[str]) -> argparse.Namespace:
    """Parsed words of the command line."""
    parser = argparse.ArgumentParser(
        prog="case",
        description="Deploy a solar sail; leave all results or none.",
        epilog=sails_text(),
    )
    add_out(parser, text="folder of the case; it appears at the end")
    parser.add_argument(
        "--no-pictures", action="store_true", help="draw no pictures and write no report.html"
    )
    add_checkpoints(parser)
    return parse(parser, kind, words)


def main() -> None:
    """Run the case; sys.exit with one sentence if that cannot be."""
    kind, words = chosen_sail(sys.argv[1:])
    arguments = command_line(kind, words)
    if not arguments.out:
        raise ValueError("--out is missing, the folder of the case")
    found = run_case(
        from_arguments(arguments, kind=kind),
        arguments.out,
        arguments.checkpoint_every,
        pictures=not arguments.no_pictures,
    )
    if found.state == COMPLETE:
        print(f"Complete: {arguments.out}")
    else:
        when = "in the spin-up" if found.time is None else f"{found.time:.6g} s after the release"
        print(f"Diverged {when}: {found.reason}: {arguments.out}")
