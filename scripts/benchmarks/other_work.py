# SPDX-License-Identifier: GPL-2.0-or-later
"""How busy the machine was with something else than the measurements."""

import os
import resource
import time
from pathlib import Path


def _busy():
    """Time [s] that all cores were busy, or withheld from this machine by its host."""
    user, nice, system, _, _, irq, soft, stolen = map(
        int, Path("/proc/stat").read_text().split()[1:9]
    )
    return (user + nice + system + irq + soft + stolen) / os.sysconf("SC_CLK_TCK")


def _own():
    """Processor time [s] of this process and of all its children that have ended."""
    kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return sum(used.ru_utime + used.ru_stime for used in map(resource.getrusage, kinds))


class OtherWork:
    """Counts from its making on."""

    def __init__(self):
        self.start = time.monotonic(), _busy(), _own()

    def cores(self):
        """Cores that were busy with something else since the start, mean.

        Of this process's own children it knows only those that have ended.
        """
        clock, busy, own = self.start
        passed = max(time.monotonic() - clock, 1e-9)
        return max(0.0, (_busy() - busy - (_own() - own)) / passed)
