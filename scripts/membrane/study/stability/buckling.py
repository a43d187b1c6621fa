# SPDX-License-Identifier: GPL-2.0-or-later
"""Buckling: the parameter alpha, tethers that snap taut, and sheets of which every side is
buckled.

- `alpha`: the paper's sail released from its fold, without the spin-up before, for 0.02 s at
  alpha from 0 to 1e6 on all sides: imbalance of the ledger over the largest kinetic energy, at
  two steps.
- `snap`: a mass on a slack tether of four segments falls, snaps it taut and is thrown up again,
  many times; undamped. Change of the total energy over the kinetic energy of the fall, over the
  step.
- `shrunk`: a free sheet shrunk in all directions, up to a point, and let go: largest extent over
  that at rest.
"""

from itertools import product

import numpy as np
from matplotlib.figure import Figure
from membrane import scene
from membrane.parameters import SailParameters
from membrane.run import driver

from .common import Model, O, figure, grid, publish

HEADER = "part; x; x means; step / estimate [-]; step [s]; value; value means"
GRAVITY = 9.81
TETHER, TETHER_EA, TETHER_DENSITY = 0.0478, 200.0, 2e-4  # m, N, kg/m
FALL, MASS = 0.01, 0.36e-3  # m, kg


def early_deployment(alpha: float, step: float, seconds: float) -> tuple[float, float, float]:
    """Largest imbalance over the kinetic energy, that energy [J], and step / estimate."""
    O.reset()
    p = SailParameters(alpha=alpha, alpha_crease=alpha)
    sail, built = driver.build(p)
    estimate = built.forces.criticalTimeStep()
    driver.release(sail, built, p.omega, step)
    largest, error = 0.0, 0.0
    try:
        for _ in range(10):
            scene.advance(int(seconds / step / 10))
            largest = max(largest, built.ledger.kinetic)
            error = max(error, abs(built.ledger.balance))
    except RuntimeError:
        return np.inf, np.inf, step / estimate
    return error / largest, largest, step / estimate


def snaps(share: float, count: int) -> tuple[float, float, int]:
    """Largest energy error over the energy of a fall up to `count` falls; step [s]; falls seen."""
    nodes = np.zeros((5, 3))
    nodes[:, 2] = np.linspace(0, -TETHER, 5)
    model = Model(
        nodes,
        cables=[(i, i + 1) for i in range(4)],
        pointMasses=[0, 0, 0, 0, MASS],
        cableStiffness=TETHER_EA,
        cableDensity=TETHER_DENSITY,
        gravity=GRAVITY,
    )
    model.sail.hold([0])
    model.place(nodes * [1, 1, 1 - FALL / TETHER])
    O.dt = share * model.forces.criticalTimeStep()
    ledger = model.start_ledger()
    rising, seen, error, end = False, 0, 0.0, model.states[4]
    for _ in range(int(count * 2.5 * np.sqrt(2 * FALL / GRAVITY) / O.dt)):
        O.step()
        now = end.vel[2] > 0.1 * np.sqrt(2 * GRAVITY * FALL)
        seen, rising = seen + (now and not rising), end.vel[2] > 0 and (now or rising)
        error = max(error, abs(ledger.total - ledger.initial))
        if seen >= count:
            break
    return error / (MASS * GRAVITY * FALL), O.dt, seen


def shrunk(factor: float, share: float, seconds: float) -> tuple[float, float, float, float]:
    """Largest, last extent over that at rest, relative energy error, step [s] of a sheet."""
    nodes, triangles = grid(5)
    nodes = nodes - nodes.mean(axis=0)
    model = Model(nodes, triangles, engine={"zeta": 0.02})
    tiny = 1e-9 * np.random.default_rng(1).normal(size=nodes.shape)
    model.place(factor * nodes + (tiny if factor else 0.0))
    O.dt = share * model.forces.criticalTimeStep()
    ledger = model.start_ledger()
    extents, rest = [], np.linalg.norm(nodes, axis=1).max()
    try:
        for _ in range(20):
            scene.advance(max(1, int(seconds / O.dt / 20)))
            extents.append(np.linalg.norm(model.positions(), axis=1).max() / rest)
    except RuntimeError:
        return np.inf, np.inf, np.inf, O.dt
    return max(extents), extents[-1], ledger.balance / ledger.initial, O.dt


def run(quick: bool) -> str:
    """Measure all parts; returns a line of text."""
    rows: list[list] = []
    alphas = (0.0, 100.0, 1e6) if quick else (0.0, 1.0, 100.0, 1e3, 1e4, 1e5, 1e6)
    for alpha, step in product(alphas, (5e-6,) if quick else (5e-6, 2.5e-6)):
        error, energy, share = early_deployment(alpha, step, 0.002 if quick else 0.02)
        where = "alpha", alpha, "alpha [-]", share, step
        rows.append([*where, error, "imbalance / largest kinetic energy [-]"])
        rows.append([*where, energy, "largest kinetic energy [J]"])
    for share in (0.9, 0.1) if quick else (0.99, 0.9, 0.5, 0.25, 0.1, 0.05):
        error, step, seen = snaps(share, 2 if quick else 20)
        text = "energy error / fall's [-]"
        rows.append(["snap", seen, "falls caught [-]", share, step, error, text])
    texts = "largest extent / rest [-]", "last extent / rest [-]", "imbalance / first energy [-]"
    for factor in (0.5, 0.0) if quick else (0.99, 0.9, 0.5, 0.1, 0.01, 0.0):
        *values, step = shrunk(factor, 0.5, 0.005 if quick else 0.1)
        for value, text in zip(values, texts):
            rows.append(["shrunk", factor, "size / rest [-]", 0.5, step, value, text])
    publish("buckling", quick, HEADER, rows, draw(rows))
    errors = column(5, rows, "alpha", "imbalance", 5e-6)
    listed = ", ".join(f"{row[5]:.1e} at {row[3]:g}" for row in rows if row[0] == "snap")
    extents = column(5, rows, "shrunk", "largest extent")
    ends = column(5, rows, "shrunk", "last extent")
    return (
        f"alpha 0 ... 1e6: imbalance {min(errors):.1e} ... {max(errors):.1e} of the kinetic energy "
        f"at 5e-6 s; snapping tether: energy error over a fall's {listed} of the estimate; shrunk "
        f"sheets stay finite: {'yes' if np.isfinite(extents).all() else 'no'}, extent at the end "
        f"{min(ends):.3g} ... {max(ends):.3g} of that at rest"
    )


def column(
    number: int, rows: list[list], part: str, text: str = "", step: float | None = None
) -> list[float]:
    """Values in a column of the rows of a part whose meaning begins with `text`, at a step [s]."""
    wanted = [r for r in rows if r[0] == part and r[6].startswith(text)]
    return [row[number] for row in wanted if step in (None, row[4])]


def draw(rows: list[list]) -> Figure:
    """Three panels, one a part."""
    drawing, (first, second, third) = figure(columns=3, width=4.4)
    for step in sorted(set(column(4, rows, "alpha"))):
        mine = rows, "alpha", "imbalance", step
        first.plot(column(1, *mine), column(5, *mine), "o-", label=f"dt = {step:g} s")
    first.set_xscale("symlog")
    first.set(xlabel="alpha [-]", ylabel="imbalance / kinetic energy [-]", yscale="log")
    second.loglog(column(3, rows, "snap"), column(5, rows, "snap"), "o-", label="measured")
    second.axvline(1.0, color="C3", label="estimate")
    second.set(xlabel="step / estimate [-]", ylabel="energy error / energy of a fall [-]")
    for text in ("largest extent", "last extent"):
        values = column(5, rows, "shrunk", text)
        third.plot(column(1, rows, "shrunk", text), values, "o-", label=text)
    third.set(xlabel="size at the start / rest [-]", ylabel="extent / rest [-]")
    for axis in (first, second, third):
        axis.legend(fontsize=7)
    return drawing
