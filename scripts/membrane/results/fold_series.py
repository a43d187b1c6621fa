# SPDX-License-Identifier: GPL-2.0-or-later
"""A sheet and its shapes over time as a FOLD file of several frames."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry import crease_angles, side_rows
from ..mesh.fold_format import FoldFile, FoldFrame, fold_angles, write_fold


def write_series(
    path: str | Path, sail: Any, times: Sequence, shapes: Sequence, custom: dict
) -> None:
    """Write a PatternSail and its shapes; all other sides inside the film are J, its edge B.

    The sail is the key frame; `shapes` (F, N, 3) [m] at `times` (F,) [s] follow. `custom` is what
    all frames tell under keys of the namespace `membrane:`.
    """
    sides, letters = sail.lines
    flat = np.ptp(sail.nodes[:, 2]) == 0
    kinds = ["crease" if letter in "MV" else "film" for letter in letters]
    key_frame = FoldFrame(
        coords=sail.nodes,
        edges=sides,
        letters=letters,
        faces=tuple(sail.triangles),
        unit="m",
        classes=("creasePattern",),
        attributes=("2D" if flat else "3D", "joins"),
        title="flat",
        custom={**custom, "edges_membrane:kind": kinds, "membrane:hub": sail.hub.tolist()},
    )
    frames = [key_frame, *(_frame(sail, key_frame, *shape) for shape in zip(times, shapes))]
    texts = {"file_creator": "membrane"}
    write_fold(path, FoldFile(tuple(frames), texts, ("singleModel", "animation")))


def _frame(sail, key_frame, now, x):
    """The FoldFrame of a shape `x` (N, 3) [m]; it shares with the key frame what is the same."""
    sides, letters = key_frame.edges, key_frame.letters
    rows, angles = side_rows(sides, sail.creases), np.zeros(len(sides))
    bent = crease_angles(x, sail.triangles, sail.creases, sail.crease_signs)
    angles[rows] = turned = fold_angles(bent, sail.crease_signs)
    # Faces that have passed through each other are bent the other way than the pattern says.
    changed = letters.copy()
    changed[rows] = np.where(turned == 0, letters[rows], np.where(turned < 0, "M", "V"))
    return FoldFrame(
        coords=x,
        edges=sides,
        letters=letters if np.array_equal(changed, letters) else changed,
        angles=angles,
        faces=key_frame.faces,
        unit="m",
        classes=("foldedForm",),
        attributes=("3D", "joins"),
        title=f"t = {now:.6g} s",
        custom={**key_frame.custom, "membrane:time": now},
    )
