# SPDX-License-Identifier: GPL-2.0-or-later
"""The Miura-ori: a sheet of parallelograms that folds with one degree of freedom.

All its vertices have closed forms, flat and folded: M. Schenk and S. D. Guest, Geometry of
Miura-folded metamaterials, PNAS 110 (2013) 3276, equations (1) to (4).
"""

from numbers import Integral

import numpy as np

from .fold_format import FoldFile, FoldFrame
from .patterns import CreasePattern, face_pairs, fold_angles_of


def miura(
    columns: int = 6,
    rows: int = 6,
    along: float = 0.075,
    across: float = 0.0776,
    angle: float = 75.0,
    fold: float = 85.0,
) -> FoldFile:
    """FOLD frames of a Miura-ori sheet: the crease pattern and one folded form.

    In metres, both frames centred at the origin. ValueError names a parameter that is out of range.

    Parameters
    ----------
    columns, rows : int
        Parallelograms along x and along y, >= 2 each, an even number of columns.
    along, across : float
        Sides of the parallelograms [m], > 0: those along y in the flat sheet, and those of the
        zig-zag lines that run along x.
    angle, fold : float
        Acute angle of the parallelograms, and angle by which the faces of the folded form are
        inclined [deg], above 0 and below 90.
    """
    _check(columns, rows, along, across, angle, fold)
    flat = vertices(columns, rows, along, across, angle, 0.0)
    folded = vertices(columns, rows, along, across, angle, fold)
    edges, border, faces = _grid(columns, rows)
    pattern = CreasePattern(
        flat, edges, np.where(border, "B", "U"), None, faces, ((),) * len(faces)
    )
    angles = np.where(border, 0.0, fold_angles_of(pattern, folded, face_pairs(pattern)))
    letters = np.where(border, "B", np.where(angles < 0, "M", "V"))
    shared = {"edges": edges, "letters": letters, "faces": faces, "unit": "m"}
    return FoldFile(
        frames=(
            FoldFrame(
                coords=flat,
                classes=("creasePattern",),
                attributes=("2D", "convexFaces"),
                title="Miura-ori",
                **shared,
            ),
            FoldFrame(
                coords=folded,
                angles=angles,
                classes=("foldedForm",),
                attributes=("3D", "convexFaces"),
                title=f"faces inclined by {fold:g} degrees",
                **shared,
            ),
        ),
        texts={"file_creator": "membrane", "file_title": "A Miura-ori sheet"},
        classes=("singleModel",),
    )


def vertices(
    columns: int, rows: int, along: float, across: float, angle: float, fold: float
) -> np.ndarray:
    """Vertices ((columns + 1) (rows + 1), 3) [m], row by row, centred at the origin.

    Parameters as in `miura`; `fold` = 0 is the flat sheet.
    """
    gamma, theta = np.radians([angle, fold])
    flatness = np.cos(theta) * np.tan(gamma)
    height = along * np.sin(theta) * np.sin(gamma)
    width = across * flatness / np.hypot(1, flatness)
    length = along * np.sqrt(1 - (np.sin(theta) * np.sin(gamma)) ** 2)
    shift = across / np.hypot(1, flatness)
    j, i = np.indices((rows + 1, columns + 1))
    x, y, z = width * i, length * j + shift * (i % 2), height * (j % 2)
    places = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    return places - (places.max(axis=0) + places.min(axis=0)) / 2


def _check(columns, rows, along, across, angle, fold):
    """Raise ValueError naming the first bad parameter, its value and its range."""
    for name, value, step in (("columns", columns, 2), ("rows", rows, 1)):
        if not isinstance(value, Integral) or value < 2 or value % step:
            even = "an even" if step == 2 else "a whole"
            raise ValueError(f"{name} = {value}: must be {even} number >= 2")
    for name, value in {"along": along, "across": across}.items():
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value} m: must be finite and > 0")
    for name, value in {"angle": angle, "fold": fold}.items():
        if not 0 < value < 90:
            raise ValueError(f"{name} = {value} degrees: must be > 0 and < 90")


def _grid(columns, rows):
    """Edges (E, 2), whether each is on the border (E,), and faces of a grid of quadrangles."""
    ids = np.arange((columns + 1) * (rows + 1)).reshape(rows + 1, columns + 1)
    right = np.stack([ids[:, :-1], ids[:, 1:]], axis=-1).reshape(-1, 2)
    up = np.stack([ids[:-1], ids[1:]], axis=-1).reshape(-1, 2)
    edge_row, edge_column = np.divmod(right[:, 0], columns + 1)[0], up[:, 0] % (columns + 1)
    border = np.concatenate(
        [(edge_row == 0) | (edge_row == rows), (edge_column == 0) | (edge_column == columns)]
    )
    corners = [ids[:-1, :-1], ids[:-1, 1:], ids[1:, 1:], ids[1:, :-1]]
    faces = np.stack(corners, axis=-1).reshape(-1, 4)
    return np.concatenate([right, up]), border, tuple(faces)
