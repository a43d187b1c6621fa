# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs the cases of a sweep by Snakemake, shows how far they are, and tells what stopped them."""

import os
import shlex
import shutil
import subprocess
import sys
import time
from argparse import Namespace
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from membrane.files import write_json
from membrane.parameters import RunParameters
from membrane.progress import Progress
from membrane.results import own
from membrane.results.case_folder import DAMAGED, FAILED, HISTORY, KILLED, RUNNING, identity, look
from membrane.results.unfinished import UNFINISHED

from .family import end, job_name, mark
from .grid import CASES, case_words

WORK = "snakemake"  # folder of what Snakemake does, and of what it and the cases say
ROUNDS = 3  # how often in one sweep a case is started that was stopped from outside
SNAKEFILE = Path(__file__).with_name("Snakefile")
SCRIPT = Path(sys.argv[0]).resolve().with_name("case.py")  # beside that of the sweep
LOOK = 0.5  # [s], between two looks at the cases

Tell = Callable[[str], None]  # takes a line of text for the user


@contextmanager
def alone(folder: Path, slurm: bool, tell: Tell) -> Iterator[None]:
    """Hold the sweep's lock; ValueError if another process sweeps in this folder.

    Ends what an earlier sweep has left behind that was killed: its jobs outlive it.
    """
    with own.held(folder / WORK, f"another sweep is running in {folder}"):
        if ended := end(folder, slurm):
            tell(f"ended {', '.join(map(str, ended))}, processes that a killed sweep had left here")
        yield


def run(folder: Path, cases: dict[str, RunParameters], how: Namespace, tell: Tell) -> None:
    """Run those cases (by name) of the sweep in a folder that are not finished yet.

    Cases that were stopped from outside are started again, alone, up to ROUNDS times. Damaged ones
    are told, and left as they are. `how` has the command's options: on how many cores or, with
    `slurm`, as how many `jobs` at once; `threads`, `memory` [MB] and `minutes` of each case;
    `checkpoint_every` [s]; `no_pictures`.
    """
    wanted = {name: identity(p) for name, p in cases.items()}

    def states(names):
        return {name: look(folder / CASES / name, wanted[name]) for name in names}

    before = states(cases)
    for status in before.values():
        if status.state == DAMAGED:
            tell(status.reason)
    whole = [name for name, status in before.items() if status.state != DAMAGED]
    left = [name for name in whole if not before[name].is_finished]
    if len(left) < len(whole):
        tell(f"{len(whole) - len(left)} of {len(whole)} cases are there already")
    for name in left:
        if before[name].state in (FAILED, KILLED):
            tell(f"{name} {before[name].state} before: {before[name].reason}; it runs again")
    for turn in range(ROUNDS):
        if left:
            _round(folder, {n: cases[n] for n in whole}, left, how)
            again = "" if turn + 1 == ROUNDS else "; it runs again"
            left = _stopped(folder, states(left), again, tell)


def _stopped(folder, now, again, tell):
    """Names of the cases that were stopped from outside, by what has become of those that ran."""
    stopped = []
    for name, status in now.items():
        if status.state == FAILED:
            tell(f"{name} failed: {status.reason}")
        elif status.state == DAMAGED:
            tell(status.reason)
        elif not status.is_finished:
            words = [w for w in _lines(folder / WORK / f"{name}.log") if " %  " not in w]
            last = f"; it said last: {words[-1]}" if words else ""
            tell(f"{name}: {status.reason}{last}{again}")
            stopped.append(name)
    return stopped


def _command(folder, name, p, how):
    """What the shell is to do for a case."""
    words = ["yade", "-n", "-x", f"-j{how.threads}", str(SCRIPT), *case_words(p)]
    words += [f"--out={folder / CASES / name}", f"--checkpoint-every={how.checkpoint_every}"]
    line = shlex.join(words + ["--no-pictures"] * how.no_pictures)
    here, log = Path.cwd(), folder / WORK / f"{name}.log"
    if not how.slurm:
        return f"cd {shlex.quote(str(here))} && exec {line} > {shlex.quote(str(log))} 2>&1"
    submit = ["sbatch", "--wait", "--quiet", f"--job-name={job_name(folder)}", f"--comment={name}"]
    submit += [f"--cpus-per-task={how.threads}", f"--mem={how.memory}", f"--time={how.minutes}"]
    return shlex.join([*submit, f"--chdir={here}", f"--output={log}", f"--wrap=exec {line}"])


def _round(folder, cases, left, how):
    """Run Snakemake over the cases `left` and show how far all `cases` are."""
    work = folder / WORK
    for name in (".snakemake", "done"):  # of an earlier round: the cases' folders tell what is done
        shutil.rmtree(work / name, ignore_errors=True)
    threads = 1 if how.slurm else how.threads
    commands = {name: _command(folder, name, cases[name], how) for name in left}
    write_json(work / "jobs.json", {"threads": threads, "commands": commands})
    command = ["snakemake", f"--snakefile={SNAKEFILE}", f"--configfile={work / 'jobs.json'}"]
    command += [f"--directory={work}", f"--cores={min(how.jobs, threads * len(left))}"]
    command += ["--keep-going", "--nolock", "--nocolor", "--scheduler=greedy"]
    if not shutil.which(command[0]):
        raise RuntimeError("Snakemake is missing: apt-get install snakemake")
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg", **mark(folder)}
    environment.pop("OMP_NUM_THREADS", None)
    progress = _CaseProgress(folder, cases)
    with open(work / "snakemake.log", "wb") as log:
        snakemake = subprocess.Popen(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
            start_new_session=True,  # Ctrl-C is for us
        )
        try:
            while snakemake.poll() is None:
                progress.update()
                time.sleep(LOOK)
        finally:
            if snakemake.poll() is None:
                end(folder, how.slurm)
                snakemake.wait()
    progress.close()
    if snakemake.returncode > 0:
        _check(work / "snakemake.log", snakemake.returncode)


def _check(log, status):
    """RuntimeError, with its own words, if Snakemake has failed, and not a case."""
    said = [line for line in _lines(log) if not line.startswith(("Complete log", "Shutting down"))]
    if not any(line.startswith("Error in rule case:") for line in said):
        last = said[-1] if said else "without a word"
        raise RuntimeError(f"Snakemake ended by {status}: {last}; all that it said is in {log}")


def _lines(path):
    """Lines of a text file that are not empty; none if there is no file."""
    if not path.exists():
        return []
    text = path.read_text(encoding="utf-8", errors="replace")
    return [line.strip() for line in text.splitlines() if line.strip()]


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
        now = {name: look(self.folder / name) for name in self.cases.keys() - self.done}
        self.done |= {name for name, status in now.items() if status.is_finished}
        running = [name for name, status in now.items() if status.state == RUNNING]
        shares = (_share(self.folder / name, self.cases[name].duration) for name in running)
        share = (sum(shares) + len(self.done)) / len(self.cases)
        self.first = share if self.first is None else self.first
        text = f"{len(self.done)} of {len(self.cases)} cases done, {len(running)} running"
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
        with open(folder / UNFINISHED / HISTORY, "rb") as history:
            history.seek(-min(2000, os.fstat(history.fileno()).st_size), os.SEEK_END)
            last = history.read().splitlines()[-2]  # the last one may still be incomplete
        return min(0.99, float(last.split(b",")[0]) / duration)
    except (OSError, ValueError, IndexError, ZeroDivisionError):
        return 0.0
