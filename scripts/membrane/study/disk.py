# SPDX-License-Identifier: GPL-2.0-or-later
"""How accurate is it? A spinning disk of film vibrates as Lamb and Southwell computed in 1921.

A free disk of radius 1 m spins at 10 rad/s and is kicked out of its plane. Frequencies of three
modes on finer and finer meshes against the closed form: the error falls with the square of the
cells. The picture is disk.png.
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from yade.wrapper import Omega

from .. import scene
from .verification import order
from .verification.disk_mesh import disk_mesh
from .verification.spinning import OMEGA, disk_frequency, frequencies2, spin, spinning_net
from ..view import plots

CELLS = (4, 8, 16)  # from the centre to the edge
POISSON = 1 / 3  # that of a net of equilateral triangles, whatever the film's
MODES = {"saddle, (2, 0)": (2, 0), "umbrella, (0, 1)": (0, 1), "three waves, (3, 0)": (3, 0)}
KICK = 1e-5  # m/s


def vibrate(cells: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Errors (M,) of the frequencies, places (N, 3) [m], triangles, shapes (M, N) as they swing."""
    Omega().reset()
    nodes, triangles = disk_mesh(cells)
    film = scene.film(young=1e9, poisson=POISSON, density=1420.0, thickness=1e-3)
    disk = scene.add_membrane(nodes, triangles, material=film)
    sail = scene.set_engines(disk, scene.SceneParameters(path="fused"))
    flat = spinning_net(nodes, disk)  # stretched by its spin
    sail.place(flat)

    r, angle = np.hypot(*flat[:, :2].T), np.arctan2(flat[:, 1], flat[:, 0])
    modes = [r**m * np.cos(m * angle) * (1 - 2 * n * r**2) for m, n in MODES.values()]
    shapes = np.array(modes).T - sail.masses() @ np.array(modes).T / sail.masses().sum()
    kick = KICK * shapes.sum(axis=1)[:, None] * [0, 0, 1]
    times, moved, _ = spin(sail, flat, kick, turns=1.5)
    found = np.sqrt(frequencies2(times, moved[:, :, 2], shapes, sail.masses()))
    exact = [disk_frequency(m, n, POISSON) for m, n in MODES.values()]
    swings = np.sin(OMEGA * np.outer(times, found))
    swinging = np.linalg.lstsq(swings, moved[:, :, 2], rcond=None)[0]
    return found / exact - 1, flat, triangles, swinging


def draw(errors: np.ndarray, run: tuple, path: Path) -> None:
    """Draw the errors (R, M) over the cells, and the modes of a run of `vibrate`."""
    figure = Figure(figsize=(10.5, 3.6))
    axes = figure.add_axes((0.07, 0.14, 0.36, 0.82))
    for name, error in zip(MODES, errors.T):
        axes.loglog(CELLS, 100 * error, "o-", label=f"{name}: order {order(error):.2f}")
    axes.set_xticks(CELLS, map(str, CELLS))
    axes.set_yticks([0.2, 0.5, 1, 2, 5], ["0.2", "0.5", "1", "2", "5"])
    axes.minorticks_off()
    axes.set(xlabel="cells from centre to edge", ylabel="error of the frequency [%]")
    axes.set_ylim(bottom=0.1)
    axes.grid(alpha=0.3)
    axes.legend(frameon=False, loc="lower left")
    _, flat, triangles, swinging = run
    for k, (name, lift) in enumerate(zip(MODES, swinging)):
        axes = figure.add_axes((0.45 + 0.18 * k, 0.05, 0.18, 0.85), projection="3d")
        lift = 0.35 * lift / np.abs(lift).max()
        axes.plot_trisurf(*flat[:, :2].T, lift, triangles=triangles, cmap="cividis")
        axes.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-0.5, 0.5))
        axes.set_box_aspect((1, 1, 0.5), zoom=1.3)
        axes.set_axis_off()
        figure.text(0.54 + 0.18 * k, 0.78, name, ha="center")
    meaning = "(nodal diameters, nodal circles); heights are enlarged, at one instant"
    figure.text(0.72, 0.1, meaning, ha="center", color="0.35", fontsize=9)
    plots.save(figure, path)
