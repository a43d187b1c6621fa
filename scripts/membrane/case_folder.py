# SPDX-License-Identifier: GPL-2.0-or-later
"""Folders of cases: names of their files, and what has become of a case. Needs no YADE."""

import fcntl
import json
from dataclasses import dataclass, field
from pathlib import Path

COMPLETE, DIVERGED = "complete", "diverged"  # outcomes: the case is finished
FAILED, KILLED, RUNNING, MISSING = "failed", "killed", "running", "not begun"

RESULT = "case.json"  # what came of the case
FAILURE = "failure.json"  # in the folder NAME.part: why there is none
BEGUN, LOCK, SAVED = "begun.json", "lock", "checkpoint"  # in NAME.part only
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
    ValueError
        If it holds no case, or one of other parameters.
    """
    if not folder.exists():
        return None
    try:
        found = json.loads((folder / RESULT).read_text())
    except FileNotFoundError:
        raise ValueError(f"{folder} is there already and holds no case") from None
    for name in sorted({*wanted, *found["parameters"]} if wanted else ()):
        was, now = found["parameters"].get(name), wanted.get(name)
        if was != now:
            raise ValueError(f"{folder} holds another case: {name} = {was}, not {now}")
    return found


@dataclass
class Status:
    """What has become of a case.

    Attributes
    ----------
    folder : Path
        Of the case, be it there or not.
    state : str
        COMPLETE, DIVERGED, FAILED, KILLED, RUNNING or MISSING.
    reason : str
        Why, unless it is complete.
    parameters : dict
        By name; empty if nobody knows.
    versions : dict
        Of what it was made with.
    time : float or None
        When it diverged, after the release [s]; None if before.
    """

    folder: Path
    state: str
    reason: str = ""
    parameters: dict = field(default_factory=dict)
    versions: dict = field(default_factory=dict)
    time: float | None = None

    @property
    def name(self):
        """Of the case."""
        return self.folder.name

    @property
    def is_finished(self):
        """Whether there is a result."""
        return self.state in (COMPLETE, DIVERGED)


def look(folder):
    """The Status of the case of a folder."""
    folder = Path(folder)
    found = finished(folder)
    if found:
        about = found["parameters"], found["versions"], found.get("time")
        return Status(folder, found["outcome"], found.get("reason", ""), *about)
    part = part_of(folder)
    if not part.is_dir():
        return Status(folder, MISSING, "it has not been run yet")
    about = _read(part / BEGUN)
    about = about.get("parameters", {}), about.get("versions", {})
    failure = _read(part / FAILURE)
    if _locked(part / LOCK):
        return Status(folder, RUNNING, "it is still running", *about)
    if failure:
        return Status(folder, FAILED, failure["reason"], *about)
    saved = "it will go on from its last checkpoint" if (part / SAVED).is_dir() else ""
    reason = "it was stopped from outside" + (f"; {saved}" if saved else "")
    return Status(folder, KILLED, reason, *about)


def _read(path):
    """A JSON file's content; {} if there is none."""
    try:
        return json.loads(path.read_text())
    except (FileNotFoundError, ValueError):
        return {}


def _locked(path):
    """Whether a process holds the lock of a case."""
    try:
        with open(path) as lock:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except FileNotFoundError:
        return False
    except BlockingIOError:
        return True
    return False
