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

from functools import cache
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from membrane.measures import lag_and_half_period
from membrane.parameters import TABLE_2_CASES, SailParameters
from membrane.study.sweep.pictures import draw_curves
from membrane.view.plots import save

from ..sources import REFERENCE
from . import Check, at_most, recorded
from .deployment import DURATION, INTERVAL, Deployment, deploy, ensemble, equilibrium
from .deployment import perturbed

PICTURE = REFERENCE / "table2.png"
ALPHA_CREASE, BETA = TABLE_2_CASES["alpha_crease"], TABLE_2_CASES["beta"]
OTHER, OTHER_MEMBERS = (1000.0, 0.0), 3  # a second case whose spread is measured
SPREADS = 2  # standard deviations of a change that count as none

Case = tuple[float, float]  # alpha_c, beta

# Last values.
LAST = {
    "largest lag, alpha_c 100, beta 0": 91.85,
    "largest lag, alpha_c 100, beta 3": 91.3,
    "largest lag, alpha_c 100, beta 30": 83.67,
    "largest lag, alpha_c 1000, beta 0": 92.96,
    "largest lag, alpha_c 1000, beta 3": 91.89,
    "largest lag, alpha_c 1000, beta 30": 81.83,
    "largest lag falls by, beta 0 to 3 at alpha_c 100": 0.5454,
    "largest lag falls by, beta 3 to 30 at alpha_c 100": 7.632,
    "largest lag falls by, beta 0 to 3 at alpha_c 1000": 1.07,
    "largest lag falls by, beta 3 to 30 at alpha_c 1000": 10.06,
    "largest lag falls by, alpha_c 100 to 1000 at beta 0": -1.108,
    "largest lag falls by, alpha_c 100 to 1000 at beta 3": -0.5836,
    "largest lag falls by, alpha_c 100 to 1000 at beta 30": 1.845,
    "largest lag: falls clearly with alpha_c at so many of 3 beta": 1,
    "half period, alpha_c 100, beta 0": 0.666,
    "half period, alpha_c 100, beta 3": 0.65,
    "half period, alpha_c 100, beta 30": 0.604,
    "half period, alpha_c 1000, beta 0": 0.673,
    "half period, alpha_c 1000, beta 3": 0.663,
    "half period, alpha_c 1000, beta 30": 0.6,
    "half period falls by, beta 0 to 3 at alpha_c 100": 0.016,
    "half period falls by, beta 3 to 30 at alpha_c 100": 0.046,
    "half period falls by, beta 0 to 3 at alpha_c 1000": 0.01,
    "half period falls by, beta 3 to 30 at alpha_c 1000": 0.063,
    "half period falls by, alpha_c 100 to 1000 at beta 0": -0.007,
    "half period falls by, alpha_c 100 to 1000 at beta 3": -0.013,
    "half period falls by, alpha_c 100 to 1000 at beta 30": 0.004,
    "half period: falls clearly with alpha_c at so many of 3 beta": 0,
}
LAST_SPREADS = {"largest lag": (0.18, 0.53), "half period": (0.0037, 0.0055)}
QUANTITIES = (("largest lag", "deg"), ("half period", "s"))
SPREAD_SOURCE = "standard deviation over the ensemble"


@cache
def case(alpha_crease: float, beta: float) -> Deployment:
    """The run of one case; that of the default parameters is the ensemble's first."""
    p = SailParameters(alpha_crease=alpha_crease, beta=beta, duration=DURATION)
    if p == SailParameters(duration=DURATION):
        return ensemble()[0]
    return deploy(p, INTERVAL)


@cache
def others() -> list[Deployment]:
    """The runs of the case OTHER: its own, and OTHER_MEMBERS - 1 that start perturbed."""
    p = SailParameters(alpha_crease=OTHER[0], beta=OTHER[1], duration=DURATION)
    start = equilibrium(p)
    rest = [deploy(p, INTERVAL, positions=perturbed(start, s)) for s in range(1, OTHER_MEMBERS)]
    return [case(*OTHER), *rest]


def draw(runs: dict[Case, Deployment], swings: dict[Case, tuple[float, float]], path: Path) -> None:
    """Phase difference of the cases (dict of Deployment) and their swings (dict), to `path`."""
    figure = Figure(figsize=(10, 4), layout="constrained")
    curves, marks = figure.subplots(1, 2, width_ratios=(1.6, 1))
    drawn = draw_curves(curves, {key: (r.times, np.degrees(r.phase)) for key, r in runs.items()})
    for (alpha_crease, beta), line in drawn.items():
        marker = {"color": line.get_color(), "marker": "sD"[alpha_crease < 1000]}
        label = line.get_label()
        marks.plot(*swings[alpha_crease, beta], linestyle="", label=label, **marker)
    usual = SailParameters()
    for members, key, sign in (
        (ensemble(), (usual.alpha_crease, usual.beta), "k."),
        (others(), OTHER, "k+"),
    ):
        twins = np.transpose([lag_and_half_period(run.times, run.phase) for run in members])
        label = "{}, starts 1e-9 m apart".format(drawn[key].get_label())
        marks.plot(*twins, sign, markersize=5, label=label)
    curves.set(xlabel="time [s]", ylabel="mean phase difference [deg]")
    marks.set(xlabel="largest lag [deg]", ylabel="half period [s]")
    curves.legend(frameon=False, fontsize=7)
    marks.legend(frameon=False, fontsize=7)
    for axes in (curves, marks):
        axes.grid(alpha=0.3)
    save(figure, path, dpi=110)


def claims(kind: str, values: dict[Case, float], spread: float, unit: str) -> list[Check]:
    """Checks of how `values` (dict by case) change along alpha_c and beta."""
    found, along_beta = [], []
    for alpha_crease in ALPHA_CREASE:
        for low, high in zip(BETA, BETA[1:]):
            drop = values[alpha_crease, low] - values[alpha_crease, high]
            along_beta.append(drop)
            title = f"{kind} falls by, beta {low:g} to {high:g} at alpha_c {alpha_crease:g}"
            found.append((title, drop))
    along_alpha = []
    for beta in BETA:
        low, high = (values[alpha_crease, beta] for alpha_crease in ALPHA_CREASE)
        along_alpha.append(low - high)
        found.append((f"{kind} falls by, alpha_c 100 to 1000 at beta {beta:g}", low - high))
    room = 5 * max(LAST_SPREADS[kind])
    checks_found = [
        recorded(name, drop, LAST[name], room, f"{drop / spread:+.1f} spreads", unit)
        for name, drop in found
    ]
    most = SPREADS * np.sqrt(2) * spread  # of the difference of two runs
    says = f"the paper: it falls; {SPREADS} standard deviations are allowed"
    checks_found.append(
        at_most(f"{kind}: largest rise with beta", -min(along_beta), most, says, unit)
    )
    fall = sum(drop > most for drop in along_alpha)
    title = f"{kind}: falls clearly with alpha_c at so many of {len(BETA)} beta"
    says = "the paper: at all; does not hold" if fall < len(BETA) else "the paper: at all; holds"
    checks_found.append(recorded(title, fall, LAST[title], 1, says))
    return checks_found


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
    runs = {(a, b): case(a, b) for a in ALPHA_CREASE for b in BETA}
    swings = {key: lag_and_half_period(run.times, run.phase) for key, run in runs.items()}
    members = np.array([lag_and_half_period(run.times, run.phase) for run in ensemble()])
    second = np.array([lag_and_half_period(run.times, run.phase) for run in others()])
    draw(runs, swings, PICTURE)
    for column, (kind, unit) in enumerate(QUANTITIES):
        values = {key: both[column] for key, both in swings.items()}
        spreads = [float(both[:, column].std(ddof=1)) for both in (members, second)]
        names = "of the default case", f"at alpha_c {OTHER[0]:g}, beta {OTHER[1]:g}"
        for name, spread, last in zip(names, spreads, LAST_SPREADS[kind]):
            title = f"{kind}: spread {name}"
            found.append(recorded(title, spread, last, 2 * last, SPREAD_SOURCE, unit))
        last = max(LAST_SPREADS[kind])
        for (alpha_crease, beta), value in values.items():
            title = f"{kind}, alpha_c {alpha_crease:g}, beta {beta:g}"
            found.append(recorded(title, value, LAST[title], 5 * last, "one run", unit))
        found += claims(kind, values, max(spreads), unit)
    return found
