# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper's sail as a scene: build, spin up, release and run it, and leave the results."""

import os
import platform
import sys
import time
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

import numpy as np
import yade.config
from yade import wrapper as yade_classes

from . import __version__, measures, plots, report, scene
from .case_folder import LAST_GOOD
from .checkpoint import save_scene
from .commands import Terminated
from .files import write_json
from .fold import fold, fold_report
from .mesh import mesh_of, tip_masses
from .output import NotFinite
from .parameters import check_steps
from .progress import Progress
from .record import Recorder, is_whole
from .spool import add_spool

# The spin-up may take longer steps than the run: no accuracy is asked of it.
SPIN_UP_STEP = 0.7
SPIN_UP_TURNS = 15  # of the spool, after which to give up
SPIN_UP, RUN = "spin_up", "run"  # stages


class Diverged(RuntimeError):
    """A run went wrong, as another one with the same parameters will.

    Attributes
    ----------
    stage : str
        SPIN_UP or RUN.
    time : float or None
        When the last step began, after the release [s]; None if it came not so far.
    reason : str
        What the engine said that stopped it.
    """

    def __init__(self, stage, time, reason, saved=""):
        super().__init__(". ".join(filter(None, [reason, saved])))
        self.stage, self.time, self.reason = stage, time, reason


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
    mesh = mesh_of(p)
    membrane = add_membrane(
        mesh,
        fold(mesh, p.bar_radius, p.arm_radius, p.layer_gap),
        p,
        cables=mesh.cables,
        radius=p.tether_radius,
        cableStiffness=p.tether_stiffness,
        cableDensity=p.tether_density,
    )
    facets = add_spool(
        p.spool_radius, p.spool_height, p.spool_facets, p.spool_young, p.spool_friction
    )
    bodies = np.array(membrane.bodyIds)
    sail = set_engines(
        membrane,
        p,
        driven=facets + bodies[mesh.anchors].tolist(),
        touching=bodies[np.setdiff1d(mesh.tether_nodes, mesh.anchors)].tolist(),
        hub_inertia=p.hub_inertia or None,
    )
    sail.hold(mesh.anchors)
    sail.hold(mesh.guide_nodes.ravel())
    return mesh, sail


def add_membrane(mesh, positions, p, **options):
    """Add a mesh to the scene, of the film and with the tip masses that its parameters name.

    Parameters
    ----------
    mesh : SailMesh or PatternSail
    positions : (N, 3) float
        Where to put the nodes [m].
    p : SailParameters or PatternParameters
    **options
        Further ones of `scene.add_membrane`.

    Returns
    -------
    Membrane
    """
    return scene.add_membrane(
        mesh.nodes,
        mesh.triangles,
        mesh.creases,
        mesh.crease_signs,
        positions=positions,
        material=scene.film(p.young, p.poisson, p.density, p.thickness),
        pointMasses=tip_masses(mesh, p.tip_mass).tolist(),
        alpha=p.alpha,
        alphaCrease=p.alpha_crease,
        interactions=p.path == "law2",
        **options,
    )


def set_engines(membrane, p, **options):
    """`scene.set_engines` for a Membrane by the parameters `p`; `options` are further ones."""
    return scene.set_engines(
        membrane,
        path=p.path,
        exchange_period=p.exchange_period,
        omega=p.omega,
        gravity=(0, 0, -p.gravity),
        beta=p.beta,
        gamma=p.gamma,
        theta0=p.theta0,
        crease_law=p.crease_law,
        zeta=p.zeta,
        air_density=p.air_density,
        force_time_step=p.force_time_step,
        energy_tolerance=p.energy_tolerance,
        **options,
    )


def check_step(dt, critical, p):
    """Raise ValueError if `dt` is above the `critical` time step [s] and `p` does not force it."""
    if dt > critical and not p.force_time_step:
        raise ValueError(
            f"dt = {dt} s must be <= {critical:.4g} s, the critical time step of this sail "
            "(force_time_step overrules)"
        )


def look_away(_):
    """What those do who do not watch."""


def spin_up(sail, p, begun=None, keep=None, look=look_away):
    """Bring the folded sail to rest in the turning frame.

    Arguments and result are those of `scene.spin_up`; `look` is called as by `deploy`.
    """
    if not begun:
        yade_classes.Omega().dt = SPIN_UP_STEP * sail.forces.criticalTimeStep()
    last = {"residual": 1.0}
    progress = Progress("spin-up ", 1.0)

    def show(simulated, residual):
        # Progress on the way from 1 down to the tolerance, on a logarithmic scale.
        last["residual"] = min(last["residual"], residual)
        share = np.log(max(last["residual"], p.spin_up_tolerance)) / np.log(p.spin_up_tolerance)
        progress.show(float(share), f"t = {simulated:.3f} s  residual energy {residual:.1e}")
        look(sail)

    return scene.spin_up(
        sail,
        p.omega,
        tolerance=p.spin_up_tolerance,
        damping=p.spin_up_damping,
        max_time=max(5.0, SPIN_UP_TURNS * 2 * np.pi / p.omega),
        on_batch=show,
        begun=begun,
        keep=keep,
    )


def release(mesh, sail, p):
    """Release a MembraneScene of a SailMesh, with spin and time step of the parameters `p`."""
    yade_classes.Omega().dt = p.dt
    scene.release(sail, p.omega, mesh.guide_nodes.ravel())


def march(p, recorder, note, look=look_away, begun=None, keep=None):
    """Run the released sail for p.duration, with rows and shapes at their intervals.

    Parameters
    ----------
    p : object
        With dt, duration, history_interval and shapes_interval [s].
    recorder : Recorder
    note : callable
        Text about a row, to be shown beside the progress.
    look : callable
        Called with the MembraneScene after each row.
    begun : int, optional
        Row that was written last when the scene was saved that is now to go on.
    keep : callable, optional
        Called after each row but the last with its number, which a later `begun` takes.
    """
    check_steps(p.duration, p.dt)
    stride = max(1, round(min(p.history_interval, p.duration) / p.dt))
    rows = max(1, round(p.duration / (stride * p.dt)))
    shapes = min(p.shapes_interval, p.duration)
    between = max(1, round(shapes / (stride * p.dt))) if shapes > 0 else 0
    progress = Progress("deploying", p.duration)
    if begun is None:
        scene.advance(1)  # a step's measures belong to the time at which it began
        recorder.history(0.0)
        recorder.shape(0.0)
    for row in range((begun or 0) + 1, rows + 1):
        scene.advance(stride, recorder.sail.forces if row - 1 == begun else None)
        now = row * stride * p.dt
        measured = recorder.history(now)
        if row == rows or (between and row % between == 0):
            recorder.shape(now)
        progress.update(now, "  " + note(measured))
        look(recorder.sail)
        if keep and row < rows:
            keep(row)


class Stopwatch:
    """Wall time [s] by stage of a run, that of an earlier part of it included."""

    def __init__(self, times=None):
        self.times, self._since = dict(times or {}), time.monotonic()

    def lap(self, stage):
        """Count the time since the last call for `stage`; returns all times."""
        now = time.monotonic()
        self.times[stage] = self.times.get(stage, 0.0) + now - self._since
        self._since = now
        return self.times


def deploy(p, folder, pictures=True, checkpoints=None, page=True, look=look_away):
    """Do it all and write the results into `folder`.

    Parameters
    ----------
    p : SailParameters
    folder : path
        Made if missing.
    pictures : bool
        Draw deployment.png and shapes.png.
    checkpoints : Checkpoints, optional
        Where the run saves itself now and then, and goes on from if it did. It leaves, but for
        wall_time.json, the files of a run that was never stopped, byte for byte.
    page : bool
        Write report.html; where the viewer is not built, say so and go on.
    look : callable, optional
        Called with the MembraneScene now and then, as `window.Watch` is to show it.

    Returns
    -------
    dict
        What is written to summary.json, and `wall_time`, which has a file of its own.

    Raises
    ------
    ValueError
        If the parameters are refused.
    Diverged
        If the run went wrong.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    watch = Stopwatch()
    saved = checkpoints.load(lambda state: _is_whole(folder, state)) if checkpoints else None
    if saved:
        mesh, sail, facts = mesh_of(p), scene.loaded(), saved["facts"]
        watch = Stopwatch(saved["wall_time"])
    else:
        mesh, sail, facts = begin(p)
        if checkpoints:
            scene.sort_interactions()
    watch.lap("build")
    look(sail)

    def keep(stage, progress):
        if checkpoints and checkpoints.due():
            times = watch.lap(stage)
            checkpoints.save(
                {"stage": stage, "facts": facts, "wall_time": times, "progress": progress}
            )

    begun = saved["progress"] if saved else None
    if not saved or saved["stage"] == SPIN_UP:
        try:
            facts["spin_up"] = spin_up(sail, p, begun, lambda state: keep(SPIN_UP, state), look)
        except RuntimeError as error:
            raise Diverged(SPIN_UP, None, str(error)) from error
        watch.lap(SPIN_UP)
        begun = None
        release(mesh, sail, p)
        facts["release_step"] = yade_classes.Omega().iter
    recorder = Recorder(folder, mesh, sail, p.omega, begun and begun["recorder"])
    try:
        with last_good_saved(sail, folder, facts["release_step"], stopped=not checkpoints):
            march(
                p,
                recorder,
                lambda row: f"rate {row['deployment_rate']:.3f}",
                look,
                begun and begun["row"],
                lambda row: keep(RUN, {"row": row, "recorder": recorder.state()}),
            )
    except Diverged:
        if pictures and recorder.frames:
            draw(mesh, recorder, recorder.columns(), folder)
        raise
    finally:
        recorder.close()
        watch.lap(RUN)
    history = recorder.columns()
    if pictures:
        draw(mesh, recorder, history, folder)
    wall = watch.lap("pictures")

    steps = round(p.duration / p.dt)
    summary = {
        "parameters": p.as_dict(),
        "versions": versions(),
        "mesh": {
            **counts(mesh, sail.membrane),
            "film_mass": p.density * p.thickness * sail.membrane.area,
        },
        "fold": facts["fold"],
        "critical_time_step": facts["critical_time_step"],
        "spin_up": facts["spin_up"],
        "measures": {
            "final_deployment_rate": float(history["deployment_rate"][-1]),
            "largest_deployment_rate": float(history["deployment_rate"].max()),
            "time_of_rate_0.9": measures.first_time_above(
                history["time"], history["deployment_rate"], 0.9
            ),
            **measures.swing(history["time"], history["phase_difference"]),
            "largest_spool_work": float(np.abs(history["spool_work"]).max()),
            **measures.energy_errors(history),
        },
    }
    wall["per_step"] = wall[RUN] / max(1, steps)
    write_json(folder / "summary.json", summary)
    write_json(folder / "wall_time.json", wall)
    if page:
        write_page(folder)
    return {**summary, "wall_time": wall}


def _is_whole(folder, saved):
    """Whether what a checkpoint of `deploy` tells of is still in the folder."""
    return saved["stage"] == SPIN_UP or is_whole(folder, saved["progress"]["recorder"])


def begin(p):
    """Build the sail of `p` and check its time step.

    Returns
    -------
    mesh : SailMesh
    sail : MembraneScene
    facts : dict
        What summary.json tells of them.
    """
    mesh, sail = build(p)
    folding = asdict(fold_report(mesh, sail.positions()))
    critical = sail.forces.criticalTimeStep()
    check_step(p.dt, critical, p)
    return mesh, sail, {"fold": folding, "critical_time_step": critical}


def counts(mesh, membrane):
    """How many nodes, triangles, sides and creases a mesh and its Membrane have: dict of int."""
    return {
        "nodes": len(mesh.nodes),
        "triangles": len(mesh.triangles),
        "sides": len(membrane.sides),
        "creases": len(mesh.creases),
    }


def write_page(folder):
    """Write report.html into a run's `folder`, or remove an earlier one and tell why."""
    (folder / report.PAGE).unlink(missing_ok=True)
    try:
        report.write_report(folder)
    except report.NoViewer as error:
        print(f"no {report.PAGE}: {error}", file=sys.stderr)


@contextmanager
def last_good_saved(sail, folder, release_step, stopped=True):
    """Where the run in the block goes wrong or is stopped, save its last good state and say so.

    Parameters
    ----------
    sail : MembraneScene
    folder : path
    release_step : int
        Of YADE, at which time after the release is 0.
    stopped : bool
        Also after Ctrl-C and other signals, not only where it goes wrong.

    Raises
    ------
    Diverged
        If it went wrong.
    """
    scene_now = yade_classes.Omega()
    try:
        yield
    except (RuntimeError, NotFinite) as error:
        time = (scene_now.iter - release_step) * scene_now.dt
        raise Diverged(RUN, time, str(error), save_last_good(sail, folder)) from error
    except (KeyboardInterrupt, Terminated) as error:
        if not stopped:
            raise
        raise type(error)(save_last_good(sail, folder)) from None


def save_last_good(sail, folder):
    """Put a MembraneScene back to its last good state, saved in `folder`; returns a sentence."""
    try:
        time = sail.watch.restore()
    except RuntimeError as error:
        return f"No good state could be saved ({error})"
    path = Path(folder) / LAST_GOOD
    scene.renew_collider()
    tags = yade_classes.Omega().tags
    for name in tags.keys():
        tags[name] = ""  # else two files of one state would differ by day and machine
    save_scene(path)
    return f"The last good state, of t = {time:.6g} s on YADE's clock, is in {path}"


def draw(mesh, recorder, history, folder):
    """Write deployment.png, and shapes.png with six instants up to the fullest deployment.

    Parameters
    ----------
    mesh : SailMesh
    recorder : Recorder
        Has the shapes.
    history : mapping of (S,) float
        As `plots.plot_deployment` takes it.
    folder : Path
    """
    plots.plot_deployment(history, folder / "deployment.png")
    times = np.array(recorder.frame_times)
    rates = np.interp(times, history["time"], history["deployment_rate"])  # of its rows
    picks = instants(times, int(np.argmax(rates)))
    frames = [recorder.frames[i] for i in picks]
    plots.plot_shapes(frames, mesh, folder / "shapes.png", times[picks])


def instants(times, last):
    """Indices of up to six of the `times` (S,) up to the one at index `last`.

    They lie closer together early, where more happens.
    """
    return nearest(times, times[last] * (np.arange(6) / 5) ** 1.5)


def nearest(times, wanted):
    """Indices of those of the `times` (S,) that are nearest to the `wanted` ones, each once."""
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
