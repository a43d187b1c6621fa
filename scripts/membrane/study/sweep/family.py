# SPDX-License-Identifier: GPL-2.0-or-later
"""Processes that sweeps in a folder start, found again and ended, whoever started them."""

import hashlib
import os
import select
import signal
import subprocess
from contextlib import suppress
from pathlib import Path

FAMILY = "MEMBRANE_SWEEP"  # variable that tells processes of which folder's sweep they are


def mark(folder: Path) -> dict[str, str]:
    """What all processes that a sweep in a folder starts have in their environment."""
    return {FAMILY: str(folder.resolve())}


def job_name(folder: Path) -> str:
    """Name of all jobs of Slurm that sweeps in a folder start."""
    return f"sweep-{hashlib.sha256(os.fsencode(folder.resolve())).hexdigest()[:8]}"


def end(folder: Path, slurm: bool = False) -> list[int]:
    """Kill all processes that sweeps in a folder have started; returns their ids.

    With `slurm`, jobs there end, too. Cases go on from their checkpoints.
    """
    ended, setting = [], os.fsencode("=".join(*mark(folder).items()))
    while found := _processes(setting):  # again: they may start others
        for number, handle in found.items():
            with suppress(ProcessLookupError):
                signal.pidfd_send_signal(handle, signal.SIGKILL)
            has_ended = select.poll()
            has_ended.register(handle, select.POLLIN)
            has_ended.poll()
            os.close(handle)
            ended.append(number)
    if slurm:
        subprocess.run(["scancel", "--quiet", f"--name={job_name(folder)}"], check=True)
    return ended


def _processes(setting):
    """Handles, by id, of the processes that have a setting, bytes, in their environment."""
    found = {}
    for number in (int(path.name) for path in Path("/proc").iterdir() if path.name.isdecimal()):
        with suppress(OSError):  # it may be another user's, or have ended
            handle = os.pidfd_open(number)  # which never becomes another process's
            try:
                if setting in Path(f"/proc/{number}/environ").read_bytes().split(b"\0"):
                    found[number] = os.dup(handle)
            finally:
                os.close(handle)
    return found
