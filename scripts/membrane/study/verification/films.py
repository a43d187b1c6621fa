# SPDX-License-Identifier: GPL-2.0-or-later
"""The deployment as ensembles on several meshes: what each film makes of a finer one.

Each member has a spin-up of its own, from a folded sail 1e-9 m off the others.
"""

from collections.abc import Iterable

import numpy as np

from . import Check, deployment, recorded

FILMS: dict[str, tuple] = {
    "springs as printed": (("as_printed", True),),
    "springs, same film": (),
    "plane stress": (("film", "plane_stress"),),
}  # changes of SailParameters
MEMBERS = 8
TIMES = (0.02, 0.06, 0.1)  # [s]
QUANTITIES = (("rate", "-"), ("phase", "deg"))


def ensemble(film: str, refine: int, members: int = MEMBERS) -> np.ndarray:
    """Means and their standard errors, (2, 2, t), of rate [-] and phase [deg] at TIMES."""
    runs = [deployment.early(refine, None, seed, FILMS[film]) for seed in range(members)]
    rows = [runs[0].at(time) for time in TIMES]
    values = np.array([(run.rate[rows], np.degrees(run.phase[rows])) for run in runs])
    return np.array([values.mean(axis=0), values.std(axis=0, ddof=1) / np.sqrt(members)])


# Means and standard errors when last looked at: rates [-] and phases [deg] at TIMES.
LAST: dict[tuple[str, int], tuple] = {}


def ensemble_checks(cases: Iterable[tuple[str, int]], members: int) -> list[Check]:
    """Means of each case, recorded; they may be off by three standard errors of either."""
    found = []
    for film, refine in cases:
        means, errors = ensemble(film, refine, members)
        last_means, last_errors = np.array(LAST[film, refine])
        room = 3 * np.hypot(errors, last_errors)
        for (kind, unit), *rows in zip(QUANTITIES, means, errors, last_means, room):
            for time, mean, error, last, allowed in zip(TIMES, *rows):
                name = f"{film}, refine {refine}: {kind} at {time:g} s"
                source = f"mean of {members} spin-ups, standard error {error:.2g}"
                found.append(recorded(name, float(mean), float(last), float(allowed), source, unit))
    return found


def checks(full: bool) -> list[Check]:
    """Ensembles of all films on all meshes of LAST; else a short one of the coarsest."""
    cases = LAST if full else [("plane stress", 1)]
    return ensemble_checks(cases, MEMBERS if full else 3)
