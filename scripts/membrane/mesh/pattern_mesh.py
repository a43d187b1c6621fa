# SPDX-License-Identifier: GPL-2.0-or-later
"""Meshes of crease patterns by gmsh: triangles whose sides run along every edge of the pattern."""

from collections import defaultdict
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..geometry import MOUNTAIN, VALLEY, area_vectors, crease_angles, side_rows, triangle_angles
from ..geometry import triangle_areas, unique_sides
from .gmsh_process import GmshError, in_gmsh
from .patterns import face_pairs

MOST_TRIANGLES = 2_000_000
MOST_SIDES = 200_000  # along the edges of a pattern; of slivers there are many
DEFAULT_TRIANGLES = 800  # about as many as the paper's sail has
GMSH_TRIANGLE = 2
BARELY = 0.05  # rad
FLATTEST = np.radians(115)  # of a triangle's angle; near 120 degrees (5) gives negative stiffness
SPLITS = 20  # rounds of splitting flat triangles, at most
SHORTEST = 0.05  # of the mesh's sides: what splitting may leave


@dataclass(frozen=True, eq=False)
class SheetMesh:
    """A triangulated sheet with creases, whatever it was made from. N nodes."""

    nodes: np.ndarray  #: (N, 3), rest positions [m]
    triangles: np.ndarray  #: (T, 3) nodes, counter-clockwise seen from the top
    creases: np.ndarray  #: (C, 2) nodes: sides on creases
    crease_signs: np.ndarray  #: (C,) +1 mountain, -1 valley
    start: np.ndarray | None = None  #: (N, 3), folded, to start from [m]; None: flat
    groups: dict = field(default_factory=dict)  #: nodes (n,) by name, as a file names them
    others: tuple = ()  #: names of those groups that make no creases
    notes: tuple = ()  #: sentences about what was changed or is doubtful

    @property
    def area(self) -> float:
        """Area at rest [m2]."""
        return float(triangle_areas(self.nodes, self.triangles).sum())

    @property
    def rim(self) -> np.ndarray:
        """Nodes on the edge of the sheet, also along cuts, (n,)."""
        sides, _, shares = unique_sides(self.triangles)
        return np.unique(sides[shares == 1])

    def lines(self) -> tuple[np.ndarray, np.ndarray]:
        """All sides (E, 2) and the FOLD letter of each (E,): B, M, V, or J inside the film."""
        sides, _, shares = unique_sides(self.triangles)
        letters = np.where(shares == 1, "B", "J")
        letters[side_rows(sides, self.creases)] = np.where(self.crease_signs == MOUNTAIN, "M", "V")
        return sides, letters


def mesh_pattern(pattern: Any, size: float | None = None) -> SheetMesh:
    """SheetMesh of a CreasePattern, whose vertices that have film are its first nodes.

    Mountains and valleys become creases. Edges of other letters are sides of the mesh without
    crease, cuts are open: their nodes are there once for each side. An unassigned edge folds where
    its angle says so. `size`, > 0, is the length of the sides to aim at [m], by default for about
    800 triangles. ValueError if it is out of range, or gmsh cannot mesh the pattern.
    """
    size = default_size(pattern.area) if size is None else size
    if not (np.isfinite(size) and size > 0):
        raise ValueError(f"size = {size} m: must be finite and > 0")
    if pattern.area / size**2 > MOST_TRIANGLES / 2.3:
        raise ValueError(f"size = {size} m: would make more than {MOST_TRIANGLES} triangles")
    if pattern.edge_lengths.sum() / size > MOST_SIDES:
        raise ValueError(f"size = {size} m: would cut the edges into more than {MOST_SIDES} sides")
    found = _without_flat_triangles(_with_gmsh(pattern, size), SHORTEST * size)
    nodes = found.nodes
    start = None if pattern.folded is None else _carried_over(pattern, found)
    sides = {e: found.edge_sides(e) for e in range(len(pattern.edges))}
    creases, signs = _creases(pattern, sides)
    if start is not None:
        signs = _seen_from_the_right_side(start, found.triangles, creases, signs)
    cuts = [sides[e] for e in np.flatnonzero(pattern.letters == "C")]
    origin, triangles = split_along(found.triangles, np.concatenate(cuts or [_NO_SIDES]))
    creases = _renamed(found.triangles, triangles, creases)
    return SheetMesh(
        nodes=nodes[origin],
        triangles=triangles,
        creases=creases,
        crease_signs=signs,
        start=None if start is None else start[origin],
        notes=pattern.notes,
    )


def default_size(area: float) -> float:
    """Length of the sides [m] with which a sheet has about `DEFAULT_TRIANGLES` triangles."""
    return float(np.sqrt(4 / np.sqrt(3) * area / DEFAULT_TRIANGLES))


_NO_SIDES = np.empty((0, 2), dtype=int)


def _creases(pattern, sides):
    """Sides on mountains and valleys (C, 2) and their signs (C,)."""
    found, signs = [_NO_SIDES], [np.empty(0, dtype=int)]
    both = np.all(face_pairs(pattern) >= 0, axis=1)
    for e, letter in enumerate(pattern.letters):
        angle = 0.0 if pattern.angles is None else pattern.angles[e]
        if letter == "U" and angle != 0 and both[e]:
            letter = "M" if angle < 0 else "V"
        if letter in "MV":
            found.append(sides[e])
            signs.append(np.full(len(sides[e]), MOUNTAIN if letter == "M" else VALLEY))
    return np.concatenate(found), np.concatenate(signs)


def _seen_from_the_right_side(start, triangles, creases, signs):
    """The signs (C,), all turned over if the folded start says that they are meant from below."""
    angles = crease_angles(start, triangles, creases, signs)
    # Face to face, neither side is the wrong one; nor is it where the sheet is nearly flat.
    bent = (np.abs(angles) > BARELY) & (np.abs(angles - np.pi) > BARELY)
    right = bent & (angles > 0) & (angles < np.pi)
    return -signs if np.sum(bent & ~right) > np.sum(right) else signs


@dataclass
class _Raw:
    """What gmsh made: `nodes` (N, 3), `triangles` (T, 3), and which nodes lie where.

    `on_edge`: for each edge its nodes in order, from the first vertex to the second. `in_face`:
    for each face the nodes inside it. `face_of` (T,): the face of each triangle.
    """

    nodes: np.ndarray
    triangles: np.ndarray
    on_edge: dict
    in_face: dict
    vertex_node: dict
    face_of: np.ndarray

    def edge_sides(self, e):
        chain = self.on_edge.get(e, ())
        return np.column_stack([chain[:-1], chain[1:]]) if len(chain) else _NO_SIDES


def _with_gmsh(pattern, size):
    """The _Raw mesh of a pattern."""
    try:
        return in_gmsh(_by_gmsh, pattern, size)
    except GmshError as error:
        raise ValueError(f"gmsh cannot mesh the pattern: {error}") from None


def _by_gmsh(gmsh, pattern, size):
    """Let gmsh mesh every face so that the meshes meet along the edges."""
    for option, value in (
        ("Mesh.Algorithm", 6),  # frontal Delaunay: nearly equilateral triangles
        ("Mesh.MeshSizeExtendFromBoundary", 0),
        ("Mesh.MeshSizeMin", size),
        ("Mesh.MeshSizeMax", size),
    ):
        gmsh.option.setNumber(option, value)
    gmsh.model.add("pattern")
    _describe(gmsh, pattern, size)
    gmsh.model.mesh.generate(2)
    return _collect(gmsh, pattern)


def _describe(gmsh, pattern, size):
    """Tell gmsh vertices, edges and faces; their tags are their numbers plus 1."""
    geo = gmsh.model.geo
    pairs = face_pairs(pattern)
    used = np.flatnonzero(np.any(pairs >= 0, axis=1))
    for v in np.unique(pattern.edges[used]):
        geo.addPoint(*pattern.vertices[v], size, int(v) + 1)
    number = {}
    for e in used.tolist():
        a, b = pattern.edges[e].tolist()
        number[a, b], number[b, a] = e + 1, -(e + 1)
        geo.addLine(a + 1, b + 1, e + 1)
        length = np.linalg.norm(pattern.vertices[b] - pattern.vertices[a])
        geo.mesh.setTransfiniteCurve(e + 1, max(1, round(length / size)) + 1)
    embedded: dict = {}
    for face in range(len(pattern.faces)):
        sides: list = [tuple(side) for side in pattern.face_sides(face).tolist()]
        both = {side for side in sides if side[::-1] in sides}
        loops = _simple_loops(pattern, [side for side in sides if side not in both])
        wires = [geo.addCurveLoop([number[side] for side in loop]) for loop in loops]
        geo.addPlaneSurface(wires, face + 1)
        embedded[face] = sorted({abs(number[side]) for side in both})
    geo.synchronize()
    for face, lines in embedded.items():
        if lines:
            gmsh.model.mesh.embed(1, lines, 2, face + 1)


def _simple_loops(pattern, sides):
    """Loops of sides that pass no vertex twice, the outer one (of the largest area) first."""
    follow = defaultdict(list)
    for a, b in sides:
        follow[a].append(b)
    loops = []
    while follow:
        trail, place = [next(iter(follow))], {}
        place[trail[0]] = 0
        while True:
            a = trail[-1]
            b = follow[a].pop()
            if not follow[a]:
                del follow[a]
            if b in place:  # a loop is closed; what led to it goes on from there
                ring = trail[place[b] :]
                loops.append(list(zip(ring, ring[1:] + ring[:1])))
                trail = trail[: place[b] + 1]
                place = {v: i for i, v in enumerate(trail)}
                if b not in follow:
                    break
            else:
                place[b] = len(trail)
                trail.append(b)
    return sorted(loops, key=lambda loop: -_area(pattern, loop))


def _area(pattern, loop):
    a, b = pattern.vertices[np.array(loop).T, :2]
    return 0.5 * float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))


def _collect(gmsh, pattern):
    """Nodes and triangles from gmsh, numbered from 0, vertices of the pattern first."""
    mesh = gmsh.model.mesh
    index: dict = {}
    nodes: list = []

    def take(dimension, tag):
        tags, places, _ = mesh.getNodes(dimension, tag)
        for node, place in zip(tags.tolist(), places.reshape(-1, 3)):
            index[node] = len(nodes)
            nodes.append(place)
        return [index[node] for node in tags.tolist()]

    vertex_node = {tag - 1: take(0, tag)[0] for _, tag in sorted(gmsh.model.getEntities(0))}
    on_edge = {}
    for _, tag in sorted(gmsh.model.getEntities(1)):
        a, b = pattern.edges[tag - 1]
        inner = np.array(take(1, tag), dtype=int)
        away = [np.linalg.norm(nodes[i] - pattern.vertices[a]) for i in inner]
        chain = [vertex_node[a], *inner[np.argsort(away)].tolist(), vertex_node[b]]
        on_edge[tag - 1] = np.array(chain)
    in_face, triangles, face_of = {}, [], []
    for _, tag in sorted(gmsh.model.getEntities(2)):
        in_face[tag - 1] = np.array(take(2, tag), dtype=int)
        kinds, _, corners = mesh.getElements(2, tag)
        if list(kinds) != [GMSH_TRIANGLE]:
            raise ValueError(f"gmsh finds no triangles in face {tag - 1} of the pattern")
        triangles.append([index[node] for node in corners[0].tolist()])
        face_of += [tag - 1] * (len(corners[0]) // 3)
    places = np.array(nodes)
    corners = np.concatenate([np.reshape(t, (-1, 3)) for t in triangles])
    upper = area_vectors(places, corners)[:, 2] > 0
    corners[~upper] = corners[~upper][:, ::-1]
    if np.min(np.abs(area_vectors(places, corners)[:, 2])) <= 0:
        raise ValueError("gmsh made a triangle without area; try another size")
    return _Raw(places, corners, on_edge, in_face, vertex_node, np.array(face_of))


def _without_flat_triangles(raw, shortest):
    """The mesh with the longest side of each triangle that is too flat split below its apex.

    Such triangles lie in narrow corners and strips of a pattern. Sides shorter than `shortest` [m]
    are not made; of all rounds the one with the least flat triangle is taken.
    """
    best = raw
    for _ in range(SPLITS):
        angles = triangle_angles(raw.nodes, raw.triangles)
        flat = np.flatnonzero(angles.max(axis=1) > FLATTEST)
        finer = _split(raw, flat, angles[flat].argmax(axis=1), shortest)
        if finer is None:
            break
        raw = finer
        best = min(best, raw, key=_largest_angle)
    return best


def _largest_angle(raw):
    return triangle_angles(raw.nodes, raw.triangles).max()


def _split(raw, flat, apexes, shortest):
    """`raw` with a node more on the side opposite corner `apexes` of each of the triangles `flat`.

    Where two of them touch, the later one waits. None if there is nothing to split.
    """
    nodes, triangles, face_of = raw.nodes.tolist(), raw.triangles.tolist(), raw.face_of.tolist()
    on_edge, in_face = dict(raw.on_edge), dict(raw.in_face)
    edge_of = {frozenset(side): e for e in on_edge for side in zip(on_edge[e][:-1], on_edge[e][1:])}
    owner = {(t[i - 1], t[i]): k for k, t in enumerate(triangles) for i in range(3)}
    split: set = set()
    for k, apex in zip(flat.tolist(), apexes.tolist()):
        c, a, b = np.roll(triangles[k], -apex).tolist()
        both = [k] if owner.get((b, a)) is None else [k, owner[b, a]]
        if split.intersection(both):
            continue
        along, away = raw.nodes[b] - raw.nodes[a], raw.nodes[c] - raw.nodes[a]
        length, foot = np.linalg.norm(along), along @ away / np.linalg.norm(along)
        if not shortest <= foot <= length - shortest:
            continue
        split.update(both)
        middle = len(nodes)
        nodes.append(raw.nodes[a] + foot / length * along)
        for t in both:
            triangles.append([middle if node == a else node for node in triangles[t]])
            triangles[t] = [middle if node == b else node for node in triangles[t]]
            face_of.append(face_of[t])
        e = edge_of.get(frozenset((a, b)))
        if e is None:
            in_face[face_of[k]] = np.append(in_face[face_of[k]], middle)
        else:
            chain = on_edge[e].tolist()
            on_edge[e] = np.insert(on_edge[e], max(chain.index(a), chain.index(b)), middle)
    if not split:
        return None
    return replace(
        raw,
        nodes=np.array(nodes),
        triangles=np.array(triangles),
        on_edge=on_edge,
        in_face=in_face,
        face_of=np.array(face_of),
    )


# ------------------------------------------------------------------------ the folded start


def _carried_over(pattern, raw):
    """Positions (N, 3) [m] of the mesh's nodes in the pattern's folded start.

    Linear along edges, inside faces by mean value coordinates (Hormann and Floater, ACM Trans.
    Graph. 25 (2006) 1424), which are exact where the face stays flat, whatever its shape.
    """
    places = np.empty_like(raw.nodes)
    for v, node in raw.vertex_node.items():
        places[node] = pattern.folded[v]
    for e, chain in raw.on_edge.items():
        a, b = pattern.edges[e]
        rest = pattern.vertices[b] - pattern.vertices[a]
        share = (raw.nodes[chain] - pattern.vertices[a]) @ rest / (rest @ rest)
        share = share[:, None]
        places[chain] = (1 - share) * pattern.folded[a] + share * pattern.folded[b]
    for face, inner in raw.in_face.items():
        sides = pattern.face_sides(face)
        weights = mean_value_coordinates(raw.nodes[inner], pattern.vertices, sides)
        places[inner] = weights @ pattern.folded
    return places


def mean_value_coordinates(
    points: np.ndarray, vertices: np.ndarray, sides: np.ndarray
) -> np.ndarray:
    """Weights (n, V) with which vertices of a polygon give its inner points, summing to 1.

    `points` (n, 3) lie inside, not on a side, in the plane z = 0; the polygon is on the left of
    each of `sides` (m, 2) between `vertices` (V, 3).
    """
    weights = np.zeros((len(points), len(vertices)))
    for a, b in sides:
        one, two = vertices[a, :2] - points[:, :2], vertices[b, :2] - points[:, :2]
        far, farther = np.linalg.norm(one, axis=1), np.linalg.norm(two, axis=1)
        cross = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
        dot = np.sum(one * two, axis=1)
        half = cross / (far * farther + dot)  # the tangent of half the angle under which it lies
        weights[:, a] += half / far
        weights[:, b] += half / farther
    return weights / weights.sum(axis=1, keepdims=True)


# ------------------------------------------------------------------------------------------ cuts


def split_along(triangles: np.ndarray, cuts: Any) -> Any:
    """Open a mesh along sides: nodes are doubled where the cut lets their triangles part.

    A cut's end inside the film stays one node. `triangles` (T, 3) are opened along `cuts` (K, 2).
    Gives the node that each node is a copy of (N + D,), of which the first N are themselves, and
    the new triangles (T, 3).
    """
    triangles = np.array(triangles)
    count = int(triangles.max()) + 1
    origin, cut = list(range(count)), {tuple(sorted(side)) for side in np.asarray(cuts).tolist()}
    around = defaultdict(list)
    touched = set(np.asarray(cuts).ravel().tolist())
    for t, corners in enumerate(triangles.tolist()):
        for node in touched.intersection(corners):
            around[node].append(t)
    before = triangles.copy()
    for node in sorted(touched):
        for fan in _fans(before, around[node], node, cut)[1:]:
            for t in fan:
                triangles[t][before[t] == node] = len(origin)
            origin.append(node)
    return np.array(origin), triangles


def _fans(triangles, around, node, cut):
    """The triangles round a node, in groups that hang together across sides not cut."""
    beside = defaultdict(list)
    for t in around:
        for other in triangles[t].tolist():
            if other != node and tuple(sorted((node, other))) not in cut:
                beside[other].append(t)
    fans, left = [], dict.fromkeys(around)
    while left:
        fan, queue = [], [next(iter(left))]
        del left[queue[0]]
        while queue:
            t = queue.pop()
            fan.append(t)
            for other in triangles[t].tolist():
                for near in beside.get(other, ()):
                    if near in left:
                        del left[near]
                        queue.append(near)
        fans.append(fan)
    return fans


def _renamed(before, after, sides):
    """`sides` (C, 2) of a mesh, by the nodes they have since the mesh was split."""
    named: dict = {}
    for old, new in zip(before.tolist(), after.tolist()):
        for i in range(3):
            named[old[i - 1], old[i]] = new[i - 1], new[i]
            named.setdefault((old[i], old[i - 1]), (new[i], new[i - 1]))
    pairs = [named[side[0], side[1]] for side in sides.tolist()]
    return np.array(pairs, dtype=int).reshape(-1, 2)
