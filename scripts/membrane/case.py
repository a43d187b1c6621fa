# SPDX-License-Identifier: GPL-2.0-or-later
"""One case, whole or not at all: a folder that gets its name only when everything is in it.

The case runs in a folder beside it, `NAME.part`, where it saves itself now and then; run again
after it was killed, it goes on from there. What it leaves is, byte for byte, what it would have
left had it never been stopped, but for wall_time.json.
"""

import fcntl
import json
import os
import shutil
from pathlib import Path

from . import sail
from .case_folder import (
    BEGUN,
    COMPLETE,
    DIVERGED,
    FAILURE,
    LOCK,
    RESULT,
    SAVED,
    finished,
    part_of,
)
from .checkpoint import Checkpoints
from .files import settle, write_json


def run_case(p, folder, checkpoint_every=60.0, pictures=True):
    """Run a case, or go on with it, unless it is there already.

    Parameters
    ----------
    p : SailParameters
    folder : path
        Made when the case is complete, or has diverged: that is a result, too.
    checkpoint_every : float
        Wall time between two checkpoints [s], >= 0.
    pictures : bool
        Draw the case's pictures and write its report.html.

    Returns
    -------
    dict
        What is in case.json: `outcome`, `parameters`, `versions`; if diverged, `stage`, `time` [s]
        and `reason`.

    Raises
    ------
    ValueError
        If `folder` holds another case, or the parameters are refused.
    """
    folder = Path(folder).absolute()
    part = part_of(folder)
    checkpoints = Checkpoints(part / SAVED, checkpoint_every)
    found = finished(folder, p.as_dict())
    while not found:
        part.mkdir(parents=True, exist_ok=True)
        with open(part / LOCK, "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # waits for another process that runs the case
            if still_there(lock, part / LOCK):
                found = finished(folder, p.as_dict()) or finish(p, folder, checkpoints, pictures)
            else:
                found = finished(folder, p.as_dict())
                if still_there(lock, folder / LOCK):  # made in the moment before it was renamed
                    (folder / LOCK).unlink()
    return found


def still_there(file, path):
    """Whether an open file is still the one at `path`."""
    try:
        return os.path.samestat(os.fstat(file.fileno()), os.stat(path))
    except FileNotFoundError:
        return False


def finish(p, folder, checkpoints, pictures):
    """Run the case from the beginning or its last checkpoint; the lock must be held.

    Parameters
    ----------
    p, folder, pictures
        As of `run_case`.
    checkpoints : Checkpoints

    Returns
    -------
    dict
        What is in case.json.
    """
    part = part_of(folder)
    about = {"parameters": p.as_dict(), "versions": sail.versions()}
    begin(part, about)
    if not (part / RESULT).exists():
        try:
            result = deploy(p, part, checkpoints, pictures)
        except Exception as error:
            write_json(part / FAILURE, {"reason": str(error) or type(error).__name__})
            raise
        write_json(part / RESULT, {**result, **about})
    shutil.rmtree(part / SAVED, ignore_errors=True)
    settle(part)
    (part / BEGUN).unlink()
    (part / LOCK).unlink()
    os.rename(part, folder)
    return json.loads((folder / RESULT).read_text())


def deploy(p, part, checkpoints, pictures):
    """Run the case in `part`; returns its outcome, and of a diverged one when and why."""
    try:
        sail.deploy(p, part, pictures, checkpoints, page=pictures)
    except sail.Diverged as error:
        about = {"stage": error.stage, "time": error.time, "reason": error.reason}
        return {"outcome": DIVERGED, **about}
    return {"outcome": COMPLETE}


def begin(part, about):
    """Make `part` ready: empty, unless the same case was begun there by the same versions."""
    try:
        begun = json.loads((part / BEGUN).read_text())
    except (FileNotFoundError, ValueError):
        begun = None
    if begun == about:
        (part / FAILURE).unlink(missing_ok=True)
        return
    for path in part.iterdir():
        if path.is_dir():
            shutil.rmtree(path)
        elif path.name != LOCK:
            path.unlink()
    write_json(part / BEGUN, about)
