# SPDX-License-Identifier: GPL-2.0-or-later
"""Energy drift over 10 s of a sheet, coarse against fine steps.

`taut`: a sheet of 3 x 3 cells of 40 mm, stretched by 0.5 % and held at its rim, whose inner nodes
start at random velocities of 0.1 m/s; its sides stay taut. `buckling`: a free one that spins, at
random velocities of 0.3 m/s, whose sides buckle all the time: undamped, it gains energy. `damped`:
the same with zeta = 0.02. The ledger's total energy is compared with its start, and a line through
it gives the drift a second. A run is left where its energy is above 1000 times the first, or where
it is stopped.
"""

from itertools import product

import numpy as np
from matplotlib.figure import Figure
from membrane import scene

from .common import Model, O, figure, grid, publish

SPIN = 60.0  # rad/s
CELLS, LENGTH = 3, 0.04  # cells in a row, and their length [m]
SECONDS = 10.0
LEFT = 1000.0  # times the first energy
MOTIONS = {"taut": "-", "buckling": ":", "damped": "--"}  # lines

Curve = tuple[np.ndarray, np.ndarray]  # times, errors

HEADER = (
    "motion; step / estimate [-]; step [s]; simulated [s]; left early at [s]; "
    "largest error / energy [-]; largest gain / energy [-]; drift a second / energy [1/s]"
)


def moving_sheet(motion: str) -> Model:
    """The sheet, set in motion."""
    nodes, triangles = grid(CELLS, LENGTH)
    nodes = nodes - nodes.mean(axis=0)
    taut = motion == "taut"
    model = Model(nodes, triangles, engine={"zeta": 0.02 if motion == "damped" else 0.0})
    positions = nodes * (1.005 if taut else 1.0)
    velocities = (0.1 if taut else 0.3) * np.random.default_rng(5).normal(size=nodes.shape)
    if taut:
        row, column = np.divmod(np.arange(len(nodes)), CELLS + 1)
        rim = np.isin(row, (0, CELLS)) | np.isin(column, (0, CELLS))
        velocities[rim] = 0
        model.sail.hold(np.flatnonzero(rim))
    else:
        velocities -= np.average(velocities, axis=0, weights=model.masses)
        velocities += np.cross([0.0, 0.0, SPIN], positions)
    model.place(positions, velocities)
    return model


def history(
    motion: str, share: float, seconds: float, samples: int = 200
) -> tuple[np.ndarray, np.ndarray, float, bool]:
    """Times [s] and relative errors of the sheet's energy over `seconds`, step [s], if it was left.

    The last error of a run that was stopped is inf.
    """
    model = moving_sheet(motion)
    O.dt = share * model.forces.criticalTimeStep()
    ledger = model.start_ledger()
    stride = max(1, int(seconds / O.dt / samples))
    times, errors = [], []
    try:
        for k in range(samples + 1):
            ledger.dead = False
            scene.advance(1)
            times.append(k * stride * O.dt)
            errors.append(ledger.total / ledger.initial - 1)
            if not abs(errors[-1]) < LEFT:  # negative where it alternates
                break
            ledger.dead = True
            scene.advance(stride - 1)
        left = k < samples
    except RuntimeError:  # it blew up
        times.append(len(times) * stride * O.dt)
        errors.append(np.inf)
        left = True
    return np.array(times), np.array(errors), O.dt, left


def run(quick: bool) -> str:
    """Run all motions at several steps; returns a line of text."""
    shares = (0.9, 0.45) if quick else (0.95, 0.7, 0.5, 0.25, 0.125)
    rows, curves = [], []
    for motion, share in product(MOTIONS, shares):
        times, errors, step, left = history(motion, share, 0.02 if quick else SECONDS)
        drift = np.nan if left else np.polyfit(times, errors, 1)[0]
        end = float(times[-1])
        largest = np.abs(errors).max(), errors.max()
        rows.append([motion, share, step, end, end if left else "", *largest, drift])
        curves.append((times, errors))
    publish("drift", quick, HEADER, rows, draw(rows, curves))
    parts = []
    for motion, share, _, end, left, error, _, drift in rows:
        if motion != "damped":
            found = f"left at {end:.3g} s" if left else f"{error:.1e}, {drift:+.1e}/s"
            parts.append(f"{motion} at {share:g}: {found}")
    gains = ", ".join(f"{r[6]:.1e} at {r[1]:g}" for r in rows if r[0] == "damped")
    return (
        f"largest error and drift of the energy over {rows[0][3]:.2g} s, {'; '.join(parts)}; "
        f"largest gain with zeta = 0.02: {gains}"
    )


def draw(rows: list[list], curves: list[Curve]) -> Figure:
    """Errors over time, and the largest over the step."""
    drawing, (left, right) = figure(columns=2)
    colors = {share: f"C{i}" for i, share in enumerate(dict.fromkeys(row[1] for row in rows))}
    for (motion, share, *_, end, _, _, _), curve in zip(rows, curves):
        style = {"color": colors[share], "linewidth": 0.8, "label": f"{motion}, {share:g}"}
        left.plot(*curve, MOTIONS[motion], **style)
        if end != "":
            left.plot(end, LEFT, "x", color=colors[share])
    left.set(xlabel="time [s] (x: left early)", ylabel="energy / first - 1 [-]", xscale="log")
    left.set_yscale("symlog", linthresh=1e-9)
    left.set_yticks([-1, -1e-4, -1e-8, 0, 1e-8, 1e-4, 1, 1e4])
    left.set_ylim(-10, 1e2 * LEFT)
    left.legend(fontsize=5, ncol=3, title="step / estimate", title_fontsize=6, loc="upper left")
    shares = np.array(list(colors))
    largest = np.array([min(row[5], LEFT) for row in rows]).reshape(-1, len(shares))
    gains = [max(row[6], 1e-16) for row in rows if row[0] == "damped"]
    for motion, sign, errors in zip(MOTIONS, ("o-", "s:"), largest):
        right.loglog(shares, errors, sign, label=motion)
    right.loglog(shares, gains, "^--", label="buckling, zeta 0.02: gain")
    right.loglog(shares, largest[1, -1] * (shares / shares[-1]) ** 2, "k--", label="order 2")
    right.axvline(1.0, color="C3", label="estimate")
    right.set(xlabel="step / estimate [-]", ylabel="largest error of the energy [-]")
    right.set_title(f"{LEFT:g}: left early", fontsize=8)
    right.set_xticks(shares, [f"{share:g}" for share in colors])
    right.minorticks_off()
    right.legend(fontsize=7)
    return drawing
