# SPDX-License-Identifier: GPL-2.0-or-later
"""One case, whole or not at all: a folder that gets its name only when everything is in it.

The case runs in a folder beside it, `NAME.part`, where it saves itself now and then; run again
after it was killed, it goes on from there. What it leaves is, byte for byte, what it would have
left had it never been stopped, but for wall_time.json.
"""

import os
import shutil
from contextlib import suppress
from pathlib import Path

from ..files import TEMPORARY, flush, read_object, settle, write_json
from ..results import own
from ..results.case_folder import BEGUN, COMPLETE, DIVERGED, FAILURE, RESULT, SAVED, finished
from ..results.case_folder import part_of, refuse_another
from . import driver
from .checkpoint import Checkpoints
from .last_good import Diverged


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
        If `folder` holds another case, also one that is not finished, or the parameters are
        refused.
    """
    folder = Path(folder).absolute()
    part = part_of(folder)
    checkpoints = Checkpoints(part / SAVED, checkpoint_every)
    found = finished(folder, p.as_dict())
    if not found:
        with own.held(part):  # waits for another process that runs the case
            found = finished(folder, p.as_dict())
            if not found:
                return finish(p, folder, checkpoints, pictures)
            if not own.content(part):  # made just now
                own.remove(part)
    tidy(folder)
    return found


def tidy(folder):
    """Remove from a finished case what is of use only before."""
    if (folder / BEGUN).exists():  # it may be on a medium that can only be read
        (folder / BEGUN).unlink()
    own.unlock(folder)


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
    about = {"parameters": p.as_dict(), "versions": driver.versions()}
    refuse_another(folder, p.as_dict())
    begin(part, about)
    if not (part / RESULT).exists():
        try:
            result = deploy(p, part, checkpoints, pictures)
        except Exception as error:
            with suppress(OSError):  # a full disk, say, of which `error` tells
                write_json(part / FAILURE, {"reason": str(error) or type(error).__name__})
            raise
        settle(part)  # all that a result stands for
        write_json(part / RESULT, {**result, **about})
    shutil.rmtree(part / SAVED, ignore_errors=True)
    os.rename(part, folder)
    flush(folder.parent)
    tidy(folder)
    return read_object(folder / RESULT)


def deploy(p, part, checkpoints, pictures):
    """Run the case in `part`; returns its outcome, and of a diverged one when and why."""
    try:
        driver.deploy(p, part, pictures, checkpoints, page=pictures)
    except Diverged as error:
        about = {"stage": error.stage, "time": error.time, "reason": error.reason}
        return {"outcome": DIVERGED, **about}
    return {"outcome": COMPLETE}


def begin(part, about):
    """Make `part` ready: empty, unless the same case was begun there by the same versions."""
    try:
        begun = read_object(part / BEGUN)
    except (FileNotFoundError, ValueError):
        begun = None
    if begun == about:
        (part / FAILURE).unlink(missing_ok=True)
        for path in part.rglob(TEMPORARY + "*"):  # of a process that was killed
            path.unlink()
        return
    own.empty(part)
    write_json(part / BEGUN, about)
