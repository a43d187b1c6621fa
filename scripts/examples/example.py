# SPDX-License-Identifier: GPL-2.0-or-later
"""A sail of one's own: smaller, thicker, with three fold lines, on a spool that turns faster."""

import numpy as np
from membrane import scene
from membrane.mesh import sail_mesh
from membrane.mesh.fold import fold
from membrane.scene import spool
from membrane.view import plots
from yade.wrapper import Omega

omega = 30.0  # rad/s
mesh = sail_mesh(outer_width=0.30, inner_width=0.10, fold_lines=3, tether_segments=3)
tip_masses = np.zeros(len(mesh.nodes))
tip_masses[mesh.tips] = 0.5e-3  # kg
membrane = scene.add_membrane(
    mesh.nodes,
    mesh.triangles,
    mesh.creases,
    mesh.crease_signs,
    mesh.cables,
    positions=fold(mesh),
    material=scene.film(young=3e9, thickness=12.5e-6),
    pointMasses=tip_masses.tolist(),
)
tether_ends = [membrane.bodyIds[i] for i in mesh.anchors]
driven = spool.add_spool() + tether_ends
sail = scene.set_engines(membrane, driven=driven, omega=omega, beta=3, zeta=0.02)
Omega().dt = 0.5 * sail.forces.criticalTimeStep()

sail.hold([*mesh.anchors, *mesh.guide_nodes.ravel()])
scene.spin_up(sail, omega)
scene.release(sail, omega, mesh.guide_nodes.ravel())
times = np.linspace(0.0, 0.25, 6)
frames = [sail.positions()]
for _ in times[1:]:
    scene.advance(round(times[1] / Omega().dt))
    frames.append(sail.positions())
plots.plot_shapes(frames, mesh, "my_sail.png", times)
