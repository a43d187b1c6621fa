# SPDX-License-Identifier: GPL-2.0-or-later
"""The estimate of the critical step against the step at which a perturbation begins to grow.

Every node gets a random velocity. A tiny one (1e-6 m/s), about a state made one of rest by
constant forces on its nodes, measures the state as it is: buckled sides have no stiffness. Growth
of modes that alternate from step to step decides; a state that is unstable in itself, as a
compressed one, grows smoothly and does not count. One of 1 m/s, without those forces, makes sides
go taut and buckle again and again: there the limit is where the sum of kinetic, strain and crease
energy doubles within 600 steps.
"""

from itertools import product
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from membrane import scene
from membrane.mesh import SailMesh, sail_mesh, tip_masses
from membrane.mesh.fold import fold

from .common import Model, O, bisect, figure, grows, publish

PLANE_STRESS = "plane_stress"
TINY, LARGE = 1e-6, 1.0  # m/s
# Strain of the tethers of the flat sail: at 0 they change between slack and taut at any motion.
TAUT = 1e-3
TIP_MASS = 0.36e-3  # kg
BUCKLING_LENGTH = 2.28e-3  # m, of a film of plane stress
HEADER = (
    "state; perturbation [m/s]; refine; zeta; beta; crease law; tether segments; tip mass [kg]; "
    "film; damping time [s]; estimate [s]; measured [s]; measured/estimate"
)
STATES = {
    "flat": "C0",
    "taut": "C2",
    "buckled": "C1",
    "folded": "C4",
    "overlapping": "C5",
}  # colours
USUAL = {"refine": 1, "zeta": 0.0, "beta": 0.0, "law": "paper", "segments": 4, "tip": TIP_MASS}
USUAL |= {"film": "springs", "time": 0.0}


def sail(
    refine: int = 1,
    zeta: float = 0.0,
    beta: float = 0.0,
    law: str = "paper",
    segments: int = 4,
    tip: float = TIP_MASS,
    film: str = "springs",
    time: float = 0.0,
    turned: bool = False,
) -> tuple[SailMesh, Model]:
    """The paper's sail without spool, in a scene; `turned`: mountains taken for valleys.

    Returns the mesh and a Model.
    """
    mesh = sail_mesh(refine=refine, tether_segments=segments)
    model = Model(
        mesh.nodes,
        mesh.triangles,
        creases=mesh.creases,
        crease_signs=mesh.crease_signs * (-1 if turned else 1),
        cables=mesh.cables,
        pointMasses=tip_masses(mesh, tip).tolist(),
        alphaCrease=1000.0,
        film=film,
        bucklingLength=0.0 if film == "springs" else BUCKLING_LENGTH,
        engine={"zeta": zeta, "beta": beta, "crease_law": law, "damping_time": time},
    )
    model.sail.hold(mesh.anchors)
    return mesh, model


def placed(mesh: SailMesh, state: str) -> np.ndarray:
    """Positions (N, 3) [m] of the sail's nodes in a state by name."""
    if state in ("folded", "overlapping"):
        return fold(mesh)
    stretch = {"flat": 1.0, "taut": 1.005, "buckled": 0.97}[state]
    positions = mesh.nodes * [stretch, stretch, 1.0]
    if state == "flat":
        for chain in mesh.cables.reshape(4, -1, 2):
            corner = positions[chain[-1, 1]]
            positions[chain[:, 0]] = corner + (1 + TAUT) * (mesh.nodes[chain[:, 0]] - corner)
    return positions


def measure(
    model: Model, positions: np.ndarray, speed: float, rounds: int, damped: bool = False
) -> tuple[float, float]:
    """Estimate and measured limit [s] at `positions` (N, 3) [m], perturbed at `speed` [m/s]."""
    model.balance(positions)
    estimate = model.forces.criticalTimeStep()
    free = np.array([len(state.blockedDOFs) < 6 for state in model.states])
    velocities = speed * np.random.default_rng(7).normal(size=positions.shape) * free[:, None]
    if speed != TINY:
        model.balance(positions, release=True)

    def is_above(step):
        try:
            return is_unstable(step)
        except RuntimeError as error:  # so fast that numbers overflowed
            if "diverged" in str(error) or "inf m apart" in str(error):
                return True
            raise

    def is_unstable(step):
        if speed == TINY:
            return grows(model, positions, velocities, step, 1600 if damped else 500)
        model.place(positions, velocities)
        O.dt = step
        ledger, first = model.start_ledger(), 0.0
        for _ in range(60):
            scene.advance(10)
            energy = ledger.total + ledger.crease
            first = first or max(energy, ledger.initial)
            if not energy < 2 * first:
                return True
        return False

    return estimate, bisect(is_above, 0.9 * estimate, 1.2 * estimate, rounds, widen=3)


def cases(quick: bool) -> list[dict[str, Any]]:
    """Cases as dicts: state, speed and parameters of sail()."""
    found: list[dict] = [{"state": s, "speed": speed} for s in STATES for speed in (TINY, LARGE)]
    if quick:
        film = {"film": PLANE_STRESS, "state": "taut", "time": 7e-6}
        return found[:2] + [{"zeta": 1.0}, {"beta": 30.0, "state": "overlapping"}, film]
    found += [{"state": "overlapping", "speed": TINY, "beta": b} for b in (30, 300)]
    found += [{"zeta": z} for z in (0.02, 0.1, 0.3, 1.0, 2.0)]
    found += [{"zeta": z, "state": "taut"} for z in (0.02, 1.0)]
    states = "flat", "folded", "overlapping"
    for law, state, beta in product(("paper", "conservative"), states, (30.0, 300.0)):
        found.append({"state": state, "beta": beta, "law": law, "speed": LARGE})
    found += [{"state": "overlapping", "beta": b, "law": "paper"} for b in (3e3, 3e4, 3e5, 3e6)]
    found += [{"state": "overlapping", "beta": b, "law": "conservative"} for b in (3e4, 3e6)]
    found += [{"segments": n} for n in (2, 3, 6, 8)]
    found += [{"tip": m, "zeta": z} for m in (0.0, 3.6e-3) for z in (0.0, 0.02, 1.0)]
    found += [{"refine": n} for n in (2, 3, 4)]
    found += [{"film": PLANE_STRESS, **case} for case in found[: 2 * len(STATES)]]
    for time, state in product((7e-7, 7e-6, 7e-5), ("flat", "taut", "buckled", "folded")):
        found.append({"film": PLANE_STRESS, "time": time, "state": state})
    return found + [{"film": PLANE_STRESS, "refine": n} for n in (2, 3)]


def run(quick: bool) -> str:
    """Measure all cases; returns a line of text."""
    rows: list[list] = []
    for case in cases(quick):
        options: dict[str, Any] = {"state": "flat", "speed": TINY, **USUAL, **case}
        state, speed = options["state"], options["speed"]
        values = {name: options[name] for name in USUAL}
        mesh, model = sail(**values, turned=state == "overlapping")
        rounds = 6 if quick or options["refine"] > 1 else 7
        damped = options["zeta"] > 0 or options["time"] > 0
        estimate, limit = measure(model, placed(mesh, state), speed, rounds, damped)
        rows.append([*options.values(), estimate, limit, limit / estimate])
    publish("timestep", quick, HEADER, rows, draw(rows))
    ratios = np.array([row[-1] for row in rows])
    flat = [r[-1] for r in rows if r[0] == "flat" and r[1] == TINY]
    low = rows[int(np.argmin(ratios))]
    return (
        f"measured/estimate on the flat sail {min(flat):.3f} ... {max(flat):.3f}; least of all "
        f"{low[-1]:.3f} ({low[0]}, {low[1]:g} m/s, zeta {low[3]:g}, beta {low[4]:g}); "
        f"{np.sum(ratios < 1)} of {len(ratios)} measured limits below the estimate"
    )


def draw(rows: list[list]) -> Figure:
    """Measured over estimated step for all cases."""
    drawing, (axis,) = figure(height=0.17 * len(rows) + 1.2, width=8)
    names, most = [], 1.6
    for i, (state, speed, *values, _, _, ratio) in enumerate(rows):
        refine, zeta, beta, law, segments, tip, film, time = values
        sign = ">" if ratio > most else "o"
        axis.plot(min(ratio, most), i, sign, color=STATES[state], markersize=4)
        names.append(
            f"{state}, {speed:g} m/s, refine {refine}, ζ {zeta:g}, β {beta:g} {law}, "
            f"{segments} segments, tip {1e3 * tip:g} g"
        )
        if film != "springs":
            names[-1] = f"plane stress, {state}, {speed:g} m/s, refine {refine}, τ {time:g} s"
    axis.axvline(1.0, color="k", label="estimate = limit")
    axis.axvspan(1.0, 1 / 0.95, color="C2", alpha=0.2, label="estimate within 5 % below")
    axis.set_yticks(range(len(rows)), names, fontsize=6)
    text = "measured limit / estimate [-] (> : 1.6 or more, or none found)"
    axis.set(xlabel=text, ylim=(len(rows), -1))
    axis.legend(fontsize=7, loc="lower right")
    axis.grid(alpha=0.3, axis="x")
    return drawing
