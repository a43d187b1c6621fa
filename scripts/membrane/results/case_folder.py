# SPDX-License-Identifier: GPL-2.0-or-later
"""Folders of cases: names of their files, and what has become of a case. Needs no YADE."""

import fcntl
import os
import sys
from dataclasses import dataclass, field, fields
from pathlib import Path

import numpy as np

from ..files import BadFile, read_object, shown
from ..parameters import KINDS, SailParameters
from .history import read_history
from .own import LOCK

COMPLETE, DIVERGED = "complete", "diverged"  # outcomes: the case is finished
FAILED, KILLED, RUNNING, MISSING = "failed", "killed", "running", "not begun"
DAMAGED = "damaged"  # there is a result, which cannot be used

HISTORY = "history.csv"
CURVES = ("time", "deployment_rate", "phase_difference")  # columns that it must have

RESULT = "case.json"  # what came of the case
FAILURE = "failure.json"  # in the folder NAME.part: why there is none
BEGUN, SAVED = "begun.json", "checkpoint"  # in NAME.part only
PART = ".part"
LAST_GOOD = "last_good.yade.gz"  # scene of a run that went wrong


def part_of(folder):
    """The folder in which a case runs until it is finished."""
    return folder.with_name(folder.name + PART)


def finished(folder, wanted=None):
    """What is in the case.json of a finished case.

    Parameters
    ----------
    folder : Path
    wanted : dict, optional
        Parameters that it must have.

    Returns
    -------
    dict or None
        None if there is no such folder.

    Raises
    ------
    Damaged
        If it holds no case, or one that is not whole.
    ValueError
        If it holds one of other parameters.
    """
    if not os.path.lexists(folder):
        return None
    try:
        found = _result(folder)
        _compare(folder, found["parameters"], wanted)
        _curves(folder, found)
    except (BadFile, OSError) as error:
        raise Damaged(f"{error}; {advice(folder)}") from None
    return found


class Damaged(ValueError):
    """A folder that should hold a finished case, and does not."""


def advice(folder):
    """What the user can do about a damaged case, or a folder that holds something else."""
    if not any((folder / name).exists() for name in (RESULT, HISTORY)):
        return "choose another folder"
    return f"the case is damaged: remove {folder}, and the same command runs it again"


def _compare(folder, parameters, wanted):
    """Raise ValueError if the parameters of the case of a folder are not those `wanted`."""
    for name in sorted({*wanted, *parameters} if wanted else ()):
        was, now = parameters.get(name), wanted.get(name)
        if was != now:
            raise ValueError(f"{folder} holds another case: {name} = {was}, not {now}")


def _result(folder):
    """What is in the case.json of a folder; BadFile or OSError if that cannot be a result."""
    path = folder / RESULT
    if not path.exists():
        raise BadFile(path, "", "is missing")
    found = read_object(path)
    outcome = found.get("outcome")
    if outcome not in (COMPLETE, DIVERGED):
        raise BadFile(path, "outcome", f"is {shown(outcome)}; must be {COMPLETE} or {DIVERGED}")
    check_parameters(path, "parameters", found.get("parameters"))
    if not isinstance(found.get("versions"), dict):
        raise BadFile(path, "versions", f"must be an object, not {shown(found.get('versions'))}")
    if outcome == DIVERGED:
        time, reason = found.get("time"), found.get("reason")
        if not (time is None or _is_number(time)):
            raise BadFile(path, "time", f"is {shown(time)}; must be a number or null")
        if not isinstance(reason, str):
            raise BadFile(path, "reason", f"is {shown(reason)}; must be a text")
    return found


def _curves(folder, found):
    """CURVES of a case with this case.json; None if it diverged before the first row.

    Raises
    ------
    BadFile or OSError
        If it is not whole.
    """
    path = folder / HISTORY
    is_complete = found["outcome"] == COMPLETE
    if not path.exists():
        if is_complete:
            raise BadFile(path, "", "is missing")
        return None
    history = read_history(path)
    for name in CURVES:
        if name not in history:
            raise BadFile(path, "line 1", f"names no column {name}")
    if np.any(np.diff(history["time"]) <= 0):
        row = int(np.argmax(np.diff(history["time"]) <= 0)) + 1
        raise BadFile(path, f"line {row + 2}, time", "must be later than in the line before")
    if len(history["time"]):
        return {name: history[name].copy() for name in CURVES}  # the others are not kept
    if is_complete:
        raise BadFile(path, "", "has no row")
    return None


def check_parameters(path, place, values):
    """Raise BadFile unless `values`, of a `place` in a file, can be parameters of a case.

    Names of another version are let pass.
    """
    if not isinstance(values, dict):
        raise BadFile(path, place, f"must be an object, not {shown(values)}")
    for name, value in values.items():
        if not (isinstance(value, (bool, str)) or _is_number(value)):
            where = f"{place}.{shown(name)[1:-1]}"
            raise BadFile(path, where, f"is {shown(value)}; must be a number or a text")
    kind = KINDS.get(values.get("sail"), SailParameters)
    known = {item.name for item in fields(kind)}
    try:
        kind(**{name: value for name, value in values.items() if name in known})
    except ValueError as error:
        raise BadFile(path, place, str(error)) from None


def _is_number(value):
    """Whether a value from JSON is a number that a float can be."""
    is_real = isinstance(value, (int, float)) and not isinstance(value, bool)
    return is_real and abs(value) <= sys.float_info.max


@dataclass
class Status:
    """What has become of a case.

    Attributes
    ----------
    folder : Path
        Of the case, be it there or not.
    state : str
        COMPLETE, DIVERGED, FAILED, KILLED, RUNNING, MISSING or DAMAGED.
    reason : str
        Why, unless it is complete.
    parameters : dict
        By name; empty if nobody knows.
    versions : dict
        Of what it was made with.
    time : float or None
        When it diverged, after the release [s]; None if before.
    history : dict of (S,) float or None
        CURVES of a finished case by name; None where there are no rows.
    """

    folder: Path
    state: str
    reason: str = ""
    parameters: dict = field(default_factory=dict)
    versions: dict = field(default_factory=dict)
    time: float | None = None
    history: dict | None = None

    @property
    def name(self):
        """Of the case."""
        return self.folder.name

    @property
    def is_finished(self):
        """Whether there is a result."""
        return self.state in (COMPLETE, DIVERGED)


def refuse_another(folder, wanted):
    """Raise ValueError if another case has begun to run for a folder, and has a checkpoint.

    Parameters
    ----------
    folder : Path
        Of the case.
    wanted : dict
        Parameters that it must have.
    """
    part = part_of(folder)
    begun, _ = _begun(part / BEGUN)
    if begun and (part / SAVED).is_dir():
        try:
            _compare(part, begun, wanted)
        except ValueError as error:
            raise ValueError(f"{error}; to lose what it has done, remove {part}") from None


def look(folder, wanted=None):
    """The Status of the case of a folder; DAMAGED if it is finished with others than `wanted`.

    Parameters
    ----------
    folder : path
    wanted : dict, optional
        Parameters that it must have.
    """
    folder = Path(folder)
    if os.path.lexists(folder):
        return _look_at_result(folder, wanted)
    part = part_of(folder)
    if not part.is_dir():
        return Status(folder, MISSING, "it has not been run yet")
    about = _begun(part / BEGUN)
    failure = _read(part / FAILURE)
    if _locked(part / LOCK):
        return Status(folder, RUNNING, "it is still running", *about)
    if failure:
        reason = failure.get("reason")
        return Status(folder, FAILED, reason if isinstance(reason, str) else "unknown", *about)
    saved = "it will go on from its last checkpoint" if (part / SAVED).is_dir() else ""
    reason = "it was stopped from outside" + (f"; {saved}" if saved else "")
    return Status(folder, KILLED, reason, *about)


def _look_at_result(folder, wanted):
    """The Status of a case whose folder is there."""
    about = {}, {}
    try:
        found = _result(folder)
        about = found["parameters"], found["versions"]
        _compare(folder, found["parameters"], wanted)
        history = _curves(folder, found)
    except (ValueError, OSError) as error:
        return Status(folder, DAMAGED, str(error), *about)
    outcome, reason, time = (found.get(name) for name in ("outcome", "reason", "time"))
    return Status(folder, outcome, reason or "", *about, time, history)


def _begun(path):
    """Parameters and versions of a case that is not finished; {} where nobody knows."""
    begun = _read(path)
    parameters, versions = begun.get("parameters"), begun.get("versions")
    try:
        check_parameters(path, "parameters", parameters)
    except BadFile:
        parameters = {}
    return parameters, versions if isinstance(versions, dict) else {}


def _read(path):
    """The object in a JSON file; {} if there is none."""
    try:
        return read_object(path)
    except (FileNotFoundError, BadFile):
        return {}


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
