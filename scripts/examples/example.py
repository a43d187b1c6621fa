# SPDX-License-Identifier: GPL-2.0-or-later
"""A sheet that is folded to a V along its middle spins, and opens."""

import numpy as np
from membrane import scene
from membrane.mesh import sheet_mesh
from yade import O

nodes, triangles = sheet_mesh(rows=9, columns=9, spacing=0.05)  # m
nodes -= nodes.mean(axis=0)  # it spins about the z axis
creases = [(36 + i, 37 + i) for i in range(8)]  # sides of the middle row
start = nodes * [1, 0.5, 1] + np.outer(np.abs(nodes[:, 1]), [0, 0, 0.87])  # 60 degrees
film = scene.film(young=3.2e9, poisson=0.34, density=1420, thickness=25e-6)
sheet = scene.add_membrane(nodes, triangles, creases, [-1] * 8, positions=start, material=film)
made = scene.set_engines(sheet, scene.SceneParameters(path="fused", beta=10, zeta=0.02))
O.dt = 0.5 * made.forces.criticalTimeStep()
scene.set_spin(made, 20)  # rad/s
for _ in range(8):
    scene.advance(round(0.05 / O.dt))
    angle = np.degrees(np.mean(made.forces.creaseAngles()))
    print(f"{O.time:.2f} s: the fold is open to {angle:.0f} degrees")
