# SPDX-License-Identifier: GPL-2.0-or-later
"""Loads the plugin into the running YADE, after checking that the two fit together."""

import importlib
import importlib.machinery
import mmap
import re
import sys
from pathlib import Path

from . import _layout

PRECISION = "PrecisionDouble"
VERSION = "0.2.0"
CLASSES = (
    "MembraneMat",
    "Membrane",
    "MembraneNode",
    "MembraneGeom",
    "Ig2_MembraneNode_MembraneNode_MembraneGeom",
    "MembranePhys",
    "Ip2_MembraneMat_MembraneMat_MembranePhys",
    "Law2_MembraneGeom_MembranePhys_Buckling",
    "MembraneForce",
    "SolarPressure",
    "MembraneForceEngine",
    "MembraneIntegrator",
    "CentrifugalField",
    "SpoolRotation",
    "FreeHub",
    "MembraneLedger",
    "MembraneTimeStepper",
    "MembraneWatch",
    "MembraneFault",
)
# Under names of earlier versions, for scripts that use them.
ALIASES = {"Ig2_Sphere_Sphere_MembraneGeom": "Ig2_MembraneNode_MembraneNode_MembraneGeom"}
DRAWERS = ("GlExtra_Membrane",)  # only where YADE has its 3D view


def load() -> dict[str, type]:
    """Give the plugin's classes by name; load and register them first if YADE does not have them.

    A YADE built with them in its source tree has them, whatever its version. ImportError, in one
    sentence, if there is no YADE, another version of it, or one laid out differently.
    """
    wrapper = _running_yade()
    names = CLASSES + (DRAWERS if hasattr(wrapper, "GlExtraDrawer") else ())
    missing = [name for name in names if not hasattr(wrapper, name)]
    if 0 < len(missing) < len(names):
        raise ImportError(
            f"membrane: this YADE was built with another pkg/membrane, without {', '.join(missing)}"
        )
    if missing:
        native = _module(*_version())
        _layout.check(native, wrapper)
        native.register_classes(list(names))
        _let_others_know(native, wrapper)
    for alias, name in ALIASES.items():
        setattr(wrapper, alias, getattr(wrapper, name))
    return {name: getattr(wrapper, name) for name in names}


def _let_others_know(native, wrapper):
    """Make room for the new classes where YADE has tables of classes already, or it would abort."""
    for engine in wrapper.Omega().engines:
        for name in ("geomDispatcher", "physDispatcher", "lawDispatcher", "boundDispatcher"):
            dispatcher = getattr(engine, name, None)
            if dispatcher is not None:
                dispatcher.functors = dispatcher.functors
    if "yade.qt" in sys.modules:
        native.renew_drawing(sys.modules["yade.qt"].Renderer())


def _running_yade():
    """Return module yade.wrapper of the YADE that runs this script."""
    if "yade.wrapper" not in sys.modules:
        raise ImportError("membrane: no YADE is running; run this script with 'yade script.py'")
    return sys.modules["yade.wrapper"]


def _version():
    """Version and precision of the YADE that runs."""
    config = sys.modules.get("yade.config") or importlib.import_module("yade.config")
    return config.version.strip(), config.highPrecisionName


def _module(version, precision):
    """The extension module, loaded only if it is for a YADE of this version and precision."""
    folder = Path(__file__).parent
    right = folder / f"_membrane{importlib.machinery.EXTENSION_SUFFIXES[0]}"
    found = (right, *folder.glob("_membrane*.so"))
    built = next((path for path in found if path.exists()), None)
    if built is None:
        raise ImportError(f"membrane: {right} is missing; scripts/run.sh build makes it")
    release = built_for(built)
    if (version, precision) != (release, PRECISION):
        systems = _systems()
        able = "scripts/run.sh build makes it for this one"
        raise ImportError(
            f"membrane: built for YADE {release} ({PRECISION}), but this is YADE {version} "
            f"({precision}); "
            + (able if version in systems else f"it can be built for {', '.join(systems)} only")
        )
    try:
        return importlib.import_module("._membrane", __package__)
    except ImportError as error:
        raise ImportError(
            f"membrane: {built.name} does not fit Python {sys.version.split()[0]} and this YADE "
            f"{version}: {error}"
        ) from None


def built_for(module: Path) -> str:
    """The release of YADE that an extension module was built for, from its file alone.

    Loading it calls YADE already.
    """
    with module.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        found = re.search(rb"membrane for YADE ([^\0]+)\0", data)
        return found[1].decode() if found else "of unknown version"


def _systems():
    """The systems, as Debian 12, by the releases of YADE that can be built for."""
    rows = (Path(__file__).parent / "releases.txt").read_text(encoding="utf-8").splitlines()
    cells = (row.split(maxsplit=6) for row in rows if row and not row.startswith("#"))
    return {row[0]: row[6] for row in cells}
