# SPDX-License-Identifier: GPL-2.0-or-later
"""What was measured: a table to read, and reference/bench.json."""

import os
import subprocess
from collections.abc import Iterable, Sequence
from pathlib import Path

from membrane.files import read_object, write_json
from membrane.study.text_table import aligned

from ..sources import ROOT
from . import Entry

MEANING = {
    "value": "median over the rounds, in which all that is compared takes turns",
    "spread": "least and largest over the rounds",
    "best": "ratio of the shortest times, which other work on the machine touches least",
    "time": "processor time on one thread; wall time in the modules threads and deployment",
    "commit": "of the sources; + if they were changed since",
    "springs": "springs, buckling and damping; in LAMMPS springs alone",
    "all forces": "springs, buckling, damping, creases on every fourth row of sides, air drag",
    "exchange": "steps between two updates of YADE's bodies, path fused",
    "roofline": "the kernels by themselves, without YADE; operations: as counted in the sources, "
    "atan2 as one; least traffic: what a step must read or write once; attainable: the least of "
    "peak and intensity times bandwidth of the level that holds all; simulated: by valgrind, "
    "without prefetching",
    "other_work": "cores that were busy with something else meanwhile, mean",
}
MADE_FROM = ("pkg", "scripts", "CMakeLists.txt")  # what decides on the speed


def commit() -> str:
    """The commit of the sources, with "+" if they differ from it; "unknown" outside git."""
    try:
        head = _git("rev-parse", "--short=12", "HEAD").strip()
        return head + "+" * bool(_git("status", "--porcelain", "--", *MADE_FROM))
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def _git(*arguments):
    done = subprocess.run(
        ["git", "-C", str(ROOT), *arguments], capture_output=True, encoding="utf-8", check=True
    )
    return done.stdout


def processor() -> str:
    """Model of the processor and how many cores of it there are."""
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    models = [line.split(":", 1)[1].strip() for line in text.splitlines() if "model name" in line]
    return f"{models[0] if models else 'unknown'}, {os.cpu_count()} cores"


def rounded(number: float) -> float:
    """A number to four digits."""
    return float(f"{number:.4g}")


def as_rows(module: str, entries: Iterable[Entry], made_of: str) -> list[dict]:
    """Entries of one module, measured at the commit `made_of`, ready for JSON."""
    rows = []
    for one in entries:
        row: dict = {"module": module, **one.as_dict(), "commit": made_of}
        row["value"] = rounded(row["value"])
        if "best" in row:
            row["best"] = rounded(row["best"])
        if "spread" in row:
            row["spread"] = [rounded(number) for number in row["spread"]]
        rows.append(row)
    return rows


def save(path: Path, module: str, rows: list[dict], made_with: dict, order: Sequence[str]) -> None:
    """Put what one module found into the file, beside what the others did, in their `order`.

    `rows` are those of `as_rows`, `made_with` has versions, machine and date, `order` all modules:
    what others left in the file is dropped.
    """
    keys = [(row["name"], row["nodes"], row["threads"]) for row in rows]
    if len(set(keys)) < len(keys):
        raise RuntimeError(f"{module} has two entries of one name, size and number of threads")
    before = read_object(path) if path.exists() else {"made_with": {}, "entries": []}
    used = {**before["made_with"], module: made_with}
    kept = [row for row in before["entries"] if row["module"] in order and row["module"] != module]
    content = {
        "made_by": "scripts/run.sh bench",
        "meaning": MEANING,
        "made_with": {name: used[name] for name in order if name in used},
        "entries": sorted([*kept, *rows], key=lambda row: order.index(row["module"])),
    }
    write_json(path, content)


def table(module: str, entries: Iterable[Entry]) -> list[str]:
    """Lines of text that show a list of Entry of a module."""
    rows = [("", "nodes", "threads", "value", "best", "spread", "other", "unit", "target", "")]
    for one in entries:
        spread = f"{one.spread[0]:.3g} … {one.spread[1]:.3g}" if one.spread else ""
        target = f"{one.bound} {one.target:g}" if one.bound else ""
        holds = {None: "", True: "holds", False: "DOES NOT HOLD"}[one.holds]
        nodes = "" if one.nodes is None else f"{one.nodes}"
        value = f"{one.value:.3g}" if one.value < 1000 else f"{one.value:.0f}"
        best = f"{one.best:.3g}" if one.best else ""
        other = "" if one.other_work is None else f"{one.other_work:.1f}"
        row = (one.name, nodes, f"{one.threads}", value, best, spread, other, one.unit)
        rows.append((*row, target, holds))
    return [module, *("  " + line for line in aligned(rows, left=(0, 7, 8, 9)))]
