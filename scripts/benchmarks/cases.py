# SPDX-License-Identifier: GPL-2.0-or-later
"""The cases of a sheet that are measured: path, forces and how often YADE's bodies are updated."""

from . import FUSED, LAW2

PERIODS = (1, 100)  # steps between two updates of the bodies, path fused
LAW2_SHARE = 0.125  # of the steps, so that a turn of the slower path is no longer


def cases(paths):
    """All (path, all forces or not, exchange period) of some paths."""
    found = []
    for everything in (False, True):
        if FUSED in paths:
            found += [(FUSED, everything, period) for period in PERIODS]
        if LAW2 in paths:
            found.append((LAW2, everything, 1))
    return found


def label(path, everything, period):
    """A case in words; the forces and the period are explained in the file of results."""
    forces = "all forces" if everything else "springs"
    return f"{path}, {forces}" + (f", exchange {period}" if path == FUSED else "")


def plan(side, threads, path, everything, period):
    """Arguments of a Worker for a case."""
    return {
        "situation": "sheet",
        "side": side,
        "threads": threads,
        "path": path,
        "everything": everything,
        "exchange_period": period,
    }


def plans(settings, side, threads):
    """Arguments of Worker for all cases of a sheet, by case."""
    return {case: plan(side, threads, *case) for case in cases(settings.paths)}


def steps_of(work, nodes):
    """Steps of a turn of `work` nodes times steps: a multiple of the longest period."""
    period = max(PERIODS)
    return period * max(1, round(work / nodes / period))
