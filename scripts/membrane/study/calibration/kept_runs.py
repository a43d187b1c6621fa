# SPDX-License-Identifier: GPL-2.0-or-later
"""The runs of a calibration that is not finished, in a file from which the next call goes on."""

import json
import os
from pathlib import Path
from typing import Any
from threading import Lock

import numpy as np
from membrane.files import named, replace_text


class KeptRuns:
    """Curves by point, kept in a file: a line about all of them, then a line for each.

    The first run that is added makes the file, in the place of one of something else. A line that a
    kill has cut off is left out. `about` holds, as JSON can, all that the curves depend on beside
    the point.
    """

    def __init__(self, path: str | Path, about: Any) -> None:
        self.path, self.about, self._lock = path, about, Lock()
        self._curves = dict(_read(path, about))
        self._is_begun = False

    def __len__(self) -> int:
        return len(self._curves)

    def __contains__(self, point: Any) -> bool:
        return tuple(point) in self._curves

    def __getitem__(self, point: Any) -> np.ndarray | None:
        """Curves (C, S) of a point (d,), None where the run diverged."""
        return self._curves[tuple(point)]

    def add(self, point: Any, curves: Any) -> None:
        """Keep a run; also from several threads at once."""
        with self._lock:
            if not self._is_begun:
                self._begin()
            self._curves[tuple(point)] = curves
            with named(self.path), open(self.path, "a", encoding="utf-8") as file:
                file.write(_line([point, _plain(curves)]))

    def _begin(self):
        """Write the file with what is known: it may end in half a line, or be of something else."""
        lines = [self.about, *([point, _plain(curves)] for point, curves in self._curves.items())]
        replace_text(self.path, "".join(map(_line, lines)))
        self._is_begun = True


def refuse_another(path: str | Path) -> None:
    """Raise ValueError if there is something else than kept runs at a path: it would be lost."""
    if not os.path.lexists(path):
        return
    try:
        with open(path, encoding="utf-8") as file:
            about = json.loads(file.readline())
    except (OSError, ValueError):
        about = None
    if (
        Path(path).is_symlink()
        or not isinstance(about, dict)
        or not {"names", "times"} <= set(about)
    ):
        raise ValueError(
            f"{path} was not made by calibrate, and would be lost: move it away, or choose another "
            "folder"
        )


def _line(content):
    return f"{json.dumps(content)}\n"


def _plain(curves):
    return None if curves is None else np.asarray(curves).tolist()


def _read(path, about):
    """Points and curves of a file's whole lines, if it is about the same."""
    try:
        first, *lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        if json.loads(first) != json.loads(json.dumps(about)):
            return
    except (FileNotFoundError, ValueError):
        return
    shape = len(about["columns"]), len(about["times"])
    for line in lines:
        try:
            point, curves = json.loads(line)
            curves = None if curves is None else np.array(curves, dtype=float)
            point = tuple(map(float, point))
        except (TypeError, ValueError):
            return
        if len(point) != len(about["names"]) or (curves is not None and curves.shape != shape):
            return
        yield point, curves
