# SPDX-License-Identifier: GPL-2.0-or-later
"""A heliogyro: long blades, pleated along their length, that the spin pulls out of a hub.

Blade k points away from the axis at an angle of 2 pi k / blades, flat in the spin plane. It is
pleated like an accordion: its fold lines lie across it, mountains and valleys in turn, and the
pleats stand on edge, so that it is as long as their projection. Its root turns with the hub.
"""

from dataclasses import dataclass
from math import cos, pi, radians, sin

import numpy as np

from ...measures import SHEET, SHEET_OUTCOMES
from ...mesh import sheet_mesh
from ...mesh.pattern_mesh import SheetMesh
from ...parameters import ASSUMED, RUN, RunParameters, changed, parameter, with_defaults
from ..kind import FinishedSail, Kind, Sail
from .sheet import draw_sheet, while_it_opens


@dataclass(frozen=True)
class Blades:
    """The blades and their pleats."""

    blades: int = parameter(2, "-", ASSUMED, "blades", least=1, most=100)
    pleats: int = parameter(8, "-", ASSUMED, "pleats of a blade", least=1, most=1000)
    pleat: float = parameter(0.05, "m", ASSUMED, "length of a pleat along the blade", above=True)
    chord: float = parameter(
        0.1, "m", ASSUMED, "width of a blade, rounded to whole cells", above=True
    )
    root: float = parameter(0.05, "m", ASSUMED, "distance of the roots from the axis", above=True)
    slope: float = parameter(
        80.0, "deg", ASSUMED, "angle of the pleats out of the spin plane at the start", most=89.9
    )
    tip_mass: float = parameter(1e-3, "kg", ASSUMED, "mass at the end of each blade")
    refine: int = parameter(2, "-", RUN, "cells of a pleat along the blade", least=1, most=100)


@dataclass(frozen=True)
@with_defaults(
    omega=changed(6 * pi, source=ASSUMED, text="spin rate of the hub"),
    beta=3.0,
    alpha_crease=100.0,
    crease_law="conservative",
    air_density=0.0,
    gravity=0.0,
)
class HeliogyroParameters(RunParameters, Blades, sail="heliogyro"):
    """Film and creases are the paper's; in space."""


def blade(
    p: HeliogyroParameters,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """One blade along +x: nodes (N, 3) [m], its start (N, 3) [m], triangles and fold lines.

    Rows of nodes run along the blade; every `refine` columns there is a fold line.
    """
    cell, columns = p.pleat / p.refine, p.pleats * p.refine + 1
    rows = max(2, round(p.chord / cell) + 1)
    nodes, triangles = sheet_mesh(rows, columns, cell)
    nodes += [p.root, -0.5 * cell * (rows - 1), 0.0]
    along = np.arange(columns)
    within = np.abs((along + p.refine) % (2 * p.refine) - p.refine)  # zigzag, from 0
    start, tilt = nodes.copy(), radians(p.slope)
    start[:, 0] = p.root + np.tile(cos(tilt) * cell * along, rows)
    start[:, 2] = np.tile(sin(tilt) * cell * within, rows)
    folds = along[p.refine : -1 : p.refine]
    sides = [(r * columns + c, (r + 1) * columns + c) for c in folds for r in range(rows - 1)]
    signs = np.repeat(np.where(np.arange(len(folds)) % 2 == 0, 1, -1), rows - 1)
    return nodes, start, triangles, np.array(sides, dtype=int).reshape(-1, 2), signs


class Heliogyro(Kind[HeliogyroParameters]):
    """See the module."""

    title = "a heliogyro, whose pleated blades the spin pulls out"
    parameters = HeliogyroParameters
    measures = SHEET
    outcomes = SHEET_OUTCOMES
    told = "projected_area"

    def sail(self, p: HeliogyroParameters) -> Sail:
        """The blades about the axis; the masses are in the middle of their ends."""
        nodes, start, triangles, creases, signs = blade(p)
        size, columns = len(nodes), p.pleats * p.refine + 1
        angles = 2 * pi * np.arange(p.blades) / p.blades
        turns = [np.array([[cos(a), -sin(a), 0], [sin(a), cos(a), 0], [0, 0, 1]]) for a in angles]
        first = size * np.arange(p.blades)
        end = (size // columns // 2) * columns + columns - 1
        mesh = SheetMesh(
            nodes=np.concatenate([nodes @ turn.T for turn in turns]),
            triangles=np.concatenate([triangles + n for n in first]),
            creases=np.concatenate([creases + n for n in first]),
            crease_signs=np.tile(signs, p.blades),
            groups={"tips": first + end},
        )
        roots = np.concatenate([np.arange(0, size, columns) + n for n in first])
        starts = np.concatenate([start @ turn.T for turn in turns])
        return Sail(mesh, starts, mesh.groups["tips"], p.tip_mass, hub=roots)

    def draw(self, run: FinishedSail) -> None:
        """history.png and shapes.png."""
        draw_sheet(run, while_it_opens(run))


KIND = Heliogyro()
