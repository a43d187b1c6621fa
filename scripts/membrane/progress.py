# SPDX-License-Identifier: GPL-2.0-or-later
"""Progress of long work on the terminal: percentage, simulated time, speed, time left; stages."""

import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import TextIO


class Terminated(BaseException):
    """SIGTERM or SIGHUP has come; as an exception, so that what was begun is cleared away."""


class Progress:
    """Prints a line now and then: rewritten in place on a terminal, every 10 % elsewhere.

    `total` is the simulated time [s] at the end, `stream` standard error by default.
    """

    def __init__(self, label: str, total: float, stream: TextIO | None = None) -> None:
        self.label, self.total, self.stream = label, total, stream or sys.stderr
        self.start, self.shown, self.tenth = time.monotonic(), 0.0, -1

    def update(self, done: float, note: str = "") -> None:
        """Tell that simulated time `done` [s] is reached."""
        wall = max(time.monotonic() - self.start, 1e-9)
        left = max(0.0, self.total - done) * wall / done if done > 0 else 0.0
        text = (
            f"t = {done:.3f} of {self.total:g} s  {done / wall:.3g} simulated s per s  "
            f"{left:.0f} s left{note}"
        )
        self.show(min(1.0, done / self.total) if self.total > 0 else 1.0, text)

    def show(self, share: float, text: str) -> None:
        """Tell that `share` (0 to 1) of the work is done."""
        now, live, tenth = time.monotonic(), self.stream.isatty(), int(10 * share)
        if share < 1 and (now - self.shown < 0.2 if live else tenth == self.tenth):
            return
        self.shown, self.tenth = now, tenth
        line = f"{self.label} {100 * share:3.0f} %  {text}"
        self.stream.write(f"\r\033[K{line}" if live else f"{line}\n")
        if live and share >= 1:
            self.stream.write("\n")
        self.stream.flush()


@contextmanager
def stages(
    label: str, weights: Mapping[str, float], silent: bool = False, stream: TextIO | None = None
) -> Iterator[Callable[[str], None]]:
    """Show by name which stage of some work has begun, and at the end how long all took.

    Gives a function to be called with the name of a stage when it begins. `weights` has the stages
    in turn, each with its share of the time, in any unit; `silent` shows nothing, as is right for
    short work; `stream` is standard error by default.
    """
    progress = Progress(label, 1.0, stream)
    names, total = list(weights), sum(weights.values())

    def begin(name: str) -> None:
        done = sum(weights[earlier] for earlier in names[: names.index(name)])
        if not silent:
            progress.show(done / total, name)

    yield begin
    if not silent:
        progress.show(1.0, f"done in {time.monotonic() - progress.start:.1f} s")


def warn(text: str) -> None:
    """Print a sentence about something doubtful to standard error."""
    print(f"Warning: {text}", file=sys.stderr, flush=True)


def announcer(prefix: str) -> Callable[[str], None]:
    """A function that prints lines of progress to standard error, with the time since now."""
    start = time.monotonic()

    def tell(text: str) -> None:
        print(f"{prefix}: {time.monotonic() - start:5.0f} s: {text}", file=sys.stderr, flush=True)

    return tell
