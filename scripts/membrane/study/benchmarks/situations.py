# SPDX-License-Identifier: GPL-2.0-or-later
"""What a worker can put into its scene and measure.

Each function here builds a scene and returns a function that takes a number of steps and returns
what it measured, as a dict of numbers.
"""

import ctypes
import gc
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from membrane import scene
from membrane.mesh import sail_mesh
from membrane.parameters import SailParameters
from membrane.run import driver
from yade import wrapper as yade

from .sheet import square_sheet

STILL = 1e-12  # [s]; a step in which nothing moves
SHARE = 0.5  # of the critical time step
DAMPING: dict = {"zeta": 0.02}
EVERYTHING: dict = {**DAMPING, "beta": 30.0, "air_density": 1.2e-3}

Measuring = Callable[[int], dict[str, float]]  # a function of a number of steps


def resident() -> tuple[int, int]:
    """Memory of this process [bytes] that is in use, and the most that ever was.

    What was freed is given back first, so that what comes next does not hide in it.
    """
    gc.collect()
    ctypes.CDLL(None).malloc_trim(0)
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    sizes = {line.split(":")[0]: line.split()[1] for line in lines if line.startswith("Vm")}
    return 1024 * int(sizes["VmRSS"]), 1024 * int(sizes["VmHWM"])


def clocks() -> np.ndarray:
    """Wall and processor time [s], (2,); on one thread other work lengthens the latter less."""
    return np.array([time.perf_counter(), time.process_time()])


def stepping_times(steps: int) -> np.ndarray:
    """Both times [s] of `steps` steps of the scene, after a tenth as many to warm up."""
    scene.advance(max(1, steps // 10))
    start = clocks()
    scene.advance(steps)
    return clocks() - start


def engine_times(steps: int) -> dict[str, float]:
    """Wall time a step [s] of each engine of the scene, by the name of its class."""
    omega = yade.Omega()
    scene.advance(max(1, steps // 10))
    omega.timingEnabled = True
    for engine in omega.engines:
        engine.execTime, engine.execCount = 0, 0
    scene.advance(steps)
    omega.timingEnabled = False
    return {type(e).__name__: 1e-9 * e.execTime / steps for e in omega.engines if e.execCount}


def stepping(**facts: float) -> Measuring:
    """A measuring function: times a step [s], memory [bytes] after it, and `facts`."""

    def measure(steps: int) -> dict[str, float]:
        wall, used = (stepping_times(steps) / steps).tolist()
        now, most = resident()
        return {"wall": wall, "used": used, "memory": now, "peak": most, **facts}

    return measure


def sheet(side: int, path: str, everything: bool, exchange_period: int = 1) -> Measuring:
    """A square sheet of `side` times `side` nodes that swings freely.

    `everything`: creases, damping and drag; else damping only. Ledger and watch are off.
    """
    before, plan = resident()[0], square_sheet(side)
    start = time.process_time()
    folds: dict = {"creases": plan.creases, "crease_signs": plan.crease_signs}
    membrane = scene.add_membrane(
        plan.nodes,
        plan.triangles,
        **(folds if everything else {}),
        positions=plan.places,
        interactions=path == "law2",
    )
    added = time.process_time() - start
    p = scene.SceneParameters(
        path=path,
        exchange_period=exchange_period,
        energy_tolerance=0,
        **(EVERYTHING if everything else DAMPING),
    )
    built = scene.set_engines(membrane, p)
    built.ledger.dead = True
    yade.Omega().dt = SHARE * built.forces.criticalTimeStep()
    scene.advance(1)
    build = time.process_time() - start
    return stepping(nodes=side * side, added=added, build=build, before=before)


def bodies(side: int) -> Measuring:
    """YADE's own bodies, one a node; what the membrane itself takes is there before.

    They are made in C++: those made in Python keep Python objects, too.
    """
    plan = square_sheet(side)
    membrane = yade.Membrane(material=scene.film(), nodes=plan.nodes, triangles=plan.triangles)
    del plan
    before = resident()[0]
    membrane.addBodies()
    yade.Omega().engines = []
    return stepping(before=before)


def add_spheres(places: np.ndarray, radius: float, material: yade.Material) -> None:
    """Add a sphere at each of the `places` to the scene, as plain YADE scripts do."""
    omega = yade.Omega()
    omega.materials.append(material)
    for position in places:
        body = yade.Body()
        body.bounded = False
        body.shape = yade.Sphere(radius=radius)
        body.material = material
        body.state.pos = position.tolist()
        body.state.mass, body.state.inertia = 1.0, (1.0, 1.0, 1.0)
        omega.bodies.append(body)


def loop_time(links: int) -> Measuring:
    """A measuring function: seconds of the InteractionLoop for one step and interaction."""

    def measure(steps: int) -> dict[str, float]:
        found = engine_times(steps)["InteractionLoop"] / links
        if yade.Omega().interactions.countReal() != links:
            raise RuntimeError("interactions were lost on the way")
        return {"seconds": found}

    return measure


def springs(refine: int) -> Measuring:
    """The interactions of the flat sail, by the plugin's functors, and nothing else."""
    mesh = sail_mesh(refine=refine)
    membrane = scene.add_membrane(
        mesh.nodes, mesh.triangles, mesh.creases, mesh.crease_signs, mesh.cables
    )
    scene.set_engines(membrane, scene.SceneParameters(force_time_step=True))
    omega = yade.Omega()
    loop = [e for e in omega.engines if isinstance(e, yade.InteractionLoop)]
    omega.engines = [yade.ForceResetter(), *loop]
    omega.dt = STILL
    return loop_time(omega.interactions.countReal())


def contacts(refine: int) -> Measuring:
    """YADE's own sphere contacts on the same pairs of the same nodes, and nothing else."""
    mesh = sail_mesh(refine=refine)
    pairs = np.concatenate([mesh.sides, mesh.cables])
    spans = np.linalg.norm(mesh.nodes[pairs[:, 0]] - mesh.nodes[pairs[:, 1]], axis=1)
    add_spheres(mesh.nodes, 0.51 * spans.max(), yade.FrictMat())
    omega = yade.Omega()
    omega.engines = [
        yade.ForceResetter(),
        yade.InteractionLoop(
            [yade.Ig2_Sphere_Sphere_ScGeom()],
            [yade.Ip2_FrictMat_FrictMat_FrictPhys()],
            [yade.Law2_ScGeom_FrictPhys_CundallStrack()],
        ),
    ]
    from yade import utils

    for a, b in pairs.tolist():
        utils.createInteraction(a, b)
    omega.dt = STILL
    return loop_time(len(pairs))


def folded(refine: int) -> Measuring:
    """The paper's folded sail on path law2, all forces on: its loop and its engine, a side."""
    _, built = driver.build(SailParameters(refine=refine, path="law2"))
    omega = yade.Omega()
    loop = [e for e in omega.engines if isinstance(e, yade.InteractionLoop)]
    omega.engines = [yade.ForceResetter(), *loop, built.forces]
    omega.dt = STILL
    sides = len(built.membrane.sides)

    def measure(steps: int) -> dict[str, float]:
        found = engine_times(steps)
        return {
            "loop": found["InteractionLoop"] / sides,
            "engine": found["MembraneForceEngine"] / sides,
        }

    return measure


ALL: dict[str, Callable[..., Measuring]] = {
    "sheet": sheet,
    "bodies": bodies,
    "springs": springs,
    "contacts": contacts,
    "folded": folded,
}  # by the name under which a worker is asked for them
