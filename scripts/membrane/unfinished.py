# SPDX-License-Identifier: GPL-2.0-or-later
"""Output folders that keep an earlier run's results until a new run has all of its own."""

import fcntl
import os
import shutil
from contextlib import contextmanager, suppress
from pathlib import Path

from .case_folder import PART

UNFINISHED = "unfinished"  # folder within the output folder
LOCK = "lock"
GOING, GONE = "earlier.part", "earlier"  # where earlier results are while they are exchanged

# What the commands leave in an output folder; anything else there is not ours.
RESULTS = (
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
)


@contextmanager
def new_results(folder):
    """Give a folder to write results into, which take the place of earlier ones at the end.

    Where the block ends by an error, `folder` holds what it held before and, in
    `folder`/unfinished, what the run had written; the next run begins by removing that.

    Parameters
    ----------
    folder : path
        Made if missing. Files in it that no run makes are left alone.

    Raises
    ------
    ValueError
        If another process writes results there.
    """
    folder = Path(folder)
    part = folder / UNFINISHED
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    part.mkdir(parents=True, exist_ok=True)
    is_empty = False
    try:
        with _locked(part / LOCK):
            _settle(folder, part)
            for path in _content(part):
                _remove(path)
            try:
                yield part
                _swap(folder, part)
            finally:
                is_empty = not _content(part)
    finally:
        if is_empty:
            shutil.rmtree(part)
            for path in missing:
                with suppress(OSError):  # which it is where there are results now
                    path.rmdir()


def name_of(folder):
    """Name of an output folder, also of one whose results are still being written."""
    path = Path(folder).resolve()
    return path.parent.name if path.name == UNFINISHED else path.name.removesuffix(PART)


@contextmanager
def _locked(path):
    """Hold a file's lock; ValueError if another process does."""
    with open(path, "w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise ValueError(f"{path.parent}: another run is writing its results there") from None
        yield


def _content(part):
    """What a run has written so far."""
    return [path for path in part.iterdir() if path.name != LOCK]


def _swap(folder, part):
    """Put all that is in `part` in the place of earlier results, and delete those."""
    made = _content(part)
    try:
        (part / GOING).mkdir()
        for name in {*RESULTS, *(path.name for path in made)}:
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
            os.rename(path, folder / path.name)
        (part / GOING).rmdir()
    if (part / GONE).exists():
        for path in _content(part):
            if path.name != GONE:
                os.rename(path, folder / path.name)
        shutil.rmtree(part / GONE)


def _remove(path):
    """Delete a file or a folder."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink()
