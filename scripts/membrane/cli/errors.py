# SPDX-License-Identifier: GPL-2.0-or-later
"""How the commands of scripts/ end where something is wrong: one sentence and an exit status."""

import linecache
import os
import re
import signal
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .. import _load
from ..progress import Terminated

STOPPED, TERMINATED = 130, 143  # exit statuses after Ctrl-C and SIGTERM, as shells have them
DEBUG = "MEMBRANE_DEBUG"  # variable of the environment: show where errors come from
PACKAGE = Path(__file__).resolve().parents[1]
PLUGIN = rf"({'|'.join(_load.CLASSES)})\b"  # how messages of its classes begin
DEBIAN = {"vtkmodules": "vtk9"}  # packages whose names in Python and in Debian differ


@contextmanager
def plain_errors(command: str, stopped: str = "stopped by Ctrl-C") -> Iterator[None]:
    """End the program with one sentence where what is inside raises an error that is foreseen.

    The sentence begins with the name of the `command`; `stopped` is what to say after Ctrl-C. What
    a command imports besides the standard library belongs inside, too: a package may be missing.
    With MEMBRANE_DEBUG=1 it shows the traceback, too. Other errors are faults of the program: a
    traceback, and what to do with it.
    """
    # Under nohup SIGHUP is ignored, and stays so.
    heard = [s for s in (signal.SIGTERM, signal.SIGHUP) if signal.getsignal(s) != signal.SIG_IGN]
    before = {number: signal.signal(number, _terminate) for number in heard}
    with suppress(AttributeError):  # of a caller's own
        getattr(sys.stdout, "reconfigure")(errors="backslashreplace")  # as standard error
    try:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])  # which scripts/run.sh blocks
        yield
    except (KeyboardInterrupt, Terminated) as error:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the end is near, and must not be disturbed
        by_hand = isinstance(error, KeyboardInterrupt)
        sentence = stopped if by_hand else "terminated"
        print(f"\n{command}: {'. '.join(filter(None, [sentence, str(error)]))}", file=sys.stderr)
        sys.exit(STOPPED if by_hand else TERMINATED)
    except MemoryError as error:
        sys.exit(f"{command}: there is not enough memory" + (f": {error}" if str(error) else ""))
    except ModuleNotFoundError as error:
        package = (error.name or "").partition(".")[0]
        if package == "yade":
            sys.exit(f"{command}: no YADE is running; scripts/run.sh {command} starts it")
        command_line = f"apt-get install python3-{DEBIAN.get(package, package)}"
        sys.exit(
            f"{command}: {error}; scripts/run.sh {command} installs it, or by hand: {command_line}"
        )
    except BrokenPipeError:
        sys.exit(f"{command}: its output is no longer read")
    except Exception as error:
        if not _is_foreseen(error):
            traceback.print_exc()
            sys.exit(
                f"{command}: this is a bug in the program, not in its input; please report "
                "it with the lines above, the command and its files"
            )
        if os.environ.get(DEBUG, "0") not in ("", "0"):
            traceback.print_exc()
        sys.exit(f"{command}: {str(error) or type(error).__name__}")
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _is_foreseen(error):
    """Whether an error is one that this package or its plugin raises itself, or the system's."""
    if isinstance(error, (ImportError, OSError)):
        return True
    if not isinstance(error, (ValueError, RuntimeError)):
        return False
    frame, line = list(traceback.walk_tb(error.__traceback__))[-1]
    file = frame.f_code.co_filename
    raised = linecache.getline(file, line).lstrip().startswith("raise ")
    is_ours = PACKAGE in Path(file).resolve().parents
    return raised and is_ours or re.match(PLUGIN, str(error)) is not None


def _terminate(number, frame):
    raise Terminated
