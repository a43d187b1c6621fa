# SPDX-License-Identifier: GPL-2.0-or-later
"""The kinds of sail, a module each, which has a class of parameters and KIND. Needs no YADE."""

import importlib
import pkgutil

from ..kind import Kind


def _found() -> dict[str, Kind]:
    modules = (m.name for m in pkgutil.iter_modules(__path__))
    kinds = [importlib.import_module(f".{name}", __name__).KIND for name in sorted(modules)]
    for kind in kinds:
        if "__dataclass_fields__" not in vars(kind.parameters):  # its defaults would be others'
            raise TypeError(f"{kind.parameters.__name__} must be a @dataclass(frozen=True)")
    return {kind.parameters.sail: kind for kind in kinds}


SAILS = _found()  # by name
