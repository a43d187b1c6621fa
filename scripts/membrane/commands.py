# SPDX-License-Identifier: GPL-2.0-or-later
"""How the commands of scripts/ end where something is wrong: one sentence and an exit status."""

import sys
from contextlib import contextmanager

STOPPED = 130  # exit status of what Ctrl-C stops, as shells have it


@contextmanager
def plain_errors(command, stopped="stopped by Ctrl-C"):
    """End the program with one sentence where what is inside raises an error that is foreseen.

    Parameters
    ----------
    command : str
        Name that the sentence begins with.
    stopped : str
        What to say after Ctrl-C.
    """
    try:
        yield
    except KeyboardInterrupt:
        print(f"\n{command}: {stopped}", file=sys.stderr)
        sys.exit(STOPPED)
    except (ValueError, RuntimeError, OSError) as error:
        sys.exit(f"{command}: {error}")
