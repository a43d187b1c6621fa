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

from pathlib import Path

import numpy as np
from membrane import scene
from membrane.parameters import SailParameters
from membrane.run import driver

from .common import Model, O, figure, folder, grid, save, write_table

HEADER = ("part", "x", "x means", "step / estimate [-]", "step [s]", "value", "value means")
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
    model.states[0].blockedDOFs = "xyzXYZ"
    lifted = nodes.copy()
    lifted[:, 2] *= 1 - FALL / TETHER
    model.place(lifted)
    O.dt = share * model.forces.criticalTimeStep()
    ledger = model.start_ledger()
    ledger.dead = False
    rising, seen, error = False, 0, 0.0
    fall = MASS * GRAVITY * FALL
    end = model.states[4]
    for _ in range(int(count * 2.5 * np.sqrt(2 * FALL / GRAVITY) / O.dt)):
        O.step()
        now = end.vel[2] > 0.1 * np.sqrt(2 * GRAVITY * FALL)
        seen, rising = seen + (now and not rising), end.vel[2] > 0 and (now or rising)
        error = max(error, abs(ledger.total - ledger.initial))
        if seen >= count:
            break
    return error / fall, O.dt, seen


def shrunk(factor: float, share: float, seconds: float) -> tuple[float, float, float, float]:
    """Largest, last extent over that at rest, relative energy error, step [s] of a sheet."""
    nodes, triangles = grid(5)
    nodes = nodes - nodes.mean(axis=0)
    model = Model(nodes, triangles, engine={"zeta": 0.02})
    tiny = 1e-9 * np.random.default_rng(1).normal(size=nodes.shape)
    model.place(factor * nodes + (tiny if factor else 0.0))
    O.dt = share * model.forces.criticalTimeStep()
    ledger = model.start_ledger()
    ledger.dead = False
    largest = 0.0
    extent = np.linalg.norm(nodes, axis=1).max()
    try:
        for _ in range(20):
            scene.advance(max(1, int(seconds / O.dt / 20)))
            largest = max(largest, np.linalg.norm(model.positions(), axis=1).max() / extent)
    except RuntimeError:
        return np.inf, np.inf, np.inf, O.dt
    last = np.linalg.norm(model.positions(), axis=1).max() / extent
    return largest, last, ledger.balance / ledger.initial, O.dt


def run(quick: bool) -> str:
    """Measure all parts; returns a line of text."""
    rows: list[list] = []
    alphas = (0.0, 100.0, 1e6) if quick else (0.0, 1.0, 100.0, 1e3, 1e4, 1e5, 1e6)
    for alpha in alphas:
        for step in (5e-6,) if quick else (5e-6, 2.5e-6):
            error, energy, share = early_deployment(alpha, step, 0.002 if quick else 0.02)
            text = "imbalance / largest kinetic energy [-]"
            rows.append(["alpha", alpha, "alpha [-]", share, step, error, text])
            text = "largest kinetic energy [J]"
            rows.append(["alpha", alpha, "alpha [-]", share, step, energy, text])
    for share in (0.9, 0.1) if quick else (0.99, 0.9, 0.5, 0.25, 0.1, 0.05):
        error, step, seen = snaps(share, 2 if quick else 20)
        rows.append(
            ["snap", seen, "falls caught [-]", share, step, error, "energy error / fall's [-]"]
        )
    for factor in (0.5, 0.0) if quick else (0.99, 0.9, 0.5, 0.1, 0.01, 0.0):
        largest, last, error, step = shrunk(factor, 0.5, 0.005 if quick else 0.1)
        for value, text in (
            (largest, "largest extent / rest [-]"),
            (last, "last extent / rest [-]"),
            (error, "imbalance / first energy [-]"),
        ):
            rows.append(["shrunk", factor, "size / rest [-]", 0.5, step, value, text])
    out = folder(quick)
    write_table(out / "buckling.csv", HEADER, rows)
    draw(rows, out / "buckling.png")
    errors = [r[5] for r in rows if r[0] == "alpha" and r[4] == 5e-6 and "imbalance" in r[6]]
    falls = {r[3]: r[5] for r in rows if r[0] == "snap"}
    extents = [r[5] for r in rows if r[6].startswith("largest extent")]
    ends = [r[5] for r in rows if r[6].startswith("last extent")]
    listed = ", ".join(f"{e:.1e} at {share:g}" for share, e in falls.items())
    return (
        f"alpha 0 ... 1e6: imbalance {min(errors):.1e} ... {max(errors):.1e} of the kinetic "
        f"energy at "
        f"5e-6 s; snapping tether: energy error over a fall's {listed} of the estimate; shrunk "
        f"sheets "
        f"stay finite: {'yes' if np.isfinite(extents).all() else 'no'}, extent at the end "
        f"{min(ends):.3g} ... {max(ends):.3g} of that at rest"
    )


def draw(rows: list[list], path: Path) -> None:
    """Three panels, one a part."""
    drawing, axes = figure(columns=3, width=4.4)
    first, second, third = axes[0]
    for step in sorted({r[4] for r in rows if r[0] == "alpha"}):
        mine = [r for r in rows if r[0] == "alpha" and r[4] == step and "imbalance" in r[6]]
        first.plot([r[1] for r in mine], [r[5] for r in mine], "o-", label=f"dt = {step:g} s")
    first.set_xscale("symlog")
    first.set(xlabel="alpha [-]", ylabel="imbalance / kinetic energy [-]", yscale="log")
    first.legend(fontsize=7)
    mine = [r for r in rows if r[0] == "snap"]
    second.loglog([r[3] for r in mine], [r[5] for r in mine], "o-", label="measured")
    second.axvline(1.0, color="C3", label="estimate")
    second.set(xlabel="step / estimate [-]", ylabel="energy error / energy of a fall [-]")
    second.legend(fontsize=7)
    for text in ("largest extent", "last extent"):
        mine = [r for r in rows if r[0] == "shrunk" and r[6].startswith(text)]
        third.plot([r[1] for r in mine], [r[5] for r in mine], "o-", label=text)
    third.set(xlabel="size at the start / rest [-]", ylabel="extent / rest [-]")
    third.legend(fontsize=7)
    save(drawing, path)
