# SPDX-License-Identifier: GPL-2.0-or-later
"""What programs write otherwise than others do in crease patterns, brought into one form.

Vertices on one another, edges given twice, faces that run clockwise, planes other than z = 0. What
changes more than the way of writing is told in the pattern's notes.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from ..geometry import nearness, twins
from .orientation import faces_to_turn, laid_down, plane_normal


def without_twins(pattern: Any) -> Any:
    """The pattern with vertices taken as one that lie on one another, and a note about them.

    Where the file gives faces they say what hangs together: twins stay two, as beside a slit.
    """
    used = np.unique(pattern.edges)
    pairs = used[twins(pattern.vertices[used], nearness(pattern.vertices))]
    if not len(pairs):
        return pattern
    a, b = pairs[0]
    apart = np.linalg.norm(pattern.vertices[b] - pattern.vertices[a])
    more = f", and so {len(pairs) - 1} more pairs" if len(pairs) > 1 else ""
    note = f"vertices {a} and {b} lie {apart:.2g} m apart{more}: "
    if pattern.faces:
        return replace(pattern, notes=(*pattern.notes, note + "they stay two, as the faces say"))
    same = np.arange(len(pattern.vertices))
    for a, b in pairs:
        same[b] = same[a]
    edges = same[pattern.edges]
    kept = edges[:, 0] != edges[:, 1]
    notes = (*pattern.notes, note + "they are taken as one")
    return _of_edges(replace(pattern, edges=edges, notes=notes), kept)


def _of_edges(pattern, kept):
    """The pattern with some of its edges only, (n,) int or (E,) bool."""
    angles = None if pattern.angles is None else pattern.angles[kept]
    return replace(pattern, edges=pattern.edges[kept], letters=pattern.letters[kept], angles=angles)


def without_repeats(pattern: Any) -> Any:
    """The pattern with each edge once; refused if its letters or angles differ."""
    number: dict = {}
    kept: list = []
    for e, ends in enumerate(map(frozenset, pattern.edges.tolist())):
        first = number.setdefault(ends, e)
        if first == e:
            kept.append(e)
        elif pattern.letters[e] != pattern.letters[first]:
            raise ValueError(
                f"edges {first} and {e} join the same vertices, one as {pattern.letters[first]}, "
                f"the other as {pattern.letters[e]}"
            )
        elif pattern.angles is not None and pattern.angles[e] != pattern.angles[first]:
            raise ValueError(
                f"edges {first} and {e} join the same vertices, bent by "
                f"{plain(pattern.angles[first])} and by {plain(pattern.angles[e])} degrees"
            )
    return pattern if len(kept) == len(pattern.edges) else _of_edges(pattern, kept)


def one_way_round(pattern: Any) -> Any:
    """The pattern with all its faces run the same way round, and a note if they did not."""
    turned = faces_to_turn(pattern.faces)
    if not np.any(turned):
        return pattern
    pairs = zip(pattern.faces, turned)
    note = f"{turned.sum()} of {len(turned)} faces run the other way round: they are turned"
    return replace(
        pattern,
        faces=tuple(face[::-1] if turn else face for face, turn in pairs),
        notes=(*pattern.notes, note),
    )


def seen_from_above(pattern: Any) -> Any:
    """Vertices (V, 3) [m] of a flat pattern, turned into z = 0 with its upper side up.

    That is the side from which the faces run counter-clockwise: it is what mountain and valley
    are seen from. Without faces a pattern in z = const is seen from +z.
    """
    normal: Any = plane_normal(pattern.vertices)
    if sum(area_vector(pattern.vertices[face]) @ normal for face in pattern.faces) < 0:
        normal = -normal
    return laid_down(pattern.vertices, normal)


def area_vector(loop: np.ndarray) -> np.ndarray:
    """Area [m2] times normal (3,) of a polygon (n, 3), as flat as may be (Newell's method)."""
    return 0.5 * np.cross(loop, np.roll(loop, -1, axis=0)).sum(axis=0)


def plain(angle: Any) -> Any:
    """An angle [deg] for a message, never -0."""
    return f"{round(angle, 2) + 0.0:g}"
