# SPDX-License-Identifier: GPL-2.0-or-later
"""Loads the plugin into the running YADE, after checking that the two fit together."""

import importlib
import sys

YADE_VERSION = "2023.02a"
PRECISION = "PrecisionDouble"
VERSION = "0.1.0"
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


def load():
    """Give the plugin's classes by name; load and register them first if YADE has them not.

    A YADE built with them in its source tree has them, whatever its version.

    Raises
    ------
    ImportError
        in one sentence, if there is no YADE, another version of it, or one laid out otherwise.
    """
    wrapper = _running_yade()
    names = CLASSES + (DRAWERS if hasattr(wrapper, "GlExtraDrawer") else ())
    missing = [name for name in names if not hasattr(wrapper, name)]
    if 0 < len(missing) < len(names):
        raise ImportError(
            f"membrane: this YADE was built with another pkg/membrane, without {', '.join(missing)}"
        )
    if missing:
        _check_version()
        native = importlib.import_module("._membrane", __package__)
        check_layout(native, wrapper)
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
        raise ImportError("membrane: no YADE is running; run this script by 'yade script.py'")
    return sys.modules["yade.wrapper"]


def _check_version():
    """Raise ImportError unless the YADE that runs is the one that the module was built for."""
    config = sys.modules["yade.config"] if "yade.config" in sys.modules else None
    config = config or importlib.import_module("yade.config")
    found = (config.version.strip(), config.highPrecisionName)
    if found != (YADE_VERSION, PRECISION):
        raise ImportError(
            f"membrane: built for YADE {YADE_VERSION} ({PRECISION}), "
            f"but this is YADE {found[0]} ({found[1]})"
        )


def check_layout(native, wrapper):
    """Compare what the compiled offsets find in native objects with what Python wrote there.

    Parameters
    ----------
    native : the extension module
    wrapper : module yade.wrapper

    Raises
    ------
    ImportError
        naming the first attribute that differs.
    """
    for cls, wrote, seen in _round_trips(native, wrapper):
        for name, value in wrote.items():
            if seen[name] != value:
                raise ImportError(
                    f"membrane: this YADE lays out its classes otherwise than {YADE_VERSION}-1: "
                    f"{cls}.{name} was set to {value} but reads as {seen[name]}"
                )


def _round_trips(native, wrapper):
    """Yield (class, values by attribute as Python knows them, the same as C++ sees them)."""
    state = {
        "pos": (1.5, 2.5, 3.5),
        "refPos": (4.5, 5.5, 6.5),
        "vel": (7.5, 8.5, 9.5),
        "angVel": (10.5, 11.5, 12.5),
        "inertia": (13.5, 14.5, 15.5),
        "mass": 16.5,
    }
    material = {"density": 17.5, "young": 18.5, "poisson": 0.195, "frictionAngle": 0.205}
    body = wrapper.Body()
    body.mask = 21
    body.bounded = False
    body.shape = wrapper.Sphere(radius=22.5)
    body.material = wrapper.FrictMat(**material)
    for name, value in state.items():
        setattr(body.state, name, value)
    body.state.blockedDOFs = "xZ"
    others = {"mask": 21, "bounded": False, "radius": 22.5, "blockedDOFs": 1 | 32}
    yield "Body", {**state, **material, **others}, native.fields_of_body(body)

    native.write_state(body.state, (23.5, 24.5, 25.5), 26.5)
    yield "State", {"vel": (23.5, 24.5, 25.5), "mass": 26.5}, {
        "vel": tuple(body.state.vel),
        "mass": body.state.mass,
    }

    geom = {"normal": (0.0, 0.6, 0.8), "contactPoint": (1.5, 2.5, 3.5), "penetrationDepth": 6.5}
    radii = {"refR1": 4.5, "refR2": 5.5}
    phys = {"kn": 7.5, "ks": 8.5, "normalForce": (9.5, 1.5, 2.5), "shearForce": (3.5, 4.5, 6.5)}
    seen = native.fields_of_interaction(
        wrapper.ScGeom(**geom, **radii), wrapper.NormShearPhys(**phys)
    )
    yield "Interaction", {**geom, **radii, **phys}, seen

    engine = {"dead": True, "ompThreads": 3}
    yield "Engine", engine, native.fields_of_engine(wrapper.ForceResetter(**engine))

    drawer = {"dead": True}
    yield "GlExtraDrawer", drawer, native.fields_of_drawer(wrapper.GlExtraDrawer(**drawer))

    omega = wrapper.Omega()
    kept = omega.dt, omega.trackEnergy
    omega.dt, omega.trackEnergy = 2.75, not kept[1]
    try:
        scene = {"dt": 2.75, "trackEnergy": not kept[1], "iter": omega.iter, "time": omega.time}
        counted = {name: len(getattr(omega, name)) for name in ("bodies", "materials", "engines")}
        yield "Scene", {**scene, **counted}, native.fields_of_scene()
    finally:
        omega.dt, omega.trackEnergy = kept
