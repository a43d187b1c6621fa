# SPDX-License-Identifier: GPL-2.0-or-later
"""Leaves out each part of the model in turn: what it changes in the answer, and what time it costs.

Writes reference/parts.csv and prints advice.
"""

import statistics
from collections.abc import Callable
from dataclasses import dataclass
from math import pi

import numpy as np

from ..files import replace_text
from ..parameters import SailParameters
from .sources import REFERENCE
from .verification import deployment
from .verification.variant import Variant

TABLE = REFERENCE / "parts.csv"
SAMPLES = (0.05, 0.1)  # [s]; single curves can be compared until then
LAG_TIME = 0.45  # [s]; the largest lag comes before
INTERVAL = 1e-3  # [s]

HEADER = """\
# What each part of the model changes in the paper's case (its default parameters), and its cost.
# Made by `scripts/run.sh parts`. Changes are those of the answer against that of the
# complete model; the row "spread" has for scale the standard deviation over runs that
# start 1e-9 m apart, the row "complete" the answer itself.
# part: what was left out or changed; dt_s: time step [s]
# rate_50ms, rate_100ms: deployment rate [-] at 0.05 s and 0.1 s
# phase_50ms_deg, phase_100ms_deg: mean phase difference [deg] at 0.05 s and 0.1 s
# lag_deg: largest lag [deg]; empty where the run was not that long
# us_per_step: processor time of a step [us], median of short runs
# time_ratio: processor time for the same simulated time over that of the complete model, median
#   of pairs; that of "complete" shows how far off such medians are
"""
COLUMNS = (
    "part,dt_s,rate_50ms,rate_100ms,phase_50ms_deg,phase_100ms_deg,lag_deg,us_per_step,time_ratio"
)


@dataclass(frozen=True)
class Part(Variant):
    """The model without one of its parts."""

    duration: float = LAG_TIME  # s


CONSERVATIVE = "conservative"
LIGHT = 0.1 * SailParameters().tether_density
COMPLETE = Part()
PARTS = {
    "no creases (beta = 0)": Part({"beta": 0.0}, rests=True),
    "no penalty of passed creases (gamma = 1)": Part({"gamma": 1.0}, rests=True),
    "no air drag": Part({"air_density": 0.0}),
    "no damping (zeta = 0)": Part({"zeta": 0.0}),
    "no gravity": Part({"gravity": 0.0}, rests=True),
    "tethers of a tenth of the mass": Part({"tether_density": LIGHT, "dt": 2.5e-6}, rests=True),
    "spool of 12 facets": Part({"spool_facets": 12}),
    "no contact with the spool": Part(contact=False),
    "no ledger": Part(ledger=False),
    "film of plane stress": Part({"film": "plane_stress"}, rests=True),
    "half the buckling length": Part({"buckling_length": 1.14e-3}, rests=True),
    "natural angle of 30 degrees": Part({"theta0": pi / 6, "crease_law": CONSERVATIVE}, rests=True),
    "twice the damping time": Part({"damping_time": 1.36e-6}),
    "half the time step": Part({"dt": 2.5e-6}, duration=SAMPLES[-1]),
    "finer mesh as printed (refine = 2)": Part(
        {"refine": 2, "dt": 2.5e-6}, rests=True, duration=SAMPLES[-1]
    ),
}


def answer(part: Part, positions: np.ndarray | None = None) -> np.ndarray:
    """Rates [-] and phases [deg] at SAMPLES and the largest lag [deg] (NaN: run too short)."""
    p = part.parameters()
    run = deployment.follow(*part.begin(positions), p, INTERVAL)
    phase, at = np.degrees(run.phase), [run.at(t) for t in SAMPLES]
    lag = -phase.min() if p.duration >= LAG_TIME else np.nan
    return np.array([*run.rate[at], *phase[at], lag])


def costs(parts: dict, rounds: int, steps: int) -> dict[str, tuple[float, float]]:
    """Time of a step [us] and time for the same simulated time over COMPLETE's, by name.

    Each is measured next to COMPLETE in every round; medians over the rounds.
    """
    steps_taken: dict[str, list] = {name: [] for name in parts}
    ratios: dict[str, list] = {name: [] for name in parts}
    for _ in range(rounds):
        for name, part in parts.items():
            base, own = COMPLETE.step_time(steps), part.step_time(steps)
            steps_taken[name].append(1e6 * own)
            ratios[name].append(own / part.parameters().dt / (base / SailParameters().dt))
    return {n: (statistics.median(steps_taken[n]), statistics.median(ratios[n])) for n in parts}


def line(name: str, dt: float, numbers: np.ndarray, cost: tuple | None = None) -> str:
    """A row of the table."""
    values = ["" if np.isnan(v) else f"{v:.4g}" for v in numbers]
    values += [f"{cost[0]:.0f}", f"{cost[1]:.2f}"] if cost else ["", ""]
    return ",".join([f'"{name}"', f"{dt:g}", *values])


def verdict(name: str, change: np.ndarray, spread: np.ndarray, cost: tuple) -> str:
    """A line of advice on one part."""
    rate, phase, lag = abs(change[1]), abs(change[3]), abs(change[4])
    within = rate <= 2 * spread[1] and phase <= 2 * spread[3] and not lag > 2 * spread[4]
    effect = f"rate {change[1]:+.3f} and phase {change[3]:+.2f} deg at {SAMPLES[1]:g} s"
    if not np.isnan(lag):
        effect += f", largest lag {change[4]:+.1f} deg"
    said = "within" if within else "beyond"
    return f"{name}: {effect} ({said} twice the spread); {cost[1]:.2f} of the time"


def measure(rounds: int, steps: int, members: int, tell: Callable[[str], None]) -> list[str]:
    """Write the table; returns a line of advice on each part.

    A part is timed by `rounds` pairs of runs of `steps` each; `members` runs give the spread, >= 2;
    `tell` takes a line of text about what comes next.
    """
    tell("the complete model")
    rest, complete = COMPLETE.start(), answer(COMPLETE)
    starts = [deployment.perturbed(rest, seed) for seed in range(1, members)]
    spread = np.std([complete, *(answer(COMPLETE, start) for start in starts)], axis=0, ddof=1)
    changes = {}
    for name, part in PARTS.items():
        tell(name)
        changes[name] = answer(part) - complete
    tell("times")
    cost = costs({"complete": COMPLETE, **PARTS}, rounds, steps)
    rows = [line("complete", COMPLETE.parameters().dt, complete, cost["complete"])]
    rows.append(line("spread", COMPLETE.parameters().dt, spread))
    rows += [line(n, p.parameters().dt, changes[n], cost[n]) for n, p in PARTS.items()]
    replace_text(TABLE, HEADER + "\n".join([COLUMNS, *rows]) + "\n")
    return [verdict(name, changes[name], spread, cost[name]) for name in PARTS]
