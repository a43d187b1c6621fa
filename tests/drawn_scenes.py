# SPDX-License-Identifier: GPL-2.0-or-later
"""Draws membranes in YADE's window and leaves pictures and facts.json in the folder it is given.

For test_drawing, which runs it with a display: `yade -x tests/drawn_scenes.py FOLDER`.
"""

import json
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parent))

import numpy as np  # noqa: E402
from membrane import scene  # noqa: E402
from membrane.mesh import sail_mesh  # noqa: E402
from membrane.mesh.fold import fold  # noqa: E402
from membrane.parameters import SailParameters  # noqa: E402
from membrane.run import driver  # noqa: E402
from membrane.view import window  # noqa: E402
from support import O, grid, node_states, quiet, set_engines  # noqa: E402

RANGE = 1e-3  # strain at the end of the scale
CORNER = np.array([0.1, 0.05, 0.0])  # of the sheet [m], off the middle of the picture
CELLS, LENGTH = 6, 0.05  # of the sheet [m]
HALF = 0.5  # half the height of the pictures [m]
SIDE = 600  # of the pictures [pixels]
TOP = (0, 0, -1)
SPEED, STEP, WIDE = 5.0, 2.5e-7, 2.0  # of the sheet that flies [m/s], [s]; half the height [m]

folder = Path(sys.argv[1])
facts = {
    "corner": CORNER.tolist(),
    "size": CELLS * LENGTH,
    "half": HALF,
    "wide": WIDE,
    "angles": [],
}


class Stage:
    """The window, of a size and view of which the pictures' scale is known."""

    def __init__(self, drawn):
        self.window = window.show(drawn, size=(SIDE, SIDE), strainRange=RANGE, drawLegend=False)
        view = self.window.view
        view.ortho = True
        view.axes = view.scale = False
        view.timeDisp = ""
        self.aim()

    def aim(self, half=HALF):
        """Look from the top at a square of 2 `half` [m] about the origin."""
        edge = half / np.sqrt(2)  # the sphere around the box is what fills the picture
        self.window.look([(-edge, -edge, 0), (edge, edge, 0)], TOP)

    def take(self, name, **attributes):
        """Take the picture `name`, with attributes of the drawer; returns the scale's end."""
        drawer = self.window.drawer
        kept = {key: getattr(drawer, key) for key in attributes}
        drawer.updateAttrs(attributes)
        self.window.snapshot(folder / f"{name}.png")
        drawer.updateAttrs(kept)
        return drawer.shownRange


def sheet(creased=False, radius=1e-3, at=CORNER, **options):
    """An empty scene with a sheet at rest; returns membrane, positions (N, 3) [m]."""
    O.reset()
    nodes, triangles = grid(CELLS, LENGTH)
    rows = CELLS + 1
    middle = [(CELLS // 2 * rows + i, CELLS // 2 * rows + i + 1) for i in range(CELLS)]
    fold_line = {"creases": middle, "crease_signs": [-1] * CELLS} if creased else {}
    made = scene.add_membrane(
        nodes,
        triangles,
        positions=nodes + at,
        radius=radius,
        interactions=False,
        **fold_line,
        **options,
    )
    return made, nodes + at


def place(net, positions):
    """Put the nodes of a membrane at `positions` (N, 3) [m]."""
    for i, x in zip(net.bodyIds, positions.tolist()):
        O.bodies[i].state.pos = x


def folded(positions, angle):
    """The sheet's right half turned up about its middle line, to `angle` [rad] between the two."""
    x = positions - CORNER
    arm = np.maximum(0, x[:, 0] - 0.5 * CELLS * LENGTH)
    x[:, 0] += arm * (np.cos(np.pi - angle) - 1)
    x[:, 2] += arm * np.sin(np.pi - angle)
    return x + CORNER


def draw_strains(stage, net, rest):
    """The sheet at rest, stretched more and more, and buckled one way and both ways."""
    for name, along_x, along_y in (
        ("strain_0", 0, 0),
        ("strain_1", 0.25 * RANGE, 0.25 * RANGE),
        ("strain_2", 0.5 * RANGE, 0.5 * RANGE),
        ("strain_3", 0.75 * RANGE, 0.75 * RANGE),
        ("strain_4", RANGE, RANGE),
        ("slack", -0.05, -0.05),
        ("wrinkled", 0.5 * RANGE, -0.05),
    ):
        place(net, CORNER + (rest - CORNER) * (1 + along_x, 1 + along_y, 1))
        stage.take(name)
        if name == "strain_1":
            facts["automatic_range"] = stage.take("automatic", strainRange=0.0)
        if name == "strain_2":
            stage.take("legend", drawLegend=True)
            stage.take("outlines", wire=True)


def draw_film(stage, net, rest):
    """A sheet of plane stress, taut, wrinkled and slack; no side is as short as it may be."""
    contracted = -0.34 * 0.5 * RANGE  # across, by Poisson's ratio
    for name, along_x, along_y in (
        ("film_taut", 0.5 * RANGE, 0.99 * contracted),
        ("film_wrinkled", 0.5 * RANGE, 1.01 * contracted),
        ("film_slack", -1e-6, -1e-6),
    ):
        place(net, CORNER + (rest - CORNER) * (1 + along_x, 1 + along_y, 1))
        stage.take(name)


def draw_creases(stage, net, rest):
    """The creased sheet at several angles."""
    for i, angle in enumerate(np.radians([180, 120, 60, 20])):
        place(net, folded(rest, angle))
        stage.take(f"crease_{i}")
        facts["angles"].append(angle)


def fly(net, rest, forces, look):
    """Let the sheet fly in another thread until `look` returns the last step; returns that."""
    place(net, rest)
    for i in net.bodyIds:
        O.bodies[i].state.vel = (SPEED, 0, 0)
    forces.forgetVelocities()
    O.resetTime()
    O.stopAtIter = 0
    O.run()
    O.stopAtIter = last = look()
    O.wait()
    return last


def draw_flight(stage, path):
    """A sheet that flies; its bodies lag behind on the fused path."""
    net, rest = sheet(at=CORNER - (0.4, 0, 0))
    made = set_engines(
        net, path=path, exchange_period=10**9, force_time_step=True, energy_tolerance=0
    )
    O.dt = STEP
    seen = {"start": rest[0, 0], "speed": SPEED}

    def look():
        while O.time < 0.01:
            stage.window.refresh(0.01)
        seen["before"] = O.time
        stage.take(f"flight_{path}")
        seen["bodies"] = O.bodies[net.bodyIds[0]].state.pos[0] - rest[0, 0]
        seen["after"] = O.time
        return O.iter + 20_000

    last = fly(net, rest, made.forces, look)
    ended = node_states(net)
    stage.take(f"landed_{path}")
    fly(net, rest, made.forces, lambda: last)
    seen["end"], seen["steps"] = ended[0, 0, 0], [last, O.iter]
    seen["same"] = bool(np.array_equal(ended, node_states(net)))
    facts[path] = seen


def draw_sail(stage):
    """The paper's sail, folded and flat; nothing moves."""
    O.reset()
    mesh = sail_mesh()
    net = scene.add_membrane(
        mesh.nodes,
        mesh.triangles,
        mesh.creases,
        mesh.crease_signs,
        mesh.cables,
        positions=fold(mesh),
        interactions=False,
    )
    stage.window.drawer.membrane = net
    stage.aim(0.35)
    stage.take("sail_folded")
    place(net, mesh.nodes)
    stage.take("sail_flat")


def draw_deployment(stage):
    """A small sail's first milliseconds, as `deploy --watch` shows them."""
    O.reset()
    watch = window.Watch()
    small = {"outer_width": 0.3, "inner_width": 0.1, "fold_lines": 3}
    parameters = SailParameters(**small, duration=0.004, spin_up_tolerance=0.1)
    frames = []

    def look(sail_now):
        # The run is over in no time; it waits for a window that draws slowly.
        watch(sail_now)
        end = time.monotonic() + window.PATIENCE
        while [watch.window.drawer.frames] == frames[-1:] and time.monotonic() < end:
            watch(sail_now)
        frames.append(watch.window.drawer.frames)

    with quiet():
        driver.deploy(parameters, folder / "deployed", pictures=False, look=look)
    watch.window.snapshot(folder / "watched.png")
    facts["frames"] = frames
    stage.window = watch.window


def close_as_a_user_does(stage):
    """Closes the window from its own events while the script waits."""
    from PyQt5.QtCore import QTimer

    QTimer.singleShot(200, stage.window.view.close)
    stage.window.wait()
    facts["closed"] = not stage.window.is_open


def main():
    """Draw everything."""
    net, rest = sheet()
    stage = Stage(net)
    draw_strains(stage, net, rest)

    net, rest = sheet(creased=True)
    stage.window.drawer.membrane = net
    draw_creases(stage, net, rest)

    net, rest = sheet(film="plane_stress")
    stage.window.drawer.membrane = net
    draw_film(stage, net, rest)

    net, rest = sheet(radius=0.03)
    stage.window.drawer.membrane = net
    stage.take("spheres_hidden")
    stage.take("spheres_shown", hideNodes=False)

    stage.window.drawer.membrane = None
    stage.aim(WIDE)
    for path in scene.PATHS:
        draw_flight(stage, path)
    draw_sail(stage)

    O.bodies.erase(stage.window.drawer.membrane.bodyIds[3])
    stage.window.redraw()
    facts["dead"] = stage.window.drawer.dead
    draw_deployment(stage)
    close_as_a_user_does(stage)
    stage.window.refresh(0.5)  # YADE takes it down a quarter of a second later
    (folder / "facts.json").write_text(json.dumps(facts))


main()
