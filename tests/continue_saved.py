# SPDX-License-Identifier: GPL-2.0-or-later
"""Driver of test_threads: `continue_saved.py FILE STEPS OUT` loads a scene and runs it on.

Writes the nodes' positions [m], the number of threads, and the strain energy [J] that YADE's
energy tracker had after the first step, to OUT as .npz.
"""

import sys

import membrane  # noqa: F401, the scene needs its classes
import numpy as np
from membrane import scene
from yade.wrapper import Omega

saved, steps, out = sys.argv[1:]
omega = Omega()
omega.load(saved, quiet=True)
(net,) = [e.membrane for e in omega.engines if type(e).__name__ == "MembraneForceEngine"]
omega.trackEnergy = True
scene.advance(1)
energy = omega.energy["membraneElastic"]
scene.advance(int(steps) - 1)
places = [omega.bodies[i].state.pos for i in net.bodyIds]
np.savez(out, positions=np.array(places), threads=omega.numThreads, energy=energy)
