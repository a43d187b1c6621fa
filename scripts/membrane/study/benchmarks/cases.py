# SPDX-License-Identifier: GPL-2.0-or-later
"""The cases of a sheet that are measured: path, forces and how often YADE's bodies are updated."""

from . import FUSED, LAW2, Settings

Case = tuple[str, bool, int]  # path, all forces or not, exchange period

PERIODS = (1, 100)  # steps between two updates of the bodies, path fused
FORCES = (False, True)  # not all, all
WORK = 2e7  # nodes times steps of a turn, about 0.3 s
LAW2_SHARE = 0.125  # of them, so that a turn of the slower path takes about as long


def fused_cases() -> list[Case]:
    """All (path, all forces or not, exchange period) of the fused path."""
    return [(FUSED, everything, period) for everything in FORCES for period in PERIODS]


def label(path: str, everything: bool, period: int) -> str:
    """A case in words; the forces and the period are explained in the file of results."""
    forces = "all forces" if everything else "springs"
    return f"{path}, {forces}" + (f", exchange {period}" if path == FUSED else "")


def plan(side: int, threads: int, path: str, everything: bool, period: int) -> dict:
    """Arguments of a Worker for a case."""
    return {
        "situation": "sheet",
        "side": side,
        "threads": threads,
        "path": path,
        "everything": everything,
        "exchange_period": period,
    }


def clock(threads: int) -> str:
    """Which of a worker's times to compare: on one thread processor time, on several wall time."""
    return "used" if threads == 1 else "wall"


def steps(settings: Settings, nodes: int, path: str = FUSED) -> int:
    """Steps of a turn: a multiple of the longest period."""
    work = settings.work(WORK) * (LAW2_SHARE if path == LAW2 else 1.0)
    period = max(PERIODS)
    return period * max(1, round(work / nodes / period))
