# SPDX-License-Identifier: GPL-2.0-or-later
"""Measures where the method becomes unstable, and writes tables and pictures into
reference/stability/.

Run it by `scripts/run.sh stability [options]`, or by `yade -n -x scripts/stability.py [options]`.
"""

import argparse
import importlib
import time

from .options import add_only

TOPICS = {
    "timestep": "estimate of the critical time step against the measured limit",
    "negative_stiffness": "sheets with flat triangles",
    "creases": "lengths in (7), both laws, angular momentum, closed and flat angles",
    "drag": "air drag in dense air",
    "buckling": "alpha, snapping tethers, all sides buckled",
    "drift": "energy drift over seconds, coarse against fine steps",
    "beyond": "what happens above the limit, and how soon a run is stopped",
}


def command_line() -> argparse.Namespace:
    """Parsed sys.argv."""
    topics = "; ".join(f"{name}: {text}" for name, text in TOPICS.items())
    parser = argparse.ArgumentParser(prog="stability", description=__doc__, epilog=topics)
    add_only(parser, TOPICS, "topics", "TOPIC")
    parser.add_argument(
        "--quick", action="store_true", help="thin scans, written into build/stability/ instead"
    )
    return parser.parse_args()


def main() -> int:
    """Run the topics in turn."""
    arguments = command_line()
    for name in arguments.only:
        start = time.monotonic()
        line = importlib.import_module(f"membrane.study.stability.{name}").run(arguments.quick)
        print(f"{name}: {line} ({time.monotonic() - start:.0f} s)", flush=True)
    return 0
