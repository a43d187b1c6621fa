# SPDX-License-Identifier: GPL-2.0-or-later
"""YADE's own 3D view with membranes in it: open it, keep it alive, take pictures of it.

A script holds the thread that the window needs: call `Window.refresh` now and then, or leave the
script, so that YADE's prompt takes care of the window.
"""

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from yade import runtime
from yade import wrapper as yade

from ..scene import MembraneScene

PATIENCE = 60.0  # s, for a window or a picture that never comes


def require_display() -> None:
    """Raise RuntimeError, in one sentence, if YADE runs without a display."""
    if not runtime.hasDisplay:
        raise RuntimeError(
            "window: YADE runs without a display; start it without -n, where DISPLAY is set"
        )


def show(
    membrane: yade.Membrane | None = None,
    *,
    direction: Sequence[float] = (0.35, 0.55, -0.75),
    size: tuple[int, int] = (900, 700),
    **attributes: Any,
) -> "Window":
    """Open YADE's 3D view, or take the one that is open, with membranes as coloured triangles.

    Parameters
    ----------
    membrane : Membrane, optional
        The one to draw; default: all that have a MembraneForceEngine in the scene.
    direction : 3 floats
        Along which to look; z points up on the screen, or y if the look goes along z.
    size : 2 ints
        Of the window [pixels].
    **attributes
        Of GlExtra_Membrane: strainRange, drawSides, hideNodes, …

    Raises
    ------
    RuntimeError
        If there is no display, or the window does not open.
    """
    require_display()
    from yade import qt

    drawer = yade.GlExtra_Membrane(membrane=membrane, **attributes)
    renderer = qt.Renderer()
    others = [d for d in renderer.extraDrawers if not isinstance(d, yade.GlExtra_Membrane)]
    renderer.extraDrawers = [*others, drawer]
    view = qt.views()[0] if qt.views() else qt.View(PATIENCE)
    view.screenSize = size
    window = Window(view, drawer)
    drawn = [membrane] if membrane else _membranes()
    if drawn:
        window.look(_extent(drawn), direction)
    window.redraw()
    return window


class Window:
    """YADE's 3D view: `view` is YADE's handle of it, a GLViewer.

    Attributes of `drawer`, a GlExtra_Membrane, may be changed at any time.
    """

    def __init__(self, view: Any, drawer: Any) -> None:
        self.view, self.drawer = view, drawer

    @property
    def is_open(self) -> bool:
        """Whether the user has left it open."""
        from yade import qt

        return bool(qt.views())

    def look(self, corners: np.ndarray, direction: Sequence[float]) -> None:
        """Look along `direction` (3,) at a box with two opposite `corners` (2, 3) [m]."""
        centre, radius = np.mean(corners, axis=0), 0.5 * np.linalg.norm(np.ptp(corners, axis=0))
        along = np.array(direction, dtype=float) / np.linalg.norm(direction)
        self.view.sceneRadius = radius
        self.view.upVector = (0, 1, 0) if abs(along[2]) > 0.999 else (0, 0, 1)
        self.view.viewDir = along.tolist()
        self.view.fitSphere(centre.tolist(), radius)

    def refresh(self, seconds: float = 0.0) -> None:
        """Let it answer the user and draw, for at least `seconds` [s]."""
        from PyQt5.QtWidgets import QApplication

        end = time.monotonic() + seconds
        QApplication.processEvents()
        while time.monotonic() < end:
            QApplication.processEvents()
            time.sleep(0.01)

    def redraw(self) -> None:
        """Wait until the present state has been drawn."""
        # The one under way may have begun before.
        wanted = self.drawer.frames + 2
        self._refresh_until(lambda: self.drawer.frames >= wanted or self.drawer.dead, "no picture")

    def snapshot(self, path: Path | str) -> Path:
        """Write a picture of the present state, .png or as `path` ends; returns the Path.

        OSError if it cannot be written; RuntimeError if the window does not draw.
        """
        from PyQt5.QtWidgets import QApplication, QOpenGLWidget

        # YADE's own saveSnapshot writes JPEG whatever the name, and does not say when.
        (widget,) = [w for w in QApplication.topLevelWidgets() if isinstance(w, QOpenGLWidget)]
        self.redraw()
        if not widget.grabFramebuffer().save(str(path)):
            raise OSError(f"{path}: could not be written")
        return Path(path)

    def wait(self) -> None:
        """Wait until the user closes it."""
        while self.is_open:
            self.refresh(0.05)

    def close(self) -> None:
        """Close it."""
        if self.is_open:
            self.view.close()
            self._refresh_until(lambda: not self.is_open, "it does not close")
            self.refresh(0.5)  # YADE takes it down a quarter of a second later

    def _refresh_until(self, done, complaint):
        end = time.monotonic() + PATIENCE
        while not done():
            if time.monotonic() > end:
                raise RuntimeError(f"window: {complaint} in {PATIENCE:g} s")
            self.refresh(0.02)


class Watch:
    """Follows a run: opens the window at the first call and refreshes it at further ones.

    Drawing takes no more than half of the time, however slow it is.
    """

    def __init__(self) -> None:
        require_display()
        self.window: Window | None = None
        self._next = 0.0

    def __call__(self, sail: MembraneScene) -> None:
        """Look at a MembraneScene."""
        if self.window is None:
            self.window = show(sail.membrane)
        begin = time.monotonic()
        if begin < self._next:
            return
        self.window.refresh()
        end = time.monotonic()
        self._next = end + max(0.02, end - begin)

    def wait(self) -> None:
        """Wait until the user closes the window."""
        if self.window:
            self.window.wait()


def _membranes():
    """The membranes that have a MembraneForceEngine in the scene."""
    engines = (e for e in yade.Omega().engines if isinstance(e, yade.MembraneForceEngine))
    return [e.membrane for e in engines if e.membrane]


def _extent(membranes):
    """Opposite corners (2, 3) [m] of a box around `membranes`, as they are and at rest."""
    bodies = yade.Omega().bodies
    points = [np.array(membrane.nodes) for membrane in membranes]
    for membrane in membranes:
        places = [bodies[i].state.pos for i in membrane.bodyIds]
        points += [np.array(places)] if places else []
    every = np.concatenate(points)
    return np.array([every.min(axis=0), every.max(axis=0)])
