# SPDX-License-Identifier: GPL-2.0-or-later
"""Checkpoints of a run: the scene, and what else it takes to go on as if it had never stopped."""

import json
import os
import shutil
import subprocess
import time
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import yade.config
from yade.wrapper import Omega

from ..files import add_to_sum, flush, read_object, replace_text, settle

SCENE, STATE = "scene.yade.gz", "state.json"
KEPT = 2  # checkpoints: should the newest turn out to be damaged, there is one to go back to


class Checkpoints:
    """Saved states of a run in a folder of their own; only the newest are kept.

    Each is a folder that gets its name when it is complete and on the disk.

    Parameters
    ----------
    folder : path
        Made by the first save.
    every : float
        Wall time [s] between two saves, >= 0; 0: at every occasion.
    """

    def __init__(self, folder: str | Path, every: float) -> None:
        if not every >= 0:
            raise ValueError(f"checkpoint_every = {every} s must be >= 0")
        self.folder, self.every = Path(folder), every
        self._last = time.monotonic()

    def due(self) -> bool:
        """Whether it is time for the next one."""
        return time.monotonic() - self._last >= self.every

    def save(self, state: dict) -> None:
        """Save the scene and `state`, which must go into JSON and tell of what is on the disk.

        Raises
        ------
        OSError
            If there is no room, say; the earlier ones stay.
        """
        older = self._complete()
        name = f"{int(older[-1].name) + 1 if older else 0:08d}"
        part = self.folder / f"{name}.part"
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir(parents=True)
        try:
            save_scene(part / SCENE)
            content = {"state": state, "scene": _sum_of(part / SCENE), "yade": _this_yade()}
            replace_text(part / STATE, json.dumps({**content, "sum": _sum(content)}))
            settle(part)
            os.rename(part, self.folder / name)
        except BaseException:
            shutil.rmtree(part, ignore_errors=True)
            raise
        flush(self.folder)
        for folder in older[: 1 - KEPT]:
            shutil.rmtree(folder)
        self._last = time.monotonic()

    def load(self, is_whole: Callable[[dict], bool] = lambda state: True) -> dict | None:
        """Load the scene of the newest one that is whole; returns its state, None if there is none.

        Others are thrown away: the run continues from an older one, or starts afresh. So are those
        of another YADE, whose classes have other attributes.

        Parameters
        ----------
        is_whole : callable
            Whether all that a state tells of is still there.
        """
        for folder in reversed(self._complete()):
            state = _whole_state(folder)
            if state is not None and is_whole(state):
                try:
                    Omega().load(str(folder / SCENE), quiet=True)
                    return state
                except MemoryError:  # it is whole, and there may be room the next time
                    raise
                except Exception:
                    Omega().reset()
            shutil.rmtree(folder)
        return None

    def _complete(self):
        """Folders of the complete ones, the oldest first."""
        if not self.folder.is_dir():
            return []
        return sorted(path for path in self.folder.iterdir() if path.name.isdecimal())


def _whole_state(folder):
    """The state of a checkpoint; None if its files are not what was saved."""
    try:
        content = read_object(folder / STATE)
        said = content.pop("sum", None)
        if said == _sum(content) and content["scene"] == _sum_of(folder / SCENE):
            if content["yade"] == _this_yade():
                return content["state"]
            there, here = content["yade"], _this_yade()
            print(f"{folder} was saved by YADE {there}; this is {here}, which cannot continue it")
    except (OSError, ValueError, KeyError):
        pass
    return None


def _this_yade():
    """Its version."""
    return yade.config.version.strip()


def _sum(content):
    """Checksum of what goes into JSON."""
    return sha256(json.dumps(content, allow_nan=False).encode()).hexdigest()


def _sum_of(path):
    """Checksum of a file."""
    return add_to_sum(sha256(), path).hexdigest()


def save_scene(path: str | Path) -> None:
    """Save the scene as O.save does, compressed.

    YADE's own compression tries for ever where there is no room on the disk.

    Raises
    ------
    OSError
    """
    with open(path, "wb") as file:
        pack = subprocess.Popen(
            ["gzip", "-cn6"],
            stdin=subprocess.PIPE,
            stdout=file,
            stderr=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C is for us
        )
    failure = ""
    assert pack.stdin  # it is a pipe
    with pack:
        try:
            Omega().save(f"/proc/self/fd/{pack.stdin.fileno()}", quiet=True)
        except RuntimeError as error:  # which else would look as if the run had gone wrong
            failure = str(error)
        said = pack.communicate()[1].decode(errors="replace").strip()
    if failure or pack.returncode:
        reason = said or failure or f"gzip ended with {pack.returncode}"
        raise OSError(f"{path}: could not be saved: {reason}")
