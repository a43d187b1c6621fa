# SPDX-License-Identifier: GPL-2.0-or-later
"""Checkpoints of a run: the scene, and what else it takes to go on as if it had never stopped."""

import json
import os
import shutil
import time
from pathlib import Path

from yade.wrapper import Omega

from .files import settle

SCENE, STATE = "scene.yade.gz", "state.json"


class Checkpoints:
    """Saved states of a run in a folder of their own; only the newest is kept.

    Each is a folder that gets its name when it is complete and on the disk.

    Parameters
    ----------
    folder : path
        Made by the first save.
    every : float
        Wall time [s] between two saves, >= 0; 0: at every occasion.
    """

    def __init__(self, folder, every):
        if not every >= 0:
            raise ValueError(f"checkpoint_every = {every} s must be >= 0")
        self.folder, self.every = Path(folder), every
        self._last = time.monotonic()

    def due(self):
        """Whether it is time for the next one."""
        return time.monotonic() - self._last >= self.every

    def save(self, state):
        """Save the scene and `state`, which must go into JSON."""
        older = self._complete()
        name = f"{int(older[-1].name) + 1 if older else 0:08d}"
        part = self.folder / f"{name}.part"
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir(parents=True)
        try:
            Omega().save(str(part / SCENE), quiet=True)
        except RuntimeError as error:  # which else would look as if the run had gone wrong
            raise OSError(f"{part}: could not be saved: {error}") from error
        (part / STATE).write_text(json.dumps(state, allow_nan=False))
        settle(part)
        os.rename(part, self.folder / name)
        for folder in older:
            shutil.rmtree(folder)
        self._last = time.monotonic()

    def load(self):
        """Load the scene of the newest one; returns its state, None if there is none.

        One that cannot be read is thrown away: the run then begins afresh.
        """
        for folder in reversed(self._complete()):
            try:
                state = json.loads((folder / STATE).read_text())
                Omega().load(str(folder / SCENE), quiet=True)
                return state
            except (OSError, ValueError, RuntimeError):
                Omega().reset()
                shutil.rmtree(folder)
        return None

    def _complete(self):
        """Folders of the complete ones, the oldest first."""
        if not self.folder.is_dir():
            return []
        return sorted(path for path in self.folder.iterdir() if path.name.isdecimal())
