# SPDX-License-Identifier: GPL-2.0-or-later
"""The mesh of the square sail of section 3.1: petals, fold lines, seams, tethers; plain sheets.

Frame: spin axis +z through the origin, the flat sail in the plane z = 0. Petal 0 points along
+x, 1 along +y, 2 along -x, 3 along -y; its arc length s runs counter-clockwise, 0 at the petal's
middle. Rows of nodes run parallel to the petal's outer edge; row 0 is the inner edge. Between
neighbouring petals lies the diagonal seam, whose nodes both share.
"""

from dataclasses import dataclass
from math import sqrt
from numbers import Integral
from typing import Any

import numpy as np

from ..geometry import MOUNTAIN, VALLEY, side_rows, unique_sides

LINE_KINDS = {"film": 0, "crease": 1, "seam": 2, "tether": 3}


@dataclass(frozen=True, eq=False)
class SailMesh:
    """Flat sail with tethers. N nodes of which F in the film, K rows of nodes, n = `refine`.

    All arrays but `nodes` and the signs hold ids of nodes.
    """

    outer_width: float  #: of the square [m]
    inner_width: float  #: of its square hole [m]
    fold_lines: int  #: on each petal; there is one strip more
    refine: int  #: sub-strips in a strip, and cells in a base cell
    spool_radius: float  #: of the central spool [m]
    tether_segments: int  #: of each of the four tethers
    nodes: np.ndarray  #: (N, 3), flat rest positions [m]; first the film's, then the tethers'
    triangles: np.ndarray  #: (T, 3), counter-clockwise seen from +z
    sides: np.ndarray  #: (E, 2), all of the film, the smaller node first
    creases: np.ndarray  #: (C, 2), sides on the fold lines, counter-clockwise about the axis
    crease_signs: np.ndarray  #: (C,) +1 mountain: sticks out at +z when folded; -1 valley
    seam_sides: np.ndarray  #: (4 (K - 1), 2), on the diagonals, from the inside outwards
    cables: np.ndarray  #: (4 tether_segments, 2), from the spool to the corner
    anchors: np.ndarray  #: (4,), inner ends of the tethers, on the spool
    tether_nodes: np.ndarray  #: (4 tether_segments,), all not in the film, anchors included
    tips: np.ndarray  #: (4,), outer corners, at azimuth 45, 135, 225, 315 degrees
    inner_corners: np.ndarray  #: (4,), at the same azimuths
    outer_edge: np.ndarray  #: (4 M,), closed loop, counter-clockwise from 315 degrees, none twice
    outer_edge_middles: np.ndarray  #: (4, 2), nearest each outer edge's middle; one may be twice
    guide_nodes: np.ndarray  #: (4, G), at most half a base cell from each petal's middle, all rows
    rows: tuple  #: K arrays (4, cells + 1), by petal with s rising; both ends are on seams

    @property
    def strips(self) -> int:
        """Strips of a petal, `fold_lines` + 1 [-]."""
        return self.fold_lines + 1

    @property
    def strip_width(self) -> float:
        """Distance between neighbouring fold lines [m]."""
        return (self.outer_width - self.inner_width) / 2 / self.strips

    @property
    def film_size(self) -> int:
        """Number F of nodes in the film; they have the ids 0 ... F - 1."""
        return len(self.nodes) - len(self.tether_nodes)

    @property
    def tether_length(self) -> float:
        """Flat length of a tether, spool to inner corner [m]."""
        return self.inner_width / sqrt(2) - self.spool_radius

    def row_distance(self, row: int) -> float:
        """Distance [m] of a row from the axis; also half the row's length."""
        return self.inner_width / 2 + self.strip_width * row / self.refine

    def row_arc(self, row: int) -> Any:
        """Arc length s [m] of the nodes of a row, (cells + 1,), 0 at the petal's middle."""
        cells = self.rows[row].shape[1] - 1
        return self.row_distance(row) * np.arange(-cells, cells + 1, 2) / cells

    def lines(self) -> Any:
        """All sides and cables: (E + 4 tether_segments, 2) node ids and their LINE_KINDS."""
        kinds = np.zeros(len(self.sides), dtype=int)
        for name, chosen in (("crease", self.creases), ("seam", self.seam_sides)):
            kinds[side_rows(self.sides, chosen)] = LINE_KINDS[name]
        tethers = np.full(len(self.cables), LINE_KINDS["tether"])
        return np.concatenate([self.sides, self.cables]), np.concatenate([kinds, tethers])


def sail_mesh(
    outer_width: float = 0.455,
    inner_width: float = 0.103,
    fold_lines: int = 7,
    refine: int = 1,
    spool_radius: float = 0.025,
    tether_segments: int = 4,
) -> SailMesh:
    """SailMesh of the flat sail with its tethers.

    A base cell is about as long as a strip is wide; from one fold line to the next a row gains two
    cells, so that the cells keep their length. `refine` = n cuts strips and cells in n.

    Parameters
    ----------
    outer_width, inner_width : float
        Widths of the sail and of its square hole [m], 0 < inner_width < outer_width.
    fold_lines, refine : int
        Fold lines on each petal; sub-strips of a strip and sub-cells of a base cell; >= 1.
    spool_radius : float
        Of the spool [m], > 0, less than the diagonal radius of the inner corners.
    tether_segments : int
        Segments of each tether, >= 1.

    Raises
    ------
    ValueError
        Naming the parameter and its range, or if the hole is less than 2.5 strips wide.
    """
    _check(outer_width, inner_width, fold_lines, refine, spool_radius, tether_segments)
    strip = (outer_width - inner_width) / 2 / (fold_lines + 1)
    inner_cells = refine * round(inner_width / strip)
    cells = [inner_cells + 2 * row for row in range((fold_lines + 1) * refine + 1)]
    rows = _number_rows(cells)
    film = _film_nodes(rows, inner_width / 2, outer_width / 2)
    triangles = np.concatenate(
        [_strip_triangles(rows[k], rows[k + 1], k % 2 == 0) for k in range(len(rows) - 1)]
    )
    creases, signs = _creases(rows, refine)
    inner_corners = rows[0][:, -1]
    beads, cables = _tethers(film, inner_corners, spool_radius, tether_segments)
    mesh = SailMesh(
        outer_width=float(outer_width),
        inner_width=float(inner_width),
        fold_lines=int(fold_lines),
        refine=int(refine),
        spool_radius=float(spool_radius),
        tether_segments=int(tether_segments),
        nodes=np.concatenate([film, beads]),
        triangles=triangles,
        sides=unique_sides(triangles)[0],
        creases=creases,
        crease_signs=signs,
        seam_sides=_seam_sides(rows),
        cables=cables,
        anchors=cables[::tether_segments, 0].copy(),
        tether_nodes=np.arange(len(film), len(film) + len(beads)),
        tips=rows[-1][:, -1].copy(),
        inner_corners=inner_corners.copy(),
        outer_edge=rows[-1][:, :-1].ravel(),
        outer_edge_middles=rows[-1][:, [cells[-1] // 2, (cells[-1] + 1) // 2]],
        guide_nodes=np.concatenate([_middle_nodes(row, refine) for row in rows], axis=1),
        rows=tuple(rows),
    )
    _lock(mesh)
    return mesh


def mesh_of(p: Any) -> SailMesh:
    """The SailMesh that the SailParameters `p` describe."""
    return sail_mesh(
        p.outer_width, p.inner_width, p.fold_lines, p.refine, p.spool_radius, p.tether_segments
    )


def sheet_mesh(rows: int, columns: int, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Mesh of a flat rectangular sheet of squares, each cut in two along the same diagonal.

    Of `rows` along y and `columns` along x, >= 2 nodes each, and squares of side `spacing` [m], >
    0. Gives nodes (rows columns, 3) [m] row by row, from the origin along +x and then +y, in the
    plane z = 0, and triangles (2 (rows - 1) (columns - 1), 3), counter-clockwise seen from +z,
    square by square in the order of the nodes. ValueError names a parameter that is out of range.
    """
    counts: dict = {"rows": rows, "columns": columns}
    for name, value in counts.items():
        if not isinstance(value, Integral) or value < 2:
            raise ValueError(f"{name} = {value}: must be a whole number >= 2")
    if not (np.isfinite(spacing) and spacing > 0):
        raise ValueError(f"spacing = {spacing} m: must be finite and > 0")
    y, x = np.indices((rows, columns))
    nodes = spacing * np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    ids = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = ids[:-1, :-1], ids[:-1, 1:], ids[1:, 1:], ids[1:, :-1]
    return nodes, np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def tip_masses(mesh: Any, mass: float) -> np.ndarray:
    """Masses (N,) [kg] of the nodes of a mesh: `mass` at each of its tips, 0 elsewhere."""
    masses = np.zeros(len(mesh.nodes))
    masses[mesh.tips] = mass
    return masses


def _check(outer_width, inner_width, fold_lines, refine, spool_radius, tether_segments):
    """Raise ValueError naming the first bad parameter, its value and its range."""
    counts = {"fold_lines": fold_lines, "refine": refine, "tether_segments": tether_segments}
    for name, value in counts.items():
        if not isinstance(value, Integral) or value < 1:
            raise ValueError(f"{name} = {value}: must be a whole number >= 1")
    widths = {"outer_width": outer_width, "inner_width": inner_width, "spool_radius": spool_radius}
    for name, value in widths.items():
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value} m: must be finite and > 0")
    if inner_width >= outer_width:
        raise ValueError(f"inner_width = {inner_width} m: must be < outer_width = {outer_width} m")
    if spool_radius >= inner_width / sqrt(2):
        raise ValueError(
            f"spool_radius = {spool_radius} m: must be < {inner_width / sqrt(2):.6g} m, "
            "the radius of the inner corners"
        )
    strip = (outer_width - inner_width) / 2 / (fold_lines + 1)
    if inner_width < 2.5 * strip:
        raise ValueError(
            f"inner_width = {inner_width} m: must be >= {2.5 * strip:.6g} m, 2.5 strip widths"
        )


def _number_rows(cells):
    """Node ids of every row, (4, cells + 1) each; the last of a petal is the first of the next."""
    rows, first = [], 0
    for count in cells:
        ids = first + np.arange(4 * count).reshape(4, count)
        rows.append(np.column_stack([ids, np.roll(ids[:, 0], -1)]))
        first += 4 * count
    return rows


def _film_nodes(rows, inner, outer):
    """Flat positions (F, 3) [m] of the film's nodes; petals are exact quarter turns of petal 0."""
    blocks: list = []
    for k, row in enumerate(rows):
        cells = row.shape[1] - 1
        distance = inner + (outer - inner) * k / (len(rows) - 1)
        arc = distance * np.arange(-cells, cells, 2) / cells
        petal = np.column_stack([np.full(cells, distance), arc, np.zeros(cells)])
        blocks.extend(quarter_turn(petal, p) for p in range(4))
    return np.concatenate(blocks)


def quarter_turn(points: np.ndarray, turns: int) -> np.ndarray:
    """Points (..., 3) turned by `turns` right angles about +z, without rounding."""
    x, y, z = np.moveaxis(points, -1, 0)
    for _ in range(turns % 4):
        x, y = -y, x
    return np.stack([x, y, z], axis=-1)


def _strip_triangles(lower, upper, lean_left):
    """Triangles of the four trapezoids between two rows of m and m + 2 cells, (4 (2 m + 2), 3).

    Squares are cut parallel to the nearer seam: one pattern, mirrored about the petal's middle,
    with six sides at almost every inner node. The square in the middle of an odd row has no
    mirror image and is cut to either side, as `lean_left` says.
    """
    cells = lower.shape[1] - 1
    left = np.arange(cells) < (cells + lean_left) // 2
    a, b = lower[:, :-1], lower[:, 1:]
    c, d = upper[:, 1:-2], upper[:, 2:-1]
    parts = [
        np.stack([lower[:, :1], upper[:, :1], upper[:, 1:2]], axis=-1),
        np.stack([a, np.where(left, c, d), b], axis=-1),
        np.stack([np.where(left, b, a), c, d], axis=-1),
        np.stack([lower[:, -1:], upper[:, -2:-1], upper[:, -1:]], axis=-1),
    ]
    return np.concatenate(parts, axis=1).reshape(-1, 3)


def _creases(rows, refine):
    """Sides on the fold lines (C, 2) and their signs (C,): odd lines mountain, even ones valley."""
    sides, signs = [], []
    for line, row in enumerate(rows[refine:-1:refine], start=1):
        pairs = np.stack([row[:, :-1], row[:, 1:]], axis=-1).reshape(-1, 2)
        sides.append(pairs)
        signs.append(np.full(len(pairs), MOUNTAIN if line % 2 else VALLEY))
    return np.concatenate(sides), np.concatenate(signs)


def _seam_sides(rows):
    """Sides on the four diagonals (4 (K - 1), 2), seam by seam, from the inside outwards."""
    seams = np.stack([row[:, -1] for row in rows], axis=1)
    return np.stack([seams[:, :-1], seams[:, 1:]], axis=-1).reshape(-1, 2)


def _tethers(film, corners, spool_radius, segments):
    """New nodes (4 segments, 3) [m] and cables (4 segments, 2), each tether from the spool."""
    outward = film[corners] / np.linalg.norm(film[corners], axis=1, keepdims=True)
    start, end = spool_radius * outward, film[corners]
    shares = np.arange(segments) / segments
    beads = start[:, None] + shares[None, :, None] * (end - start)[:, None]
    ids = len(film) + np.arange(4 * segments).reshape(4, segments)
    chain = np.column_stack([ids, corners])
    return beads.reshape(-1, 3), np.stack([chain[:, :-1], chain[:, 1:]], axis=-1).reshape(-1, 2)


def _middle_nodes(row, refine):
    """Nodes (4, g) of a row at most half a base cell from the petal's middle."""
    cells = row.shape[1] - 1
    return row[:, np.abs(2 * np.arange(cells + 1) - cells) <= refine]


def _lock(mesh):
    """Make all arrays of a mesh read-only."""
    for value in vars(mesh).values():
        for array in value if isinstance(value, tuple) else (value,):
            if isinstance(array, np.ndarray):
                array.setflags(write=False)
