# SPDX-License-Identifier: GPL-2.0-or-later
"""Explicit air drag (10) on a plate that moves face on: the step at which it turns back, and
grows.

Each node of a triangle has the mass rho_f h S / 3 and in its first step the drag rho S V² / 6 at
the velocity V that it was given, so that V' = V (1 - rho V dt / (2 rho_f h)): it reverses above dt
= 2 rho_f h / (rho V) and grows above twice that, whatever the mesh. Later steps extrapolate V. A
node at which triangles meet at angles, or one with a tip mass, is slower, so safer. The engine's
estimate takes the slope of the drag, 2 rho V S / 6, as damping: it stays below both.
"""

from itertools import product

import numpy as np
from matplotlib.figure import Figure
from membrane import scene
from membrane.mesh import sail_mesh

from .common import TWO_TRIANGLES, Model, O, bisect, figure, publish, two_triangles

FILM, THICKNESS = 1420.0, 7.5e-6  # kg/m3, m
ATMOSPHERE = 1.204  # kg/m3
PAPER_STEP = 5e-6  # s
TIP_SPEED = 6.1  # m/s, of the flat sail's corners at 6 pi rad/s
FILMS = {THICKNESS: "C0", 25e-6: "C1"}  # colours by thickness [m]
HEADER = (
    "air density [kg/m3]; thickness [m]; speed [m/s]; reverses above, predicted [s]; "
    "reverses above, measured [s]; grows above, predicted [s]; grows above, measured [s]; "
    "estimate of the engine [s]"
)


def limit(air: float, speed: float, thickness: float = THICKNESS, film: float = FILM) -> float:
    """Step [s] above which a plate face on to its `speed` [m/s] is turned back by its drag."""
    return 2 * film * thickness / (air * speed)


def plate(air: float, thickness: float) -> Model:
    """A Model of a flat plate of two triangles in the x-z plane."""
    film, engine = scene.film(thickness=thickness), {"air_density": air}
    return Model(two_triangles(np.pi), TWO_TRIANGLES, material=film, engine=engine)


def throw(model: Model, speed: float) -> np.ndarray:
    """Put a plate where it rests and move it face on at `speed` [m/s]; returns its normal (3,)."""
    normal = np.cross(model.rest[1] - model.rest[0], model.rest[2] - model.rest[0])
    normal /= np.linalg.norm(normal)
    model.place(model.rest, np.tile(speed * normal, (4, 1)))
    return normal


def speed_after(model: Model, speed: float, step: float, steps: int) -> float:
    """Velocity [m/s] along the normal after `steps` steps of a plate that starts at `speed`."""
    normal = throw(model, speed)
    O.dt = step
    scene.advance(steps)
    return float(model.velocities().mean(axis=0) @ normal)


def sail_in_air(air: float, share: float, seconds: float) -> tuple[float, float, float]:
    """Step [s], and largest and last kinetic energy over the first, of the spinning sail.

    It also moves face on at TIP_SPEED.
    """
    mesh = sail_mesh()
    size = mesh.film_size
    model = Model(mesh.nodes[:size], mesh.triangles, engine={"air_density": air, "zeta": 0.02})
    O.dt = share * model.forces.criticalTimeStep()
    x, y, _ = 6 * np.pi * model.rest.T
    model.place(model.rest, np.column_stack([-y, x, np.full(size, TIP_SPEED)]))
    start, largest = model.kinetic(), 0.0
    for _ in range(int(seconds / O.dt) // 200 + 1):
        scene.advance(200)
        largest = max(largest, model.kinetic())
    return O.dt, largest / start, model.kinetic() / start


def run(quick: bool) -> str:
    """Measure plates and the sail; returns a line of text."""
    airs, rounds = (1.2e-3, ATMOSPHERE, 1000.0), 8 if quick else 20
    rows, errors = [], []
    for air, thickness, speed in product(airs, FILMS, (1.0, TIP_SPEED, 100.0)):
        model = plate(air, thickness)
        throw(model, speed)
        estimate = model.forces.criticalTimeStep()
        turn = limit(air, speed, thickness)

        def reverses(step: float) -> bool:
            return speed_after(model, speed, step, 1) < 0

        def swells(step: float) -> bool:
            return abs(speed_after(model, speed, step, 1)) > speed

        back = bisect(reverses, 0.8 * turn, 1.3 * turn, rounds)
        blow = bisect(swells, 1.6 * turn, 2.6 * turn, rounds)
        rows.append([air, thickness, speed, turn, back, 2 * turn, blow, estimate])
        errors += [abs(back / turn - 1), abs(blow / turn / 2 - 1)]
    binding = limit(ATMOSPHERE, 1.0) / PAPER_STEP
    step, most, end = sail_in_air(ATMOSPHERE, 0.9, 0.005 if quick else 0.05)
    publish("drag", quick, HEADER, rows, draw(rows))
    return (
        f"predicted and measured limits agree within {max(errors):.1e}; at 1 atm on 7.5 um film "
        f"dt < {limit(ATMOSPHERE, TIP_SPEED):.2e} s at {TIP_SPEED} m/s, and {PAPER_STEP:g} s holds "
        f"up to {binding:.0f} m/s; the flat sail, spinning and moving face on at {TIP_SPEED} m/s "
        f"in 1 atm, at dt = {step:.3g} s: largest kinetic energy {most:.3f}, last {end:.3g} of the "
        "first"
    )


def draw(rows: list[list]) -> Figure:
    """Limits over density times speed."""
    drawing, (axis,) = figure(width=6.0)
    for thickness, color in FILMS.items():
        mine = [[row[0] * row[2], *row[3:7]] for row in rows if row[1] == thickness]
        flux, turn, back, grow, blow = np.transpose(sorted(mine))
        name = f"{1e6 * thickness:g} um"
        axis.loglog(flux, turn, color=color, label=f"predicted: reverses, {name}")
        axis.loglog(flux, grow, "--", color=color, label=f"predicted: grows, {name}")
        axis.loglog(flux, back, "o", color=color, label=f"measured, {name}")
        axis.loglog(flux, blow, "s", color=color)
    axis.axhline(PAPER_STEP, color="k", linewidth=0.8, label="the paper's step")
    axis.axvline(ATMOSPHERE * TIP_SPEED, color="C3", linewidth=0.8, label="1 atm, tip speed")
    axis.set(xlabel="air density x speed [kg/(m2 s)]", ylabel="time step [s]")
    axis.legend(fontsize=7)
    axis.grid(alpha=0.3)
    return drawing
