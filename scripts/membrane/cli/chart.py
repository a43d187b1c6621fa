# SPDX-License-Identifier: GPL-2.0-or-later
"""Charts accuracy against time: path, time step, mesh and parts left out, on one grid.

Three questions, each with its error and its processor time on one thread: the early deployment
curve against the finest mesh, the spinning disk's frequencies against the closed form, and the
energy ledger. Writes reference/chart.csv and chart.png.
"""

import argparse

from ..files import replace_text
from ..progress import announcer
from ..study import chart
from ..study.sources import REFERENCE
from ..study.verification.chart_picture import TITLES, draw
from .options import add_out, count


def main() -> None:
    """Run the grid, write table and picture."""
    parser = argparse.ArgumentParser(prog="chart", description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=count, default=3, help="rounds of the timing (default 3)")
    parser.add_argument(
        "--steps", type=count, default=4000, help="steps of each, at refine = 1 (default 4000)"
    )
    parser.add_argument("--quick", action="store_true", help="a small grid")
    add_out(parser, REFERENCE, "folder of chart.csv and chart.png (default: reference)")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    tell = announcer("chart")
    points = chart.measure(arguments.quick, arguments.rounds, arguments.steps, tell)
    table = arguments.out / "chart.csv"
    replace_text(table, chart.table(points))
    draw(points, arguments.out / "chart.png")
    for question in TITLES:
        for p in sorted((p for p in points if p.question == question), key=lambda p: p.cost):
            print(
                f"{question:10s} {p.path:5s} mesh {p.mesh:2d} dt {p.dt:8.3g} s {p.cost:8.3g} s "
                f"error {p.error:9.3g} {'*' if p.pareto else ' '} "
                f"{'without ' + p.part if p.part else ''}"
            )
    print(f"Wrote {table} and {arguments.out / 'chart.png'}")
    tell("done")
