# SPDX-License-Identifier: GPL-2.0-or-later
"""What is saved of a run that goes wrong, or is stopped: its last good state."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from yade.wrapper import Omega

from .. import scene
from ..progress import Terminated
from ..results.case_folder import LAST_GOOD
from ..results.output import NotFinite
from .checkpoint import save_scene

SPIN_UP, RUN = "spin_up", "run"  # stages


class Diverged(RuntimeError):
    """A run went wrong, as another one with the same parameters will.

    Attributes
    ----------
    stage : str
        SPIN_UP or RUN.
    time : float or None
        When the last step began, after the release [s]; None if it came not so far.
    reason : str
        What the engine said that stopped it.
    """

    def __init__(self, stage: str, time: float | None, reason: str, saved: str = "") -> None:
        super().__init__(". ".join(filter(None, [reason, saved])))
        self.stage, self.time, self.reason = stage, time, reason


@contextmanager
def last_good_saved(
    sail: scene.MembraneScene, folder: str | Path, release_step: int, stopped: bool = True
) -> Iterator[None]:
    """Where the run in the block goes wrong or is stopped, save its last good state and say so.

    Parameters
    ----------
    sail : MembraneScene
    folder : path
    release_step : int
        Of YADE, at which time after the release is 0.
    stopped : bool
        Also after Ctrl-C and other signals, not only where it goes wrong.

    Raises
    ------
    Diverged
        If it went wrong.
    """
    scene_now = Omega()
    try:
        yield
    except (RuntimeError, NotFinite) as error:
        time = (scene_now.iter - release_step) * scene_now.dt
        raise Diverged(RUN, time, str(error), save_last_good(sail, folder)) from error
    except (KeyboardInterrupt, Terminated) as error:
        if not stopped:
            raise
        raise type(error)(save_last_good(sail, folder)) from None


def save_last_good(sail: scene.MembraneScene, folder: str | Path) -> str:
    """Put a MembraneScene back to its last good state, saved in `folder`; returns a sentence."""
    try:
        time = sail.watch.restore()
    except RuntimeError as error:
        return f"No good state could be saved ({error})"
    path = Path(folder) / LAST_GOOD
    scene.renew_collider()
    tags = Omega().tags
    for name in tags.keys():
        tags[name] = ""  # else two files of one state would differ by day and machine
    save_scene(path)
    return f"The last good state, of t = {time:.6g} s on YADE's clock, is in {path}"
