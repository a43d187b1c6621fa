# SPDX-License-Identifier: GPL-2.0-or-later
"""Charts accuracy against time: path, time step, mesh and parts left out, on one grid.

Three questions, each with its error and its processor time on one thread: the early deployment
curve against the finest mesh, the spinning disk's frequencies against the closed form, and the
energy ledger. Writes reference/chart.csv and chart.png.
"""

import statistics
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from yade import wrapper as yade

from .. import scene
from ..parameters import SailParameters
from .verification import deployment, spinning
from .verification.variant import Variant

DURATION, INTERVAL = 0.1, 1e-3  # of the deployments [s]; single curves can be compared so long
FINEST: dict = {"refine": 4, "as_printed": True, "dt": 1.25e-6}
TURNS = 1.5  # of the disks
Tell = Callable[[str], None]

HEADER = """\
# Accuracy against time. Made by `scripts/run.sh chart`, on one thread.
# question: "deployment": rms error of the deployment rate [-] over the first 0.1 s, against
#   refine = 4, dt = 1.25e-6 s; "ledger": largest energy imbalance over kinetic energy [-] in
#   the same runs; "disk": largest relative error of the frequencies of modes (2,0), (0,1), (3,0)
# part: what was left out; mesh: refine of the sail, cells of the disk; dt_s: time step [s]
# us_per_step: processor time of a step [us]; cost_s: that of the paper's 1 s of deployment, or of
#   one turn of the disk [s]; pareto: 1 if nothing is both cheaper and more accurate
"""
COLUMNS = "question,path,part,mesh,nodes,dt_s,us_per_step,cost_s,error,pareto"


@dataclass
class Point:
    """One setting and what came of it."""

    question: str
    path: str
    part: str
    mesh: int
    nodes: int
    dt: float
    us_per_step: float
    cost: float
    error: float
    pareto: bool = False

    def line(self) -> str:
        """Its row of the table."""
        return (
            f'{self.question},{self.path},"{self.part}",{self.mesh},{self.nodes},{self.dt:.4g},'
            f"{self.us_per_step:.4g},{self.cost:.4g},{self.error:.4g},{int(self.pareto)}"
        )


@dataclass(frozen=True)
class Setting(Variant):
    """A deployment on the grid; `part` names what was left out."""

    duration: float = DURATION  # s
    part: str = ""


def grid(quick: bool) -> list[Setting]:
    """Settings of the deployments."""
    steps = {1: (1e-5, 5e-6, 2.5e-6, 1.25e-6), 2: (5e-6, 2.5e-6), 3: (2.5e-6, 1.25e-6)}
    fused = [Setting({"refine": n, "dt": dt}) for n in steps for dt in steps[n]]
    slow = [(1, 1e-5), (1, 5e-6), (1, 2.5e-6)] + ([] if quick else [(2, 5e-6)])
    law2 = [Setting({"path": "law2", "refine": n, "dt": dt}) for n, dt in slow]
    parts = []
    for refine, dt in ((1, 5e-6),) if quick else ((1, 5e-6), (2, 2.5e-6)):
        base = {"refine": refine, "dt": dt}
        parts += [
            Setting({**base, "beta": 0.0}, part="creases", rests=True),
            Setting({**base, "air_density": 0.0}, part="drag"),
            Setting({**base, "zeta": 0.0}, part="damping"),
            Setting({**base, "gravity": 0.0}, part="gravity", rests=True),
            Setting(base, part="ledger", ledger=False),
        ]
    return fused + law2 + parts


def deployments(settings: list[Setting], rounds: int, steps: int, tell: Tell) -> list[Point]:
    """Points of the questions "deployment" and "ledger"."""
    tell(f"the reference, refine = {FINEST['refine']}")
    finest = deployment.deploy(SailParameters(duration=DURATION, **FINEST), INTERVAL, ledger=False)
    errors = {}
    for setting in settings:
        p = setting.parameters()
        tell(f"{p.path}, refine = {p.refine}, dt = {p.dt:g} s, without {setting.part or 'nothing'}")
        start = setting.start()
        _, built = deployment.begin(replace(p, force_time_step=True), start)
        limit = built.forces.criticalTimeStep()
        if p.dt > limit:
            tell(f"left out: dt is above the critical time step, {limit:.3g} s")
            continue
        try:
            run = deployment.deploy(p, INTERVAL, positions=start, ledger=setting.ledger)
        except RuntimeError as error:
            tell(f"left out: {error}")
            continue
        curve = float(np.sqrt(np.mean((run.rate - finest.rate) ** 2)))
        energy = np.abs(run.balance).max() / kinetic_energy(p, run) if setting.ledger else np.nan
        errors[id(setting)] = curve, energy, run.positions.shape[1]
    settings = [setting for setting in settings if id(setting) in errors]
    taken: dict[int, list] = {id(setting): [] for setting in settings}
    for turn in range(rounds):
        tell(f"times, round {turn + 1} of {rounds}")
        for setting in settings:
            refine = setting.parameters().refine
            taken[id(setting)].append(setting.step_time(max(50, steps // refine**2)))
    points = []
    for setting in settings:
        p, (curve, energy, nodes) = setting.parameters(), errors[id(setting)]
        step = statistics.median(taken[id(setting)])
        about = p.path, setting.part, p.refine, nodes, p.dt, 1e6 * step, step / p.dt
        points.append(Point("deployment", *about, curve))
        if setting.ledger:
            points.append(Point("ledger", *about, energy))
    return points


def kinetic_energy(p: SailParameters, run: deployment.Deployment) -> float:
    """Of the sail that turns at p.omega as it is at the release [J]."""
    _, built = deployment.begin(p, run.positions[0])
    radius2 = np.sum(run.positions[0][:, :2] ** 2, axis=1)
    return 0.5 * p.omega**2 * np.sum(built.masses() * radius2)


def disks(quick: bool, tell: Tell) -> list[Point]:
    """Points of the question "disk"."""
    points = []
    modes = {name: spinning.DISK_MODES[name] for name in ("(2,0)", "(0,1)", "(3,0)")}
    for cells in (8, 16) if quick else (8, 16, 32):
        for path in scene.PATHS:
            for share in (0.9, 0.45):
                tell(f"disk of {cells} cells, {path}, {share:g} of the critical step")
                disk = spinning.spin_disk(cells, turns=TURNS, path=path, step=share)
                error = max(
                    abs(
                        disk.frequency[name]
                        / spinning.disk_frequency(*mode, spinning.LATTICE_POISSON)
                        - 1
                    )
                    for name, mode in modes.items()
                )
                steps = 2 * np.pi / spinning.OMEGA / disk.dt
                nodes = len(yade.Omega().bodies)
                about = path, "", cells, nodes, disk.dt, 1e6 * disk.step_time
                points.append(Point("disk", *about, disk.step_time * steps, error))
    return points


def mark_pareto(points: list[Point]) -> None:
    """Mark the points that none of the same question beats in both cost and error."""
    for point in points:
        rivals = [q for q in points if q.question == point.question and q is not point]
        point.pareto = not any(
            q.cost <= point.cost
            and q.error <= point.error
            and (q.cost < point.cost or q.error < point.error)
            for q in rivals
        )


def table(points: list[Point]) -> str:
    """Text of chart.csv."""
    return HEADER + "\n".join([COLUMNS, *(p.line() for p in points)]) + "\n"


def measure(quick: bool, rounds: int, steps: int, tell: Tell) -> list[Point]:
    """All Points of the grid, or of a small one if `quick`.

    `rounds` and `steps` are of the timing, the steps those at refine = 1; `tell` takes a line of
    text about what comes next.
    """
    points = deployments(grid(quick), rounds, steps, tell) + disks(quick, tell)
    mark_pareto(points)
    return points
