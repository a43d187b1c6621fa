# SPDX-License-Identifier: GPL-2.0-or-later
"""Plain geometry of triangulated surfaces: sides, lengths, areas, fold angles, crossings.

Works for any mesh. Nodes are rows of an (N, 3) array in metres; triangles are (T, 3) node ids,
counter-clockwise seen from the top side; sides and creases are (E, 2) node ids.
"""

from typing import Any

import numpy as np

MOUNTAIN = 1
VALLEY = -1
NEAR = 1e-6  # of a sheet's width: nodes that are nearer make the time step hopelessly short
EVEN = 1e-6  # rad: angles nearer to each other count as equal
MOST_CELLS = 100  # along each axis of the grid in which near pairs are sought
MOST_PAIRS = 500_000  # that are looked at together, for the sake of memory


def unique_sides(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sides of a triangulation (T, 3), each once.

    Returns the sides (E, 2), node ids in lexical order with the smaller first; their rows (T, 3)
    for the sides (0, 1), (1, 2), (2, 0) of each triangle; and the number of triangles at each,
    (E,): 1 on an edge, 2 inside.
    """
    triangles = np.asarray(triangles, dtype=int).reshape(-1, 3)
    size = 1 + triangles.max(initial=0)
    ahead = np.roll(triangles, -1, axis=1)
    keys = np.minimum(triangles, ahead) * size + np.maximum(triangles, ahead)
    keys, side_of, shares = np.unique(keys, return_inverse=True, return_counts=True)
    return np.column_stack(np.divmod(keys, size)), side_of.reshape(-1, 3), shares


def side_rows(sides: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Rows (n,) of `sides` (E, 2), the smaller node first, that join `pairs` (n, 2) of nodes.

    ValueError if a pair is not a side.
    """
    size = 1 + np.max(sides, initial=0)
    keys = sides[:, 0] * size + sides[:, 1]
    low, high = np.sort(pairs, axis=1).T
    order = np.argsort(keys)
    rows = order[np.searchsorted(keys, low * size + high, sorter=order).clip(max=len(keys) - 1)]
    wrong = np.any(sides[rows] != np.column_stack([low, high]), axis=1)
    if np.any(wrong):
        raise ValueError(f"nodes {tuple(pairs[wrong][0].tolist())} are not the ends of a side")
    return rows


def side_lengths(nodes: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Lengths (E,) [m] of `sides` (E, 2) between `nodes` (N, 3) [m]."""
    return np.linalg.norm(nodes[sides[:, 1]] - nodes[sides[:, 0]], axis=1)


def area_vectors(nodes: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Area [m2] times upper unit normal of `triangles` (T, 3) of `nodes` (N, 3) [m]: (T, 3).

    Seen from above the corners run counter-clockwise. Zero where a triangle has no area.
    """
    a, b, c = (nodes[triangles[:, i]] for i in range(3))
    return 0.5 * np.cross(b - a, c - a)


def triangle_areas(nodes: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Areas (T,) [m2] of `triangles` (T, 3) of `nodes` (N, 3) [m], never negative."""
    return np.linalg.norm(area_vectors(nodes, triangles), axis=1)


def triangle_angles(nodes: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Inner angles (T, 3) [rad] at the corners of `triangles` (T, 3) of `nodes` (N, 3) [m].

    0 or pi at corners of a triangle without area.
    """
    corners = nodes[triangles]
    ahead = np.roll(corners, -1, axis=1) - corners
    behind = np.roll(corners, 1, axis=1) - corners
    sine = np.linalg.norm(np.cross(ahead, behind), axis=2)
    return np.arctan2(sine, np.einsum("tij,tij->ti", ahead, behind))


def cut_quadrangles(nodes: np.ndarray, quadrangles: np.ndarray) -> np.ndarray:
    """Each quadrangle cut in two along the diagonal that leaves the smaller largest angle.

    Flat triangles would get a negative stiffness. Where both are as good, from the first corner.
    Makes of `quadrangles` (n, 4), whose corners run all round, of `nodes` (N, 3) [m] triangles (2
    n, 3) that run the same way round. ValueError if sides of a quadrangle cross.
    """
    ways = np.stack(
        [quadrangles[:, [[0, 1, 2], [0, 2, 3]]], quadrangles[:, [[1, 2, 3], [1, 3, 0]]]]
    )
    upward = area_vectors(nodes, ways.reshape(-1, 3)).reshape(*ways.shape)
    whole = upward[0].sum(axis=1)
    outside = np.any(np.einsum("wqti,qi->wqt", upward, whole) <= 0, axis=2)
    worst = triangle_angles(nodes, ways.reshape(-1, 3)).reshape(2, -1, 6).max(axis=2)
    worst[outside] = np.inf
    if np.any(np.all(outside, axis=0)):
        q = int(np.argmax(np.all(outside, axis=0)))
        middle = nodes[quadrangles[q]].mean(axis=0).tolist()
        raise ValueError(f"the sides of the quadrangle around {middle} m cross")
    best = np.where(worst[1] < worst[0] - EVEN, 1, 0)
    return ways[best, np.arange(len(best))].reshape(-1, 3)


def crease_corners(triangles: np.ndarray, creases: np.ndarray) -> Any:
    """The two triangles at each of `creases` (K, 2): nodes A, B, C, D (K, 4), A and B as given.

    Of `triangles` (T, 3), counter-clockwise seen from the top; so is ABC: C lies left of A -> B, D
    right of it. ValueError if a crease is not shared by exactly two triangles of equal orientation.
    """
    triangles = np.asarray(triangles, dtype=int)
    creases = np.asarray(creases, dtype=int).reshape(-1, 2)
    size = 1 + max(triangles.max(), creases.max(initial=0))
    keys = (triangles * size + np.roll(triangles, -1, axis=1)).ravel()
    opposite = np.roll(triangles, 1, axis=1).ravel()
    order = np.argsort(keys)

    def apex(start, end):
        wanted = start * size + end
        first = np.searchsorted(keys[order], wanted, side="left")
        found = np.searchsorted(keys[order], wanted, side="right") - first
        if np.any(found != 1):
            k = int(np.argmax(found != 1))
            raise ValueError(
                f"creases[{k}] = {tuple(creases[k])}: {found[k]} triangles run from node "
                f"{start[k]} to node {end[k]}; a crease needs one in each direction"
            )
        return opposite[order[first]]

    a, b = creases.T
    return np.column_stack([a, b, apex(a, b), apex(b, a)])


def crease_angles(
    nodes: np.ndarray, triangles: np.ndarray, creases: np.ndarray, signs: np.ndarray
) -> np.ndarray:
    """Angle between the two triangles at each crease, on the inside of the fold: (K,) float [rad].

    In (-pi/2, 3 pi/2]: 0 folded face to face, pi flat, negative where the two faces have passed
    through each other.

    Parameters
    ----------
    nodes : (N, 3) float
        Positions [m].
    triangles, creases : (T, 3) and (K, 2) int
        Corners, counter-clockwise seen from the top; nodes A, B of each crease in any order.
    signs : (K,) int
        MOUNTAIN (+1): the crease sticks out on the top side when folded. VALLEY (-1): below.

    Raises
    ------
    ValueError
        If a sign is neither +1 nor -1, or a crease is not a side of two triangles.
    """
    signs = np.asarray(signs)
    if not np.all(np.isin(signs, (MOUNTAIN, VALLEY))):
        raise ValueError("signs must be +1 (mountain) or -1 (valley)")
    a, b, c, d = (nodes[i] for i in crease_corners(triangles, creases).T)
    along = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)

    def away(apex):
        arm = apex - a
        return arm - along * np.sum(arm * along, axis=1, keepdims=True)

    left, right = away(c), away(d)
    sine = -signs * np.sum(along * np.cross(left, right), axis=1)
    angles = np.arctan2(sine, np.sum(left * right, axis=1))
    return np.where(angles <= -np.pi / 2, angles + 2 * np.pi, angles)


def nearness(points: np.ndarray) -> float:
    """Below which distance [m] `points` (N, 3) of a sheet count as one: NEAR of its width."""
    return NEAR * np.sort(np.ptp(points, axis=0))[1]


def twins(points: np.ndarray, near: float) -> np.ndarray:
    """Pairs (n, 2) of rows of `points` (N, 3) no farther than `near` apart [m], in order."""
    # Sorted along a direction in which few points of a grid lie side by side.
    order = np.argsort(points @ (0.534, 0.633, 0.561))
    places, found = points[order], [np.empty((0, 2), dtype=int)]
    along = places @ (0.534, 0.633, 0.561)
    for ahead in range(1, len(order)):
        close = np.flatnonzero(along[ahead:] - along[:-ahead] <= near)
        if not len(close):
            break
        apart = np.linalg.norm(places[close + ahead] - places[close], axis=1)
        close = close[apart <= near]
        found.append(np.column_stack([order[close], order[close + ahead]]))
    pairs = np.sort(np.concatenate(found), axis=1)
    return pairs[np.lexsort(pairs.T[::-1])]


def pieces(count: int, sides: np.ndarray) -> np.ndarray:
    """Number (N,) of the piece that each of `count` nodes belongs to, joined by `sides` (E, 2)."""
    root = np.arange(count)
    while len(sides):
        low, high = np.sort(root[sides], axis=1).T
        sides, low, high = (a[low != high] for a in (sides, low, high))
        np.minimum.at(root, high, low)
        while not np.array_equal(root, root[root]):
            root = root[root]
    return np.unique(root, return_inverse=True)[1]


def crossings(nodes: np.ndarray, sides: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Pairs (P, 2) of rows of `sides` and of `triangles` that cut each other.

    A pair with a common node is never counted, nor is one that only touches in its plane. `nodes`
    (N, 3) are positions [m], `sides` (E, 2) and `triangles` (T, 3) node ids.
    """
    found = [np.empty((0, 2), dtype=int)]
    if not (len(sides) and len(triangles)):
        return found[0]
    ends, corners = nodes[sides], nodes[triangles]
    for side, triangle in _near_pairs(ends, corners):
        apart = np.all(sides[side][:, :, None] != triangles[triangle][:, None], axis=(1, 2))
        side, triangle = side[apart], triangle[apart]
        hit = _pierces(ends[side, 0], ends[side, 1], corners[triangle])
        found.append(np.column_stack([side, triangle])[hit])
    pairs = np.concatenate(found)
    return pairs[np.lexsort(pairs.T[::-1])]


def _near_pairs(ones, others):
    """Yield, piece by piece, the pairs of point sets whose boxes touch, each pair once.

    `ones` (m, p, 3) and `others` (n, q, 3) are sets of points [m]; pairs are rows (k,) of either.
    """
    low, high = others.min(axis=1), others.max(axis=1)
    least, most = ones.min(axis=1), ones.max(axis=1)
    # Cells like the boxes: in a stack of thin layers they are flat, too.
    cell = np.maximum(2 * np.mean(high - low, axis=0), np.ptp(low, axis=0) / MOST_CELLS)
    corner, cell = low.min(axis=0), np.where(cell > 0, cell, 1.0)

    def cells(points):
        return np.clip((points - corner) // cell, -1, MOST_CELLS + 1).astype(int)

    def key(place):
        return np.ravel_multi_index(tuple(place.T + 1), (MOST_CELLS + 3,) * 3)

    def all_cells(first, last):
        """Rows and keys of all cells from `first` to `last` (n, 3)."""
        size = last - first + 1
        row, step = _counted(np.prod(size, axis=1))
        step, z = np.divmod(step, size[row, 2])
        x, y = np.divmod(step, size[row, 1])
        return row, key(first[row] + np.column_stack([x, y, z]))

    first, begin = cells(low), cells(least)
    other, at = all_cells(first, cells(high))
    order = np.argsort(at, kind="stable")
    other, at = other[order], at[order]
    one, wanted = all_cells(begin, cells(most))
    start, stop = np.searchsorted(at, wanted), np.searchsorted(at, wanted, side="right")
    shares = np.cumsum(stop - start) // MOST_PAIRS
    for piece in np.split(np.arange(len(one)), np.flatnonzero(np.diff(shares)) + 1):
        row, step = _counted(stop[piece] - start[piece])
        row = piece[row]
        a, b = one[row], other[start[row] + step]
        touch = np.all((least[a] <= high[b]) & (most[a] >= low[b]), axis=1)
        # Boxes that have several cells in common count in the first of them.
        touch &= key(np.maximum(begin[a], first[b])) == wanted[row]
        yield a[touch], b[touch]


def _counted(counts):
    """For each i, `counts[i]` times i, and beside it 0, 1, … up to `counts[i]` - 1."""
    row = np.repeat(np.arange(len(counts)), counts)
    return row, np.arange(len(row)) - (np.cumsum(counts) - counts)[row]


def _pierces(start, end, corners):
    """Whether the side start -> end passes through each of the triangles `corners` (T, 3, 3)."""

    def volume(p, q, r, s):
        return np.sum(np.cross(q - p, r - p) * (s - p), axis=-1)

    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    tiny = 1e-9 * np.max(np.ptp(corners, axis=1), axis=1, initial=0)
    tiny *= np.linalg.norm(np.cross(b - a, c - a), axis=1)
    below, above = volume(a, b, c, start), volume(a, b, c, end)
    split = (below * above < 0) & (np.minimum(abs(below), abs(above)) > tiny)
    turns = [volume(start, end, *pair) for pair in ((a, b), (b, c), (c, a))]
    same = (np.min(turns, axis=0) > 0) | (np.max(turns, axis=0) < 0)
    return split & same
