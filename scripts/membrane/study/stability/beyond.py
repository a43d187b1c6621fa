# SPDX-License-Identifier: GPL-2.0-or-later
"""What the code does above the limit: refuse, or, if forced, stop; and how many steps that takes.

The flat sail's film with a tiny perturbation runs at steps above the estimate with forceTimeStep.
Counted are the steps from the start to where the kinetic energy is a million times the first, and
from there to where the run is stopped by an exception, without a watch: numbers overflow. The same
runs are then watched by a MembraneWatch, and the steps to its stop are counted. Predicted: an
undamped mode above its limit grows by a factor a step, b + sqrt(b² - 1) with b = 2 (dt / limit)² -
1, until numbers overflow at 1e308.
"""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from membrane import scene
from membrane.mesh import sail_mesh

from .common import Model, O, figure, publish

HEADER = (
    "step / estimate [-]; refused unless forced; steps to a million times the energy; "
    "steps from there to the stop; predicted steps to the stop, taut; "
    "largest velocity seen [m/s]; message; steps to the stop by the watch; message of the watch"
)
SPEED = 1e-6  # m/s
TOLERANCE = 0.1  # of the watch, its default


def predicted(share: float, limit: float = 1.01) -> float:
    """Steps in which a taut mode overflows above its limit, `limit` times the estimate."""
    b = 2 * (share / limit) ** 2 - 1
    return 320 * np.log(10) / np.log(b + np.sqrt(b * b - 1))


def refusal(model: Model, step: float) -> str:
    """What the engine says to a step that is not forced; empty if it runs."""
    model.forces.forceTimeStep = False
    O.dt = step
    try:
        scene.advance(1)
    except RuntimeError as error:
        return str(error)
    finally:
        model.forces.forceTimeStep = True
    return ""


def film(tolerance: float = 0.0) -> Model:
    """The flat film with a tiny perturbation; with a `tolerance` > 0 it is watched."""
    mesh, engine = sail_mesh(), {"zeta": 0.0, "energy_tolerance": tolerance}
    model = Model(mesh.nodes[: mesh.film_size], mesh.triangles, engine=engine)
    model.ledger.dead = tolerance == 0
    noise = np.random.default_rng(4).normal(size=model.rest.shape)
    model.place(model.rest, SPEED * noise)
    return model


def blow_up(share: float, most: int) -> tuple[list, str]:
    """Row of a run at `share` of the estimate, of at most `most` steps; who refuses it unforced."""
    model = film()
    step = share * model.forces.criticalTimeStep()
    refused = refusal(model, step)
    done, grown, fastest, message = forced_run(film(), step, most)
    stop = done - grown if message and grown >= 0 else -1
    expected = predicted(share) if share > 1.01 else np.inf
    watch = watched_stop(film(TOLERANCE), step, most)
    about = share, int(bool(refused)), grown, stop, expected, fastest, message or "not stopped"
    return [*about, *watch], refused


def forced_run(model: Model, step: float, most: int) -> tuple[int, int, float, str]:
    """Steps that a run does, at most `most`, and what was seen on the way.

    Beside them the steps to a million times the energy, -1 if it is never seen; the largest
    velocity [m/s]; and what stops the run, empty if nothing does.
    """
    O.dt = step
    start, grown, fastest = model.kinetic(), -1, 0.0
    for done in range(most):
        try:
            O.step()
        except RuntimeError as error:
            return done, grown, fastest, str(error)
        if grown < 0 or (done + 1) % 20 == 0:
            fastest = max(fastest, float(np.abs(model.velocities()).max()))
            if grown < 0 and not model.kinetic() < 1e6 * start:
                grown = done + 1
    return most, grown, fastest, ""


def watched_stop(model: Model, step: float, most: int) -> tuple[int, str]:
    """Steps to the stop of a watched run of at most `most` steps, and its message; -1 if none."""
    O.dt = step
    for done in range(1, most + 1):
        try:
            O.step()
        except RuntimeError as error:
            return done, str(error)
    return -1, "not stopped"


def run(quick: bool) -> str:
    """Run above the limit; returns a line of text."""
    shares = (1.1, 2.0) if quick else (0.99, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 3.0)
    rows, said = zip(*(blow_up(share, 1500 if quick else 6000) for share in shares))
    publish("beyond", quick, HEADER, rows, draw(rows))
    stops, watched = (
        ", ".join(f"{r[k] if r[k] >= 0 else 'none'} at {r[0]:g}" for r in rows) for k in (3, 7)
    )
    refused = next(filter(None, said), "")
    return (
        f'refused unless forced: {sum(r[1] for r in rows)} of {len(rows)}, with "{refused}"; '
        f"forced, steps from a millionfold energy to the stop: {stops}; largest velocity before it "
        f"{max(r[5] for r in rows):.1e} m/s; with a watch, steps to the stop: {watched}"
    )


def draw(rows: Sequence[list]) -> Figure:
    """Steps to the blow-up and from there to the stop, over the step."""
    drawing, (axis,) = figure(width=6.0)
    for column, sign, name in (
        (2, "o-", "start to a million times the energy"),
        (3, "o-", "from there to the stop"),
        (7, "s-", "to the watch's stop"),
        (4, "k--", "predicted from start to stop, taut"),
    ):
        points = [(r[0], r[column]) for r in rows if 0 <= r[column] < np.inf]
        axis.semilogy(*np.reshape(points, (-1, 2)).T, sign, label=name)
    axis.axvline(1.0, color="C3", label="estimate: refused above")
    axis.set(xlabel="step / estimate [-]", ylabel="steps [-]")
    axis.legend(fontsize=7)
    axis.grid(alpha=0.3)
    return drawing
