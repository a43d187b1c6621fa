# SPDX-License-Identifier: GPL-2.0-or-later
"""What can be attacked, every attribute and method of every class; and values that fit nowhere."""

import re
from pathlib import Path

import membrane
import numpy as np
from membrane import _load
from yade import wrapper as yade

NAN, INF = float("nan"), float("inf")
NUMBERS = (NAN, INF, -INF, -1.0, 0.0, 1e308, -1e308, 5e-324)
WHOLES = (-1, 0, 1, 10**5, 2**31 - 1, -(2**31), 2**63 - 1, -(2**63))
TEXTS = ("", "conservative", "x" * 10**5, "\0\n")
MISFITS = (None, "text", b"\xff", object(), [], [None], {}, 2**80, 1j, np.zeros((2, 2)), np.int8)
MANY = 20_000  # entries of a list that is too long

# What YADE lets be changed of a body without dying by itself.
OF_BODIES = {
    "state.pos": "Vector3r",
    "state.vel": "Vector3r",
    "state.angVel": "Vector3r",
    "state.inertia": "Vector3r",
    "state.mass": "Real",
    "state.blockedDOFs": "string",
    "state": "another",  # YADE dies of a body without, and of a shape without functors
    "shape": "another",
    "mat": "shared_ptr<FrictMat>",
    "mask": "int",
    "bounded": "bool",
    "dynamic": "bool",
}

CLASSES = {name: getattr(membrane, name) for name in membrane.__all__ if name not in _load.ALIASES}
SOURCES = Path(__file__).resolve().parents[2] / "pkg" / "membrane"
DECLARATION = re.compile(r"YADE_CLASS_BASE_DOC\w*\((\w+),|\(\(([\w<>]+(?: \w+)?), (\w+), ")


def _own_attributes():
    """Types of the plugin's attributes by class and name, hidden ones too, as its sources tell."""
    found = {}
    for file in sorted(SOURCES.glob("*.[ch]pp")):
        for cls, kind, name in DECLARATION.findall(file.read_text()):
            if cls:
                found[cls] = of_class = {}
            else:
                of_class[name] = kind
    return found


OWN = _own_attributes()


def attributes(cls):
    """Types by name of all attributes of a class of the plugin, with those that YADE gives it."""
    kinds = {}
    for base in reversed(cls.__mro__):
        kinds.update(OWN.get(base.__name__, {}))
    usual = {bool: "bool", int: "int", float: "Real", str: "string", list: "vector<int>"}
    for name, value in cls().dict().items():
        kinds.setdefault(name, usual.get(type(value), type(value).__name__))
    if issubclass(cls, yade.Material):
        del kinds["id"]  # by which YADE looks it up, without a check, when it loads a scene
    return kinds


def methods(cls):
    """Names of the methods of a class of the plugin, not those that are YADE's own."""
    ours = [vars(base) for base in cls.__mro__ if base.__name__ in OWN]
    found = {name for names in ours for name, member in names.items() if callable(member)}
    found = {name for name in found if not name.startswith("__")}
    return sorted(found | {"__call__"} if issubclass(cls, yade.Engine) else found)


def _entries(kind):
    """Entries that a list should not have."""
    if kind == "Real":
        return NUMBERS
    if kind == "int":
        return WHOLES
    if kind == "string":
        return TEXTS
    size = int(kind[6])  # as in Vector3r
    return [(one,) * size for one in (NUMBERS if kind.endswith("r") else WHOLES)]


def values(kind, present, objects):
    """What an attribute of a type in C++ may be set to, to no good.

    Parameters
    ----------
    kind : str
    present : object
        Its value now; None if it is hidden.
    objects : sequence
        Of the scene, to which pointers may point.
    """
    pointer, list_of = (re.match(rf"{outer}<(\w+)>", kind) for outer in ("shared_ptr", "vector"))
    if pointer:
        cls = getattr(yade, pointer[1])
        return [cls(), cls(), *(one for one in objects if isinstance(one, cls)), *MISFITS]
    if list_of:
        now, bad = list(present or []), _entries(list_of[1])
        lists = [now[:-1], now[1:], now[::-1], now + now[:1], bad[:1] * MANY]
        for one in bad:
            lists += [[one], [one] * 6, [one] * len(now), now[:-1] + [one]]
        return [*lists, *MISFITS]
    simple = {"bool": (True, False), "int": WHOLES, "long": WHOLES, "string": TEXTS}
    if kind.startswith("Vector"):
        return [*_entries("Vector3r"), *MISFITS]
    return [*simple.get(kind, NUMBERS), *MISFITS]


def is_senseless(value):
    """Whether a value holds a number that is not finite, which nobody can mean."""
    if value is None:
        return False
    try:
        return not np.all(np.isfinite(np.array(value, dtype=float)))
    except (TypeError, ValueError, OverflowError):
        return False
