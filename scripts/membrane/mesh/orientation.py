# SPDX-License-Identifier: GPL-2.0-or-later
"""Which way up a sheet lies: the plane of its points, and faces that run the same way round."""

from collections import defaultdict, deque
from typing import Any

import numpy as np

FLAT = 1e-6  # of the extent: what points may be off their plane


def plane_normal(points: np.ndarray) -> np.ndarray | None:
    """Unit normal (3,) of the plane in which `points` (n, 3) lie, or None if there is none.

    Its largest component is positive; it is (0, 0, 1) to the last digit where that will do.
    """
    size = np.max(np.ptp(points, axis=0))
    if np.ptp(points[:, 2]) <= FLAT * size:
        return np.array([0.0, 0.0, 1.0])
    away = points - points.mean(axis=0)
    normal = np.linalg.svd(away.T @ away)[0][:, 2]
    normal *= np.sign(normal[np.argmax(np.abs(normal))])
    return normal if np.ptp(away @ normal) <= FLAT * size else None


def laid_down(points: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """`points` (n, 3) of a plane, turned so that its unit `normal` becomes +z, at z = 0.

    By the least turn; the sheet is turned over about x where it is from -z.
    """
    x, y, z = normal
    if z < -0.5:  # by way of +z, since from -z no turn is the least
        return laid_down(points * [1, -1, -1], normal * [1, -1, -1])
    cross = np.array([[0, 0, -x], [0, 0, -y], [x, y, 0]])
    turned = points @ (np.eye(3) + cross + cross @ cross / (1 + z)).T
    return turned * [1, 1, 0] + 0.0  # never -0


def faces_to_turn(faces: Any) -> np.ndarray:
    """Which faces (F,) bool run the other way round than most of those they hang together with.

    `faces` are loops (n,) of vertices. ValueError if there is no way round for all of them: the
    surface has one side only.
    """
    along = defaultdict(list)
    for f, loop in enumerate(faces):
        ends = np.asarray(loop).tolist()
        for a, b in zip(ends, ends[1:] + ends[:1]):
            along[min(a, b), max(a, b)].append((f, a < b))
    beside = defaultdict(list)
    for pair in along.values():
        if len(pair) == 2:
            (one, ahead), (other, back) = pair
            beside[one].append((other, ahead == back))
            beside[other].append((one, ahead == back))
    turned: list = [None] * len(faces)
    for first in range(len(faces)):
        if turned[first] is not None:
            continue
        turned[first], piece, queue = False, [first], deque([first])
        while queue:
            face = queue.popleft()
            for other, opposed in beside[face]:
                if turned[other] is None:
                    turned[other] = turned[face] != opposed
                    piece.append(other)
                    queue.append(other)
                elif turned[other] != (turned[face] != opposed):
                    raise ValueError(
                        f"faces {face} and {other} cannot be made to run the same way round: the "
                        "surface has one side only, as a Moebius strip has, and a sheet has two"
                    )
        if 2 * sum(turned[face] for face in piece) > len(piece):
            for face in piece:
                turned[face] = not turned[face]
    return np.array(turned, dtype=bool)
