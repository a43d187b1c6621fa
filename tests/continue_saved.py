# SPDX-License-Identifier: GPL-2.0-or-later
"""Driver of test_threads: `continue_saved.py FILE STEPS OUT [sorted]` loads a scene and runs it on.

Writes the nodes' positions [m], the number of threads, and the strain energy [J] after the first
step, of path "law2" that in YADE's energy tracker, to OUT as .npz.
"""

import sys

import membrane
import numpy as np
from membrane import scene
from yade.wrapper import Omega

saved, steps, out, *order = sys.argv[1:]
omega = Omega()
omega.load(saved, quiet=True)
(forces,) = [e for e in omega.engines if isinstance(e, membrane.MembraneForceEngine)]
(ledger,) = [e for e in omega.engines if isinstance(e, membrane.MembraneLedger)]
omega.trackEnergy = True
if order:
    scene.sort_interactions()
scene.advance(1)
fused = isinstance(forces, membrane.MembraneIntegrator)
energy = ledger.elastic if fused else omega.energy["membraneElastic"]
scene.advance(int(steps) - 1)
places = [omega.bodies[i].state.pos for i in forces.membrane.bodyIds]
np.savez(out, positions=np.array(places), threads=omega.numThreads, energy=energy)
