# SPDX-License-Identifier: GPL-2.0-or-later
"""From a mesh to a running YADE scene: bodies, engines, spin-up, release, hub, spool."""

from .. import Membrane  # noqa: F401 (and so on: names of scenes; without YADE this one says so)
from ..parameters import PATHS, SceneParameters  # noqa: F401
from .bodies import add_membrane, film  # noqa: F401
from .engines import NODE_MASK, MembraneScene, loaded, renew_collider  # noqa: F401
from .engines import set_engines, sort_interactions  # noqa: F401
from .motion import advance, compute_forces, release, residual_energy, set_spin  # noqa: F401
from .motion import spin_up  # noqa: F401
