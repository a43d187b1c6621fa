# SPDX-License-Identifier: GPL-2.0-or-later
"""What is ours in the folders of users: nothing else is ever removed, renamed or replaced.

A folder that is ours as a whole has a file `lock`, made with it, that says so. A folder of the
user's that holds results has a file `.membrane` that names them. Needs no YADE.
"""

import errno
import fcntl
import os
import shutil
import stat
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path, PurePath

from ..files import BadFile, read_object, shown, write_json

LOCK = "lock"
OURS = b"made by membrane, which may remove this folder and all that is in it\n"  # in a lock
LIST = ".membrane"
RUN, CASE, CALIBRATION, SWEEP = "a run", "a case", "a calibration", "a sweep"  # kinds of results


@contextmanager
def held(folder: Path, busy: str = "") -> Iterator[None]:
    """Hold a folder that is ours as a whole, and is made if it is missing, as the only process.

    `busy` is what to say if another process holds it; "": wait for that one. ValueError if it is
    not ours, another process holds it, or somebody has put a link into it.
    """
    while True:
        lock = _open_lock(folder)
        try:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | (fcntl.LOCK_NB if busy else 0))
            except BlockingIOError:
                raise ValueError(busy) from None
            if _is_at(lock, folder / LOCK):  # else it was removed meanwhile
                _claim(lock, folder)
                yield
                return
        finally:
            os.close(lock)


def _open_lock(folder):
    """Descriptor of the lock of a folder; both are made if they are missing."""
    with suppress(FileExistsError):  # if it is a file, what follows says so
        folder.parent.mkdir(parents=True)
    while True:
        with suppress(FileExistsError):
            folder.mkdir()
        names = []
        try:
            if not stat.S_ISDIR(os.lstat(folder).st_mode):
                raise ValueError(_not_ours(folder))
            names = os.listdir(folder)
            # Nothing is put into a folder that may be another's: only an empty one can become ours.
            new = 0 if names else os.O_CREAT
            return os.open(folder / LOCK, os.O_RDWR | os.O_NOFOLLOW | new, 0o666)
        except FileNotFoundError:  # another process may just be removing it
            if names and LOCK not in names:
                raise ValueError(_not_ours(folder)) from None
        except OSError as error:
            if error.errno != errno.ELOOP:
                raise
            raise ValueError(_not_ours(folder)) from error


def _is_at(handle, path):
    """Whether an open file is still the one at `path`."""
    try:
        return os.path.samestat(os.fstat(handle), os.lstat(path))
    except FileNotFoundError:
        return False


def _claim(lock, folder):
    """Mark a folder that was made just now as ours; ValueError unless it is."""
    is_file = stat.S_ISREG(os.fstat(lock).st_mode)
    content = os.pread(lock, len(OURS) + 1, 0) if is_file else b""
    if content != OURS:
        if content or not is_file or os.listdir(folder) != [LOCK]:
            raise ValueError(_not_ours(folder))
        os.pwrite(lock, OURS, 0)
        os.fsync(lock)  # before anything else is in it: after a power cut, too, it is ours
    for path in folder.rglob("*"):
        if path.is_symlink():
            raise ValueError(f"{path} is a symbolic link, which is not followed: remove it")


def _not_ours(folder):
    return (
        f"{folder} was not made by this version of membrane, whose mark is the file {LOCK}: "
        "move it away, or choose another folder"
    )


def content(folder: Path) -> list[Path]:
    """What is in a folder beside its lock."""
    return [path for path in folder.iterdir() if path.name != LOCK]


def empty(folder: Path) -> None:
    """Remove all that is in a folder that is held."""
    for path in content(folder):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()


def remove(folder: Path) -> None:
    """Remove a folder that is held, with all that is in it."""
    empty(folder)
    (folder / LOCK).unlink()
    with suppress(OSError):  # another process may have begun to use it
        folder.rmdir()


def listed(folder: Path, kind: str) -> set[str]:
    """Names of the results in a folder of the user's that are ours to replace.

    ValueError if it holds results of another kind, or the list is not ours.
    """
    found, names = _list(folder)
    if found not in (None, kind):
        raise ValueError(f"{folder} holds {shown(found)[1:-1]}: choose another folder")
    return names


def _list(folder):
    """Kind of the results in a folder, None if there are none, and their names."""
    path = folder / LIST
    if not os.path.lexists(path):
        return None, set()
    found = read_object(path)
    names = found.get("made")
    if not isinstance(names, list) or not all(map(_is_name, names)):
        raise BadFile(path, "made", "must be a list of names of files")
    return found.get("kind", ""), set(names)


def _is_name(name):
    """Whether a value is the name of something in a folder."""
    return isinstance(name, str) and name not in ("", "..") and PurePath(name).name == name


def write_list(folder: Path, kind: str, names: Iterable[str]) -> None:
    """Note in a folder of the user's which results in it are ours to replace."""
    write_json(folder / LIST, {"membrane": "made these", "kind": kind, "made": sorted(names)})


def add_to_list(folder: Path, names: Iterable[str]) -> None:
    """Add names to the list of a folder, if it has one; ValueError if one is another's."""
    kind, ours = _list(folder)
    if kind is not None:
        refuse_others(folder, kind, names)
        write_list(folder, kind, ours | set(names))


def refuse_others(folder: Path, kind: str, names: Iterable[str]) -> None:
    """Raise ValueError if a folder holds something under one of some names that is not ours."""
    ours = listed(folder, kind)
    for name in names:
        if name not in ours and os.path.lexists(folder / name):
            raise ValueError(
                f"{folder / name} was not made by this version of membrane, and would be lost: "
                "move it away, or choose another folder"
            )
