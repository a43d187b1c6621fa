# SPDX-License-Identifier: GPL-2.0-or-later
"""Folders of cases: what a case is, and what has become of one. Needs no YADE."""

import fcntl
import os
import sys
from dataclasses import dataclass, field, fields
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from ..files import BadFile, add_to_sum, read_object, shown
from ..measures import EVERY
from ..parameters import KINDS, RunParameters
from . import own
from .history import read_history
from .unfinished import FAILURE, RESULT, SAVED, UNFINISHED, begun, refuse_another

COMPLETE, DIVERGED = "complete", "diverged"  # outcomes: the case is finished
FAILED, KILLED, RUNNING, MISSING = "failed", "killed", "running", "not begun"
DAMAGED = "damaged"  # there is a result, which cannot be used

LAST_GOOD = "last_good.yade.gz"  # scene of a run that went wrong
HISTORY, UNITS, SUMMARY = "history.csv", "history.units.json", "summary.json"


class Damaged(ValueError):
    """A folder that should hold a finished case, and does not."""


@dataclass
class Status:
    """What has become of a case, be its folder there or not."""

    folder: Path
    state: str  # COMPLETE, DIVERGED, FAILED, KILLED, RUNNING, MISSING or DAMAGED
    reason: str = ""  # why, unless it is complete
    about: dict = field(default_factory=dict)  # its `identity` and "versions"; {}: nobody knows
    time: float | None = None  # when it diverged, after the release [s]; None: before
    history: dict = field(default_factory=dict)  # columns (S,) that are drawn, by name
    measures: dict = field(default_factory=dict)  # what summary.json tells of a complete case

    @property
    def name(self) -> str:
        """Of the case."""
        return self.folder.name

    @property
    def is_finished(self) -> bool:
        """Whether there is a result."""
        return self.state in (COMPLETE, DIVERGED)

    @property
    def parameters(self) -> dict:
        """By name, with "sail", the kind of sail; empty if nobody knows."""
        return {"sail": self.about["sail"], **self.about["parameters"]} if self.about else {}


def identity(p: RunParameters) -> dict:
    """What tells a case from others: sail, parameters, and what is in the sheet's file, if any."""
    about = {"sail": p.sail, "parameters": p.as_dict()}
    file = getattr(p, "file", "")
    return {**about, "sum_of_file": add_to_sum(sha256(), file).hexdigest()} if file else about


def look(folder: str | Path, wanted: dict | None = None) -> Status:
    """The Status of the case of a folder; DAMAGED if it is finished, and other than `wanted`."""
    folder = Path(folder)
    try:
        found = finished(folder, wanted)
    except ValueError as error:
        return Status(folder, DAMAGED, str(error))
    if found:
        return found
    part = folder / UNFINISHED
    if not part.is_dir():
        return Status(folder, MISSING, "it has not been run yet")
    about = _known(part)
    if _locked(part / own.LOCK):
        return Status(folder, RUNNING, "it is still running", about)
    try:
        reason = read_object(part / FAILURE).get("reason")
        return Status(folder, FAILED, reason if isinstance(reason, str) else "unknown", about)
    except (FileNotFoundError, BadFile):
        saved = "; it will go on from its last checkpoint" if (part / SAVED).is_dir() else ""
        return Status(folder, KILLED, f"it was stopped from outside{saved}", about)


def finished(folder: Path, wanted: dict | None = None) -> Status | None:
    """The Status of the finished case in a folder; None if there is none yet.

    Damaged if it holds something else, or a case that is not whole; Another if it holds another
    case than `wanted`.
    """
    if not os.path.lexists(folder) or _is_begun(folder):
        return None
    try:
        found = _result(folder)
        if wanted:
            refuse_another(folder, found, wanted)
        is_complete = found["outcome"] == COMPLETE
        history = _history(folder, is_complete)
        measures = _measures(folder / SUMMARY) if is_complete else {}
    except (BadFile, OSError) as error:
        raise Damaged(f"{error}; {_advice(folder)}") from None
    reason, time = found.get("reason", ""), found.get("time")
    return Status(folder, found["outcome"], reason, found, time, history, measures)


def _is_begun(folder):
    """Whether there is no more than an unfinished case in a folder, or a new one."""
    if os.path.lexists(folder / RESULT) or not folder.is_dir():
        return False
    return (folder / UNFINISHED).is_dir() or not any(folder.iterdir())


def _advice(folder):
    """What the user can do about a damaged case, or a folder that holds something else."""
    try:
        is_a_case = bool(own.listed(folder, own.CASE)) or (folder / RESULT).exists()
    except (ValueError, OSError):
        is_a_case = False
    if not is_a_case:
        return "choose another folder"
    return f"the case is damaged: remove {folder}, and the same command runs it again"


def _result(folder):
    """What is in the case.json of a folder; BadFile or OSError if that cannot be a result."""
    path = folder / RESULT
    if not path.exists():
        raise BadFile(path, "", "is missing")
    found = read_object(path)
    outcome = found.get("outcome")
    if outcome not in (COMPLETE, DIVERGED):
        raise BadFile(path, "outcome", f"is {shown(outcome)}; must be {COMPLETE} or {DIVERGED}")
    check_identity(path, "", found)
    _object(path, "versions", found.get("versions"))
    if outcome == DIVERGED:
        time, reason = found.get("time"), found.get("reason")
        if not (time is None or _is_number(time)):
            raise BadFile(path, "time", f"is {shown(time)}; must be a number or null")
        if not isinstance(reason, str):
            raise BadFile(path, "reason", f"is {shown(reason)}; must be a text")
    return found


def check_identity(path: Path, place: str, about: Any) -> None:
    """Raise BadFile unless what a `place` in a file holds can tell what a case is.

    Names of parameters of another version are let pass.
    """
    _object(path, place, about)
    below = f"{place}.parameters".removeprefix(".")
    sail, values = about.get("sail"), _object(path, below, about.get("parameters"))
    for name, value in values.items():
        if not (isinstance(value, (bool, str)) or _is_number(value)):
            where = f"{below}.{shown(name)[1:-1]}"
            raise BadFile(path, where, f"is {shown(value)}; must be a number or a text")
    if not (isinstance(sail, str) and sail in KINDS):
        where, kinds = f"{place}.sail".removeprefix("."), ", ".join(KINDS)
        raise BadFile(path, where, f"is {shown(sail)}; must be one of {kinds}")
    known = {item.name for item in fields(KINDS[sail])}
    try:
        KINDS[sail](**{name: value for name, value in values.items() if name in known})
    except ValueError as error:
        raise BadFile(path, below, str(error)) from None


def _object(path: Path, place: str, value: Any) -> dict:
    """The value of a place in a file; BadFile if it is no object."""
    if not isinstance(value, dict):
        raise BadFile(path, place, f"must be an object, not {shown(value)}")
    return value


def _history(folder, is_complete):
    """Columns (S,) of the history of a case that are drawn; {} if it diverged before the first row.

    BadFile or OSError if it is not whole.
    """
    path = folder / HISTORY
    if not path.exists() and not is_complete:
        return {}
    history = read_history(path) if path.exists() else {}
    for name in read_object(folder / UNITS) if history else ["time"]:
        if name not in history:
            reason = f"line 1: names no column {name}" if history else "is missing"
            raise BadFile(path, "", reason)
    times = history["time"]
    if np.any(np.diff(times) <= 0):
        row = int(np.argmax(np.diff(times) <= 0)) + 1
        raise BadFile(path, f"line {row + 2}, time", "must be later than in the line before")
    if is_complete and not len(times):
        raise BadFile(path, "", "has no row")
    drawn = ["time", *(m.name for m in EVERY if m.plot and not m.minor)]
    return {n: history[n].copy() for n in drawn if n in history} if len(times) else {}


def _measures(path):
    """What a summary.json tells among its measures: numbers, and None where there is none."""
    found = _object(path, "measures", read_object(path).get("measures"))
    for name, value in found.items():
        if not (value is None or _is_number(value)):
            where = f"measures.{shown(name)[1:-1]}"
            raise BadFile(path, where, f"is {shown(value)}; must be a number or null")
    return found


def _is_number(value):
    """Whether a value from JSON is a number that a float can be."""
    is_real = isinstance(value, (int, float)) and not isinstance(value, bool)
    return is_real and abs(value) <= sys.float_info.max


def _known(part):
    """What an unfinished case is about; {} where nobody knows."""
    about = begun(part)
    try:
        check_identity(part, "", about)
    except BadFile:
        return {}
    return about


def _locked(path):
    """Whether a process holds the lock of a case."""
    try:
        with open(path, "rb") as lock:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except FileNotFoundError:
        return False
    except BlockingIOError:
        return True
    return False
