# SPDX-License-Identifier: GPL-2.0-or-later
"""Energy drift over seconds of a sheet, coarse against fine steps.

`taut`: a sheet of 4 x 4 cells of 20 mm, stretched by 0.5 % and held at its rim, whose inner nodes
start at random velocities of 0.1 m/s; its sides stay taut. `buckling`: a free one of 3 x 3 cells
that spins, at random velocities of 0.3 m/s, whose sides buckle all the time. `damped`: the same
with zeta = 0.02. The ledger's total energy is compared with its start, and a line through it gives
the drift a second.
"""

import numpy as np
from membrane import scene

from .common import Model, O, figure, folder, grid, save, write_table

SPIN = 60.0  # rad/s
HEADER = (
    "motion",
    "step / estimate [-]",
    "step [s]",
    "simulated [s]",
    "largest error / energy [-]",
    "largest gain / energy [-]",
    "drift a second / energy [1/s]",
)


def history(motion, share, seconds, samples=200):
    """Times [s] and relative errors of the energy of the sheet over `seconds`."""
    taut = motion == "taut"
    nodes, triangles = grid(4 if taut else 3)
    nodes = nodes - nodes.mean(axis=0)
    model = Model(nodes, triangles, engine={"zeta": 0.02 if motion == "damped" else 0.0})
    positions = nodes * (1.005 if taut else 1.0)
    velocities = (0.1 if taut else 0.3) * np.random.default_rng(5).normal(size=nodes.shape)
    if taut:
        rim = [i for i in range(25) if i // 5 in (0, 4) or i % 5 in (0, 4)]
        velocities[rim] = 0
        for i in rim:
            model.states[i].blockedDOFs = "xyzXYZ"
    else:
        velocities -= np.average(velocities, axis=0, weights=model.masses)
        velocities += np.cross([0.0, 0.0, SPIN], positions)
    model.place(positions, velocities)
    O.dt = share * model.forces.criticalTimeStep()
    ledger = model.start_ledger()
    stride = max(1, int(seconds / O.dt / samples))
    times, errors = [], []
    model.ledger.dead = False
    try:
        for k in range(samples):
            scene.advance(1)
            times.append(k * stride * O.dt)
            errors.append(ledger.total / ledger.initial - 1)
            ledger.dead = True
            scene.advance(stride - 1)
            ledger.dead = False
    except RuntimeError:  # it blew up
        times.append(len(times) * stride * O.dt)
        errors.append(np.inf)
    return np.array(times), np.array(errors), O.dt


def run(quick):
    """Run both motions at several steps; returns a line of text."""
    shares = (0.9, 0.45) if quick else (0.95, 0.7, 0.5, 0.25, 0.125)
    rows, curves = [], []
    for motion in ("taut", "buckling", "damped"):
        for share in shares:
            seconds = 0.02 if quick else (10.0 if share >= 0.7 and motion != "damped" else 2.0)
            times, errors, step = history(motion, share, seconds)
            drift = np.polyfit(times, errors, 1)[0] if np.isfinite(errors).all() else np.inf
            rows.append(
                [motion, share, step, float(times[-1]), np.abs(errors).max(), errors.max(), drift]
            )
            curves.append((motion, share, times, errors))
    out = folder(quick)
    write_table(out / "drift.csv", HEADER, rows)
    draw(rows, curves, out / "drift.png")
    undamped = [r for r in rows if r[0] != "damped"]
    gains = ", ".join(f"{r[5]:.1e} at {r[1]:g}" for r in rows if r[0] == "damped")
    parts = [f"{r[0]} at {r[1]:g}: {r[4]:.1e}, {r[6]:+.1e}/s over {r[3]:.2g} s" for r in undamped]
    return (
        "largest error and drift of the energy, "
        + "; ".join(parts)
        + f"; largest gain with zeta = 0.02: {gains}"
    )


def draw(rows, curves, path):
    """Errors over time, and the largest over the step."""
    drawing, axes = figure(columns=2)
    left, right = axes[0]
    for motion, share, times, errors in curves:
        style = {"taut": "-", "buckling": ":", "damped": "--"}[motion]
        left.plot(times, errors, style, linewidth=0.8, label=f"{motion}, {share:g}")
    left.set(xlabel="time [s]", ylabel="energy / first - 1 [-]", xscale="log")
    left.set_yscale("symlog", linthresh=1e-9)
    left.set_ylim(-10, 1e13)
    left.legend(fontsize=5, ncol=2, title="step / estimate", title_fontsize=6)
    for motion, sign in (("taut", "o-"), ("buckling", "s:")):
        mine = [r for r in rows if r[0] == motion]
        right.loglog([r[1] for r in mine], [r[4] for r in mine], sign, label=motion)
        most = mine[-1][4] / mine[-1][1] ** 2
    mine = [r for r in rows if r[0] == "damped"]
    gains = [max(r[5], 1e-16) for r in mine]
    right.loglog([r[1] for r in mine], gains, "^--", label="buckling, zeta 0.02: gain")
    right.loglog([r[1] for r in mine], [most * r[1] ** 2 for r in mine], "k--", label="order 2")
    right.axvline(1.0, color="C3", label="estimate")
    right.set(xlabel="step / estimate [-]", ylabel="largest error of the energy [-]")
    right.legend(fontsize=7)
    save(drawing, path)
