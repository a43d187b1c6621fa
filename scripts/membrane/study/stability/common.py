# SPDX-License-Identifier: GPL-2.0-or-later
"""What the maps share: a membrane in a scene of its own, bisection, growth, tables and figures."""

import csv
import io
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import membrane as plugin
import numpy as np
from matplotlib.figure import Figure
from membrane import scene
from membrane.files import replace_text
from membrane.view import plots
from numpy.typing import ArrayLike
from yade import wrapper as yade

from ..sources import BUILD, REFERENCE

FULL, OTHER = REFERENCE / "stability", BUILD / "stability"
O = yade.Omega()  # noqa: E741, YADE's own name for it


class Model:
    """A membrane alone in the scene, that may run above its critical step.

    Attributes
    ----------
    rest : (N, 3) float
        Rest positions [m].
    net : Membrane
    forces : MembraneForceEngine
    ledger : MembraneLedger
    states : list of State
    masses : (N,) float
        [kg].
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
        built = scene.set_engines(self.net, scene.SceneParameters(gravity=gravity, **about))
        self.sail, self.forces, self.ledger = built, built.forces, built.ledger
        self.ledger.dead = True
        self.states = [O.bodies[i].state for i in self.net.bodyIds]
        self.masses = np.array(self.net.masses)

    def place(self, positions: ArrayLike, velocities: ArrayLike | None = None) -> None:
        """Put the nodes at positions (N, 3) [m] with velocities (N, 3) [m/s], default 0."""
        if velocities is None:
            velocities = np.zeros_like(self.rest)
        places = np.asarray(positions, dtype=float).tolist()
        speeds = np.asarray(velocities, dtype=float).tolist()
        for state, x, v in zip(self.states, places, speeds):
            state.pos, state.vel = x, v
        self.forces.forgetVelocities()

    def positions(self) -> np.ndarray:
        """Present positions (N, 3) [m]."""
        return np.array([state.pos for state in self.states])

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
    largest, before = 0.0, model.velocities()
    for _ in range(steps):
        O.step()
        now = model.velocities()
        largest, before = max(largest, kinetic(model.masses, now - before)), now
    return largest


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
    height = length * np.sqrt(3) / 2 if height is None else height
    heights = np.broadcast_to(np.asarray(height, dtype=float), cells)
    level = np.concatenate([[0.0], np.cumsum(heights)])
    rows = cells + 1
    nodes = np.zeros((rows * rows, 3))
    for j in range(rows):
        nodes[j * rows : (j + 1) * rows, 0] = length * (np.arange(rows) + 0.5 * (j % 2))
        nodes[j * rows : (j + 1) * rows, 1] = level[j]
    triangles = []
    for j in range(cells):
        for i in range(cells):
            a, b = j * rows + i, j * rows + i + 1
            c, d = a + rows, b + rows
            triangles += [(a, b, c), (b, d, c)] if j % 2 == 0 else [(a, b, d), (a, d, c)]
    return nodes, np.array(triangles)


def two_triangles(
    theta: float, heights: Sequence[float] = (0.02, 0.02), length: float = 0.02
) -> np.ndarray:
    """Nodes A, B, C, D [m] of two triangles on a mountain crease AB at an angle theta [rad]."""
    half = 0.5 * theta
    arms = [np.array([0.0, side * np.sin(half), -np.cos(half)]) for side in (1, -1)]
    middle = np.array([0.5 * length, 0.0, 0.0])
    ends = [np.zeros(3), np.array([length, 0.0, 0.0])]
    return np.array(ends + [middle + h * arm for h, arm in zip(heights, arms)])


TWO_TRIANGLES = ((0, 1, 2), (1, 0, 3))


def folder(quick: bool) -> Path:
    """Where a topic's files go: reference/stability/, or with `quick` build/stability/."""
    path = OTHER if quick else FULL
    path.mkdir(parents=True, exist_ok=True)
    return path


def write_table(path: Path, header: Sequence[str], rows: Iterable[Sequence]) -> None:
    """Write rows of numbers and words as CSV, whole or not at all."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(header)
    for row in rows:
        writer.writerow([f"{v:.6g}" if isinstance(v, (float, np.floating)) else v for v in row])
    replace_text(path, stream.getvalue())


def figure(
    columns: int = 1, rows: int = 1, width: float = 5.0, height: float = 3.8
) -> tuple[Figure, np.ndarray]:
    """A Figure and its axes (rows, columns)."""
    drawing = Figure(figsize=(width * columns, height * rows), layout="constrained")
    return drawing, drawing.subplots(rows, columns, squeeze=False)


def save(drawing: Figure, path: Path) -> None:
    """Write a picture, without the date in it."""
    plots.save(drawing, path, dpi=72, metadata={"Software": None})
