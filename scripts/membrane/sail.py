# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper's sail as a scene: build, spin up, release and run it, and leave the results."""

import json
import os
import platform
import time
from dataclasses import asdict
from pathlib import Path

import numpy as np
import yade.config
from yade import wrapper as yade_classes

from . import __version__, measures, plots, scene
from .fold import fold, fold_report
from .mesh import sail_mesh
from .progress import Progress
from .record import Recorder
from .spool import add_spool

# The spin-up may take longer steps than the run: no accuracy is asked of it.
SPIN_UP_STEP = 0.7
SPIN_UP_TURNS = 15  # of the spool, after which to give up
LAST_GOOD = "last_good.yade.gz"


def build(p):
    """Put the folded sail, its tethers and the spool into the (empty) scene.

    Parameters
    ----------
    p : SailParameters

    Returns
    -------
    mesh : SailMesh
    sail : MembraneScene
        With guide nodes and tether ends held.
    """
    mesh = sail_mesh(
        p.outer_width, p.inner_width, p.fold_lines, p.refine, p.spool_radius, p.tether_segments
    )
    masses = np.zeros(len(mesh.nodes))
    masses[mesh.tips] = p.tip_mass
    membrane = scene.add_membrane(
        mesh.nodes,
        mesh.triangles,
        mesh.creases,
        mesh.crease_signs,
        mesh.cables,
        positions=fold(mesh, p.bar_radius, p.arm_radius, p.layer_gap),
        material=scene.film(p.young, p.poisson, p.density, p.thickness),
        radius=p.tether_radius,
        pointMasses=masses.tolist(),
        alpha=p.alpha,
        alphaCrease=p.alpha_crease,
        interactions=p.path == "law2",
        cableStiffness=p.tether_stiffness,
        cableDensity=p.tether_density,
    )
    facets = add_spool(
        p.spool_radius, p.spool_height, p.spool_facets, p.spool_young, p.spool_friction
    )
    bodies = np.array(membrane.bodyIds)
    sail = scene.set_engines(
        membrane,
        path=p.path,
        exchange_period=p.exchange_period,
        driven=facets + bodies[mesh.anchors].tolist(),
        touching=bodies[np.setdiff1d(mesh.tether_nodes, mesh.anchors)].tolist(),
        omega=p.omega,
        hub_inertia=p.hub_inertia or None,
        gravity=(0, 0, -p.gravity),
        beta=p.beta,
        gamma=p.gamma,
        theta0=p.theta0,
        crease_law=p.crease_law,
        zeta=p.zeta,
        air_density=p.air_density,
        force_time_step=p.force_time_step,
        energy_tolerance=p.energy_tolerance,
    )
    sail.hold(mesh.anchors)
    sail.hold(mesh.guide_nodes.ravel())
    return mesh, sail


def spin_up(sail, p):
    """Bring the folded sail to rest in the turning frame; returns what `scene.spin_up` does."""
    yade_classes.Omega().dt = SPIN_UP_STEP * sail.forces.criticalTimeStep()
    last = {"residual": 1.0}
    progress = Progress("spin-up ", 1.0)

    def show(simulated, residual):
        # Progress on the way from 1 down to the tolerance, on a logarithmic scale.
        last["residual"] = min(last["residual"], residual)
        share = np.log(max(last["residual"], p.spin_up_tolerance)) / np.log(p.spin_up_tolerance)
        progress.show(float(share), f"t = {simulated:.3f} s  residual energy {residual:.1e}")

    return scene.spin_up(
        sail,
        p.omega,
        tolerance=p.spin_up_tolerance,
        damping=p.spin_up_damping,
        max_time=max(5.0, SPIN_UP_TURNS * 2 * np.pi / p.omega),
        on_batch=show,
    )


def run(mesh, sail, p, recorder):
    """Release the sail and run it for p.duration, with rows and shapes at their intervals."""
    omega = yade_classes.Omega()
    omega.dt = p.dt
    scene.release(sail, p.omega, mesh.guide_nodes.ravel())
    stride = max(1, round(p.history_interval / p.dt))
    rows = max(1, round(p.duration / (stride * p.dt)))
    between = round(p.shapes_interval / (stride * p.dt)) if p.shapes_interval > 0 else 0
    progress = Progress("deploying", p.duration)
    scene.advance(1)  # a step's measures belong to the time at which it began
    recorder.history(0.0)
    recorder.shape(0.0)
    for row in range(1, rows + 1):
        scene.advance(stride)
        now = row * stride * p.dt
        measured = recorder.history(now)
        if row == rows or (between and row % max(1, between) == 0):
            recorder.shape(now)
        progress.update(now, f"  rate {measured['deployment_rate']:.3f}")


def deploy(p, folder, pictures=True):
    """Do it all and write the results into `folder`.

    Parameters
    ----------
    p : SailParameters
    folder : path
        Made if missing.
    pictures : bool
        Draw deployment.png and shapes.png.

    Returns
    -------
    dict
        What is written to summary.json.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    clock = [time.monotonic()]
    mesh, sail = build(p)
    folded = sail.positions()
    report = asdict(fold_report(mesh, folded))
    critical = sail.forces.criticalTimeStep()
    if p.dt > critical and not p.force_time_step:
        raise ValueError(
            f"dt = {p.dt} s must be <= {critical:.4g} s, the critical time step of this sail "
            "(force_time_step overrules)"
        )
    clock.append(time.monotonic())
    equilibrium = spin_up(sail, p)
    clock.append(time.monotonic())
    recorder = Recorder(folder, mesh, sail, p.omega)
    try:
        run(mesh, sail, p, recorder)
    except RuntimeError as error:
        raise RuntimeError(f"{error}. {save_last_good(sail, folder)}") from error
    finally:
        recorder.close()
    clock.append(time.monotonic())
    history = recorder.columns()
    if pictures:
        draw(mesh, recorder, history, folder)
    clock.append(time.monotonic())

    stages = ("build", "spin_up", "run", "pictures")
    wall = {name: clock[i + 1] - clock[i] for i, name in enumerate(stages)}
    steps = round(p.duration / p.dt)
    summary = {
        "parameters": p.as_dict(),
        "versions": versions(),
        "mesh": {
            "nodes": len(mesh.nodes),
            "triangles": len(mesh.triangles),
            "sides": len(sail.membrane.sides),
            "creases": len(mesh.creases),
            "film_mass": p.density * p.thickness * sail.membrane.area,
        },
        "fold": report,
        "critical_time_step": critical,
        "spin_up": equilibrium,
        "wall_time": {**wall, "per_step": wall["run"] / max(1, steps)},
        "measures": {
            "final_deployment_rate": float(history["deployment_rate"][-1]),
            "largest_deployment_rate": float(history["deployment_rate"].max()),
            "time_of_rate_0.9": measures.first_time_above(
                history["time"], history["deployment_rate"], 0.9
            ),
            **measures.swing(history["time"], history["phase_difference"]),
            "largest_spool_work": float(np.abs(history["spool_work"]).max()),
            "largest_energy_imbalance": float(np.abs(history["energy_balance"]).max()),
            "largest_unexplained_energy": float(
                np.abs(history["energy_balance"] - history["kink_error"]).max()
            ),
        },
    }
    write_json(folder / "summary.json", summary)
    return summary


def save_last_good(sail, folder):
    """Put the sail back to the last good state and save it; returns a sentence about it."""
    try:
        time = sail.watch.restore()
    except RuntimeError as error:
        return f"No good state could be saved ({error})"
    path = Path(folder) / LAST_GOOD
    yade_classes.Omega().save(str(path), quiet=True)
    return f"The last good state, of t = {time:.6g} s on YADE's clock, is in {path}"


def draw(mesh, recorder, history, folder):
    """Write deployment.png, and shapes.png with six instants up to the fullest deployment."""
    plots.plot_deployment(history, folder / "deployment.png")
    times = np.array(recorder.frame_times)
    rates = [measures.deployment_rate(mesh, x) for x in recorder.frames]
    picks = instants(times, int(np.argmax(rates)))
    frames = [recorder.frames[i] for i in picks]
    plots.plot_shapes(frames, mesh, folder / "shapes.png", times[picks])


def instants(times, last):
    """Indices of up to six of the `times` (S,) up to the one at index `last`.

    They lie closer together early, where more happens.
    """
    wanted = times[last] * (np.arange(6) / 5) ** 1.5
    return np.unique([int(np.argmin(np.abs(times - t))) for t in wanted])


def versions():
    """Versions of everything that the numbers depend on."""
    return {
        "membrane": __version__,
        "yade": yade.config.version.strip(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "threads": int(os.environ.get("OMP_NUM_THREADS", 1)),
    }


def write_json(path, content):
    """Write a JSON file so that readers see either the old one or the new one."""
    part = path.with_name(path.name + ".part")
    part.write_text(json.dumps(content, indent=2, allow_nan=False) + "\n")
    os.replace(part, path)
