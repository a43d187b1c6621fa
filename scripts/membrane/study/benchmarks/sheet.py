# SPDX-License-Identifier: GPL-2.0-or-later
"""The square sheet that is measured in all sizes: squares cut by a diagonal, slightly perturbed."""

from dataclasses import dataclass

import numpy as np
from membrane.geometry import MOUNTAIN, VALLEY, unique_sides
from membrane.mesh import sheet_mesh

SPACING = 0.02  # [m]
PERTURBATION = 1e-3  # of the spacing, standard deviation of each coordinate
ROWS_A_FOLD = 4  # every fourth row of sides is a fold line
SIDES = (32, 100, 316, 1000)  # nodes along an edge: 1,024 to a million in all


@dataclass(frozen=True)
class Sheet:
    """A sheet of N nodes."""

    nodes: np.ndarray  #: (N, 3), rest positions [m]
    places: np.ndarray  #: (N, 3), where the nodes are [m]
    triangles: np.ndarray  #: (T, 3) nodes
    creases: np.ndarray  #: (C, 2) nodes
    crease_signs: np.ndarray  #: (C,)

    def sides(self) -> np.ndarray:
        """Node ids (E, 2) of all sides, the smaller first, in lexical order."""
        return unique_sides(self.triangles)[0]


def square_sheet(side: int) -> Sheet:
    """A Sheet of `side` times `side` nodes."""
    nodes, triangles = sheet_mesh(side, side, SPACING)
    noise = np.random.default_rng(side).normal(scale=PERTURBATION * SPACING, size=nodes.shape)
    ids = np.arange(side * side).reshape(side, side)
    lines = ids[ROWS_A_FOLD:-1:ROWS_A_FOLD]
    creases = np.stack([lines[:, :-1], lines[:, 1:]], axis=-1).reshape(-1, 2)
    signs = np.where(np.arange(len(lines)) % 2, VALLEY, MOUNTAIN).repeat(side - 1)
    return Sheet(nodes, nodes + noise, triangles, creases, signs)
