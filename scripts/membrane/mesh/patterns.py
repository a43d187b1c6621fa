# SPDX-License-Identifier: GPL-2.0-or-later
"""Crease patterns: from the frames of a FOLD file to a checked flat sheet and its folded start.

A pattern is a flat sheet of polygons, in metres, in the plane z = 0, its faces counter-clockwise
seen from +z. Faces may be non-convex and have holes and slits. Where a file gives no faces they
are found by walking round the planar graph of its edges; a file of a folded form only is unrolled.
A pattern in another plane, or seen from below, is turned as a whole.
"""

from collections import defaultdict, deque
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..geometry import nearness
from .orientation import plane_normal
from .pattern_ways import area_vector, one_way_round, plain, seen_from_above, without_repeats
from .pattern_ways import without_twins

STRETCH = 0.01  # by which edges of a folded form may be longer than the pattern's
SHORTENED = 0.5  # and shorter: film between the ends may have buckled
GAP = 1e-4  # of the pattern's size: what folding by angles may leave open
LOOSE = 0.1  # degrees: to which fold angles must fit together
MOST_EDGES = 100_000  # more would take minutes to check
SAME_PLACE = 1e-9  # of the pattern's size
ROUNDS = 1000  # of evening out an unrolled sheet, at most


@dataclass(frozen=True, eq=False)
class CreasePattern:
    """A flat sheet of V vertices, E edges, F faces.

    Sides of a face are those from each vertex of a loop to the next; its outer loop runs
    counter-clockwise, holes and slits run through with the rest, further loops round its holes
    clockwise.
    """

    vertices: np.ndarray  #: (V, 3), flat [m], z = 0
    edges: np.ndarray  #: (E, 2) vertices
    letters: np.ndarray  #: (E,) B, M, V, F, U, C, J as in FOLD
    angles: np.ndarray | None  #: (E,) fold angles [deg], positive valley
    faces: tuple  #: vertices (n,) of each face
    holes: tuple  #: loops (n,) round the holes of each face, in a tuple
    folded: np.ndarray | None = None  #: (V, 3), where the folded sheet starts [m]
    notes: tuple = ()  #: sentences about what was changed

    @property
    def size(self) -> float:
        """Length of the diagonal of the pattern's bounding box [m]."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))

    @property
    def edge_lengths(self) -> np.ndarray:
        """Lengths (E,) of the edges [m]."""
        return np.linalg.norm(np.diff(self.vertices[self.edges], axis=1)[:, 0], axis=1)

    def face_sides(self, face: Any) -> Any:
        """All sides of a face as pairs of vertices (n, 2), the face on the left of each."""
        loops = (self.faces[face], *self.holes[face])
        return np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in loops])

    @property
    def area(self) -> float:
        """Area of the sheet [m2]."""
        loops = [loop for pair in zip(self.faces, self.holes) for loop in (pair[0], *pair[1])]
        return float(sum(_loop_area(self.vertices, loop) for loop in loops))


def crease_pattern(
    content: Any, unit: float | None = None, start: int | None = None, unfolded: bool = False
) -> CreasePattern:
    """The pattern that a FoldFile describes, with its folded start if the file has one.

    The flat sheet is the first frame that lies in the plane and is no folded form; if there is
    none, the folded form is unrolled. The folded start is the frame `start`; by default the first
    folded form in space with as many vertices, or else what the fold angles give, or else None;
    None, too, where that is folded flat: it has no height to open from.

    Parameters
    ----------
    unit : float, optional
        Length of the file's unit [m]; needed where the file names no physical one.
    start : int, optional
        Number of a frame, 0 the key frame.
    unfolded : bool
        The sheet will start flat: no folded start is an error.

    Raises
    ------
    ValueError
        In one sentence, if the file's frames make no sheet.
    """
    frames = content.frames
    if start is not None and not 0 <= start < len(frames):
        raise ValueError(f"start = {start}: the file's frames are 0 to {len(frames) - 1}")
    flat = next((i for i, frame in enumerate(frames) if _is_flat(frame)), None)
    form = start
    if form is None:
        count = None if flat is None else len(frames[flat].coords)
        form = next((i for i, frame in enumerate(frames) if _is_folded(frame, count)), None)
    if flat is None and form is None:  # folded flat only: enough to unroll
        form = next((i for i, frame in enumerate(frames) if frame.coords is not None), None)
    if form is None and flat is None:
        raise ValueError("no frame has vertices with coordinates: there is nothing to make")
    source = frames[form if flat is None else flat]
    scale = _metres(source, unit)
    edges, letters, faces = _edges_of(source)
    if not 0 < len(edges) <= MOST_EDGES:
        raise ValueError(f"the pattern has {len(edges)} edges; must be 1 to {MOST_EDGES}")
    pattern = CreasePattern(
        vertices=scale * source.coords,
        edges=edges,
        letters=letters,
        angles=source.angles if source.angles is not None else _angles_of(frames, form, edges),
        faces=faces,
        holes=((),) * len(faces),
    )
    _check_lengths(pattern)
    pattern = pattern if flat is None else without_twins(pattern)
    pattern = one_way_round(without_repeats(pattern))
    flattened = _unrolled if flat is None else seen_from_above
    pattern = replace(pattern, vertices=flattened(pattern))
    pattern = _with_faces(pattern)
    _check(pattern)
    doubts: tuple = ()
    if form is None and pattern.angles is not None and 0 < np.abs(pattern.angles).max() <= np.pi:
        doubts = ("no fold angle is larger than pi: are they in radians? FOLD has degrees",)
    try:
        folded = _folded_start(pattern, frames, form if form != flat else None, unit)
        if folded is not None and _is_folded_flat(pattern, folded):
            if start is not None:
                raise ValueError(f"frame {start} is folded flat: it has no height to open from")
            folded = None
    except ValueError as error:
        if not unfolded:
            raise ValueError("; ".join([str(error), *doubts])) from None
        folded = None
    return replace(pattern, folded=folded, notes=(*pattern.notes, *doubts))


def _folded_start(pattern, frames, form, unit):
    """Vertices (V, 3) [m] of frame `form`, if not None, or as the fold angles say, or None."""
    if form is not None:
        return _fitting(pattern, frames[form], _metres(frames[form], unit), form)
    if pattern.angles is not None and np.any(pattern.angles != 0):
        return fold_by_angles(pattern)
    return None


def _is_folded_flat(pattern, places):
    """Whether with its vertices at `places` (V, 3) all of the sheet lies in one plane, some of it
    turned over.
    """
    normals = np.array([_normal(places[face]) for face in pattern.faces])
    turned = normals @ normals[0]
    return bool(np.all(np.abs(turned) > 1 - SAME_PLACE) and np.any(turned < 0))


def _is_flat(frame):
    """Whether a frame is a sheet in the plane."""
    if frame.coords is None or len(frame.coords) < 3 or "foldedForm" in frame.classes:
        return False
    return plane_normal(frame.coords) is not None


def _is_folded(frame, count=None):
    """Whether a frame is a folded form in space, of `count` vertices (None: of any number).

    Flat-folded ones have no height to open from.
    """
    return (
        frame.coords is not None
        and len(frame.coords) >= 3
        and count in (None, len(frame.coords))
        and "creasePattern" not in frame.classes
        and plane_normal(frame.coords) is None
    )


def _metres(frame, unit):
    """Length of a frame's unit [m]."""
    if unit is not None:
        if not (np.isfinite(unit) and unit > 0):
            raise ValueError(f"unit = {unit} m: must be finite and > 0")
        return unit
    if frame.metre is None:
        raise ValueError(
            f"the pattern's frame_unit is {frame.unit!r}, which has no physical length: say how "
            "many metres it is (unit; on the command line --unit)"
        )
    return frame.metre


def _angles_of(frames, form, edges):
    """Fold angles [deg] that a folded form gives to the pattern's edges, or None."""
    if form is None or frames[form].angles is None or frames[form].edges is None:
        return None
    same = frames[form].edges.shape == edges.shape and np.all(frames[form].edges == edges)
    return frames[form].angles if same else None


def _edges_of(frame):
    """Edges, their letters and the faces (maybe none) of a frame.

    Where the file gives no letters the faces tell the border; other edges are unassigned.
    """
    faces = () if frame.faces is None else frame.faces
    edges, letters = frame.edges, frame.letters
    if edges is None and not faces:
        raise ValueError("the pattern has neither edges nor faces")
    if letters is None and not faces:
        raise ValueError(
            "the pattern has neither edges_assignment nor faces: which edges are its border is "
            "not said"
        )
    if edges is None or letters is None:
        ends = np.concatenate([np.column_stack([f, np.roll(f, -1)]) for f in faces])
        sides, shares = np.unique(np.sort(ends, axis=1), axis=0, return_counts=True)
        edges = sides if edges is None else edges
        border = set(map(tuple, sides[shares == 1].tolist()))
        is_border = [tuple(side) in border for side in np.sort(edges, axis=1).tolist()]
        letters = np.where(is_border, "B", "U")
    return edges, letters, faces


# ------------------------------------------------------------------------------------- the faces


def _with_faces(pattern):
    """The pattern with faces whose sides are simple, found from the edges where there are none."""
    _check_edges(pattern)
    if not pattern.faces:
        faces, holes = find_faces(pattern.vertices, pattern.edges, pattern.letters)
        return replace(pattern, faces=faces, holes=holes)
    pattern = _with_border(pattern)
    for f, face in enumerate(pattern.faces):
        if not _loop_area(pattern.vertices, face) > 0:
            raise ValueError(f"face {f} has no area, or is turned over in the flat sheet")
        if len(face) > 3:  # a loop that touches itself makes gmsh crash
            _check_touching(pattern.vertices, pattern.face_sides(f))
    return pattern


def _with_border(pattern):
    """The pattern with letter B on mountains and valleys that end the film, and a note.

    Some programs give every edge a fold. Where edges have no face at all, one may be missing, and
    the letters stay.
    """
    shares = np.sum(face_pairs(pattern) >= 0, axis=1)
    ends = np.flatnonzero((shares == 1) & np.isin(pattern.letters, ("M", "V")))
    if not len(ends) or np.any(shares == 0):
        return pattern
    letters = pattern.letters.copy()
    letters[ends] = "B"
    more = f" and {len(ends) - 1} more" if len(ends) > 1 else ""
    note = f"edge {ends[0]} ({pattern.letters[ends[0]]}){more} cannot fold: the film ends there"
    return replace(pattern, letters=letters, notes=(*pattern.notes, note))


def _check_edges(pattern):
    """Refuse edges that cross."""
    vertices, edges = pattern.vertices, pattern.edges
    tiny = SAME_PLACE * pattern.size
    plane = vertices[:, :2]
    for e, rest in _near_pairs(plane, edges):
        rest = rest[~np.isin(edges[rest], edges[e]).any(axis=1)]
        a, b = plane[edges[e]]
        c, d = plane[edges[rest, 0]], plane[edges[rest, 1]]
        one, other = _side_of(a, b, c), _side_of(a, b, d)
        two, more = _side_of(c, d, a), _side_of(c, d, b)
        cross = (one * other < 0) & (two * more < 0)
        cross &= np.min(np.abs([one, other, two, more]), axis=0, initial=np.inf) > tiny
        if np.any(cross):
            pair = sorted((e, int(rest[np.argmax(cross)])))
            raise ValueError(f"edges {pair[0]} and {pair[1]} cross where there is no vertex")


def _check_lengths(pattern):
    """Refuse edges of no length."""
    if np.min(pattern.edge_lengths, initial=np.inf) <= SAME_PLACE * pattern.size:
        raise ValueError(f"edge {int(np.argmin(pattern.edge_lengths))} has no length")


def _near_pairs(plane, edges):
    """Yield each edge with those later ones, from left to right, whose boxes touch its own."""
    low, high = plane[edges].min(axis=1), plane[edges].max(axis=1)
    order = np.argsort(low[:, 0])
    starts = low[order, 0]
    for i, e in enumerate(order):
        rest = order[i + 1 : np.searchsorted(starts, high[e, 0], side="right")]
        yield int(e), rest[(low[rest, 1] <= high[e, 1]) & (high[rest, 1] >= low[e, 1])]


def _side_of(a, b, points):
    """Distances of points from the lines a -> b, positive on the left."""
    along = b - a
    away = points - a
    turn = along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0]
    return turn / np.linalg.norm(along, axis=-1)


def find_faces(vertices: np.ndarray, edges: np.ndarray, letters: Any) -> Any:
    """Faces of the planar graph of the edges, by walking round each with the face on the left.

    Whether a face is of film or a hole follows from the border edges, of letter B: film lies inside
    an odd number of them. `vertices` (V, 3) lie in the plane z = 0, `edges` (E, 2) meet at vertices
    only, `letters` are (E,). Gives the outer loop (n,) of each face of film, counter-clockwise, and
    for each the loops round its holes, and round whatever lies free inside it, clockwise.
    """
    _check_touching(vertices, edges)
    loops, loop_of = _walk(vertices, edges)
    areas = np.array([_loop_area(vertices, loop) for loop in loops])
    tiny = SAME_PLACE * np.ptp(vertices[:, :2], axis=0).max() ** 2
    outer = [i for i in range(len(loops)) if areas[i] > tiny]
    owner = {i: i for i in outer}
    for i in range(len(loops)):
        if i not in owner:
            owner[i] = _smallest_around(vertices, loops, outer, areas, i)
    film = _film(edges, letters, loop_of, owner)
    faces = [i for i in outer if film.get(i)]
    if not faces:
        raise ValueError("the edges enclose no film: no closed loop of border edges (B)")
    holes = defaultdict(list)
    for i, face in owner.items():
        if face != i and film.get(face):
            holes[face].append(loops[i])
    return tuple(loops[i] for i in faces), tuple(tuple(holes[i]) for i in faces)


def _check_touching(vertices, edges):
    """Refuse vertices that lie on one another or on an edge: the graph would not be planar."""
    plane = vertices[:, :2]
    tiny = nearness(vertices)
    used = np.unique(edges)
    used = used[np.argsort(plane[used, 0])]
    across = plane[used, 0]
    for a, b in edges:
        low, high = np.minimum(plane[a], plane[b]) - tiny, np.maximum(plane[a], plane[b]) + tiny
        near = used[slice(*np.searchsorted(across, (low[0], high[0])))]
        near = near[(plane[near, 1] >= low[1]) & (plane[near, 1] <= high[1])]
        near = near[(near != a) & (near != b)]
        on = near[np.abs(_side_of(plane[a], plane[b], plane[near])) <= tiny]
        if len(on):
            raise ValueError(f"vertex {on[0]} lies on the edge from vertex {a} to vertex {b}")


def _walk(vertices, edges):
    """Closed walks along the edges, each with one face on its left: list of vertices (n,).

    Also a dict of the number of the walk along (a, b), for both directions of each edge.
    """
    ways = defaultdict(list)
    for a, b in np.concatenate([edges, edges[:, ::-1]]).tolist():
        ways[a].append(b)
    following = {}
    for b, ends in ways.items():
        away = vertices[ends, :2] - vertices[b, :2]
        turned = [ends[i] for i in np.argsort(np.arctan2(away[:, 1], away[:, 0]))]
        for i, a in enumerate(turned):
            following[a, b] = b, turned[i - 1]  # arriving from a: the next clockwise of it
    loops: list = []
    loop_of: dict = {}
    for begin in following:
        if begin in loop_of:
            continue
        loop, side = [], begin
        while side not in loop_of:
            loop_of[side] = len(loops)
            loop.append(side[0])
            side = following[side]
        loops.append(np.array(loop))
    return loops, loop_of


def _smallest_around(vertices, loops, outer, areas, i):
    """Number of the smallest outer loop round loop i, or None; they have no vertex in common."""
    first = loops[i][0]
    for j in sorted(outer, key=lambda j: areas[j]):
        if areas[j] > -areas[i] and first not in loops[j]:
            if _inside(vertices, loops[j], vertices[first]):
                return j
    return None


def _inside(vertices, loop, point):
    """Whether a loop winds round a point."""
    a, b = vertices[loop, :2] - point[:2], vertices[np.roll(loop, -1), :2] - point[:2]
    turn = np.arctan2(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], np.sum(a * b, axis=1))
    return abs(np.sum(turn)) > np.pi


def _film(edges, letters, loop_of, owner):
    """Whether each face (by the number of its outer loop; None the outside) is of film."""
    beside = defaultdict(list)
    for e, (a, b) in enumerate(edges.tolist()):
        left, right = owner[loop_of[a, b]], owner[loop_of[b, a]]
        if left == right and letters[e] == "B":
            raise ValueError(
                f"edge {e} is a border (B) with the same face on both sides; a cut is C"
            )
        beside[left].append((right, letters[e] == "B", e))
        beside[right].append((left, letters[e] == "B", e))
    film, queue = {None: False}, deque([None])
    while queue:
        face = queue.popleft()
        for other, border, e in beside[face]:
            expected = film[face] != border
            if other not in film:
                film[other] = expected
                queue.append(other)
            elif film[other] != expected:
                raise ValueError(f"edge {e}: the border edges (B) round its faces do not close")
    return film


def _loop_area(vertices, loop):
    """Signed area [m2] of a loop, positive counter-clockwise."""
    x, y = (vertices[loop, :2] - vertices[loop[0], :2]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


# ------------------------------------------------------------------------------------ the checks


def face_pairs(pattern: Any) -> Any:
    """The faces on the left and on the right of each edge (E, 2), -1 for none.

    ValueError if a face has a side that is no edge, or two faces lie on the same side of an edge.
    """
    number = {tuple(pair): (e, 0) for e, pair in enumerate(pattern.edges.tolist())}
    number |= {(b, a): (e, 1) for (a, b), (e, _) in list(number.items())}
    pairs = np.full((len(pattern.edges), 2), -1)
    for face in range(len(pattern.faces)):
        for a, b in pattern.face_sides(face).tolist():
            if (a, b) not in number:
                raise ValueError(
                    f"face {face} runs from vertex {a} to vertex {b}, but no edge does"
                )
            e, side = number[a, b]
            if pairs[e, side] >= 0:
                raise ValueError(
                    f"faces {pairs[e, side]} and {face} lie on the same side of edge {e}: "
                    "they overlap"
                )
            pairs[e, side] = face
    return pairs


def _check(pattern):
    """Refuse letters that contradict the faces, and sheets that are not of one piece."""
    pairs = face_pairs(pattern)
    shares = np.sum(pairs >= 0, axis=1)
    for e, (letter, share) in enumerate(zip(pattern.letters, shares)):
        if letter == "B" and share == 2:
            raise ValueError(f"edge {e} is a border (B) between two faces; a cut is C")
        if letter in "MV" and share < 2:
            raise ValueError(f"edge {e} is a crease ({letter}) but has no face on one side")
    linked = _neighbours(pattern, pairs)
    reached, queue = {0}, deque([0])
    while queue:
        for other, *_ in linked[queue.popleft()]:
            if other not in reached:
                reached.add(other)
                queue.append(other)
    if len(reached) < len(pattern.faces):
        raise ValueError(
            f"the sheet is of several pieces: faces {min(reached)} and "
            f"{min(set(range(len(pattern.faces))) - reached)} do not hang together"
            + "".join(f"; {note}" for note in pattern.notes)
        )


def _neighbours(pattern, pairs):
    """For each face its neighbours across edges that are not cut: (face, edge, a, b, angle).

    The face itself lies left of a -> b; the fold angle is in degrees, 0 where none is given.
    """
    angles = np.zeros(len(pattern.edges)) if pattern.angles is None else pattern.angles
    linked = defaultdict(list)
    for e, (left, right) in enumerate(pairs.tolist()):
        if min(left, right) < 0 or left == right or pattern.letters[e] in "BC":
            continue
        a, b = pattern.edges[e].tolist()
        linked[left].append((right, e, a, b, angles[e]))
        linked[right].append((left, e, b, a, angles[e]))
    return linked


# --------------------------------------------------------------------------- folding, unrolling


def fold_by_angles(pattern: Any) -> np.ndarray:
    """Vertices (V, 3) [m] of the pattern folded by its angles, every face kept rigid.

    The first face stays where it is; each other one hangs on a chain of creases. ValueError if the
    angles do not go together: a vertex would be in two places.
    """
    placed = {0: (np.eye(3), np.zeros(3))}
    for face, other, _, a, b, angle in _outwards(pattern):
        turn, shift = placed[face]
        # The other face lies right of a -> b; a valley lifts it.
        hinge = _rotation(pattern.vertices[b] - pattern.vertices[a], -np.radians(angle))
        pivot = pattern.vertices[a]
        placed[other] = (turn @ hinge, turn @ (pivot - hinge @ pivot) + shift)
    found = [
        pattern.vertices[_vertices_of(pattern, face)] @ turn.T + shift
        for face, (turn, shift) in sorted(placed.items())
    ]
    places = _agreed(pattern, found, "the fold angles do not go together")
    pairs = face_pairs(pattern)
    hinges = np.all(pairs >= 0, axis=1) & ~np.isin(pattern.letters, ("B", "C"))
    bent = fold_angles_of(pattern, places, pairs)
    wrong = hinges * np.abs((bent - pattern.angles + 180) % 360 - 180)
    e = int(np.argmax(wrong))
    if wrong[e] > LOOSE and pairs[e, 0] == pairs[e, 1]:
        raise ValueError(
            f"edge {e} ({pattern.letters[e]}) ends inside face {pairs[e, 0]}, which stays flat: it "
            f"cannot be bent by {plain(pattern.angles[e])} degrees"
        )
    if wrong[e] > LOOSE:
        raise ValueError(
            f"the fold angles do not go together: edge {e} would be bent by {plain(bent[e])} "
            f"degrees, not by {plain(pattern.angles[e])}"
        )
    return places


def fold_angles_of(pattern: Any, places: np.ndarray, pairs: Any) -> Any:
    """Fold angles (E,) [deg] of the edges in a folded form, positive valley, 0 on the border.

    `places` (V, 3) are the vertices of the folded form [m], `pairs` (E, 2) what `face_pairs` gives.
    """
    normals = np.array([_normal(places[face]) for face in pattern.faces])
    a, b = pattern.edges.T
    along = places[b] - places[a]
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along /= np.where(length > 0, length, 1.0)  # edges of no face have no place
    left, right = normals[pairs[:, 0]], normals[pairs[:, 1]]
    # A valley lifts the right face: it turns about a -> b the other way than a screw.
    sine = -np.sum(along * np.cross(left, right), axis=1)
    angles = np.degrees(np.arctan2(sine, np.sum(left * right, axis=1)))
    return np.where(np.all(pairs >= 0, axis=1), angles, 0.0)


def _normal(loop, tiny=0.0):
    """Unit normal (3,) of a polygon (n, 3), as flat as may be.

    It is 0 where the polygon's area is at most half of `tiny` [m2].
    """
    normal = 2 * area_vector(loop)
    size = np.linalg.norm(normal)
    return normal / size if size > tiny else np.zeros(3)


def _unrolled(pattern):
    """Flat vertices (V, 3) [m] of a pattern whose `vertices` are those of a folded form."""
    if not pattern.faces:
        raise ValueError("a folded form without faces_vertices cannot be unrolled")
    flat = [_laid_flat(pattern, face) for face in range(len(pattern.faces))]
    ids = [_vertices_of(pattern, face) for face in range(len(pattern.faces))]
    for face, other, _, a, b, _ in _outwards(pattern):
        here, there = ids[face].tolist(), ids[other].tolist()
        start, end = flat[face][here.index(a)], flat[face][here.index(b)]
        begin, stop = flat[other][there.index(a)], flat[other][there.index(b)]
        turn = (end - start) / (stop - begin)
        flat[other] = start + turn / abs(turn) * (flat[other] - begin)
    places = _evened_out(pattern, np.concatenate(ids), flat)
    on_faces = np.any(face_pairs(pattern) >= 0, axis=1)
    strain = np.where(on_faces, _strains(pattern, pattern.vertices, places), 0.0)
    if np.max(np.abs(strain)) > STRETCH:
        e = int(np.argmax(np.abs(strain)))
        raise ValueError(
            "the folded form does not unroll into the plane: edge "
            f"{e} would be {100 * strain[e]:+.3g} % longer folded"
        )
    return places


def _evened_out(pattern, ids, flat):
    """Vertices (V, 3) [m] in the plane on which the faces agree as well as can be.

    Each face is laid as it best fits, each vertex then into the middle of where its faces put it,
    round by round (shape matching: Mueller et al., ACM Trans. Graph. 24 (2005) 471). `ids` (n,) are
    the vertices of all faces, one face after the other; `flat` is where each puts its own, a list
    of complex (m,) [m].
    """
    sizes = [len(z) for z in flat]
    face = np.repeat(np.arange(len(flat)), sizes)
    shares = np.maximum(np.bincount(ids, minlength=len(pattern.vertices)), 1)

    def total(rows, z, count):
        return np.bincount(rows, z.real, count) + 1j * np.bincount(rows, z.imag, count)

    def centres(z):
        return (total(face, z, len(flat)) / sizes)[face]

    put = np.concatenate(flat)
    shape = put - centres(put)
    for _ in range(ROUNDS):
        middle = total(ids, put, len(shares)) / shares
        gap, wanted = np.max(np.abs(put - middle[ids])), middle[ids]
        turn = total(face, (wanted - centres(wanted)) * shape.conj(), len(flat))
        laid = centres(wanted) + (turn / np.abs(turn))[face] * shape
        if gap <= SAME_PLACE * pattern.size or np.max(np.abs(laid - put)) <= 1e-4 * gap:
            break
        put = laid
    return np.column_stack([middle.real, middle.imag, np.zeros(len(middle))])


def _laid_flat(pattern, face):
    """Corners of a face in its own plane, as complex numbers [m]."""
    corners = pattern.vertices[_vertices_of(pattern, face)]
    loop = pattern.vertices[pattern.faces[face]]
    normal = _normal(loop - loop[0], SAME_PLACE * pattern.size**2)
    if not np.any(normal):
        raise ValueError(f"face {face} of the folded form has no area")
    away = (corners - corners[0]) @ normal
    if np.max(np.abs(away)) > STRETCH * pattern.size:
        raise ValueError(f"face {face} of the folded form is not flat")
    along = corners[1] - corners[0]
    along = along - normal * (along @ normal)
    along /= np.linalg.norm(along)
    return (corners - corners[0]) @ along + 1j * ((corners - corners[0]) @ np.cross(normal, along))


def _vertices_of(pattern, face):
    """All vertices of a face, each once, in the order of its sides."""
    return np.array(list(dict.fromkeys(pattern.face_sides(face)[:, 0].tolist())))


def _outwards(pattern):
    """Yield (face, other, edge, a, b, angle) so that every face but the first is once `other`."""
    linked = _neighbours(pattern, face_pairs(pattern))
    reached, queue = {0}, deque([0])
    while queue:
        face = queue.popleft()
        for other, *about in linked[face]:
            if other not in reached:
                reached.add(other)
                queue.append(other)
                yield face, other, *about


def _agreed(pattern, found, trouble):
    """Vertices (V, 3) on whose places all faces agree; `found` has those of each face's own."""
    total, shares = np.zeros_like(pattern.vertices), np.zeros(len(pattern.vertices))
    for face, places in enumerate(found):
        ids = _vertices_of(pattern, face)
        total[ids] += places
        shares[ids] += 1
    mean = total / np.maximum(shares, 1)[:, None]
    for face, places in enumerate(found):
        ids = _vertices_of(pattern, face)
        gaps = np.linalg.norm(places - mean[ids], axis=1)
        if np.max(gaps) > GAP * pattern.size:
            v = int(np.argmax(gaps))
            raise ValueError(f"{trouble}: vertex {ids[v]} would be in places {gaps[v]:.3g} m apart")
    return mean


def _rotation(axis, angle):
    """Matrix (3, 3) of a right-handed rotation [rad] about an axis of any length."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def _fitting(pattern, frame, scale, number):
    """Vertices (V, 3) [m] of a folded form, if it is one of this pattern."""
    if frame.coords is None or len(frame.coords) != len(pattern.vertices):
        given = "none" if frame.coords is None else len(frame.coords)
        raise ValueError(
            f"frame {number} has {given} vertices, the pattern {len(pattern.vertices)}: it is no "
            "folded form of it"
        )
    folded = scale * frame.coords
    strain = _strains(pattern, folded, pattern.vertices)
    wrong = (strain > STRETCH) | (strain < -SHORTENED)
    if np.any(wrong):
        e = int(np.argmax(wrong))
        raise ValueError(
            f"frame {number} changes the length of edge {e} by {100 * strain[e]:.3g} %: it is no "
            f"folded form of the pattern"
        )
    return folded


def _strains(pattern, places, rest):
    """Strains (E,) [-] of the edges with vertices at `places` (V, 3), beside those at `rest`."""
    a, b = pattern.edges.T
    now, before = (np.linalg.norm(x[b] - x[a], axis=1) for x in (places, rest))
    return now / np.where(before > 0, before, np.inf) - 1


def nearest_pose(
    places: np.ndarray, target: np.ndarray, weights: np.ndarray | None = None
) -> np.ndarray:
    """`places` (n, 3), turned and shifted as a whole so as to come nearest to `target` (n, 3).

    Kabsch, Acta Cryst. A32 (1976) 922. `weights` (n,) default to equal ones.
    """
    weights = np.ones(len(places)) if weights is None else np.asarray(weights)
    centre = np.average(places, axis=0, weights=weights)
    goal = np.average(target, axis=0, weights=weights)
    u, _, v = np.linalg.svd((weights[:, None] * (places - centre)).T @ (target - goal))
    turn = v.T @ np.diag([1.0, 1.0, np.sign(np.linalg.det(v.T @ u.T))]) @ u.T
    return (places - centre) @ turn.T + goal
