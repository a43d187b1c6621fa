# SPDX-License-Identifier: GPL-2.0-or-later
"""Modules by their names of earlier versions, for scripts that use them, as `membrane.fold`."""

import sys
from importlib import import_module
from importlib.machinery import ModuleSpec

ROOMS = {"fold": "mesh", "spool": "scene", "output": "results"}  # in which they are now
ROOMS |= dict.fromkeys(("plots", "report", "animation", "window"), "view")


class Former:
    """Finds and loads them, for `import`, which asks it last."""

    @staticmethod
    def find_spec(name, path=None, target=None):
        """A spec for a name of earlier versions, None for others."""
        package, _, module = name.rpartition(".")
        return ModuleSpec(name, Former) if package == __package__ and module in ROOMS else None

    @staticmethod
    def create_module(spec):
        """None: an empty one will do."""

    @staticmethod
    def exec_module(module):
        """Put the module itself in the place of the empty one."""
        name = module.__name__.rpartition(".")[2]
        sys.modules[module.__name__] = import_module(f".{ROOMS[name]}.{name}", __package__)


sys.meta_path.append(Former)
