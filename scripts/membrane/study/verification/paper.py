# SPDX-License-Identifier: GPL-2.0-or-later
"""Table 2's six cases: do amplitude and period of the phase difference fall with alpha_c and beta?

The paper finds that they do, if little. Amplitude is the largest lag of the mean tip behind the
spool, half a period the time from there to the largest lead that follows. Their spread is
that of runs of one case that start a nanometre apart: the larger of two cases.

What cannot be compared: the paper's curves of rate and phase difference (Figures 8 and 9) and the
chamber experiment behind them are not available as numbers, and the paper states neither how it
defines the rate nor the density of the air, the tethers and the guides; those are assumed. So only
the direction of the change is held against the paper, not its size.
"""

from collections.abc import Sequence
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from membrane.measures import lag_and_half_period
from membrane.parameters import TABLE_2_CASES, SailParameters
from membrane.study.sweep.pictures import draw_curves
from membrane.view.plots import save

from ..sources import REFERENCE
from . import Check, at_most, recorded
from .deployment import DURATION, Deployment, ensemble, members

PICTURE = REFERENCE / "table2.png"
ALPHA_CREASE, BETA = TABLE_2_CASES["alpha_crease"], TABLE_2_CASES["beta"]
USUAL = (SailParameters().alpha_crease, SailParameters().beta)
OTHER, OTHER_MEMBERS = (1000.0, 0.0), 3  # a second case whose spread is measured
SPREADS = 2  # standard deviations of a change that count as none

Case = tuple[float, float]  # alpha_c, beta

# Last values: of each case, of the falls with beta at each alpha_c and with alpha_c at each beta,
# how many of the latter are clear, and both spreads.
LAST_VALUES = {
    "largest lag": (91.85, 91.3, 83.67, 92.96, 91.89, 81.83),
    "half period": (0.666, 0.65, 0.604, 0.673, 0.663, 0.6),
}
LAST_FALLS = {
    "largest lag": (0.5454, 7.632, 1.07, 10.06, -1.108, -0.5836, 1.845),
    "half period": (0.016, 0.046, 0.01, 0.063, -0.007, -0.013, 0.004),
}
LAST_CLEAR = {"largest lag": 1, "half period": 0}
LAST_SPREADS = {"largest lag": (0.18, 0.53), "half period": (0.0037, 0.0055)}
QUANTITIES = (("largest lag", "deg"), ("half period", "s"))
SPREAD_SOURCE = "standard deviation over the ensemble"


@cache
def runs_of(alpha_crease: float, beta: float) -> list[Deployment]:
    """The runs of one case: the ensemble of the default parameters, some of OTHER, else one."""
    p = SailParameters(alpha_crease=alpha_crease, beta=beta, duration=DURATION)
    if p == SailParameters(duration=DURATION):
        return ensemble()
    return members(p, OTHER_MEMBERS if (alpha_crease, beta) == OTHER else 1)


def swings_of(runs: Sequence[Deployment]) -> np.ndarray:
    """Largest lag [deg] and half period [s] of runs: (R, 2)."""
    return np.array([lag_and_half_period(run.times, run.phase) for run in runs])


def draw(runs: dict[Case, Deployment], path: Path) -> None:
    """Phase difference of the cases, and their swings beside those of their twins, to `path`."""
    figure = Figure(figsize=(10, 4), layout="constrained")
    curves, marks = figure.subplots(1, 2, width_ratios=(1.6, 1))
    drawn = draw_curves(curves, {key: (r.times, np.degrees(r.phase)) for key, r in runs.items()})
    for (alpha_crease, beta), line in drawn.items():
        marker = {"color": line.get_color(), "marker": "sD"[alpha_crease < 1000]}
        swing = swings_of([runs[alpha_crease, beta]]).T
        marks.plot(*swing, linestyle="", label=line.get_label(), **marker)
    for key, sign in (USUAL, "k."), (OTHER, "k+"):
        label = f"{drawn[key].get_label()}, starts 1e-9 m apart"
        marks.plot(*swings_of(runs_of(*key)).T, sign, markersize=5, label=label)
    curves.set(xlabel="time [s]", ylabel="mean phase difference [deg]")
    marks.set(xlabel="largest lag [deg]", ylabel="half period [s]")
    for axes in (curves, marks):
        axes.legend(frameon=False, fontsize=7)
        axes.grid(alpha=0.3)
    save(figure, path, dpi=110)


def claims(kind: str, values: dict[Case, float], spread: float, unit: str) -> list[Check]:
    """Checks of how `values` (dict by case) change along alpha_c and beta."""
    along_beta = {
        f"beta {low:g} to {high:g} at alpha_c {a:g}": values[a, low] - values[a, high]
        for a in ALPHA_CREASE
        for low, high in zip(BETA, BETA[1:])
    }
    soft, stiff = ALPHA_CREASE
    along_alpha = {
        f"alpha_c 100 to 1000 at beta {beta:g}": values[soft, beta] - values[stiff, beta]
        for beta in BETA
    }
    room = 5 * max(LAST_SPREADS[kind])
    found = [
        recorded(
            f"{kind} falls by, {name}", drop, last, room, f"{drop / spread:+.1f} spreads", unit
        )
        for (name, drop), last in zip({**along_beta, **along_alpha}.items(), LAST_FALLS[kind])
    ]
    most = SPREADS * np.sqrt(2) * spread  # of the difference of two runs
    rise, fall = -min(along_beta.values()), sum(drop > most for drop in along_alpha.values())
    says = f"the paper: it falls; {SPREADS} standard deviations are allowed"
    found.append(at_most(f"{kind}: largest rise with beta", rise, most, says, unit))
    title = f"{kind}: falls clearly with alpha_c at so many of {len(BETA)} beta"
    says = "the paper: at all; does not hold" if fall < len(BETA) else "the paper: at all; holds"
    return [*found, recorded(title, fall, LAST_CLEAR[kind], 1, says)]


def known_swing() -> list[Check]:
    """Check of `lag_and_half_period` on a curve whose extremes are known."""
    times = np.linspace(0, 2, 2001)
    lag, half = lag_and_half_period(times, -np.radians(30) * np.sin(np.pi * times))
    exact = "-30 deg sin(pi t)"
    return [
        Check("largest lag of a known curve", lag, 30, 1e-6, exact, "deg"),
        Check("half period of a known curve", half, 1, 1e-9, exact, "s"),
    ]


def checks(full: bool) -> list[Check]:
    """Checks of Table 2's cases, each of half a minute; if not `full`, of what is measured."""
    found = known_swing()
    if not full:
        return found
    runs = {case: runs_of(*case)[0] for case in product(ALPHA_CREASE, BETA)}
    draw(runs, PICTURE)
    swings = swings_of(list(runs.values()))
    twins = [swings_of(runs_of(*case)) for case in (USUAL, OTHER)]
    for column, (kind, unit) in enumerate(QUANTITIES):
        values = dict(zip(runs, swings[:, column].tolist()))
        spreads = [float(both[:, column].std(ddof=1)) for both in twins]
        names = "of the default case", f"at alpha_c {OTHER[0]:g}, beta {OTHER[1]:g}"
        for name, spread, last in zip(names, spreads, LAST_SPREADS[kind]):
            title = f"{kind}: spread {name}"
            found.append(recorded(title, spread, last, 2 * last, SPREAD_SOURCE, unit))
        last = max(LAST_SPREADS[kind])
        for ((alpha_crease, beta), value), then in zip(values.items(), LAST_VALUES[kind]):
            title = f"{kind}, alpha_c {alpha_crease:g}, beta {beta:g}"
            found.append(recorded(title, value, then, 5 * last, "one run", unit))
        found += claims(kind, values, max(spreads), unit)
    return found
