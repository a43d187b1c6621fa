# SPDX-License-Identifier: GPL-2.0-or-later
"""The commands of scripts/, a module each; their options, the batch's table, their errors.

Run them by `scripts/run.sh NAME [options]`, or by `yade -n -x scripts/NAME.py [options]`.
"""

import importlib
import sys

from .errors import plain_errors


def run(command, stopped="stopped by Ctrl-C"):
    """Run `main` of a command's module; if it returns anything, that is the exit status.

    Parameters
    ----------
    command : str
    stopped : str
        What to say after Ctrl-C.
    """
    with plain_errors(command, stopped):  # a package that is imported may be missing
        status = importlib.import_module(f".{command}", __name__).main()
        if status is not None:
            sys.exit(status)
