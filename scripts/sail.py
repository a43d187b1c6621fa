# SPDX-License-Identifier: GPL-2.0-or-later
"""Any sheet as a spinning sail: a crease pattern in a FOLD file, or a mesh of gmsh.

Run it by `scripts/run.sh sail PATTERN.fold|MESH.msh [options]`.
"""

import argparse
from pathlib import Path

from membrane.commands import file, folder, plain_errors
from membrane.parameters import from_arguments, parse
from membrane.unfinished import new_results

with plain_errors("sail"):
    from membrane import pattern_sail
    from membrane.pattern_sail import PatternParameters
    from membrane.report import PAGE
    from membrane.sheet_words import described


def command_line():
    """Parsed sys.argv."""
    parser = argparse.ArgumentParser(
        prog="sail", description="Spin a sail made from a crease pattern or a mesh."
    )
    parser.add_argument("file", type=file, help="crease pattern (.fold) or mesh of gmsh (.msh)")
    parser.add_argument(
        "--out", type=folder, default=Path("out"), metavar="DIR", help="default: out"
    )
    parser.add_argument("--no-pictures", action="store_true", help="draw no pictures")
    parser.add_argument("--no-report", action="store_true", help="write no report.html")
    return parse(parser, PatternParameters)


def main():
    """Spin the sail; sys.exit with one sentence if that cannot be."""
    arguments = command_line()
    out, pictures = arguments.out, not arguments.no_pictures
    parameters = from_arguments(arguments, kind=PatternParameters)
    sheet = pattern_sail.read_sheet(arguments.file, parameters)
    words = described(sheet, pattern_sail.place(sheet, parameters))
    print(f"{arguments.file}: {words}", flush=True)
    with new_results(out) as part:
        page = not arguments.no_report
        summary = pattern_sail.fly(sheet, parameters, part, pictures, page=page)
    found = summary["measures"]
    print(
        f"Projected area {found['final_projected_area']:.3f} of the flat one after "
        f"{parameters.duration:g} s, at most {found['largest_projected_area']:.3f}; energy from "
        f"nowhere {found['largest_unexplained_energy']:.1e} of {found['largest_energy']:.1e} J; "
        f"{summary['wall_time']['run']:.1f} s of wall time."
    )
    print("Look at:")
    shown = ["shapes.png", "history.png"] if pictures else []
    shown += [PAGE] if (out / PAGE).exists() else []
    others = ["history.csv", "summary.json", "sail.fold", "shapes/film.pvd", "shapes/sides.pvd"]
    for name in [*shown, *others]:
        print(f"  {out / name}")


with plain_errors("sail"):
    main()
