# SPDX-License-Identifier: GPL-2.0-or-later
"""Scenes in which the plugin is attacked: one with everything, before, during and after its run."""

from dataclasses import dataclass, field

import membrane
import numpy as np
from arsenal import CLASSES
from membrane import scene
from membrane.scene import spool
from support import O, grid, set_engines
from yade import wrapper as yade

RADIUS, NODE, PIECE = 0.025, 5e-4, 3e-3  # of the spool, of a node, of the tether [m]
BEFORE = 10  # steps before an attack
MEANWHILE = 40  # steps during an attack from another thread


def build(path):
    """A creased sheet, its tether on a spool that turns freely, with every engine there is."""
    O.reset()
    facets = spool.add_spool(RADIUS, facets=6)
    outwards, along = np.array([[3**0.5 / 2, 0.5, 0], [-0.5, 3**0.5 / 2, 0]])
    touching = (3**0.5 / 2 * RADIUS + 0.98 * NODE) * outwards
    tether = touching + np.outer(np.arange(-2, 4) * PIECE, along)
    sheet, triangles = grid(2, 0.01)
    places = np.concatenate([sheet + tether[-1] + PIECE * along, tether])
    first, last = len(sheet), len(places) - 1
    net = scene.add_membrane(
        0.99 * places,
        triangles,
        [(3, 4), (4, 5)],
        [1, -1],
        [*((i, i + 1) for i in range(first, last)), (0, last)],
        positions=places,
        interactions=path == "law2",
        radius=NODE,
    )
    made = set_engines(
        net,
        path=path,
        exchange_period=3,
        driven=[*facets, net.bodyIds[first]],
        touching=net.bodyIds[first + 1 :],
        omega=20.0,
        hub_inertia=1e-6,
        gravity=9.81,
        beta=3,
        zeta=0.02,
        air_density=1e-3,
    )
    made.hold([first])
    made.forces.timeStepCheckPeriod = 4
    made.watch.period = 3
    made.field.omega = 20.0
    O.dt = 0.3 * made.forces.criticalTimeStep()
    stepper = membrane.MembraneTimeStepper(
        forces=made.forces, fraction=0.3, timeStepUpdateInterval=5
    )
    further = [cls for name, cls in CLASSES.items() if issubclass(cls, membrane.MembraneForce)]
    further.remove(membrane.MembraneForce)
    O.engines = [*(cls(membrane=net) for cls in further), *O.engines, stepper]


def run(path):
    build(path)
    scene.advance(BEFORE)


def objects():
    """An object of each class of the plugin, by name: that of the scene, or a new one."""
    there = list(O.engines)
    for engine in O.engines:
        if isinstance(engine, yade.InteractionLoop):
            for dispatcher in (engine.geomDispatcher, engine.physDispatcher, engine.lawDispatcher):
                there += dispatcher.functors
    for link in O.interactions:
        there += [link.geom, link.phys]
    for body in O.bodies:
        there += [body.shape, body.mat]
    there += [one.membrane for one in there if hasattr(one, "membrane")]
    found = {type(one).__name__: one for one in reversed(there)}
    return {name: found.get(name) or cls() for name, cls in CLASSES.items()}


@dataclass
class World:
    """What an attack finds.

    Attributes
    ----------
    objects : dict
        An object of each class by name, see `objects`.
    engines : list
        Those that ran, or all that there are.
    running : bool
        Whether the scene goes on running in YADE's own thread.
    """

    objects: dict = field(default_factory=objects)
    engines: list = field(default_factory=lambda: list(O.engines))
    running: bool = False


def before_a_scene(_):
    O.reset()
    world = World()
    world.engines = [one for one in world.objects.values() if isinstance(one, yade.Engine)]
    return world


def fresh(path):
    build(path)
    return World()


def running(path):
    run(path)
    return World()


def loaded(path):
    run(path)
    O.save(":memory:loaded", quiet=True)
    O.reset()
    O.load(":memory:loaded", quiet=True)
    return World()


def after_reset(path):
    world = running(path)
    O.reset()
    return world


def after_clear(path):
    world = running(path)
    O.bodies.clear()
    O.interactions.clear()  # else YADE's InteractionLoop looks for the bodies where they were
    return world


def after_erase(path):
    world = running(path)
    O.bodies.erase(world.objects["Membrane"].bodyIds[4])
    O.bodies.erase(0)
    return world


def in_another_scene(path):
    world = running(path)
    O.addScene()
    O.switchToScene(1)
    return world


def in_the_background(path):
    world = running(path)
    world.running = True
    O.run(MEANWHILE, False)  # O.pause() would not wait for the last step
    return world


SITUATIONS = (
    before_a_scene,
    fresh,
    running,
    loaded,
    after_reset,
    after_clear,
    after_erase,
    in_another_scene,
    in_the_background,
)
