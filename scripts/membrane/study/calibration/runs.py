# SPDX-License-Identifier: GPL-2.0-or-later
"""Curves of deployments for given parameters: each run a YADE of its own, several at once."""

import os
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from membrane._load import VERSION
from membrane.results.case_folder import LAST_GOOD
from membrane.results.unfinished import UNFINISHED
from scipy.interpolate import CubicSpline

from .kept_runs import KeptRuns, refuse_another

INTERVAL = 1e-3  # [s] between rows of a run's history


class Deployments:
    """Runs scripts/deploy.py, at a Path, for points in parameter space; no point twice.

    The d parameters of `names` vary; the Target gives columns and times; further `options` are the
    same for all runs. `tell` is called with values of the parameters (d,) and curves or None after
    each run.
    """

    def __init__(
        self,
        deploy: Any,
        names: Any,
        target: Any,
        options: Any = (),
        tell: Callable = lambda values, curves: None,
    ) -> None:
        self.deploy, self.options, self.tell = deploy, list(options), tell
        self.names, self.target = names, target
        self.kept: KeptRuns | None = None
        self.workers = len(os.sched_getaffinity(0))
        self._known: dict = {}

    def keep(self, path: str | Path) -> int:
        """Keep the runs in a file, and take from it those of an earlier call; returns how many."""
        about = {
            "membrane": VERSION,
            "names": list(self.names),
            "options": self.options,
            "files": _files(self.options),
            "columns": list(self.target.columns),
            "times": self.target.times.tolist(),
        }
        refuse_another(path)
        self.kept = KeptRuns(path, about)
        return len(self.kept)

    def __call__(self, points: Any) -> list:
        """Curves of points (n, d), logarithms: a list of (C, S), None where the run diverged."""
        points = [tuple(float(v) for v in point) for point in points]
        new = [point for point in dict.fromkeys(points) if point not in self._known]
        with ThreadPoolExecutor(self.workers) as pool:
            try:
                self._known.update(zip(new, pool.map(self._run, new)))
            except BaseException:
                pool.shutdown(cancel_futures=True)  # what the first refuses, the others would
                raise
        return [self._known[point] for point in points]

    @property
    def points(self) -> np.ndarray:
        """Logarithms of the parameters of the runs that went well, (n, d)."""
        return np.array([p for p, curves in self._known.items() if curves is not None])

    @property
    def curves(self) -> np.ndarray:
        """Their curves, (n, C, S)."""
        return np.array([curves for curves in self._known.values() if curves is not None])

    def __len__(self) -> int:
        return len(self._known)

    def _run(self, point):
        """Curves of a point, of an earlier call if they are there."""
        if self.kept is not None and point in self.kept:
            return self.kept[point]
        curves = self._deploy(np.exp(point))
        if self.kept is not None:
            self.kept.add(point, curves)
        self.tell(np.exp(point), curves)
        return curves

    def _deploy(self, values):
        with tempfile.TemporaryDirectory(prefix="calibration-") as folder:
            done = subprocess.run(
                ["yade", "-n", "-x", "-j1", str(self.deploy)]
                + [*self.options, *self._own(values, folder)],
                capture_output=True,
                encoding="utf-8",
                errors="replace",
            )
            kept = Path(folder) / UNFINISHED / LAST_GOOD  # also by a run that was only stopped
            diverged = done.returncode == 1 and kept.exists()
            if done.returncode and not diverged:
                said = [line for line in done.stderr.splitlines() if line.startswith("deploy:")]
                raise RuntimeError(said[-1] if said else f"a run ended by {done.returncode}")
            return None if diverged else self._read(Path(folder) / "history.csv")

    def _own(self, values, folder):
        """Options that are not the caller's to choose."""
        flags = [f"--{name.replace('_', '-')}" for name in self.names]
        given = [f"{flag}={value!r}" for flag, value in zip(flags, values.tolist())]
        duration = INTERVAL * (np.ceil(self.target.times[-1] / INTERVAL) + 1)
        return [
            *given,
            f"--duration={duration}",
            f"--history-interval={INTERVAL}",
            "--shapes-interval=0",
            "--no-pictures",
            "--no-report",
            f"--out={folder}",
        ]

    def _read(self, path):
        """Curves (C, S) of a history.csv at the target's times."""
        table: Any = np.genfromtxt(path, delimiter=",", names=True, encoding="utf-8")
        rows = np.array([table[name] for name in self.target.columns])
        return CubicSpline(table["time"], rows, axis=1)(self.target.times)


def _files(options):
    """Digests of the files that options name, as --parameters does."""
    paths = [Path(word.partition("=")[2] or word) for word in options]
    return {str(p): sha256(p.read_bytes()).hexdigest() for p in paths if p.is_file()}
