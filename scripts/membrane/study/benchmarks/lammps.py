# SPDX-License-Identifier: GPL-2.0-or-later
"""The bare springs of a sheet in LAMMPS: harmonic bonds and leapfrog, no pairs, no new lists."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
from membrane.geometry import side_lengths

from .sheet import SPACING, Sheet

PROGRAM = "lmp"
# Of the plugin's default film, as if each spring were a strip as wide as it is long.
STIFFNESS = 3.2e9 * 7.5e-6  # E h [N/m]
MASS = 1420 * 7.5e-6 * SPACING**2  # of a node [kg]
STEP = 0.1 * (MASS / STIFFNESS) ** 0.5  # [s]
MARGIN = 0.5 * SPACING  # of the box [m]; it is fixed, and nothing gets that far

# Nodes in the order of the rows are faster unsorted (atom_modify sort) than sorted; ghosts reach
# just beyond the longest bond. Lists are made once, at the start.
INPUT = """\
units si
atom_style bond
atom_modify sort 0 0
boundary f f f
newton on
processors * * 1
comm_modify cutoff {reach:.6g}
special_bonds lj/coul 1 1 1
bond_style harmonic
read_data sheet.data
bond_coeff 1 {half:.9g} {straight:.9g}
bond_coeff 2 {half:.9g} {diagonal:.9g}
neigh_modify delay 1000000 every 1000000 check no
fix motion all nve
timestep {step:.6g}
thermo 1000000
run {warm}
run {steps}
"""


def input_text(steps: int) -> str:
    """LAMMPS commands that warm up, then run `steps` steps of the sheet in sheet.data."""
    diagonal = 2**0.5 * SPACING
    return INPUT.format(
        reach=1.2 * diagonal,
        half=STIFFNESS / 2,  # LAMMPS's K has the usual 1/2 in it
        straight=SPACING,
        diagonal=diagonal,
        step=STEP,
        warm=max(1, steps // 10),
        steps=steps,
    )


def write_data(sheet: Sheet, path: Path) -> None:
    """Write nodes and sides of a Sheet as LAMMPS data; bonds of type 1 are sides of squares."""
    sides = sheet.sides()
    kinds = 1 + (side_lengths(sheet.nodes, sides) > 1.2 * SPACING)
    ids = 1 + np.arange(len(sheet.nodes))
    ones = np.ones_like(ids)
    box = np.column_stack([sheet.places.min(axis=0) - MARGIN, sheet.places.max(axis=0) + MARGIN])
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"Sheet\n\n{len(ids)} atoms\n{len(sides)} bonds\n1 atom types\n2 bond types\n\n")
        for axis, (low, high) in zip("xyz", box):
            file.write(f"{low:.9g} {high:.9g} {axis}lo {axis}hi\n")
        file.write(f"\nMasses\n\n1 {MASS:.9g}\n\nAtoms # bond\n\n")
        np.savetxt(
            file, np.column_stack([ids, ones, ones, sheet.places]), fmt="%d %d %d" + " %.12g" * 3
        )
        file.write("\nBonds\n\n")
        np.savetxt(file, np.column_stack([1 + np.arange(len(sides)), kinds, 1 + sides]), fmt="%d")


def available() -> bool:
    """Whether LAMMPS can be run."""
    return shutil.which(PROGRAM) is not None


def version() -> str | None:
    """The version of LAMMPS; None if there is no LAMMPS."""
    if not available():
        return None
    done = subprocess.run([PROGRAM, "-h"], capture_output=True, encoding="utf-8", check=False)
    found = re.search(r"Simulator - (.+)", done.stdout)
    return found[1] if found else "unknown"


def loop_time(output: str, threads: int) -> float:
    """Time a step [s] of the last run in what LAMMPS printed.

    It is wall time; on one thread processor time, which other work on the machine lengthens less.
    """
    found = re.findall(r"Loop time of (\S+) on \d+ procs for (\d+) steps", output)
    if not found:
        raise RuntimeError(f"LAMMPS reported no loop time; it said last: {output[-300:]!r}")
    seconds, steps = found[-1]
    used = re.findall(r"([\d.]+)% CPU use", output) if threads == 1 else ["100"]
    return float(seconds) / int(steps) * min(1.0, float(used[-1]) / 100)


def run(folder: Path, steps: int, threads: int) -> str:
    """Run the sheet whose sheet.data is in `folder`; returns what LAMMPS printed.

    Debian's LAMMPS has no threads (package OPENMP): two of them are two processes under MPI.
    """
    (folder / "in.sheet").write_text(input_text(steps), encoding="utf-8")
    start = [] if threads == 1 else ["mpirun", "--allow-run-as-root", "-np", str(threads)]
    done = subprocess.run(
        [*start, PROGRAM, "-in", "in.sheet", "-log", "none"],
        cwd=folder,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        encoding="utf-8",
        timeout=600,
    )
    if done.returncode:
        raise RuntimeError(f"LAMMPS failed: {(done.stdout + done.stderr)[-500:]!r}")
    return done.stdout
