# SPDX-License-Identifier: GPL-2.0-or-later
"""Measures while the machine does nothing else, as far as patience goes."""

import os
import resource
import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

LIMIT = 0.15  # cores busy with something else, below which a machine is quiet
LOOK = 0.5  # [s]; how long to look whether it is
TICKS = os.sysconf("SC_CLK_TCK")  # a second, in /proc

Taken = TypeVar("Taken")


def _busy():
    """Time [s] that all cores were busy, or withheld from this machine by its host."""
    user, nice, system, _, _, irq, soft, stolen = map(
        int, Path("/proc/stat").read_text(encoding="utf-8").split()[1:9]
    )
    return (user + nice + system + irq + soft + stolen) / TICKS


def _children():
    """Processor time [s] of this process's children that run now, and of theirs that have ended."""
    ticks = 0
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_bytes().rpartition(b")")[2].split()
        except OSError:  # it has just ended
            continue
        if int(fields[1]) == os.getpid():
            ticks += sum(map(int, fields[11:15]))
    return ticks / TICKS


def _own():
    """Processor time [s] of this process and of all its children."""
    kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return _children() + sum(u.ru_utime + u.ru_stime for u in map(resource.getrusage, kinds))


class OtherWork:
    """What else the machine does, from the making of this object on."""

    def __init__(self) -> None:
        self.start = time.monotonic(), _busy(), _own()

    def cores(self) -> float:
        """Cores that were busy with something else since, mean."""
        clock, busy, own = self.start
        passed = max(time.monotonic() - clock, 1e-9)
        return max(0.0, (_busy() - busy - (_own() - own)) / passed)


class Quiet:
    """Waits for a quiet machine before a measurement, and repeats one that was disturbed.

    `patience` is the time [s] that may still be lost by that; afterwards every measurement counts,
    and `tell` takes a line when it is at its end.
    """

    def __init__(self, tell: Callable[[str], None] | None = None) -> None:
        self.patience, self.tell = 0.0, tell
        # Cores busy with something else during each measurement that counts.
        self.accepted: list[float] = []

    def _lose(self, start):
        """Count the time since `start` as lost."""
        before, self.patience = self.patience, self.patience - (time.monotonic() - start)
        if before > 0 >= self.patience and self.tell:
            self.tell("the machine does not become quiet: from now on every measurement counts")

    def _wait(self):
        """Wait until the machine is quiet."""
        while self.patience > 0:
            start, others = time.monotonic(), OtherWork()
            time.sleep(LOOK)
            if others.cores() <= LIMIT:
                return
            self._lose(start)

    def measure(self, take: Callable[[], Taken], wait: bool = True) -> Taken:
        """What the function `take` returns, taken while the machine was quiet if `wait`."""
        while True:
            if wait:
                self._wait()
            start, others = time.monotonic(), OtherWork()
            taken, busy = take(), others.cores()
            if not wait or busy <= LIMIT or self.patience <= 0:
                self.accepted.append(busy)
                return taken
            self._lose(start)

    def mark(self, entries: list) -> list:
        """List of Entry, with the other work during what was accepted since the last call."""
        busy, self.accepted = round(statistics.fmean(self.accepted), 2), []
        return [replace(entry, other_work=busy) for entry in entries]
