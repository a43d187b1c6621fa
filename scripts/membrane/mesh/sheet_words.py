# SPDX-License-Identifier: GPL-2.0-or-later
"""A sheet in words: what was read, what is doubtful about it, which sides set its time step."""

from typing import Any

import numpy as np

from ..geometry import MOUNTAIN

LARGEST, SMALLEST = 100.0, 1e-3  # m; beyond them a unit has probably been forgotten
FEW = 10  # sides, or pairs of nodes, that may be said to set the time step
LONGER = 3.0  # times as long the step would be without them, at least


def described(sheet: Any, sail: Any) -> str:
    """One line about a SheetMesh: size, triangles, creases, tips, hub, groups not used.

    `sail` is the same as a PatternSail, placed on the axis.
    """
    extent = np.ptp(sheet.nodes, axis=0)
    size = " x ".join(f"{x:.4g}" for x in extent[: 3 if extent[2] > 0 else 2])
    mountains = int(np.sum(sheet.crease_signs == MOUNTAIN))
    valleys = len(sheet.creases) - mountains
    unused = [name for name in sheet.others if name not in sail.used]
    return ", ".join(
        [
            f"{size} m",
            _counted(len(sheet.triangles), "triangle"),
            f"creases of {_counted(len(sheet.creases), 'side')} ({mountains} mountain, {valleys} "
            "valley)",
            f"tips at {_counted(len(sail.tips), 'node')}",
            f"a hub of {_counted(len(sail.hub), 'node')}" if len(sail.hub) else "no hub",
            *([f"groups not used: {', '.join(unused)}"] if unused else []),
        ]
    )


def _counted(number, thing):
    return f"{number} {thing}" + "s" * (number != 1)


def doubts(sheet: Any) -> list[str]:
    """Sentences about what is read by the letter, but probably not meant."""
    said = list(sheet.notes)
    if not len(sheet.creases):
        said.append(
            "the sheet has no creases: no edge has the letter M or V, and no group of curves the "
            "name mountain or valley"
        )
    width = np.max(np.ptp(sheet.nodes, axis=0))
    if not SMALLEST <= width <= LARGEST:
        said.append(f"the sail is {width:.4g} m wide: is the length of its unit right (--unit)?")
    return said


def slow_sides(
    nodes: np.ndarray,
    sides: np.ndarray,
    stiffnesses: np.ndarray,
    masses: np.ndarray,
    zeta: float = 0.0,
    time: float = 0.0,
) -> tuple[np.ndarray, float]:
    """The few sides without which the time step could be much longer.

    The step that a side allows is estimated from its ends, each moved alone: exact for a side much
    stiffer than all about it, and for a lattice of equal triangles. Of `nodes` (N, 3) [m] at rest,
    `sides` (E, 2), `stiffnesses` (E,) [N/m], `masses` (N,) [kg] and a damping ratio `zeta` [-]
    or a damping `time` [s] in its place.

    Gives rows (n,) of `sides`, the worst first, at most FEW, or none if many sides are alike; and
    by which factor the step would be longer without these sides and their nodes.
    """
    along = nodes[sides[:, 1]] - nodes[sides[:, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)

    def largest(strengths):
        """Of the eigenvalues (E,) of springs or dashpots of some strengths (E,) over the masses."""
        blocks = np.empty((len(nodes), 3, 3))
        for i, j in np.ndindex(3, 3):
            shares = np.tile(strengths * along[:, i] * along[:, j], 2)
            blocks[:, i, j] = np.bincount(sides.T.ravel(), shares, len(nodes))
        return np.linalg.eigvalsh(blocks / masses[:, None, None])[:, -1][sides].sum(axis=1)

    square = largest(stiffnesses)
    dampers = 2 * zeta * np.sqrt(stiffnesses * masses[sides].mean(axis=1))
    rate = largest(time * stiffnesses if time else dampers)
    step = 2 / (rate + np.sqrt(rate**2 + square))  # at which square step^2 + 4 rate step = 4
    rows: list = []
    taken = np.zeros(len(nodes), dtype=bool)
    for row in np.argsort(step):
        if np.any(taken[sides[row]]):
            continue
        longer = step[row] / step[rows[0]] if rows else 1.0
        if longer >= LONGER:
            return np.array(rows), float(longer)
        if len(rows) == FEW:
            break
        rows.append(row)
        taken[sides[row]] = True
    return np.empty(0, dtype=int), 1.0


def about_slow_sides(nodes: np.ndarray, sides: np.ndarray, *springs: Any) -> list[str]:
    """A sentence about the `slow_sides`, in a list; no sentence if there are none."""
    rows, longer = slow_sides(nodes, sides, *springs)
    if not len(rows):
        return []
    a, b = nodes[sides[rows[0]]]
    seen = slice(3 if np.ptp(nodes[:, 2]) > 0 else 2)
    ends = " to ".join(f"({', '.join(f'{x:.4g}' for x in end[seen])})" for end in (a, b))
    worst = f"the side from {ends} m, {np.linalg.norm(b - a):.2g} m long,"
    if len(rows) > 1:
        worst += f" and {len(rows) - 1} more"
    sets, it = ("sets", "it") if len(rows) == 1 else ("set", "them")
    return [f"{worst} {sets} the time step: without {it} it could be {longer:.2g} times as long"]
