# SPDX-License-Identifier: GPL-2.0-or-later
"""Processes that tests stop, go on with and kill, at places that their speed does not change."""

import os
import signal
import time
from contextlib import suppress
from itertools import count
from pathlib import Path

from support import scratch, yade_environment

_numbers = count()


def children(pid):
    """Ids of the processes that a process started; none if it has ended."""
    try:
        tasks = list(Path(f"/proc/{pid}/task").iterdir())
        return [int(child) for task in tasks for child in (task / "children").read_text().split()]
    except (FileNotFoundError, ProcessLookupError):
        return []


def family(pid):
    """Ids of a process and of all that it and they started, the oldest first."""
    found = [pid]
    for one in found:
        found += children(one)
    return found


def send(pid, number):
    """Send a signal to a process, if it has not ended meanwhile."""
    with suppress(ProcessLookupError):
        os.kill(pid, number)


def kill(process):
    """kill -9 of a process and of everything that it started, in whatever session."""
    ids = [process.pid]
    for pid in ids:
        send(pid, signal.SIGSTOP)  # so that it starts no more
        ids += children(pid)
    for pid in ids:
        send(pid, signal.SIGKILL)
    process.communicate()


class Halt:
    """A place where a command and what it starts stop, each by itself, until told to go on.

    Parameters
    ----------
    pattern : str
        Regular expression of a path. Python code that is about to write, rename or remove such a
        file or folder stops.
    number : int
        At which operation of this kind a process stops first, from 1; it does at all later ones.
    """

    def __init__(self, pattern, number=1):
        self._order = scratch() / f"halt_{next(_numbers)}"
        self._order.write_text(f"{number} {pattern}")

    def environment(self):
        """Environment variables of the command."""
        variables = yade_environment()
        path = os.pathsep.join([str(Path(__file__).parent / "halting"), variables["PYTHONPATH"]])
        return {**variables, "PYTHONPATH": path, "HALT": str(self._order)}

    def wait(self, process):
        """Id of a process that has stopped; AssertionError if the command ends before."""
        while process.poll() is None:
            for pid in family(process.pid):
                if state(pid) == "T":
                    return pid
            time.sleep(0.001)
        raise AssertionError(f"it came to its end: {process.communicate()}")

    def wait_until(self, process, reached):
        """The same, of the first stop at which `reached()` is true."""
        while pid := self.wait(process):
            if reached():
                return pid
            os.kill(pid, signal.SIGCONT)

    def lift(self):
        """From now on nothing stops any more."""
        self._order.unlink()


def state(pid):
    """State of a process by one letter, as ps(1) gives it."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return "X"
