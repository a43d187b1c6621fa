# SPDX-License-Identifier: GPL-2.0-or-later
"""Speed of the plugin beside YADE's own functors, measured in one run, turn by turn.

Run it by `scripts/run.sh bench [options]`. Prints, writes nothing.
"""

import argparse
import statistics
import time

import numpy as np
from membrane import sail, scene
from membrane.mesh import sail_mesh
from membrane.parameters import SailParameters
from yade import wrapper as yade


def membrane_loop(mesh):
    """Engines and interactions of the plugin on the flat sail."""
    membrane = scene.add_membrane(
        mesh.nodes, mesh.triangles, mesh.creases, mesh.crease_signs, mesh.cables
    )
    engines = scene.set_engines(membrane)
    engines.forces.forceTimeStep = True
    loop = [e for e in yade.Omega().engines if isinstance(e, yade.InteractionLoop)]
    yade.Omega().engines = [yade.ForceResetter(), *loop]


def contact_loop(mesh):
    """YADE's own sphere contacts on the same pairs of the same nodes."""
    pairs = np.concatenate([mesh.sides, mesh.cables])
    spans = np.linalg.norm(mesh.nodes[pairs[:, 0]] - mesh.nodes[pairs[:, 1]], axis=1)
    omega, material = yade.Omega(), yade.FrictMat()
    omega.materials.append(material)
    for position in mesh.nodes.tolist():
        body = yade.Body()
        body.bounded = False
        body.shape = yade.Sphere(radius=0.51 * spans.max())
        body.material = material
        body.state.pos, body.state.mass, body.state.inertia = position, 1.0, (1.0, 1.0, 1.0)
        omega.bodies.append(body)
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


def loop_time(build, mesh, steps):
    """Time [ns] of the InteractionLoop for one step and interaction."""
    omega = yade.Omega()
    omega.reset()
    build(mesh)
    omega.dt = 1e-12
    scene.advance(steps // 10)
    loop = omega.engines[1]
    links = omega.interactions.countReal()
    omega.timingEnabled, loop.execTime, loop.execCount = True, 0, 0
    scene.advance(steps)
    omega.timingEnabled = False
    assert omega.interactions.countReal() == links == len(mesh.sides) + len(mesh.cables)
    return loop.execTime / loop.execCount / links


def compare_loops(refine, rounds, steps):
    """Print time per side of both loops, alternating, and their ratio."""
    mesh = sail_mesh(refine=refine)
    ours, theirs = [], []
    for _ in range(rounds):
        ours.append(loop_time(membrane_loop, mesh, steps))
        theirs.append(loop_time(contact_loop, mesh, steps))
    ratio = statistics.median(a / b for a, b in zip(ours, theirs))
    print(
        f"{len(mesh.nodes):6d} nodes {len(mesh.sides) + len(mesh.cables):6d} sides: "
        f"membrane {statistics.median(ours):6.1f} ns a side, "
        f"YADE's sphere contact {statistics.median(theirs):6.1f} ns, ratio {ratio:.2f}"
    )


def deployment(duration):
    """Print where the time of the released sail goes."""
    omega = yade.Omega()
    omega.reset()
    p = SailParameters(duration=duration)
    mesh, engines = sail.build(p)
    start = time.perf_counter()
    sail.spin_up(engines, p)
    spun = time.perf_counter()
    omega.dt = p.dt
    scene.release(engines, p.omega, mesh.guide_nodes.ravel())
    steps = round(duration / p.dt)
    omega.timingEnabled = True
    for engine in omega.engines:
        engine.execTime, engine.execCount = 0, 0
    scene.advance(steps)
    wall = time.perf_counter() - spun
    omega.timingEnabled = False
    print(f"\nThe paper's sail: spin-up {spun - start:.1f} s of wall time,")
    print(
        f"then {1e6 * wall / steps:.1f} us a step, so {wall / steps / p.dt:.0f} s for each second"
    )
    print("of deployment. Of a step:")
    for engine in sorted(omega.engines, key=lambda e: -e.execTime):
        if engine.execCount:
            name = type(engine).__name__
            print(f"  {name:24s} {engine.execTime / steps / 1e3:7.2f} us")


def main():
    parser = argparse.ArgumentParser(prog="bench", description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5, help="rounds of each comparison")
    parser.add_argument("--steps", type=int, default=2000, help="steps of each round")
    parser.add_argument("--duration", type=float, default=0.05, help="of the sail's run [s]")
    arguments = parser.parse_args()
    print("InteractionLoop alone, medians of paired rounds:")
    for refine in (1, 2):
        compare_loops(refine, arguments.rounds, arguments.steps)
    deployment(arguments.duration)


main()
