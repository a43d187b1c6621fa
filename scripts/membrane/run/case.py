# SPDX-License-Identifier: GPL-2.0-or-later
"""One case, whole or not at all: a result, case.json, that appears when everything else is there.

The case runs in its folder's `unfinished`, where it saves itself now and then; run again after it
was killed, it goes on from there. What it leaves is, byte for byte, what it would have left had it
never been stopped, but for wall_time.json.
"""

from pathlib import Path

from ..files import settle, write_json
from ..parameters import RunParameters
from ..results.case_folder import COMPLETE, DIVERGED, Status, finished, identity
from ..results.own import CASE
from ..results.unfinished import RESULT, SAVED, UNFINISHED, new_results
from . import driver
from .checkpoint import Checkpoints
from .last_good import Diverged


def run_case(
    p: RunParameters, folder: str | Path, checkpoint_every: float = 60.0, pictures: bool = True
) -> Status:
    """Run a case, or go on with it, unless it is there already.

    Parameters
    ----------
    p : RunParameters
    folder : path
        Has case.json when the case is complete, or has diverged: that is a result, too.
    checkpoint_every : float
        Wall time between two checkpoints [s], >= 0.
    pictures : bool
        Draw the case's pictures and write its report.html.

    Raises
    ------
    ValueError
        If `folder` holds another case, also one that is not finished, or the parameters are
        refused.
    """
    folder = Path(folder).absolute()
    checkpoints = Checkpoints(folder / UNFINISHED / SAVED, checkpoint_every)
    about = {**identity(p), "versions": driver.versions()}
    found = finished(folder, about)
    if found and not (folder / UNFINISHED).exists():
        return found
    with new_results(folder, CASE, about) as part:  # waits for another process that runs the case
        if not finished(folder, about) and not (part / RESULT).exists():
            result = _deploy(p, part, checkpoints, pictures)
            settle(part)  # all that a result stands for
            write_json(part / RESULT, {**result, **about})
    found = finished(folder, about)
    assert found  # it is there now
    return found


def _deploy(p, part, checkpoints, pictures):
    """Run the case in `part`; returns its outcome, and of a diverged one when and why."""
    try:
        driver.deploy(p, part, pictures, checkpoints, page=pictures)
    except Diverged as error:
        about = {"stage": error.stage, "time": error.time, "reason": error.reason}
        return {"outcome": DIVERGED, **about}
    return {"outcome": COMPLETE}
