# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs the cases of a sweep by yade-batch, shows how far they are, and tells what stopped them."""

import os
import select
import signal
import subprocess
import time
from contextlib import contextmanager, suppress
from pathlib import Path

from membrane import own
from membrane.case_folder import DAMAGED, FAILED, KILLED, MISSING, RUNNING, advice, look, part_of
from membrane.files import replace_text
from membrane.progress import Progress

from .grid import CASES, table

BATCH = "batch"  # folder of the table and of what yade-batch and the jobs say
FAMILY = "MEMBRANE_SWEEP"  # variable that tells processes of which folder's sweep they are
ROUNDS = 3  # how often in one sweep a case is started that was stopped from outside
SCRIPT = Path(__file__).resolve().parents[1] / "case.py"
LOOK = 0.5  # [s], between two looks at the cases


@contextmanager
def alone(folder, tell):
    """Hold the sweep's lock; ValueError if another process sweeps in this folder.

    Ends what an earlier sweep has left behind that was killed: yade-batch outlives it.
    """
    busy = f"another sweep is running in {folder}"
    with own.held(folder / BATCH, busy, links={SCRIPT.name}):
        ended = end(folder)
        if ended:
            tell(f"ended {', '.join(map(str, ended))}, processes that a killed sweep had left here")
        yield


def end(folder):
    """Kill all processes that sweeps in a folder have started; returns their ids.

    Jobs go on from their checkpoints.
    """
    ended = []
    while found := _processes(os.fsencode(_family(folder))):  # again: they may start others
        for number, handle in found.items():
            with suppress(ProcessLookupError):
                signal.pidfd_send_signal(handle, signal.SIGKILL)
            has_ended = select.poll()
            has_ended.register(handle, select.POLLIN)
            has_ended.poll()
            os.close(handle)
            ended.append(number)
    return ended


def _family(folder):
    """What all processes that a sweep in a folder starts have in their environment."""
    return f"{FAMILY}={folder.resolve()}"


def _processes(mark):
    """Handles, by id, of the processes that have a setting `mark` in their environment."""
    found = {}
    for number in (int(path.name) for path in Path("/proc").iterdir() if path.name.isdecimal()):
        with suppress(OSError):  # it may be another user's, or have ended
            handle = os.pidfd_open(number)  # which never becomes another process's
            try:
                if mark in Path(f"/proc/{number}/environ").read_bytes().split(b"\0"):
                    found[number] = os.dup(handle)
            finally:
                os.close(handle)
    return found


def run(folder, cases, jobs, checkpoint_every, pictures, tell):
    """Run those cases that are not finished yet.

    Cases that were stopped from outside are started again, alone, up to ROUNDS times. Damaged ones
    are told, and left as they are.

    Parameters
    ----------
    folder : Path
        Of the sweep.
    cases : dict of SailParameters by name
    jobs : int
        How many run at once, each on one thread.
    checkpoint_every : float
        Wall time between two checkpoints of a case [s].
    pictures : bool
        Draw each case's own pictures and write its page.
    tell : callable
        Takes a line of text for the user.
    """
    here = folder / CASES

    def states(names):
        return {name: look(here / name, cases[name].as_dict()) for name in names}

    before = states(cases)
    for name, status in before.items():
        if status.state == DAMAGED:
            tell(f"{status.reason}; {advice(status.folder)}")
    cases = {name: p for name, p in cases.items() if before[name].state != DAMAGED}
    left = {name: p for name, p in cases.items() if not before[name].is_finished}
    if len(left) < len(cases):
        tell(f"{len(cases) - len(left)} of {len(cases)} cases are there already")
    for name in left:
        if before[name].state in (FAILED, KILLED):
            tell(f"{name} {before[name].state} before: {before[name].reason}; it runs again")
    for turn in range(ROUNDS):
        if not left:
            break
        _batch(folder, cases, left, jobs, checkpoint_every, pictures)
        now = states(left)
        for name, status in now.items():
            if status.state == FAILED:
                tell(f"{name} failed: {status.reason}")
            elif status.state == DAMAGED:
                tell(f"{status.reason}; {advice(status.folder)}")
            elif not status.is_finished:
                again = "" if turn + 1 == ROUNDS else "; it runs again"
                tell(f"{name}: {status.reason}{_last_words(folder, name)}{again}")
        stopped = [n for n, status in now.items() if status.state in (KILLED, RUNNING, MISSING)]
        left = {name: cases[name] for name in stopped}


def _batch(folder, cases, left, jobs, checkpoint_every, pictures):
    """Run yade-batch over the cases `left` and show how far all `cases` are."""
    batch = folder / BATCH
    script = batch / SCRIPT.name  # yade-batch allows no blanks in paths
    script.unlink(missing_ok=True)
    script.symlink_to(SCRIPT)
    columns = {
        name: {
            "out": f"../{CASES}/{name}",
            "checkpoint_every": checkpoint_every,
            "no_pictures": not pictures,
        }
        for name in left
    }
    replace_text(batch / "table.txt", table(left, columns))
    command = ["yade-batch", f"--jobs={jobs}", "--job-threads=1", "--plot-update=-1"]
    command += ["--disable-pynotify", "--log=@.log", "table.txt", SCRIPT.name]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
    environment |= [_family(folder).split("=", 1)]
    environment.pop("OMP_NUM_THREADS", None)
    progress = _CaseProgress(folder, cases)
    with open(batch / "batch.log", "ab") as log:
        batch_process = subprocess.Popen(
            command,
            cwd=batch,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # Ctrl-C is for us
        )
        try:
            while batch_process.poll() is None:
                progress.update()
                time.sleep(LOOK)
        finally:
            if batch_process.poll() is None:
                end(folder)
                batch_process.wait()
    progress.close()


class _CaseProgress:
    """Cases done, running and left, and the time that will take."""

    def __init__(self, folder, cases):
        self.folder, self.cases = folder / CASES, cases
        self.progress = Progress("sweep", 1.0)
        self.start, self.first, self.done = time.monotonic(), None, set()

    def update(self):
        """Look at the cases that were not done and show how far all are."""
        if len(self.done) == len(self.cases):
            return
        share, running = 0.0, 0
        for name in self.cases.keys() - self.done:
            status = look(self.folder / name)
            if status.is_finished:
                self.done.add(name)
            elif status.state == RUNNING:
                running += 1
                share += _share(self.folder / name, self.cases[name].duration)
        share = (share + len(self.done)) / len(self.cases)
        if self.first is None:
            self.first = share
        text = f"{len(self.done)} of {len(self.cases)} cases done, {running} running"
        gone = share - self.first
        if gone > 0 and share < 1:
            text += f", {(time.monotonic() - self.start) * (1 - share) / gone:.0f} s left"
        self.progress.show(share, text)

    def close(self):
        """Show the end."""
        self.update()
        if len(self.done) < len(self.cases) and self.progress.stream.isatty():
            self.progress.stream.write("\n")


def _share(folder, duration):
    """How much of its simulated time a case that runs has behind it."""
    try:
        with open(part_of(folder) / "history.csv", "rb") as history:
            history.seek(-min(2000, os.fstat(history.fileno()).st_size), os.SEEK_END)
            last = history.read().splitlines()[-2]  # the last one may still be incomplete
        return min(0.99, float(last.split(b",")[0]) / duration)
    except (OSError, ValueError, IndexError, ZeroDivisionError):
        return 0.0


def _last_words(folder, name):
    """What a job said last that was stopped, for the user; "" if nothing."""
    try:
        lines = (
            (folder / BATCH / f"{name}.log")
            .read_text(encoding="utf-8", errors="replace")
            .splitlines()
        )
    except FileNotFoundError:
        return ""
    if any("JOB SUMMARY" in line for line in lines):
        lines = lines[: next(i for i, line in enumerate(lines) if "JOB SUMMARY" in line)]
    said = [line.strip() for line in lines if line.strip() and " %  " not in line]
    return f"; it said last: {said[-1]}" if said else ""
