# SPDX-License-Identifier: GPL-2.0-or-later
"""The commands of scripts/, a module each; their options, the batch's table, their errors.

Run them by `scripts/run.sh NAME [options]`, or by `yade -n -x scripts/NAME.py [options]`.
"""

import importlib
import sys
from typing import Any

from .errors import plain_errors


def run(
    command: str, stopped: str = "stopped by Ctrl-C", module: str | None = None, **options: Any
) -> None:
    """Run `main` of a command's module; if it returns anything, that is the exit status.

    `stopped` is what to say after Ctrl-C, `module` is where the command is if that does not have
    its name; `options` are those of its `main`.
    """
    with plain_errors(command, stopped):  # a package that is imported may be missing
        found = importlib.import_module(f".{module or command}", __name__)
        status = found.main(**options)
        if status is not None:
            sys.exit(status)
