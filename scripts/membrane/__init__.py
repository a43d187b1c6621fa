# SPDX-License-Identifier: GPL-2.0-or-later
"""Membranes that fold, spin and deploy in YADE.

``import membrane`` in any script run by ``yade`` loads the plugin and gives its classes
(`Membrane`, `MembraneMat`, `MembraneForceEngine`, …), which also appear in ``yade.wrapper``.
The package can also be imported without YADE: only asking for a class is then refused.

Its rooms, each of which imports only from those before it, as tests/test_rooms.py sees to:
the ground, beside this file: what all need, such as files, parameters and progress;
`mesh` without YADE; `scene`; `results`, what runs leave; `view`, pictures of them;
`run`, sails that run; `study`, many runs; `cli`, the commands of scripts/.
"""

import sys
from typing import Any

from . import _former, _load  # noqa: F401

__version__ = _load.VERSION
__all__ = sorted((*_load.CLASSES, *_load.ALIASES))


def _load_plugin():
    """Put the plugin's classes among the names of this package."""
    classes = _load.load()
    classes.update({alias: classes[name] for alias, name in _load.ALIASES.items()})
    globals().update(classes)
    __all__[:] = sorted(classes)


def __getattr__(name: str) -> Any:
    """A class of the plugin, which is loaded only now."""
    if name in (*__all__, *_load.DRAWERS):
        _load_plugin()
        if name in globals():
            return globals()[name]
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


if "yade.wrapper" in sys.modules:  # saved scenes with the classes may follow
    _load_plugin()
