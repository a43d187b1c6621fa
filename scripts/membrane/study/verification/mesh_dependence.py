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
LAST: dict[tuple[str, int], tuple] = {
    ("springs as printed", 1): (
        ((0.09525, 0.46498, 0.77086), (-0.55545, -9.35005, -29.33203)),
        ((6e-05, 0.00029, 0.00127), (0.00045, 0.00126, 0.00625)),
    ),
    ("springs, same film", 1): (
        ((0.09525, 0.46498, 0.77086), (-0.55545, -9.35005, -29.33203)),
        ((6e-05, 0.00029, 0.00127), (0.00045, 0.00126, 0.00625)),
    ),
    ("plane stress", 1): (
        ((0.09398, 0.48997, 0.82307), (-0.56078, -9.65593, -29.67937)),
        ((9e-05, 0.00048, 0.00257), (0.00083, 0.00373, 0.01286)),
    ),
    ("springs as printed", 2): (
        ((0.08891, 0.43841, 0.62226), (-0.55649, -9.21443, -27.63297)),
        ((0.0004, 0.00142, 0.00482), (0.00094, 0.01012, 0.02631)),
    ),
    ("springs, same film", 2): (
        ((0.09982, 0.49168, 0.79901), (-0.5692, -9.70901, -30.13805)),
        ((0.00025, 0.00046, 0.00136), (0.00071, 0.0052, 0.017)),
    ),
    ("plane stress", 2): (
        ((0.09729, 0.49071, 0.7978), (-0.56117, -9.78193, -29.96336)),
        ((0.00032, 0.00061, 0.00115), (0.00059, 0.00682, 0.01267)),
    ),
    ("springs as printed", 3): (
        ((0.08399, 0.37111, 0.41467), (-0.54019, -8.51278, -23.42222)),
        ((0.00067, 0.00985, 0.01186), (0.00191, 0.07892, 0.32381)),
    ),
    ("springs, same film", 3): (
        ((0.10266, 0.5271, 0.77343), (-0.57798, -10.00347, -30.69394)),
        ((0.0002, 0.00095, 0.00164), (0.00109, 0.00366, 0.01149)),
    ),
}


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
