# SPDX-License-Identifier: GPL-2.0-or-later
"""How accurate is it? A spinning disk of film vibrates as Lamb and Southwell computed in 1921.

A free disk of radius 1 m spins at 10 rad/s and is kicked out of its plane. Frequencies of three
modes on finer and finer meshes against the closed form: the error falls with the square of the
cells. The picture is disk.png.
"""

import argparse

import numpy as np

from ..study import disk
from .options import add_out


def main() -> None:
    """Vibrate the disks, tell the errors and draw."""
    parser = argparse.ArgumentParser(prog="disk", description=__doc__.splitlines()[0])
    add_out(parser, "out/disk", "folder of disk.png (default: {})")
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    runs = [disk.vibrate(cells) for cells in disk.CELLS]
    errors = np.abs([run[0] for run in runs])
    for name, error in zip(disk.MODES, errors.T):
        order = disk.order(error)
        print(f"{name}: error {100 * error[-1]:.3f} % on {disk.CELLS[-1]} cells, order {order:.2f}")
    disk.draw(errors, runs[-1], out / "disk.png")
    print(f"Look at {out / 'disk.png'}")
