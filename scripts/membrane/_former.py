# SPDX-License-Identifier: GPL-2.0-or-later
"""Modules by their names of earlier versions, for scripts that use them, as `membrane.fold`."""

import sys
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

ROOMS = {"fold": "mesh", "spool": "scene", "output": "results"}  # in which they are now
ROOMS |= dict.fromkeys(("plots", "report", "animation", "window"), "view")


class Former(MetaPathFinder, Loader):
    """Finds and loads them, for `import`, which asks it last."""

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        """A spec for a name of earlier versions, None for others."""
        package, _, module = name.rpartition(".")
        return ModuleSpec(name, self) if package == __package__ and module in ROOMS else None

    def create_module(self, spec: ModuleSpec) -> None:
        """None: an empty one will do."""

    def exec_module(self, module: ModuleType) -> None:
        """Put the module itself in the place of the empty one."""
        name = module.__name__.rpartition(".")[2]
        sys.modules[module.__name__] = import_module(f".{ROOMS[name]}.{name}", __package__)


sys.meta_path.append(Former())
