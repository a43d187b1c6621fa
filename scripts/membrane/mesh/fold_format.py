# SPDX-License-Identifier: GPL-2.0-or-later
"""The origami format FOLD, specification 1.2 (https://github.com/edemaine/fold): read and write.

A file holds one or more frames: crease patterns, folded states. Coordinates are in the frame's
unit, fold angles in degrees as in the format: 0 flat, positive valley, negative mountain, 180
folded face to face. `crease_angles` and `fold_angles` convert to and from the angles of creases
that the rest of the package uses.

What can be computed from vertices, edges and faces (`vertices_edges`, `faces_faces`, …) and the
stacking of layers (`faceOrders`) is neither read nor written. Keys with a colon are anybody's own
data; they are kept. What keys may hold is in the tables FILE and FRAME, which `_checked` walks;
jsonschema would take six times as long as all else, and say no more than "[1] is too short".
"""

import json
import math
from collections.abc import Callable, Container
from dataclasses import dataclass, field
from operator import eq
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..files import BadFile, is_value, read_object, replace_text, shown
from ..geometry import MOUNTAIN, VALLEY

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


@dataclass(frozen=True, eq=False)
class FoldFrame:
    """One frame. V vertices, E edges, F faces; None where the frame says nothing.

    Letters are B border, M mountain, V valley, F flat, U unassigned, C cut, J join. In files null
    stands for an angle of 0 on edges that do not fold.
    """

    coords: np.ndarray | None = None  #: (V, 3) in `unit`; missing third coordinates are 0
    edges: np.ndarray | None = None  #: (E, 2) vertices
    letters: np.ndarray | None = None  #: (E,)
    angles: np.ndarray | None = None  #: (E,) [deg] in [-180, 180], + valley, - mountain
    faces: tuple[np.ndarray, ...] | None = None  #: vertices (n,), counter-clockwise from the top
    unit: str = "unit"  #: of the coordinates; "unit": no physical meaning
    classes: tuple[str, ...] = ()  #: as "creasePattern", "foldedForm"
    attributes: tuple[str, ...] = ()  #: as "2D", "3D"
    title: str = ""
    description: str = ""
    author: str = ""
    custom: dict[str, Any] = field(default_factory=dict)  #: what JSON can hold; keys with a colon

    @property
    def metre(self) -> float | None:
        """Length [m] of the frame's unit; None if it is not a physical one."""
        return UNITS.get(self.unit)


@dataclass(frozen=True, eq=False)
class FoldFile:
    """All frames of a file, the key frame first, and what the file says about itself.

    Its texts are file_creator, file_author, file_title, file_description, where given.
    """

    frames: tuple[FoldFrame, ...]
    texts: dict[str, str] = field(default_factory=dict)  #: by key, as "file_author"
    classes: tuple[str, ...] = ()  #: as "singleModel", "animation"


def fold_angles(angles: ArrayLike, signs: ArrayLike) -> np.ndarray:
    """Fold angles [deg] of creases, in [-180, 180], positive valley.

    `angles` (C,) between the two triangles [rad], 0 face to face, pi flat, are those of
    `geometry.crease_angles`; `signs` (C,) are +1 mountain, -1 valley.
    """
    turned = -np.asarray(signs) * np.degrees(math.pi - np.asarray(angles))
    # Faces that have passed through each other are bent by more than half a turn.
    return turned - 360 * np.round(turned / 360)


def crease_angles(angles: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Angles (C,) [rad] in [0, pi] between the faces at creases, and their signs (C,).

    From fold angles (C,) [deg] in [-180, 180], of which those of 0 count as valleys. An angle of 0
    is folded face to face, pi flat; a sign of +1 mountain, -1 valley.
    """
    turned = np.asarray(angles, dtype=float)
    return math.pi - np.radians(np.abs(turned)), np.where(turned < 0, MOUNTAIN, VALLEY)


# ------------------------------------------------------------------------- what keys may hold


class _Rule(NamedTuple):
    """What a key holds: one entry or, if they have a `plural`, a list of them, or of lists."""

    name: str  # of the attribute of a FoldFrame
    fits: Callable[[Any, int], bool]  # whether an entry is right, given the number of vertices
    wrong: str  # what is said of one that is not
    plural: str = ""
    of_edges: bool = False  # as many as there are edges
    lengths: Container[int] = ()  # of lists in the list
    length: str = ""  # what is said of others
    make: Callable[[Any], Any] = tuple  # what the attribute becomes


def _array(values, dtype, *shape):
    """A read-only array."""
    array = np.array(values, dtype=dtype).reshape(shape or -1)
    array.setflags(write=False)
    return array


def _is_text(value, _=0):
    return isinstance(value, str)


def _is_number(value, most):
    return type(value) in (int, float) and abs(value) <= most  # a bool is an int, too


def _is_id(value, count):
    return type(value) is int and 0 <= value < count


_TEXT, _TEXTS = "must be a text, not {}", "is {}; must be a list of texts"
_NO_VERTEX = "names {}, which is no vertex{}"
FILE = {
    "file_creator": _Rule("", _is_text, _TEXT, make=str),
    "file_author": _Rule("", _is_text, _TEXT, make=str),
    "file_title": _Rule("", _is_text, _TEXT, make=str),
    "file_description": _Rule("", _is_text, _TEXT, make=str),
    "file_classes": _Rule("", _is_text, _TEXTS, "texts"),
    "file_frames": _Rule(
        "", lambda x, _: isinstance(x, dict), "is {}; must be a list of objects", "objects"
    ),
}
_ANGLES = _Rule(
    "angles",
    lambda x, _: x is None or _is_number(x, 180 + ROUNDED),
    "is {}; must be degrees from -180 to 180",
    "angles",
    of_edges=True,
    make=lambda angles: _array(np.clip(np.array(angles, dtype=float), -180, 180), float),
)
FRAME = {
    "frame_classes": _Rule("classes", _is_text, _TEXTS, "texts"),
    "frame_attributes": _Rule("attributes", _is_text, _TEXTS, "texts"),
    "frame_unit": _Rule("unit", _is_text, _TEXT, make=lambda unit: unit or "unit"),
    "frame_title": _Rule("title", _is_text, _TEXT, make=str),
    "frame_description": _Rule("description", _is_text, _TEXT, make=str),
    "frame_author": _Rule("author", _is_text, _TEXT, make=str),
    "vertices_coords": _Rule(
        "coords",
        lambda x, _: _is_number(x, FARTHEST),
        f"holds {{}}; must be numbers up to {FARTHEST:g}",
        "coordinates",
        lengths=(2, 3),
        length="must be 2 or 3",
        make=lambda points: _array([(*p, 0.0)[:3] for p in points], float, -1, 3),
    ),
    "edges_vertices": _Rule(
        "edges",
        _is_id,
        _NO_VERTEX,
        "vertices",
        lengths=(2,),
        length="an edge has 2",
        make=lambda pairs: _array(pairs, int, -1, 2),
    ),
    "edges_assignment": _Rule(
        "letters",
        lambda x, _: x in [*LETTERS],
        f"is {{}}; must be one of {', '.join(LETTERS)}",
        "letters",
        of_edges=True,
        make=lambda letters: _array(letters, "<U1"),
    ),
    "edges_foldAngles": _ANGLES,  # of specification 1.0
    "edges_foldAngle": _ANGLES,
    "faces_vertices": _Rule(
        "faces",
        _is_id,
        _NO_VERTEX,
        "vertices",
        lengths=range(3, LARGEST_ID),
        length="a face has 3 or more",
        make=lambda loops: tuple(_array(loop, int) for loop in loops),
    ),
}
KEYS = {rule.name: key for key, rule in FRAME.items()}  # to write


def _checked(path, place, value, rule, vertices=LARGEST_ID, edges=0):
    """What a value becomes by its rule; BadFile if it breaks it."""
    if rule.plural and not isinstance(value, list):
        raise BadFile(path, place, f"must be a list, not {shown(value)}")
    if rule.of_edges and len(value) != edges:
        raise BadFile(path, place, f"has {len(value)} {rule.plural} for {edges} edges")
    last = f"; the last is {vertices - 1}" if vertices < LARGEST_ID else ""
    for i, item in enumerate(value if rule.plural else (value,)):
        here = f"{place}[{i}]" if rule.plural else place
        if rule.lengths and not isinstance(item, list):
            raise BadFile(path, here, f"is {shown(item)}; must be a list of {rule.plural}")
        if rule.lengths and len(item) not in rule.lengths:
            raise BadFile(path, here, f"has {len(item)} {rule.plural}; {rule.length}")
        for entry in item if rule.lengths else (item,):
            if not rule.fits(entry, vertices):
                raise BadFile(path, here, rule.wrong.format(shown(entry), last))
        if rule.plural == "vertices" and any(map(eq, item, item[1:] + item[:1])):
            vertex = next(a for a, b in zip(item, item[1:] + item[:1]) if a == b)
            raise BadFile(path, here, f"joins vertex {vertex} to itself")
    return rule.make(value)


# ---------------------------------------------------------------------------------------- reading


def read_fold(path: str | Path) -> FoldFile:
    """Read a FOLD file; every inherited property is filled in, each frame stands for itself.

    BadFile, in one sentence, for whatever is wrong; OSError if the file cannot be opened.
    """
    top = read_object(path)
    _check_spec(path, top)
    about = {key: _checked(path, key, top[key], rule) for key, rule in FILE.items() if key in top}
    others, classes = about.pop("file_frames", ()), about.pop("file_classes", ())
    if len(others) >= MOST_FRAMES:
        raise BadFile(path, "file_frames", f"has {len(others)} frames, {MOST_FRAMES} at most")
    key_frame = {key: value for key, value in top.items() if not key.startswith("file_")}
    raw = _inherited(path, [key_frame, *others])
    _check_size(path, raw)
    reader = _FrameReader(path)
    frames = tuple(reader.frame(number, found) for number, found in enumerate(raw))
    return FoldFile(frames, about, classes)


def _check_spec(path, top):
    """Refuse files of a later specification, which may mean something else by the same words."""
    spec = top.get("file_spec", SPEC)
    number = spec
    if isinstance(spec, str) and is_value(spec):  # as some programs write it
        number = float(spec)
    if not (_is_number(number, 2) and 1 <= number < 2):
        raise BadFile(path, "file_spec", f"is {shown(spec)}; specifications 1 to 1.2 are read")


def _inherited(path, raw):
    """The frames (dicts) with what they inherit from their parents.

    A frame's parent may stand anywhere in the file; a circle of parents is refused.
    """
    parents = [_parent(path, number, frame, len(raw)) for number, frame in enumerate(raw)]
    done: dict = {}
    for number in range(len(raw)):
        chain: list = []
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
        self._made: dict = {}

    def frame(self, number, raw):
        """The FoldFrame of one object."""
        found: dict = {}
        for key, rule in FRAME.items():
            if key in raw:
                vertices = len(found["coords"]) if "coords" in found else LARGEST_ID
                about = vertices, len(found.get("edges", ()))
                # The objects live as long as the file is read, so that their ids stay theirs.
                name = key, id(raw[key]), *about
                if name not in self._made:
                    place = _place(number, key)
                    self._made[name] = _checked(self.path, place, raw[key], rule, *about)
                found[rule.name] = self._made[name]
        if "edges" not in found:  # empty lists, if any
            found |= {"letters": None, "angles": None}
        if found.get("angles") is not None:
            found["angles"] = self._angles(number, found.get("letters"), found["angles"])
        return FoldFrame(**found, custom={key: raw[key] for key in raw if ":" in key})

    def _angles(self, number, letters, angles):
        """The angles (E,), 0 for null on edges that do not fold; refused where letters differ."""
        gaps = np.isnan(angles)  # Origami Simulator writes null where an edge has no angle
        folds = letters is None or np.isin(letters, ("M", "V"))
        other_way = (letters == "M") & (angles > 0) | (letters == "V") & (angles < 0)
        for wrong, said in (
            (gaps & folds, "has no angle (null)"),
            (
                other_way,
                "is {:g} degrees, but its edge is {}; mountains have negative angles, valleys "
                "positive ones",
            ),
        ):
            if np.any(wrong):
                e = int(np.argmax(wrong))
                place = _place(number, f"edges_foldAngle[{e}]")
                letter = "" if letters is None else letters[e]
                raise BadFile(self.path, place, said.format(angles[e], letter))
        return _array(np.where(gaps, 0.0, angles), float) if np.any(gaps) else angles


def _place(number, name):
    """Where in the file: a name in the key frame, or in one of file_frames."""
    return name if number == 0 else f"file_frames[{number - 1}].{name}"


# ---------------------------------------------------------------------------------------- writing


def write_fold(path: str | Path, content: FoldFile) -> None:
    """Write a FOLD file, all of it or nothing; ValueError if `read_fold` would not accept it.

    Frames inherit from the key frame the arrays and tuples that they share with it, which keeps a
    series of folded states short.
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
    values = {key: getattr(frame, name) for name, key in KEYS.items()}
    found = {key: _plain(value) for key, value in values.items() if value is not None}
    found = {key: value for key, value in found.items() if value != ""}
    _FrameReader(path).frame(number, found)
    for key in frame.custom:
        if ":" not in key:
            raise BadFile(path, _place(number, key), "own data need a key with a colon")
    return found | frame.custom


def _plain(value):
    """An attribute of a frame as JSON has it."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    return [_plain(item) for item in value] if isinstance(value, (tuple, list)) else value


def _child(found, frame, first, key_frame):
    """A later frame as an object of JSON (`found`), without what it shares with the key frame."""
    if not found.keys() >= first.keys():
        return found  # it would inherit what it does not have
    lists = {name: key for name, key in KEYS.items() if not key.startswith("frame_")}
    shared = {k for name, k in lists.items() if getattr(frame, name) is getattr(key_frame, name)}
    shared |= {k for k, value in frame.custom.items() if value is key_frame.custom.get(k)}
    own = {key: value for key, value in found.items() if key not in shared}
    return {"frame_parent": 0, "frame_inherit": True, **own}
