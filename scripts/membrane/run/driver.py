# SPDX-License-Identifier: GPL-2.0-or-later
"""The driver of any sail: build, spin up, release and run it, and leave the results."""

import os
import platform
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Any

from .. import __version__, scene  # first, for without YADE it says so

import numpy as np
import yade.config
from yade import wrapper as yade_classes

from ..files import write_json
from ..measures import HUB_OUTCOMES, LEDGER_OUTCOMES
from ..parameters import RunParameters, Spool, Tethers, attributes, check_steps
from ..progress import Progress, warn
from ..scene.physical import physical_parameters
from ..scene.spool import add_spool
from ..view import report
from .checkpoint import Checkpoints
from .kind import FinishedSail, Sail
from .last_good import RUN, SPIN_UP, Diverged, last_good_saved
from .record import Recorder, is_whole
from .sails import SAILS

# The spin-up may take longer steps than the run: no accuracy is asked of it.
SPIN_UP_STEP = 0.7
SPIN_UP_TURNS = 15  # of the spool, after which to give up
STEP = 0.5  # of the critical one, by default
TURN_STEP = 0.05  # rad: what the sail turns in a step, at most, by default


def look_away(_: Any) -> None:
    """What is done with a scene that nobody watches."""


# ------------------------------------------------------------------------------ from mesh to scene


def build(p: RunParameters, sail: Sail | None = None) -> tuple[Sail, scene.MembraneScene]:
    """Put the sail of parameters into the (empty) scene, hub and what is to be released held.

    Parameters
    ----------
    p : RunParameters
        Of one of SAILS.
    sail : Sail, optional
        That of the parameters, if it is known already.

    Returns
    -------
    sail : Sail
    built : MembraneScene

    Raises
    ------
    ValueError
        In one sentence, if there can be no such sail.
    """
    kind = SAILS[p.sail]
    sail = sail or kind.sail(p)
    mesh = sail.mesh
    try:
        p = kind.film(sail, p)
        membrane = scene.add_membrane(
            mesh.nodes,
            mesh.triangles,
            mesh.creases,
            mesh.crease_signs,
            sail.cables,
            positions=sail.start,
            material=scene.film(**attributes("MembraneMat", p)),
            pointMasses=sail.point_masses.tolist(),
            interactions=p.path == "law2",
            **({"radius": p.tether_radius} if isinstance(p, Tethers) else {}),
            **attributes("Membrane", p),
        )
    except ValueError as error:
        raise ValueError(kind.explained(str(error))) from None
    facets = []
    if isinstance(p, Spool):
        form = p.spool_radius, p.spool_height, p.spool_facets, p.spool_young, p.spool_friction
        facets = add_spool(*form)
    bodies = np.array(membrane.bodyIds)
    driven = facets + bodies[sail.hub].tolist()
    built = scene.set_engines(membrane, p, driven=driven, touching=bodies[sail.touching].tolist())
    built.hold(sail.hub)
    built.hold(sail.held)
    kind.equip(sail, built, p)
    return sail, built


def spin_up(
    built: scene.MembraneScene,
    p: Any,
    begun: dict | None = None,
    keep: Callable | None = None,
    look: Callable = look_away,
) -> dict:
    """Bring a folded sail to rest in the turning frame.

    Arguments and result are those of `scene.spin_up`; `look` is called as by `deploy`.
    """
    if not begun:
        yade_classes.Omega().dt = SPIN_UP_STEP * built.forces.criticalTimeStep()
    last = {"residual": 1.0}
    progress = Progress("spin-up ", 1.0)

    def show(simulated, residual):
        # Progress on the way from 1 down to the tolerance, on a logarithmic scale.
        last["residual"] = min(last["residual"], residual)
        share = np.log(max(last["residual"], p.spin_up_tolerance)) / np.log(p.spin_up_tolerance)
        progress.show(float(share), f"t = {simulated:.3f} s  residual energy {residual:.1e}")
        look(built)

    return scene.spin_up(
        built,
        p.omega,
        tolerance=p.spin_up_tolerance,
        damping=p.spin_up_damping,
        max_time=max(5.0, SPIN_UP_TURNS * 2 * np.pi / p.omega),
        on_batch=show,
        begun=begun,
        keep=keep,
    )


def release(sail: Sail, built: scene.MembraneScene, spin: float, dt: float) -> None:
    """Release a Sail in its MembraneScene, at a spin [rad/s], with a time step [s]."""
    yade_classes.Omega().dt = dt
    scene.release(built, spin, sail.held.tolist())


@dataclass(frozen=True)
class Steps:
    """Steps of `dt` [s], of which `stride` make a row, `rows` of them; `between` make a shape.

    `between` is 0 where only the first and the last row do.
    """

    dt: float
    stride: int
    rows: int
    between: int


def steps_of(p: RunParameters, critical: float) -> Steps:
    """The Steps that parameters of a run ask for, whose `critical` step [s] is known.

    They and the rows are no longer than asked for, and end at the duration.

    Raises
    ------
    ValueError
        If the step is above the critical one and not forced, or there are too many.
    """
    if p.dt > critical and not p.force_time_step:
        raise ValueError(
            f"dt = {p.dt} s must be <= {critical:.4g} s, the critical time step of this sail "
            "(force_time_step overrules)"
        )
    if not 0 < p.duration >= p.dt:
        raise ValueError(
            f"duration = {p.duration} s: must be > 0" + f" and >= dt = {p.dt} s" * (p.dt > 0)
        )
    longest = min(p.dt or STEP * critical, p.duration)
    if not p.dt and p.omega > 0:
        longest = min(longest, TURN_STEP / p.omega)
    check_steps(p.duration, longest)
    rows = _parts(p.duration, max(p.history_interval, longest))
    stride = _parts(p.duration / rows, longest)
    dt = p.duration / rows / stride
    if abs(dt / p.dt - 1 if p.dt else 1) < 1e-9:
        dt = p.dt  # to the last digit
    shapes = min(p.shapes_interval, p.duration)
    return Steps(dt, stride, rows, max(1, round(shapes / (stride * dt))) if shapes > 0 else 0)


def _parts(whole, most):
    """Into how many equal parts to divide `whole`, so that none is longer than `most`."""
    return max(1, ceil(whole / most * (1 - 1e-9)))


def march(steps: Steps, row: int = 0, resumed: Any = None) -> Iterator[tuple[int, float]]:
    """Run the released sail, from a row on: yields the number of each later row and its time [s].

    Parameters
    ----------
    steps : Steps
    row : int
        Where to begin.
    resumed : MembraneForceEngine, optional
        As of `scene.advance`.
    """
    for number in range(row + 1, steps.rows + 1):
        scene.advance(steps.stride, resumed)
        resumed = None
        yield number, number * steps.stride * steps.dt


# --------------------------------------------------------------------------------- one run, whole


def deploy(
    p: RunParameters,
    folder: str | Path,
    pictures: bool = True,
    checkpoints: Checkpoints | None = None,
    page: bool = True,
    look: Callable = look_away,
    sail: Sail | None = None,
) -> dict:
    """Run a sail and write the results into `folder`.

    Parameters
    ----------
    p : RunParameters
        Of one of SAILS.
    folder : path
        Made if missing.
    pictures : bool
        Draw the pictures of the kind of sail.
    checkpoints : Checkpoints, optional
        Where the run saves itself now and then, and goes on from if it did. It leaves, but for
        wall_time.json, the files of a run that was never stopped, byte for byte.
    page : bool
        Write report.html; where the viewer is not built, say so and go on.
    look : callable, optional
        Called with the MembraneScene now and then, as `window.Watch` is to show it.
    sail : Sail, optional
        That of the parameters, if it is known already.

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
    return _Deployment(p, folder, checkpoints, look, sail).run(pictures, page)


class _Deployment:
    """One call of `deploy`."""

    def __init__(self, p, folder, checkpoints, look, sail):
        self.p, self.folder, self.checkpoints, self.look = p, folder, checkpoints, look
        self.kind, self.watch = SAILS[p.sail], Stopwatch()
        self.sail = sail or self.kind.sail(p)

    def run(self, pictures, page):
        """All stages, or those that are left; returns what `deploy` does."""
        saved = self.checkpoints and self.checkpoints.load(self._is_whole)
        stage, begun = self._go_on(saved) if saved else self._begin()
        self.look(self.built)
        if stage == SPIN_UP:
            self._spin_up(begun)
            begun = None
        try:
            self._run(begun)
        except Diverged:
            if pictures and self.recorder.frames:
                self.kind.draw(self._finished())
            raise
        return self._finish(pictures, page)

    def _begin(self):
        """Build the scene; returns the stage that comes next, and no progress."""
        _, self.built = build(self.p, self.sail)
        critical = self.built.forces.criticalTimeStep()
        self.steps = steps_of(self.p, critical)
        lengths = physical_parameters(self.sail.mesh, self.kind.film(self.sail, self.p))
        about = {"film": lengths, "critical_time_step": critical, "dt": self.steps.dt}
        self.facts = {**self.sail.facts, **about}
        for doubt in (*self.sail.doubts, *self.kind.about_film(self.p)):
            warn(doubt)
        if self.checkpoints:
            scene.sort_interactions()
        self.watch.lap("build")
        if len(self.sail.held):
            return SPIN_UP, None
        self._release()
        return RUN, None

    def _go_on(self, saved):
        """Take up a run that was stopped; returns its stage and how far that was."""
        self.built, self.facts = scene.loaded(), saved["facts"]
        self.steps = steps_of(self.p, self.facts["critical_time_step"])
        self.watch = Stopwatch(saved["wall_time"])
        return saved["stage"], saved["progress"]

    def _is_whole(self, saved):
        """Whether what a checkpoint tells of is still in the folder."""
        return saved["stage"] == SPIN_UP or is_whole(self.folder, saved["progress"]["recorder"])

    def _keep(self, stage, progress):
        """Save a checkpoint if it is time; `progress()` tells how far the stage is."""
        if self.checkpoints and self.checkpoints.due():
            about = {"facts": self.facts, "wall_time": self.watch.lap(stage)}
            self.checkpoints.save({"stage": stage, **about, "progress": progress()})

    def _spin_up(self, begun):
        """Bring the sail to rest, and release it."""

        def keep(state):
            self._keep(SPIN_UP, lambda: state)

        try:
            self.facts["spin_up"] = spin_up(self.built, self.p, begun, keep, self.look)
        except RuntimeError as error:
            raise Diverged(SPIN_UP, None, str(error)) from error
        self.watch.lap(SPIN_UP)
        self._release()

    def _release(self):
        spin = self.kind.release_rate(self.built, self.p)
        release(self.sail, self.built, spin, self.steps.dt)
        self.facts |= {"spin": spin, "release_step": yade_classes.Omega().iter}

    def _run(self, begun):
        """March, and record."""
        about = self.sail, self.built, self.kind.measures, self.facts["spin"]
        self.recorder = Recorder(self.folder, *about, begun and begun["recorder"])
        stopped = not self.checkpoints
        try:
            with last_good_saved(self.built, self.folder, self.facts["release_step"], stopped):
                self._record(begun and begun["row"])
        finally:
            self.recorder.close()
            self.watch.lap(RUN)

    def _record(self, begun):
        """Rows and shapes at their intervals, from the row `begun` on, if any."""
        recorder, steps = self.recorder, self.steps
        progress = Progress("deploying", self.p.duration)
        if begun is None:
            scene.advance(1)  # a step's measures belong to the time at which it began
            recorder.history(0.0)
            recorder.shape(0.0)
        for row, now in march(steps, begun or 0, self.built.forces if begun is not None else None):
            measured = recorder.history(now)
            if row == steps.rows or (steps.between and row % steps.between == 0):
                recorder.shape(now)
            progress.update(now, "  " + recorder.told(self.kind.told, measured))
            self.look(self.built)
            if row < steps.rows:
                self._keep(RUN, lambda: {"row": row, "recorder": recorder.state()})

    def _finished(self):
        """The FinishedSail of the results."""
        recorder = self.recorder
        times = np.array(recorder.frame_times)
        about = self.sail, self.p, self.built, recorder.columns(), times, recorder.frames
        return FinishedSail(*about, self.folder)

    def _finish(self, pictures, page):
        """Pictures, files, summary and page."""
        run = self._finished()
        further = self.kind.leave(run)
        if pictures:
            self.kind.draw(run)
        wall = self.watch.lap("pictures")
        wall["per_step"] = wall[RUN] / max(1, self.steps.rows * self.steps.stride)
        found = {outcome.name: outcome.of(run.history) for outcome in self._outcomes()}
        summary = {**self._about(), "measures": {**found, **further}}
        write_json(self.folder / "summary.json", summary)
        write_json(self.folder / "wall_time.json", wall)
        if page:
            write_page(self.folder)
        return {**summary, "wall_time": wall}

    def _outcomes(self):
        return *self.kind.outcomes, *(HUB_OUTCOMES if self.built.hub else ()), *LEDGER_OUTCOMES

    def _about(self):
        """What the summary tells besides measures."""
        membrane, p = self.built.membrane, self.p
        told = {name: value for name, value in self.facts.items() if name != "release_step"}
        return {
            "sail": p.sail,
            "parameters": p.as_dict(),
            "versions": versions(),
            "mesh": {
                "nodes": len(membrane.nodes),
                "triangles": len(membrane.triangles),
                "sides": len(membrane.sides),
                "creases": len(membrane.creases),
                "tips": self.sail.tips.tolist(),
                "hub": self.sail.hub.tolist(),
                "film_mass": p.density * p.thickness * membrane.area,
            },
            **told,
        }


class Stopwatch:
    """Wall time [s] by stage of a run, that of an earlier part of it included."""

    def __init__(self, times: dict | None = None) -> None:
        self.times, self._since = dict(times or {}), time.monotonic()

    def lap(self, stage: str) -> dict[str, float]:
        """Count the time since the last call for `stage`; returns all times."""
        now = time.monotonic()
        self.times[stage] = self.times.get(stage, 0.0) + now - self._since
        self._since = now
        return self.times


def write_page(folder: Path) -> None:
    """Write report.html into a run's `folder`, or remove an earlier one and tell why."""
    (folder / report.PAGE).unlink(missing_ok=True)
    try:
        report.write_report(folder)
    except report.NoViewer as error:
        print(f"no {report.PAGE}: {error}", file=sys.stderr)


def versions() -> dict[str, Any]:
    """Versions of everything that the numbers depend on."""
    return {
        "membrane": __version__,
        "yade": yade.config.version.strip(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "threads": int(os.environ.get("OMP_NUM_THREADS", 1)),
    }
