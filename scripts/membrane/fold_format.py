# SPDX-License-Identifier: GPL-2.0-or-later
"""The origami format FOLD, specification 1.2 (https://github.com/edemaine/fold): read and write.

A file holds one or more frames: crease patterns, folded states. Coordinates are in the frame's
unit, fold angles in degrees as in the format: 0 flat, positive valley, negative mountain, 180
folded face to face. `crease_angles` and `fold_angles` convert to and from the angles of creases
that the rest of the package uses.

What can be computed from vertices, edges and faces (`vertices_edges`, `faces_faces`, …) and the
stacking of layers (`faceOrders`) is neither read nor written. Keys with a colon are anybody's own
data; they are kept.
"""

import json
import math
from dataclasses import dataclass, field

import numpy as np

from .files import BadFile, read_object, replace_text, shown
from .geometry import MOUNTAIN, VALLEY
from .history import is_value

SPEC = 1.2
LETTERS = "BMVFUCJ"
UNITS = {  # metres
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "nm": 1e-9,
    "in": 0.0254,
    "pt": 0.0254 / 72,
}
MOST_FRAMES = 100_000
MOST_ENTRIES = 50_000_000  # numbers in all frames together, once those inherited are counted
FARTHEST = 1e12  # of coordinates, in any unit
ROUNDED = 1e-6  # degrees beyond 180 that are taken for an error of rounding
LARGEST_ID = 2**31 - 1

_TEXTS = {"title": "frame_title", "description": "frame_description", "author": "frame_author"}
_FILE_TEXTS = ("file_creator", "file_author", "file_title", "file_description")


@dataclass(frozen=True, eq=False)
class FoldFrame:
    """One frame. V vertices, E edges, F faces; None where the frame says nothing.

    Attributes
    ----------
    coords : (V, 3) float or None
        In `unit`; missing third coordinates are 0.
    edges : (E, 2) int or None
        Vertices.
    letters : (E,) str or None
        B border, M mountain, V valley, F flat, U unassigned, C cut, J join.
    angles : (E,) float or None
        Fold angles [deg] in [-180, 180], positive valley, negative mountain. In files null stands
        for 0 on edges that do not fold.
    faces : tuple of (n,) int or None
        Vertices of each face, counter-clockwise seen from the top.
    unit : str
        Of the coordinates; "unit": no physical meaning.
    classes, attributes : tuple of str
        As "creasePattern", "foldedForm"; as "2D", "3D".
    title, description, author : str
    custom : dict
        By key, whose name has a colon; anything that JSON can hold.
    """

    coords: np.ndarray = None
    edges: np.ndarray = None
    letters: np.ndarray = None
    angles: np.ndarray = None
    faces: tuple = None
    unit: str = "unit"
    classes: tuple = ()
    attributes: tuple = ()
    title: str = ""
    description: str = ""
    author: str = ""
    custom: dict = field(default_factory=dict)

    @property
    def metre(self):
        """Length [m] of the frame's unit; None if it is not a physical one."""
        return UNITS.get(self.unit)


@dataclass(frozen=True, eq=False)
class FoldFile:
    """All frames of a file, the key frame first, and what the file says about itself.

    Attributes
    ----------
    frames : tuple of FoldFrame
    texts : dict of str
        file_creator, file_author, file_title, file_description, where given.
    classes : tuple of str
        As "singleModel", "animation".
    """

    frames: tuple
    texts: dict = field(default_factory=dict)
    classes: tuple = ()


def fold_angles(angles, signs):
    """Fold angles [deg] of creases, in [-180, 180], positive valley.

    Parameters
    ----------
    angles : (C,) float
        Between the two triangles [rad]: 0 face to face, pi flat; `geometry.crease_angles`.
    signs : (C,) int
        +1 mountain, -1 valley.
    """
    turned = -np.asarray(signs) * np.degrees(math.pi - np.asarray(angles))
    # Faces that have passed through each other are bent by more than half a turn.
    return turned - 360 * np.round(turned / 360)


def crease_angles(angles):
    """Angles [rad] in [0, pi] between the faces at creases, and their signs, from fold angles.

    Parameters
    ----------
    angles : (C,) float
        Fold angles [deg] in [-180, 180]. Those of 0 count as valleys.

    Returns
    -------
    angles : (C,) float
        0 folded face to face, pi flat.
    signs : (C,) int
        +1 mountain, -1 valley.
    """
    angles = np.asarray(angles, dtype=float)
    return math.pi - np.radians(np.abs(angles)), np.where(angles < 0, MOUNTAIN, VALLEY)


# ---------------------------------------------------------------------------------------- reading


def read_fold(path):
    """Read a FOLD file.

    Returns
    -------
    FoldFile
        With every inherited property filled in, so that each frame stands for itself.

    Raises
    ------
    BadFile
        Whatever is wrong, in one sentence.
    OSError
        If the file cannot be opened.
    """
    top = read_object(path)
    _check_spec(path, top)
    others = _list(path, "file_frames", top.get("file_frames", []), dict, "objects")
    if len(others) >= MOST_FRAMES:
        raise BadFile(path, "file_frames", f"has {len(others)} frames, {MOST_FRAMES} at most")
    key_frame = {key: value for key, value in top.items() if not key.startswith("file_")}
    raw = _inherited(path, [key_frame, *others])
    _check_size(path, raw)
    reader = _FrameReader(path)
    frames = tuple(reader.frame(number, found) for number, found in enumerate(raw))
    texts = {name: _text(path, name, top[name]) for name in _FILE_TEXTS if name in top}
    return FoldFile(frames, texts, _strings(path, "file_classes", top.get("file_classes", [])))


def _check_spec(path, top):
    """Refuse files of a later specification, which may mean something else by the same words."""
    spec = top.get("file_spec", SPEC)
    number = spec
    if isinstance(spec, str) and is_value(spec):  # as some programs write it
        number = float(spec)
    if not _is_number(number) or not 1 <= number < 2:
        raise BadFile(path, "file_spec", f"is {shown(spec)}; specifications 1 to 1.2 are read")


def _inherited(path, raw):
    """The frames (dicts) with what they inherit from their parents.

    A frame's parent may stand anywhere in the file; a circle of parents is refused.
    """
    parents = [_parent(path, number, frame, len(raw)) for number, frame in enumerate(raw)]
    done = {}
    for number in range(len(raw)):
        chain = []
        while number is not None and number not in done:
            if number in chain:
                circle = " -> ".join(map(str, [*chain[chain.index(number) :], number][:12]))
                raise BadFile(path, "frame_parent", f"runs in a circle: frames {circle}")
            chain.append(number)
            # A chain longer than this is no origami, and its circles would be slow to find.
            if len(chain) > 1000:
                raise BadFile(path, "frame_parent", "more than 1000 frames inherit in a row")
            number = parents[number]
        for own in reversed(chain):
            older = done[parents[own]] if parents[own] is not None else {}
            done[own] = {**older, **raw[own]}
    return [done[number] for number in range(len(raw))]


def _parent(path, number, frame, count):
    """Number of the frame that this one inherits from, or None."""
    place = _place(number, "frame_parent")
    inherits = frame.get("frame_inherit", False)
    if not isinstance(inherits, bool):
        raise BadFile(path, _place(number, "frame_inherit"), "must be true or false")
    parent = frame.get("frame_parent")
    if parent is None:
        if inherits:
            raise BadFile(path, place, "is missing, and frame_inherit is true")
        return None
    if number == 0:
        raise BadFile(path, place, "the key frame has no parent")
    if not _is_id(parent, count):
        raise BadFile(path, place, f"is {shown(parent)}, no frame; the last is {count - 1}")
    return parent if inherits else None


def _check_size(path, raw):
    """Refuse a short file whose frames inherit more than memory holds."""
    lists = ("vertices_coords", "edges_vertices", "faces_vertices")
    sizes = [frame.get(name) for frame in raw for name in lists]
    entries = sum(3 * len(size) for size in sizes if isinstance(size, list))
    if entries > MOST_ENTRIES:
        raise BadFile(path, "", f"has more than {MOST_ENTRIES} numbers with what frames inherit")


class _FrameReader:
    """Turns objects of JSON into frames; what several frames share is converted once."""

    def __init__(self, path):
        self.path = path
        self._converted = {}

    def frame(self, number, raw):
        """The FoldFrame of one object."""

        def get(name, convert, *about):
            if name not in raw:
                return None
            # The objects live as long as the file is read, so that their ids stay theirs.
            key = (name, id(raw[name]), *about)
            if key not in self._converted:
                self._converted[key] = convert(self.path, _place(number, name), raw[name], *about)
            return self._converted[key]

        coords = get("vertices_coords", _coords)
        count = LARGEST_ID if coords is None else len(coords)
        edges = get("edges_vertices", _edges, count)
        size = 0 if edges is None else len(edges)
        letters = get("edges_assignment", _letters, size)
        name = "edges_foldAngle" if "edges_foldAngle" in raw else "edges_foldAngles"  # 1.0's name
        angles = self._without_gaps(number, letters, get(name, _angles, size))
        self._check_directions(number, letters, angles)
        if edges is None:  # empty lists, if any
            letters = angles = None
        return FoldFrame(
            coords=coords,
            edges=edges,
            letters=letters,
            angles=angles,
            faces=get("faces_vertices", _faces, count),
            unit=get("frame_unit", _text) or "unit",
            classes=get("frame_classes", _strings) or (),
            attributes=get("frame_attributes", _strings) or (),
            **{name: get(key, _text) or "" for name, key in _TEXTS.items()},
            custom={key: value for key, value in raw.items() if ":" in key},
        )

    def _without_gaps(self, number, letters, angles):
        """The angles (E,), 0 for null, which Origami Simulator writes where an edge has none."""
        gaps = np.zeros(0, dtype=bool) if angles is None else np.isnan(angles)
        if not np.any(gaps):
            return angles
        folds = gaps if letters is None else gaps & np.isin(letters, ("M", "V"))
        if np.any(folds):
            place = _place(number, f"edges_foldAngle[{int(np.argmax(folds))}]")
            raise BadFile(self.path, place, "has no angle (null)")
        return _frozen(np.where(gaps, 0.0, angles))

    def _check_directions(self, number, letters, angles):
        """Refuse mountains with a valley's angle, and the other way about."""
        if letters is None or angles is None:
            return
        wrong = ((letters == "M") & (angles > 0)) | ((letters == "V") & (angles < 0))
        if np.any(wrong):
            e = int(np.argmax(wrong))
            raise BadFile(
                self.path,
                _place(number, f"edges_foldAngle[{e}]"),
                f"is {angles[e]:g} degrees, but its edge is {letters[e]}; "
                "mountains have negative angles, valleys positive ones",
            )


def _place(number, name):
    """Where in the file: a name in the key frame, or in one of file_frames."""
    return name if number == 0 else f"file_frames[{number - 1}].{name}"


def _is_number(value):
    return type(value) in (int, float)  # a bool is an int, too


def _is_id(value, count):
    return type(value) is int and 0 <= value < count


def _list(path, place, value, kind, words):
    """`value`, if it is a list of `kind`."""
    if not isinstance(value, list):
        raise BadFile(path, place, f"must be a list, not {shown(value)}")
    for i, item in enumerate(value):
        if not isinstance(item, kind):
            raise BadFile(path, f"{place}[{i}]", f"is {shown(item)}; must be a list of {words}")
    return value


def _text(path, place, value):
    if not isinstance(value, str):
        raise BadFile(path, place, f"must be a text, not {shown(value)}")
    return value


def _strings(path, place, value):
    return tuple(_list(path, place, value, str, "texts"))


def _coords(path, place, value):
    """Coordinates (V, 3) from a list of pairs or triples."""
    points = _list(path, place, value, list, "coordinates")
    for i, point in enumerate(points):
        if len(point) not in (2, 3):
            raise BadFile(path, f"{place}[{i}]", f"has {len(point)} coordinates; must be 2 or 3")
        for x in point:
            if not (_is_number(x) and abs(x) <= FARTHEST):
                raise BadFile(
                    path, f"{place}[{i}]", f"holds {shown(x)}; must be numbers up to {FARTHEST:g}"
                )
    return _frozen(np.array([(*p, 0.0)[:3] for p in points], dtype=float).reshape(-1, 3))


def _ids(path, place, value, count):
    """`value`, a list of ids of vertices, none twice in a row."""
    for i, vertex in enumerate(value):
        if not _is_id(vertex, count):
            last = f"; the last is {count - 1}" if count < LARGEST_ID else ""
            raise BadFile(path, place, f"names {shown(vertex)}, which is no vertex{last}")
        if vertex == value[i - 1]:
            raise BadFile(path, place, f"joins vertex {vertex} to itself")
    return value


def _edges(path, place, value, count):
    """Edges (E, 2)."""
    pairs = _list(path, place, value, list, "two vertices")
    for i, pair in enumerate(pairs):
        if len(pair) != 2:
            raise BadFile(path, f"{place}[{i}]", f"has {len(pair)} vertices; an edge has 2")
        _ids(path, f"{place}[{i}]", pair, count)
    return _frozen(np.array(pairs, dtype=int).reshape(-1, 2))


def _faces(path, place, value, count):
    """Faces, each (n,)."""
    loops = _list(path, place, value, list, "vertices")
    for i, loop in enumerate(loops):
        if len(loop) < 3:
            raise BadFile(path, f"{place}[{i}]", f"has {len(loop)} vertices; a face has 3 or more")
        _ids(path, f"{place}[{i}]", loop, count)
    return tuple(_frozen(np.array(loop, dtype=int)) for loop in loops)


def _per_edge(path, place, value, size, words):
    """`value`, if it is a list with one entry for each edge."""
    if not isinstance(value, list) or len(value) != size:
        given = f"{len(value)} {words}" if isinstance(value, list) else shown(value)
        raise BadFile(path, place, f"has {given} for {size} edges")
    return value


def _letters(path, place, value, size):
    """Assignments (E,)."""
    for i, letter in enumerate(_per_edge(path, place, value, size, "letters")):
        if not (isinstance(letter, str) and len(letter) == 1 and letter in LETTERS):
            raise BadFile(
                path, f"{place}[{i}]", f"is {shown(letter)}; must be one of {', '.join(LETTERS)}"
            )
    return _frozen(np.array(value, dtype="<U1"))


def _angles(path, place, value, size):
    """Fold angles (E,) [deg], not a number for null."""
    for i, angle in enumerate(_per_edge(path, place, value, size, "angles")):
        if angle is not None and not (_is_number(angle) and abs(angle) <= 180 + ROUNDED):
            raise BadFile(
                path, f"{place}[{i}]", f"is {shown(angle)}; must be degrees from -180 to 180"
            )
    return _frozen(np.clip(np.array(value, dtype=float), -180, 180))


def _frozen(array):
    array.setflags(write=False)
    return array


# ---------------------------------------------------------------------------------------- writing


def write_fold(path, content):
    """Write a FOLD file, all of it or nothing.

    Parameters
    ----------
    path : path
    content : FoldFile
        Frames inherit from the key frame the arrays and tuples that they share with it, which
        keeps a series of folded states short.

    Raises
    ------
    ValueError
        If `read_fold` would not accept it.
    """
    key_frame = content.frames[0]
    top = {"file_spec": SPEC, **content.texts, "file_classes": list(content.classes)}
    first = _as_dict(path, 0, key_frame)
    top |= first
    children = [
        _child(_as_dict(path, i, frame), frame, first, key_frame)
        for i, frame in enumerate(content.frames[1:], start=1)
    ]
    if children:
        top["file_frames"] = children
    text = json.dumps(top, allow_nan=False, default=lambda array: array.tolist())
    replace_text(path, text + "\n")


def _as_dict(path, number, frame):
    """A frame as an object of JSON; refused if it could not be read back."""
    arrays = {
        "vertices_coords": frame.coords,
        "edges_vertices": frame.edges,
        "edges_assignment": frame.letters,
        "edges_foldAngle": frame.angles,
    }
    texts = {key: getattr(frame, name) for name, key in _TEXTS.items()}
    found = {
        "frame_classes": list(frame.classes),
        "frame_attributes": list(frame.attributes),
        "frame_unit": frame.unit,
        **{key: text for key, text in texts.items() if text},
        **{key: np.asarray(array).tolist() for key, array in arrays.items() if array is not None},
    }
    if frame.faces is not None:
        found["faces_vertices"] = [np.asarray(face).tolist() for face in frame.faces]
    _FrameReader(path).frame(number, found)
    for key in frame.custom:
        if ":" not in key:
            raise BadFile(path, _place(number, key), "own data need a key with a colon")
    return found | frame.custom


def _child(found, frame, first, key_frame):
    """A later frame as an object of JSON (`found`), without what it shares with the key frame."""
    if not found.keys() >= first.keys():
        return found  # it would inherit what it does not have
    names = {
        "vertices_coords": "coords",
        "edges_vertices": "edges",
        "edges_assignment": "letters",
        "edges_foldAngle": "angles",
        "faces_vertices": "faces",
    }
    shared = {k for k, name in names.items() if getattr(frame, name) is getattr(key_frame, name)}
    shared |= {k for k, value in frame.custom.items() if value is key_frame.custom.get(k)}
    own = {key: value for key, value in found.items() if key not in shared}
    return {"frame_parent": 0, "frame_inherit": True, **own}
