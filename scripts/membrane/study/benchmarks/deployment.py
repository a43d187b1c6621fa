# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper's deployment of 1 s, by the command that everybody uses."""

import json
import resource
import subprocess
import tempfile
import time
from pathlib import Path

from ..sources import SCRIPTS
from . import AT_MOST, FUSED, PATHS, Entry, Settings

SCRIPT = SCRIPTS / "deploy.py"
MOST = 6.0  # [s], all together
STAGES = {"build": "fold and build", "spin_up": "spin-up", "run": "run of 1 s"}


def deploy(path: str) -> tuple[dict, float, float]:
    """Deploy the sail at the defaults, on a path.

    Gives what is in summary.json and wall_time.json, and wall time and processor time [s] of the
    whole command.
    """
    start, used = time.monotonic(), processor_time()
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            ["yade", "-n", "-x", "-j", "1", str(SCRIPT)]
            + ["--path", path, "--no-pictures", "--no-report", "--out", folder],
            capture_output=True,
            encoding="utf-8",
            timeout=3600,
        )
        if done.returncode:
            raise RuntimeError(f"deploy failed: {done.stderr.strip()[-500:]}")
        wall = time.monotonic() - start
        summary, times = (
            json.loads((Path(folder) / name).read_text(encoding="utf-8"))
            for name in ("summary.json", "wall_time.json")
        )
        return {**summary, "wall_time": times}, wall, processor_time() - used


def processor_time() -> float:
    """Processor time [s] of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure(settings: Settings) -> list[Entry]:
    """Entries of the wall time of each stage and of all."""
    return [entry for path in PATHS for entry in measure_path(path, settings)]


def measure_path(path: str, settings: Settings) -> list[Entry]:
    """Entries for one path."""
    settings.tell(f"the paper's deployment, path {path}")
    summary, whole, used = settings.quiet.measure(lambda: deploy(path))
    nodes, wall = summary["mesh"]["nodes"], summary["wall_time"]
    found = [
        Entry(f"deployment, {path}: {text}", wall[stage], "s", nodes)
        for stage, text in STAGES.items()
    ]
    total = sum(wall[stage] for stage in STAGES)
    wanted: dict = {"target": MOST, "bound": AT_MOST} if path == FUSED else {}
    found.append(Entry(f"deployment, {path}: total", total, "s", nodes, **wanted))
    for text, value in {"wall": whole, "processor": used}.items():
        name = f"deployment, {path}: {text} time with YADE's start and end"
        found.append(Entry(name, value, "s", nodes))
    return settings.quiet.mark(found)
