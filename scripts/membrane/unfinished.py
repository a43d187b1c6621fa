# SPDX-License-Identifier: GPL-2.0-or-later
"""Output folders that keep an earlier run's results until a new run has all of its own."""

import os
import shutil
from contextlib import contextmanager, suppress
from pathlib import Path

from . import own
from .case_folder import PART
from .files import flush, settle

UNFINISHED = "unfinished"  # folder within the output folder
GOING, GONE = "earlier.part", "earlier"  # where earlier results are while they are exchanged

# What the commands leave in an output folder: refused at once where it is another's.
RESULTS = {
    own.RUN: (
        "summary.json",
        "wall_time.json",
        "history.csv",
        "history.units.json",
        "shapes",
        "sail.fold",
        "shapes.png",
        "deployment.png",
        "history.png",
        "ikaros.png",
        "report.html",
        "sail.mp4",
        "sail.gif",
    ),
    own.CALIBRATION: ("calibration.json", "calibration.png", "runs.csv"),
}


@contextmanager
def new_results(folder, kind=own.RUN):
    """Give a folder to write results into, which take the place of earlier ones at the end.

    Where the block ends by an error, `folder` holds what it held before and, in
    `folder`/unfinished, what the run had written; the next run begins by removing that.

    Parameters
    ----------
    folder : path
        Made if missing. What is in it and not listed as ours is left alone.
    kind : str
        Of the results: own.RUN or own.CALIBRATION.

    Raises
    ------
    ValueError
        If another process writes results there, or something of another's would be lost.
    """
    folder = Path(folder)
    part = folder / UNFINISHED
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    busy = f"{part}: another run is writing its results there"
    try:
        with own.held(part, busy):
            try:
                _settle(folder, part)
                own.refuse_others(folder, kind, RESULTS[kind])
                own.empty(part)
                yield part
                _swap(folder, part, kind)
            finally:
                if not own.content(part):
                    own.remove(part)
    finally:
        for path in missing:
            with suppress(OSError):  # which it is where there are results now
                path.rmdir()


def name_of(folder):
    """Name of an output folder, also of one whose results are still being written."""
    path = Path(folder).resolve()
    return path.parent.name if path.name == UNFINISHED else path.name.removesuffix(PART)


def _swap(folder, part, kind):
    """Put all that is in `part` in the place of earlier results, and delete those."""
    made = [path.name for path in own.content(part)]
    own.refuse_others(folder, kind, made)
    earlier = own.listed(folder, kind)
    own.write_list(part, kind, made)  # which goes the way of the results
    if earlier:  # they are removed for what must be on the disk
        settle(part)
    try:
        (part / GOING).mkdir()
        for name in {*earlier, own.LIST}:
            if os.path.lexists(folder / name):
                os.rename(folder / name, part / GOING / name)
        os.rename(part / GOING, part / GONE)
    finally:
        _settle(folder, part)


def _settle(folder, part):
    """Go on with an exchange of results, or back if earlier ones are still on their way out.

    Also with one that a kill has cut off: results of two runs must not stay mixed.
    """
    if (part / GOING).exists():
        for path in (part / GOING).iterdir():
            _move(path, folder)
        (part / GOING).rmdir()
    if (part / GONE).exists():
        for path in own.content(part):
            if path.name != GONE:
                _move(path, folder)
        flush(folder)
        shutil.rmtree(part / GONE)


def _move(path, folder):
    """Move results into a folder, where nothing must be in their way."""
    if os.path.lexists(folder / path.name):
        raise ValueError(f"{folder / path.name} is in the way of {path}: move it away")
    os.rename(path, folder / path.name)
