# SPDX-License-Identifier: GPL-2.0-or-later
"""How the commands of scripts/ end where something is wrong: one sentence and an exit status."""

import sys
from contextlib import contextmanager

STOPPED = 130  # exit status of what Ctrl-C stops, as shells have it
DEBIAN = {"vtkmodules": "vtk9"}  # packages whose names in Python and in Debian differ


@contextmanager
def plain_errors(command, stopped="stopped by Ctrl-C"):
    """End the program with one sentence where what is inside raises an error that is foreseen.

    What a command imports beside the standard library belongs inside, too: a package may be
    missing.

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
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        by_hand = f"apt-get install python3-{DEBIAN.get(package, package)}"
        sys.exit(f"{command}: {error}; scripts/run.sh {command} installs it, or by hand: {by_hand}")
    except (ImportError, ValueError, RuntimeError, OSError, MemoryError) as error:
        sys.exit(f"{command}: {error or type(error).__name__}")
