# SPDX-License-Identifier: GPL-2.0-or-later
"""Stops a process at a file operation that a test names: see `Halt` in processes.py.

Python imports a module of this name when it starts, where this folder is in PYTHONPATH.
"""

import os
import re
import signal
import sys

CHANGES = {"os.rename", "os.remove", "os.mkdir", "os.rmdir", "shutil.rmtree"}
WRITING = os.O_WRONLY | os.O_RDWR


def watch(order):
    """Stop this process at each operation from the one on that the file `order` names."""
    with open(order) as file:
        number, pattern = file.read().split(maxsplit=1)
    count, found = int(number), re.compile(pattern)

    def hook(event, arguments):
        nonlocal count
        if event not in CHANGES and not (event == "open" and arguments[2] & WRITING):
            return
        paths = (os.fspath(a) for a in arguments if isinstance(a, (str, os.PathLike)))
        if any(map(found.search, paths)) and os.path.exists(order):
            count -= 1
            if count <= 0:
                os.kill(os.getpid(), signal.SIGSTOP)

    sys.addaudithook(hook)


if os.path.exists(os.environ.get("HALT", "")):
    watch(os.environ["HALT"])
