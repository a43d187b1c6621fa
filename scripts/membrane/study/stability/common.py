# SPDX-License-Identifier: GPL-2.0-or-later
"""What the maps share: a membrane in a scene of its own, bisection, growth, tables and figures."""

import csv
import io
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import membrane as plugin
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from membrane import scene
from membrane.files import replace_text
from membrane.view import plots
from numpy.typing import ArrayLike
from yade import wrapper as yade

from ..sources import BUILD, REFERENCE

O = yade.Omega()  # noqa: E741, YADE's own name for it


class Model:
    """A membrane alone in the scene, that may run above its critical step; its ledger is dead.

    `rest` (N, 3) are its nodes' rest positions [m], `states` and `masses` (N,) [kg] theirs.
    """

    def __init__(
        self,
        nodes: ArrayLike,
        triangles: ArrayLike = (),
        *,
        engine: dict | None = None,
        gravity: float = 0.0,
        **options: Any,
    ) -> None:
        O.reset()
        self.rest = np.array(nodes, dtype=float)
        self.net = scene.add_membrane(self.rest, triangles, **options)
        about: dict = {"force_time_step": True, "energy_tolerance": 0, **(engine or {})}
        self.sail = scene.set_engines(self.net, scene.SceneParameters(gravity=gravity, **about))
        self.forces, self.ledger = self.sail.forces, self.sail.ledger
        self.ledger.dead = True
        self.states = [O.bodies[i].state for i in self.net.bodyIds]
        self.masses = np.array(self.net.masses)

    def place(self, positions: ArrayLike, velocities: ArrayLike | None = None) -> None:
        """Put the nodes at positions (N, 3) [m] with velocities (N, 3) [m/s], default 0."""
        speeds = np.zeros_like(self.rest) if velocities is None else np.asarray(velocities)
        self.sail.place(np.asarray(positions))
        for state, v in zip(self.states, speeds.tolist()):
            state.vel = v
        self.forces.forgetVelocities()

    def positions(self) -> np.ndarray:
        """Present positions (N, 3) [m]."""
        return self.sail.positions()

    def velocities(self) -> np.ndarray:
        """Present velocities (N, 3) [m/s], half a step before the positions."""
        return np.array([state.vel for state in self.states])

    def balance(self, positions: np.ndarray, release: bool = False) -> None:
        """Put constant forces on the nodes that hold them at rest at `positions` (N, 3) [m].

        `release` only takes them away.
        """
        for i in self.net.bodyIds:
            O.forces.setPermF(i, (0, 0, 0))
        self.place(positions)
        if release:
            return
        O.dt = 1e-30
        for i, force in zip(self.net.bodyIds, scene.compute_forces(self.sail).tolist()):
            O.forces.setPermF(i, tuple(-f for f in force))

    def kinetic(self) -> float:
        """Kinetic energy [J] of all nodes."""
        return kinetic(self.masses, self.velocities())

    def start_ledger(self) -> plugin.MembraneLedger:
        """Exchange the ledger for one that starts at the next step; returns it."""
        new = plugin.MembraneLedger(forces=self.forces, gravity=self.ledger.gravity)
        O.engines = [new if isinstance(e, plugin.MembraneLedger) else e for e in O.engines]
        self.ledger = self.sail.ledger = new
        return new


def kinetic(masses: np.ndarray, velocities: np.ndarray) -> float:
    """Kinetic energy [J] of masses (N,) [kg] with velocities (N, 3) [m/s]."""
    with np.errstate(all="ignore"):
        return float(0.5 * np.sum(masses[:, None] * velocities**2))


def ripple(model: Model, steps: int) -> float:
    """Energy [J] of the change of the velocities in a step, m dv²/2, largest over `steps` steps.

    It sees the fast modes, which go unstable first, and not drift or rigid motion.
    """
    seen = [model.velocities()]
    for _ in range(steps):
        O.step()
        seen.append(model.velocities())
    return max(0.0, *(kinetic(model.masses, change) for change in np.diff(seen, axis=0)))


def advance_below(model: Model, steps: int, most: float, chunk: int = 8) -> bool:
    """Run `steps` steps; False as soon as the kinetic energy is seen above `most` [J].

    It looks every `chunk` steps, so that a run is left long before numbers overflow.
    """
    for done in range(0, steps, chunk):
        scene.advance(min(chunk, steps - done))
        if not model.kinetic() <= most:
            return False
    return True


def alternates(model: Model) -> bool:
    """Whether the motion is ruled by modes that change sign in every step.

    So do those that a step too long makes grow; a state unstable in itself grows smoothly.
    """
    seen = [model.velocities()]
    for _ in range(3):
        O.step()
        seen.append(model.velocities())
    first, second = np.diff(seen, axis=0)[-1], np.diff(seen, n=2, axis=0)[-1]
    return kinetic(model.masses, second) > 2 * kinetic(model.masses, first)


def grows(
    model: Model,
    positions: np.ndarray,
    velocities: np.ndarray,
    step: float,
    steps: int = 600,
    watch: int = 12,
    ratio: float = 3.0,
) -> bool:
    """Whether a perturbation grows by modes that alternate.

    Its ripple must grow `ratio`-fold from the middle of `steps` steps to their end, or a
    thousandfold in all: sides that go slack end the growth.
    """
    model.place(positions, velocities)
    O.dt = step
    most = 1e6 * kinetic(model.masses, velocities)
    first = ripple(model, watch)
    if not advance_below(model, steps // 2 - 2 * watch, most):
        return alternates(model)
    middle = ripple(model, watch)
    if not advance_below(model, steps - steps // 2 - watch, most):
        return alternates(model)
    return not ripple(model, watch) < min(ratio * middle, 1e3 * first) and alternates(model)


def bisect(
    is_above: Callable[[float], bool], low: float, high: float, rounds: int = 9, widen: int = 6
) -> float:
    """Where `is_above` turns true, by bisection of the ratio high / low; inf or 0 if nowhere."""
    for _ in range(widen):
        if is_above(high):
            break
        low, high = high, 2 * high
    else:
        return np.inf
    for _ in range(widen):
        if not is_above(low):
            break
        low, high = low / 2, low
    else:
        return 0.0
    for _ in range(rounds):
        middle = np.sqrt(low * high)
        low, high = (low, middle) if is_above(middle) else (middle, high)
    return float(np.sqrt(low * high))


def grid(
    cells: int, length: float = 0.02, height: ArrayLike | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Flat sheet of rows of isosceles triangles, staggered: nodes (N, 3) [m], triangles (T, 3).

    `cells` bases of `length` [m] in a row, `cells` rows; `height` [m] of one, or of each row.
    """
    heights = np.broadcast_to(length * np.sqrt(3) / 2 if height is None else height, cells)
    level, rows = np.concatenate([[0.0], np.cumsum(heights)]), cells + 1
    j, i = (axis.ravel() for axis in np.mgrid[:rows, :rows])
    nodes = np.column_stack([length * (i + 0.5 * (j % 2)), level[j], np.zeros(rows * rows)])
    j, i = (axis.ravel() for axis in np.mgrid[:cells, :cells])
    a, odd = j * rows + i, j % 2 == 1
    b, c, d = a + 1, a + rows, a + rows + 1
    pairs = np.column_stack([a, b, np.where(odd, d, c), np.where(odd, a, b), d, c])
    return nodes, pairs.reshape(-1, 3)


def two_triangles(
    theta: float, heights: Sequence[float] = (0.02, 0.02), length: float = 0.02
) -> np.ndarray:
    """Nodes A, B, C, D [m] of two triangles on a mountain crease AB at an angle theta [rad]."""
    s, c = np.sin(0.5 * theta), np.cos(0.5 * theta)
    (high, low), x = heights, 0.5 * length
    return np.array([(0, 0, 0), (length, 0, 0), (x, high * s, -high * c), (x, -low * s, -low * c)])


TWO_TRIANGLES = ((0, 1, 2), (1, 0, 3))


def publish(name: str, quick: bool, header: str, rows: Iterable[Sequence], drawing: Figure) -> None:
    """Write a topic's table and picture into reference/stability/, `quick` build/stability/.

    `header` names the columns, "; " between two, of `rows` of numbers and words: NAME.csv. Each
    file is written whole or not at all; the picture is without the date in it.
    """
    out = BUILD / "stability" if quick else REFERENCE / "stability"
    out.mkdir(parents=True, exist_ok=True)
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(header.split("; "))
    for row in rows:
        writer.writerow([f"{v:.6g}" if isinstance(v, (float, np.floating)) else v for v in row])
    replace_text(out / f"{name}.csv", stream.getvalue())
    plots.save(drawing, out / f"{name}.png", dpi=72, metadata={"Software": None})


def figure(
    columns: int = 1, rows: int = 1, width: float = 5.0, height: float = 3.8
) -> tuple[Figure, Sequence[Axes]]:
    """A Figure and its axes, row by row; width and height [inches] of one."""
    drawing = Figure(figsize=(width * columns, height * rows), layout="constrained")
    return drawing, drawing.subplots(rows, columns, squeeze=False).ravel()
