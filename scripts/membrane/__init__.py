# SPDX-License-Identifier: GPL-2.0-or-later
"""Membranes that fold, spin and deploy in YADE.

``import membrane`` in any script run by ``yade`` loads the plugin and gives its classes
(`Membrane`, `MembraneMat`, `MembraneForceEngine`, …), which also appear in ``yade.wrapper``.
The building blocks of scenes are modules of this package: `mesh`, `fold`, `spool`, `scene`,
`measures`, `output`, `plots`, `report`, `animation`.
"""

from . import _load

_classes = _load.load()
_classes.update({alias: _classes[name] for alias, name in _load.ALIASES.items()})
globals().update(_classes)
__version__ = _load.VERSION
__all__ = sorted(_classes)
