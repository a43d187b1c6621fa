# SPDX-License-Identifier: GPL-2.0-or-later
"""The deployment itself: order in time, ledgers, steps and meshes, and an ensemble of runs.

Every run of one set of parameters starts from the same equilibrium, found once. Single runs are
compared early; late, where tiny differences have grown, the ensemble's mean and spread count.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from membrane import measures, scene
from membrane.parameters import TABLE_2_DURATION, SailParameters
from membrane.run import driver
from membrane.run.kind import Sail
from membrane.view import plots
from yade import wrapper as yade

from ..sources import REFERENCE
from . import Check, at_most, order, recorded

PICTURE = REFERENCE / "ensemble.png"

# Order in time: errors against a run at REFERENCE_STEP.
ORDER_STEPS = (2.5e-6, 1.25e-6, 0.625e-6, 0.3125e-6)  # [s]; the fast mode takes the last two
REFERENCE_STEP = 0.3125e-6 / 8  # [s]
ORDER_TIME = 5e-4  # [s]
LATER_TIME, LATER_STEPS, LATER_REFERENCE = 0.01, (5e-6, 2.5e-6, 1.25e-6), 0.3125e-6  # [s]

# Ledgers, steps and meshes.
SHOCK_TIME = 5e-3  # [s]; the guides' release shakes the sail
EARLY_TIMES = (0.02, 0.04, 0.06, 0.08, 0.1)  # [s]
STEPS = (5e-6, 2.5e-6, 1.25e-6)  # [s]
LEDGER_TIME = 1.0  # [s]
LEDGER_STEPS = (5e-6, 2.5e-6)  # [s]
LAST_IMBALANCE = (1.02e-4, 2.66e-5)
MESH_STEP = 0.4  # share of the critical time step of the folded sail

# Ensemble.
MEMBERS = 5
PERTURBATION = 1e-9  # [m], standard deviation of each coordinate at the release
DURATION = TABLE_2_DURATION  # [s]; members are Table 2's last case
INTERVAL = 1e-3  # [s]
POWER_UNTIL = 0.1  # [s]
GROWTHS = ((2e-7, 1e-5), (1e-5, 1e-3))  # [m]: ranges in which growth is taken as exponential

UNDAMPED = {"zeta": 0.0}
UNBUCKLED = {"alpha": 1e12, "alpha_crease": 1e12}


# --- runs ---


@dataclass
class Deployment:
    """A run after the release: S rows.

    `times` (S,) [s], the first one 0; `positions` (S, N, 3) of the nodes [m]; deployment `rate` [-]
    and mean `phase` difference [rad], both (S,). Of the ledger, one step before, 0 if it was off,
    all (S,): its `balance` and the `spool_work` [J]; by what its `angular_momentum` [kg m2/s]
    changed beyond the impulse, the `angular_defect`; and what of the balance is `unexplained` [J]
    by the error at kinks, where sides buckle or become taut.
    """

    times: np.ndarray
    positions: np.ndarray
    rate: np.ndarray
    phase: np.ndarray
    balance: np.ndarray
    spool_work: np.ndarray
    angular_defect: np.ndarray
    angular_momentum: np.ndarray
    unexplained: np.ndarray

    def at(self, time: float) -> int:
        """Row of the time nearest to `time` [s]."""
        return int(np.argmin(np.abs(self.times - time)))


@cache
def _equilibrium(p, seed):
    yade.Omega().reset()
    _, built = driver.build(p)
    if seed:
        built.place(perturbed(built.positions(), seed))
    driver.spin_up(built, p)
    return built.positions()


def equilibrium(p: SailParameters, seed: int = 0) -> np.ndarray:
    """Positions (N, 3) [m] of the folded sail at rest in the turning frame; computed once.

    Other seeds than 0: with the folded sail `perturbed` before the spin-up.
    """
    default = SailParameters()
    return _equilibrium(replace(p, dt=default.dt, duration=default.duration), seed)


def begin(
    p: SailParameters, positions: np.ndarray, ledger: bool = True
) -> tuple[Sail, scene.MembraneScene]:
    """Build the sail of `p`, put its nodes at `positions` (N, 3) [m], release it."""
    yade.Omega().reset()
    sail, built = driver.build(p)
    built.place(positions)
    driver.release(sail, built, p.omega, p.dt)
    built.ledger.dead = not ledger
    return sail, built


def deploy(
    p: SailParameters, interval: float, *, positions: np.ndarray | None = None, ledger: bool = False
) -> Deployment:
    """Release the sail from `positions` (N, 3) [m], by default the equilibrium, and `follow` it."""
    start = equilibrium(p) if positions is None else positions
    return follow(*begin(p, start, ledger), p, interval)


def follow(
    sail: Sail, built: scene.MembraneScene, p: SailParameters, interval: float
) -> Deployment:
    """Run a released sail for p.duration, with rows every `interval` [s], a multiple of p.dt."""
    stride, rows = round(interval / p.dt), round(p.duration / interval)
    if rows < 1 or abs(stride * p.dt / interval - 1) > 1e-9:
        raise ValueError(f"interval = {interval} s must be a multiple of dt = {p.dt} s")
    frames, book = [built.positions()], [(0.0, 0.0, 0.0, 0.0, 0.0)]
    for _ in driver.march(driver.Steps(p.dt, stride, rows, 0)):
        frames.append(built.positions())
        kept = built.ledger
        momentum = kept.angularMomentum
        defect = momentum - kept.initialAngularMomentum - kept.angularImpulse
        book.append((kept.balance, kept.drivenWork, defect, momentum, kept.unexplained))
    times = interval * np.arange(rows + 1)
    azimuths = np.array([measures.tip_azimuths(sail.mesh, x) for x in frames])
    rates = np.array([measures.deployment_rate(sail.mesh, x) for x in frames])
    phases = measures.phase_difference(azimuths, p.omega * times).mean(axis=1)
    return Deployment(times, np.array(frames), rates, phases, *np.array(book).T)


def perturbed(positions: np.ndarray, seed: int) -> np.ndarray:
    """`positions` (N, 3) [m], each coordinate off by about PERTURBATION."""
    noise = np.random.default_rng(seed).standard_normal(positions.shape)
    return positions + PERTURBATION * noise


def members(p: SailParameters, count: int, ledger: bool = False) -> list[Deployment]:
    """`count` runs from one equilibrium; the first may keep the ledger, others start perturbed."""
    start = equilibrium(p)
    first = deploy(p, INTERVAL, positions=start, ledger=ledger)
    return [first, *(deploy(p, INTERVAL, positions=perturbed(start, s)) for s in range(1, count))]


@cache
def ensemble() -> list[Deployment]:
    """MEMBERS runs of the default parameters; the first keeps the ledger."""
    return members(SailParameters(duration=DURATION), MEMBERS, ledger=True)


def rms(difference: np.ndarray) -> np.ndarray:
    """Root mean square over all nodes of differences (..., N, 3) [m] of positions."""
    return np.sqrt(np.mean(np.sum(difference**2, axis=-1), axis=-1))


# --- order in time ---


def step_errors(
    steps: Iterable[float], reference: float, duration: float, **changes: Any
) -> np.ndarray:
    """Errors (len(steps),) [m] of positions at `duration` [s] against a run at step `reference`.

    `changes` go to SailParameters; the equilibrium is that of the defaults.
    """
    start = equilibrium(SailParameters())
    p = SailParameters(duration=duration, **changes)
    runs = [deploy(replace(p, dt=dt), duration, positions=start) for dt in (*steps, reference)]
    return np.array([rms(r.positions[-1] - runs[-1].positions[-1]) for r in runs[:-1]])


def order_checks(full: bool) -> list[Check]:
    """Order of the time integration, part by part and of all together."""
    cases: list[tuple[str, dict, float]] = [
        ("smooth: no damping, no buckling", {**UNDAMPED, **UNBUCKLED}, 0.1),
        ("sides buckle, no damping", UNDAMPED, 0.25),
        ("damping, no buckling", UNBUCKLED, 0.1),
        ("all", {}, 0.25),
    ]
    steps = ORDER_STEPS if full else ORDER_STEPS[-2:]
    found = []
    for name, changes, tolerance in cases if full else cases[:1]:
        errors = step_errors(steps, REFERENCE_STEP, ORDER_TIME, **changes)
        title = f"order in time, {1e3 * ORDER_TIME:g} ms, {name}"
        found.append(Check(title, order(errors), 2, tolerance, "leapfrog, central differences"))
    if full:
        errors = step_errors(LATER_STEPS, LATER_REFERENCE, LATER_TIME)
        title = f"{1e3 * LATER_TIME:g} ms, all"
        late = "fast vibration of buckled sides after the release is out of phase; no order shows"
        found.append(recorded(f"order in time, {title}", order(errors), 0.51, 0.3, late))
        title = f"error of positions at dt = 5e-6 s, {title}"
        found.append(recorded(title, errors[0], 2.2e-5, 1e-5, "", "m"))
    return found


# --- ledgers ---


def energy_errors(p: SailParameters) -> tuple[float, float, float, float]:
    """Where the energy of the sides goes astray, run from the release for p.duration.

    The leapfrog's work is the mean of a side's forces at both ends of a step times its motion;
    its energy changes by the integral of the force between. They differ where the tension is no
    straight line over the step (a side buckles or becomes taut: a kink) and where the side turns.

    Returns sums over steps and sides at kinks and of turning, and the ledger's balance and
    kinkError, all in J.
    """
    _, built = begin(p, equilibrium(SailParameters()))
    net = built.membrane
    a, b = np.array(net.sides).T
    stiffness, rest = np.array(net.stiffnesses), np.array(net.restLengths)
    critical = np.array(net.criticalLengths)

    def look():
        x = np.array(built.forces.lastPositions())
        span = x[b] - x[a]
        length = np.linalg.norm(span, axis=1)
        stretch = np.maximum(length, critical) - rest
        energy = stiffness * stretch * (0.5 * stretch + np.minimum(0, length - critical))
        return span, length, stiffness * stretch, energy

    kinks = turns = 0.0
    scene.advance(1)
    old = look()
    for _ in range(round(p.duration / p.dt) - 1):
        scene.advance(1)
        new = look()
        growth = new[3] - old[3]
        straight = 0.5 * (old[2] + new[2]) * (new[1] - old[1])
        force = 0.5 * ((old[2] / old[1])[:, None] * old[0] + (new[2] / new[1])[:, None] * new[0])
        work = np.sum(force * (new[0] - old[0]), axis=1)
        kinks += np.sum(growth - straight)
        turns += np.sum(straight - work)
        old = new
    return float(kinks), float(turns), built.ledger.balance, built.ledger.kinkError


def ledger_checks() -> list[Check]:
    """Energy and angular momentum of the whole run, and what breaks the energy's balance."""
    p = SailParameters(duration=LEDGER_TIME)
    runs = {LEDGER_STEPS[0]: ensemble()[0]}
    for dt in LEDGER_STEPS[1:]:
        runs[dt] = deploy(replace(p, dt=dt), INTERVAL, ledger=True)
    kink = "sides run through their kinks in less than a step; falls with its square"
    found = []
    for (dt, run), last in zip(runs.items(), LAST_IMBALANCE):
        rows = slice(run.at(LEDGER_TIME) + 1)

        def most(values: np.ndarray, scale: np.ndarray) -> float:
            return float(np.abs(values[rows]).max() / np.abs(scale[rows]).max())

        energy, beyond = most(run.balance, run.spool_work), most(run.unexplained, run.spool_work)
        angular = most(run.angular_defect, run.angular_momentum)
        title = f"{LEDGER_TIME:g} s at dt = {dt:g} s: "
        name = title + "energy imbalance over spool work"
        found.append(recorded(name, energy, last, 0.5 * last, kink))
        name = title + "imbalance beyond the error at kinks over spool work"
        found.append(at_most(name, beyond, 1e-6, "every energy and work is accounted for"))
        name = title + "angular momentum beyond the impulse"
        found.append(at_most(name, angular, 1e-12, "leapfrog under its own torque"))
    missing = [abs(early(1, dt).balance[-1]) for dt in STEPS]
    for dt, *pair in zip(STEPS, missing, missing[1:]):
        name = f"order of the energy imbalance at {EARLY_TIMES[-1]:g} s, dt = {dt:g} s halved"
        found.append(Check(name, order(pair), 2, 0.4, "kinks: second order"))

    p = SailParameters(duration=SHOCK_TIME)
    kinks, turns, balance, booked = energy_errors(p)
    straight = energy_errors(replace(p, **UNBUCKLED))[2]
    title = f"first {1e3 * SHOCK_TIME:g} ms: "
    rest = "all else in the ledger is exact"
    name = title + "errors at kinks and of turning over the imbalance"
    return found + [
        Check(name, (kinks + turns) / balance, 1, 1e-3, rest),
        Check(title + "kinks in the ledger over those in NumPy", booked / kinks, 1, 1e-6, "twice"),
        recorded(title + "share of the kinks", kinks / balance, 0.9998, 1e-2, "the rest: turning"),
        recorded(title + "energy imbalance", balance, -9.24e-7, 2e-7, kink, "J"),
        recorded(title + "the same if no side buckles", straight, 5.06e-8, 2e-8, "no kinks", "J"),
    ]


# --- steps and meshes ---


@cache
def early(
    refine: int, dt: float | None, seed: int = 0, changes: tuple = (("as_printed", True),)
) -> Deployment:
    """The run up to the last of EARLY_TIMES; `dt` None: MESH_STEP of the critical one.

    `seed`: of the `equilibrium` from which it is released; `changes`: items of SailParameters,
    the paper's as printed by default.
    """
    p = SailParameters(refine=refine, duration=EARLY_TIMES[-1], **dict(changes))
    start = equilibrium(p, seed)
    if dt is None:
        _, built = begin(replace(p, dt=STEPS[-1]), start)
        limit = MESH_STEP * built.forces.criticalTimeStep()
        dt = EARLY_TIMES[0] / np.ceil(EARLY_TIMES[0] / limit)
    return deploy(replace(p, dt=dt), EARLY_TIMES[0], positions=start, ledger=True)


# Last values at EARLY_TIMES by step [s]: rate [-] and phase difference [deg].
LAST_EARLY = {
    5e-6: (
        (0.095177, 0.210176, 0.465524, 0.718628, 0.773438),
        (-0.5542, -3.4736, -9.3439, -18.7202, -29.3287),
    ),
    2.5e-6: (
        (0.095072, 0.210708, 0.465152, 0.715697, 0.76861),
        (-0.5543, -3.4741, -9.348, -18.7268, -29.3459),
    ),
    1.25e-6: (
        (0.095072, 0.210558, 0.464855, 0.72034, 0.767576),
        (-0.5544, -3.4751, -9.3463, -18.7161, -29.3185),
    ),
}

# Last values at EARLY_TIMES by `refine`: mean and spread of rate [-] and phase difference [deg].
LAST_MESHES = {
    1: (
        ((0.0953, 0.0001), (0.2106, 0.0004), (0.4645, 0.0006), (0.7183, 0.0010), (0.7734, 0.0055)),
        ((-0.555, 0.0008), (-3.477, 0.0013), (-9.347, 0.0045), (-18.72, 0.0111), (-29.34, 0.0174)),
    ),
    2: (
        ((0.0882, 0.0012), (0.2014, 0.0015), (0.4375, 0.0013), (0.6111, 0.0037), (0.6360, 0.0064)),
        ((-0.557, 0.0030), (-3.459, 0.0133), (-9.208, 0.0655), (-18.03, 0.132), (-27.71, 0.140)),
    ),
    3: (
        ((0.0838, 0.0022), (0.1924, 0.0043), (0.3647, 0.0144), (0.4540, 0.0209), (0.4164, 0.0243)),
        ((-0.542, 0.0055), (-3.307, 0.0536), (-8.535, 0.201), (-15.65, 0.577), (-23.54, 0.847)),
    ),
}


def step_checks() -> list[Check]:
    """Rate and phase difference at early times, and how they change with the step."""
    runs = [early(1, dt) for dt in STEPS]
    measured = np.array([(run.rate[1:], np.degrees(run.phase[1:])) for run in runs])
    last = np.array([LAST_EARLY[dt] for dt in STEPS])
    for values in (measured, last):
        values[1:] -= values[0]
    found = []
    for dt, here, before in zip(STEPS, measured.tolist(), last.tolist()):
        first = dt == STEPS[0]
        change, against = (
            ("", "one run") if first else ("change of ", f"against dt = {STEPS[0]:g} s")
        )
        for kind, unit, room, *rows in zip(
            ("rate", "phase"), ("-", "deg"), (0.02, 0.3), here, before
        ):
            for time, now, then in zip(EARLY_TIMES, *rows):
                title = f"dt = {dt:g} s: {change}{kind} at {time:g} s"
                found.append(recorded(title, now, then, room, against, unit))
    return found


def mesh_checks() -> list[Check]:
    """Rate and phase difference at early times on each mesh: mean and spread over spin-ups.

    The finer the film, the more shapes there are in which it can come to rest.
    """
    source = f"{MEMBERS} spin-ups of folded sails, {PERTURBATION:g} m apart"
    found = []
    for refine, last in LAST_MESHES.items():
        runs = [early(refine, None, seed) for seed in range(MEMBERS)]
        found += spread_checks(runs, EARLY_TIMES, last, source, f"refine = {refine}: ")
    return found


# --- ensemble ---


def spread_checks(
    runs: Sequence[Deployment], times: Sequence[float], last: tuple, source: str, title: str = ""
) -> list[Check]:
    """Mean and spread of rate and phase difference [deg] over `runs`, at `times` [s].

    `last`: of both, the last (mean, spread) at each time. Names begin with `title`.
    """
    rates, phases = np.array([r.rate for r in runs]), np.degrees([r.phase for r in runs])
    found = []
    for time, *before in zip(times, *last):
        row = runs[0].at(time)
        values = ("rate", "-", rates[:, row]), ("phase", "deg", phases[:, row])
        for (kind, unit, here), (mean, spread) in zip(values, before):
            off = here.std(ddof=1)
            rows = ("mean", here.mean(), mean, 3 * spread), ("spread", off, spread, 2 * spread)
            for name, now, then, room in rows:
                name = f"{title}{kind} at {time:g} s: {name}"
                found.append(recorded(name, float(now), then, room, source, unit))
    return found


def growth_times(
    times: np.ndarray, distances: np.ndarray, within: tuple[float, float]
) -> np.ndarray:
    """Times [s] in which distances (M, S) [m] between runs grow by e while they are `within`.

    Straight lines through the logarithms, from a distance's last row below the lower of the two
    limits [m] to its first one beyond the upper.
    """
    found = []
    for distance in distances:
        beyond = int(np.argmax(distance > within[1]))
        first = int(np.flatnonzero(distance[:beyond] < within[0])[-1])
        rows = slice(first, beyond + 1)
        found.append(1 / np.polyfit(times[rows], np.log(distance[rows]), 1)[0])
    return np.array(found)


def draw(runs: Sequence[Deployment], distances: np.ndarray, path: Path) -> None:
    """Rates, phases and distances (M, S) [m] of the ensemble `runs` over time, to `path`."""
    figure = Figure(figsize=(7, 8), layout="constrained")
    rate, phase, growth = figure.subplots(3, 1)
    times = runs[0].times
    rates, phases = np.array([r.rate for r in runs]), np.degrees([r.phase for r in runs])
    for axes, values in (rate, rates), (phase, phases):
        mean, spread = np.mean(values, axis=0), np.std(values, axis=0, ddof=1)
        axes.plot(times, np.transpose(values), color="C1", linewidth=0.5, alpha=0.7)
        axes.plot(times, mean, color="C0", label="mean")
        axes.fill_between(times, mean - 2 * spread, mean + 2 * spread, alpha=0.3, label="2 spreads")
    rate.set(xlabel="time [s]", ylabel="deployment rate [-]")
    rate.legend(frameon=False)
    phase.set(xlabel="time [s]", ylabel="mean phase difference [deg]")
    growth.loglog(times[1:], distances[:, 1:].T, color="C0", linewidth=0.8)
    for limit in np.unique(GROWTHS):
        dotted = growth.axhline(limit, color="0.5", linewidth=0.8, linestyle=":")
    growth.legend([dotted], ["between these exponentials are fitted"], frameon=False)
    growth.set(xlabel="time [s]", ylabel="distance from the first run [m]")
    for axes in (rate, phase, growth):
        axes.grid(alpha=0.3)
        axes.margins(x=0)
    plots.save(figure, path, dpi=100)


# Last values: Lyapunov times [s] within GROWTHS, the power of time with which distances grow,
# mean and spread of rate and phase difference [deg] at MEAN_TIMES.
LAST_GROWTH = (2.17e-3, 14.6e-3)
LAST_POWER = 2.5
MEAN_TIMES = (0.05, 0.1, 0.2, 0.5, 1.0)
LAST_MEANS = (
    ((0.3221, 0.0004), (0.7745, 0.0030), (0.4121, 0.0068), (0.6610, 0.0228), (0.6944, 0.0080)),
    ((-5.998, 0.0012), (-29.32, 0.0113), (-61.57, 0.234), (-71.76, 0.568), (67.38, 1.309)),
)


def ensemble_checks() -> list[Check]:
    """Growth of tiny differences, and mean and spread over the ensemble, early and late."""
    runs = ensemble()
    times = runs[0].times
    distances = np.array([rms(r.positions - runs[0].positions) for r in runs[1:]])
    draw(runs, distances, PICTURE)
    found = []
    chaos = "no single exponent: small folds diverge first and fast, then saturate"
    for within, last in zip(GROWTHS, LAST_GROWTH):
        name = f"Lyapunov time, distances {within[0]:g} m to {within[1]:g} m"
        measured = float(growth_times(times, distances, within).mean())
        found.append(recorded(name, measured, last, 0.3 * last, chaos, "s"))
    grows = slice(1, runs[0].at(POWER_UNTIL) + 1)
    mean = np.exp(np.log(distances[:, grows]).mean(axis=0))
    power = float(np.polyfit(np.log(times[grows]), np.log(mean), 1)[0])
    name = f"distances grow with this power of time until {POWER_UNTIL:g} s"
    found.append(recorded(name, power, LAST_POWER, 0.3, "a straight line, both logarithmic"))
    source = f"{MEMBERS} runs, {PERTURBATION:g} m apart at the release"
    return found + spread_checks(runs, MEAN_TIMES, LAST_MEANS, source)


def checks(full: bool) -> list[Check]:
    """Checks of the deployment: order in time; `full`, also ledgers, meshes and the ensemble."""
    found = order_checks(full)
    if full:
        found += ledger_checks() + step_checks() + mesh_checks() + ensemble_checks()
    return found
