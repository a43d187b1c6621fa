# SPDX-License-Identifier: GPL-2.0-or-later
"""A Miura-ori sheet, read from a FOLD file, spins and is unfolded by masses at its corners.

The sheet flies free in thin air, as in the paper's chamber: it keeps its angular momentum but for
the drag, and turns the slower the wider it is open.
"""

import argparse
import sys
from pathlib import Path

from ..parameters import PatternParameters
from ..results.unfinished import new_results
from ..run import pattern_sail
from ..view.report import PAGE
from .options import add_out

PATTERN = Path(sys.argv[0]).resolve().parent / "patterns" / "miura.fold"
INSTANTS = (0.0, 0.015, 0.03, 0.05, 0.1, 1.0)  # s


def parameters(duration):
    """What this scene changes of a sail's parameters; film and air are the paper's."""
    return PatternParameters(
        size=0.019,
        omega=60.0,
        tip_mass=0.36e-3,
        beta=1.0,
        zeta=0.1,
        air_density=1.2e-3,
        duration=duration,
        shapes_interval=5e-3,
    )


def main():
    """Unfold the sheet; sys.exit with one sentence if that cannot be."""
    parser = argparse.ArgumentParser(prog="miura", description=__doc__.splitlines()[0])
    add_out(parser, "out/miura")
    parser.add_argument("--duration", type=float, default=1.0, metavar="s", help="[s] (default 1)")
    arguments = parser.parse_args()
    chosen = parameters(arguments.duration)
    sheet = pattern_sail.read_sheet(PATTERN, chosen)
    with new_results(arguments.out) as part:
        summary = pattern_sail.fly(sheet, chosen, part, shown=INSTANTS)
    found = summary["measures"]
    print(
        f"Open to {100 * found['final_projected_area']:.1f} % of the flat area after "
        f"{chosen.duration:g} s, turning at {found['final_spin_rate']:.2f} rad/s; energy from "
        f"nowhere {found['largest_unexplained_energy']:.1e} of {found['largest_energy']:.1e} J."
    )
    print("Look at:")
    for name in ("shapes.png", "history.png", PAGE):
        if (arguments.out / name).exists():
            print(f"  {arguments.out / name}")
