# SPDX-License-Identifier: GPL-2.0-or-later
"""Output folders: new results appear all at once or not at all, and take the place of earlier ones.

All commands write into `FOLDER/unfinished`, which one process at a time holds; at the end what is
there is moved into FOLDER. A run that can go on keeps there what it takes, too.
"""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ..files import TEMPORARY, BadFile, flush, read_object, settle, write_json
from . import own

UNFINISHED = "unfinished"  # folder within the output folder
GOING, GONE = "earlier.part", "earlier"  # where earlier results are while they are exchanged
BEGUN, SAVED, FAILURE = "begun.json", "checkpoint", "failure.json"  # what runs, how far, its end
RESULT = "case.json"  # comes last: who sees it sees all
IDENTITY = ("sail", "sum_of_file")  # of a case, beside its parameters

# What the commands leave in an output folder: refused at once where it is another's.
OF_A_RUN = """
summary.json wall_time.json history.csv history.units.json shapes sail.fold shapes.png
deployment.png history.png ikaros.png report.html sail.mp4 sail.gif
""".split()
RESULTS = {
    own.RUN: OF_A_RUN,
    own.CASE: [*OF_A_RUN, RESULT],
    own.CALIBRATION: ["calibration.json", "calibration.png", "runs.csv"],
}


class Another(ValueError):
    """A folder holds another case than that which is asked for."""


@contextmanager
def new_results(
    folder: str | Path, kind: str = own.RUN, resume: dict | None = None
) -> Iterator[Path]:
    """Give a folder to write results into, which take the place of earlier ones at the end.

    Where the block ends by an error, `folder` holds what it held before and, in
    `folder`/unfinished, what the run had written; the next run begins by removing that, unless it
    can go on from there: then the reason is kept, too, and it waits for another process's run. What
    is in `folder` and not listed as ours is left alone.

    `kind` is own.RUN, CASE or CALIBRATION. `resume` is what a run that can go on is about, ready
    for JSON: "sail", "parameters" and others; what an earlier process has left that was about the
    same is kept. ValueError if another process writes there, or something of another's or a case
    would be lost.
    """
    folder = Path(folder)
    part = folder / UNFINISHED
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    busy = "" if resume else f"{part}: another run is writing its results there"
    try:
        with own.held(part, busy):
            try:
                _settle(folder, part)
                own.refuse_others(folder, kind, RESULTS[kind])
                _begin(part, resume)
                with _reason_kept(part, resume):
                    yield part
                    _swap(folder, part, kind)
                own.empty(part)
            finally:
                if not own.content(part):
                    own.remove(part)
    finally:
        for path in missing:
            with suppress(OSError):  # which it is where there are results now
                path.rmdir()


def _begin(part, about):
    """Make `part` ready: empty, unless the same was begun there; ValueError if another was."""
    if about and begun(part) == about:
        (part / FAILURE).unlink(missing_ok=True)
        for path in part.rglob(TEMPORARY + "*"):  # of a process that was killed
            path.unlink()
        return
    refuse_begun(part, about)
    own.empty(part)
    if about:
        write_json(part / BEGUN, about)


@contextmanager
def _reason_kept(part, about):
    """Where the block ends by an error, note why for those who look at a run that can go on."""
    try:
        yield
    except Exception as error:
        if about:
            with suppress(OSError):  # a full disk, say, of which `error` tells
                write_json(part / FAILURE, {"reason": str(error) or type(error).__name__})
        raise


def begun(part: Path) -> dict:
    """What a run in `part` that can go on is about; {} if nobody knows."""
    try:
        found = read_object(part / BEGUN)
    except (OSError, BadFile):
        return {}
    return found if isinstance(found.get("parameters"), dict) else {}


def refuse_begun(part: Path, about: dict | None) -> None:
    """Raise ValueError if another case than this has begun in `part`, and has a checkpoint."""
    was = begun(part)
    if was and (part / SAVED).is_dir():
        try:
            refuse_another(part, was, about)
        except Another as error:
            raise ValueError(f"{error}; to lose what it has done, remove {part}") from None


def refuse_another(folder: Path, was: dict, now: dict | None) -> None:
    """Raise Another if a folder's case differs in sail, parameters or the sheet's file.

    `was` is what its files say of it, `now` what a run is about, None: no case.
    """
    if now is None:
        raise Another(f"{folder} holds a case that can go on")
    was, now = ({**{n: d.get(n) for n in IDENTITY}, **d["parameters"]} for d in (was, now))
    for name in sorted({*was, *now}):
        if was.get(name) != now.get(name):
            found, wanted = was.get(name), now.get(name)
            raise Another(f"{folder} holds another case: {name} = {found}, not {wanted}")


def name_of(folder: str | Path) -> str:
    """Name of an output folder, also of one whose results are still being written."""
    path = Path(folder).resolve()
    return path.parent.name if path.name == UNFINISHED else path.name


def _swap(folder, part, kind):
    """Put the results in `part` in the place of earlier ones, and delete those."""
    made = [path.name for path in _results(part) if path.name != own.LIST]
    if not made:
        return
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


def _results(part):
    """What is in `part` of the results, the mark that all are there last."""
    found = [p for p in own.content(part) if p.name not in (BEGUN, SAVED, FAILURE, GOING, GONE)]
    return sorted(found, key=lambda path: path.name == RESULT)


def _settle(folder, part):
    """Go on with an exchange of results, or back if earlier ones are still on their way out.

    Also with one that a kill has cut off: results of two runs must not stay mixed.
    """
    if (part / GOING).exists():
        for path in (part / GOING).iterdir():
            _move(path, folder)
        (part / GOING).rmdir()
    if (part / GONE).exists():
        for path in _results(part):
            if path.name == RESULT:
                flush(folder)
            _move(path, folder)
        flush(folder)
        flush(folder.parent)
        shutil.rmtree(part / GONE)


def _move(path, folder):
    """Move results into a folder, where nothing must be in their way."""
    if os.path.lexists(folder / path.name):
        raise ValueError(f"{folder / path.name} is in the way of {path}: move it away")
    os.rename(path, folder / path.name)
