# SPDX-License-Identifier: GPL-2.0-or-later
"""Does this YADE lay out its classes as the plugin was compiled for?"""

from collections.abc import Iterator
from types import ModuleType


def check(native: ModuleType, wrapper: ModuleType) -> None:
    """Compare what the compiled offsets find in YADE's objects with what YADE wrote there.

    `native` is the extension module, `wrapper` yade.wrapper. ImportError names the first member
    that differs.
    """
    for cls, wrote, seen in round_trips(native, wrapper):
        for name, value in wrote.items():
            if seen[name] != value:
                raise ImportError(
                    f"membrane: this YADE lays out its classes differently from Debian's: "
                    f"{cls}.{name} was set to {value} but reads as {seen[name]}"
                )


def round_trips(native: ModuleType, wrapper: ModuleType) -> Iterator[tuple[str, dict, dict]]:
    """Yield (class, values by member as YADE knows them, the same as C++ sees them).

    What lies in an object comes before what is reached through it.
    """

    def as_seen(value):
        if isinstance(value, wrapper.Serializable):
            return native.place_of(value)
        return len(value) if isinstance(value, (list, str)) else value

    for name, values in _settings(wrapper).items():
        made = getattr(wrapper, name)()
        made.updateAttrs(values)
        yield name, {key: as_seen(value) for key, value in values.items()}, native.fields_of(made)

    state = wrapper.State()
    state.pos = (1.5, 2.5, 3.5)
    state.ori = type(state.ori)(0.8, 0.0, 0.6, 0.0)  # w first
    place = {"pos": (1.5, 2.5, 3.5), "ori": (0.0, 0.6, 0.0, 0.8)}
    yield "State", place, native.fields_of(state)
    native.write_state(state, (23.5, 24.5, 25.5), 26.5)
    read = {"vel": tuple(state.vel), "mass": state.mass}
    yield "State", {"vel": (23.5, 24.5, 25.5), "mass": 26.5}, read

    running = {"scene": native.place_of(wrapper.Omega()._sceneObj)}
    yield "Engine", running, native.fields_of(wrapper.ForceResetter())
    held = {"bodies": 2, "interactions": 1, "interactions listed": 1, "interactions found": True}
    forces = {"forces added": False, "forces summed": True, "sums of forces": 1}
    last = {"forces last reset": 7}
    yield "Scene", {**held, **forces, **last}, native.fields_of_containers(wrapper.Scene())


def _settings(wrapper: ModuleType) -> dict[str, dict]:
    """Values to set, by class and attribute, of the members that the plugin uses."""
    motion = {"vel": (7.5, 8.5, 9.5), "angVel": (10.5, 11.5, 12.5), "refPos": (4.5, 5.5, 6.5)}
    inertia = {"mass": 16.5, "inertia": (13.5, 14.5, 15.5)}
    newton = {"damping": 35.5, "gravity": (36.5, 37.5, 38.5), "maxVelocitySq": 39.5, "mask": 40}
    elastic = {"young": 18.5, "poisson": 0.195, "frictionAngle": 0.205}
    settings: dict[str, dict] = {
        "Scene": _scene_settings(wrapper),
        "State": {**motion, **inertia, "blockedDOFs": 1 | 32},
        "Sphere": {"radius": 22.5},
        "Aabb": {"refPos": (1.5, 2.5, 3.5), "sweepLength": 4.5},
        "FrictMat": {"id": 19, "density": 17.5, **elastic},
        "IGeomFunctor": {"label": "eight"},
        "ForceResetter": {"dead": True, "ompThreads": 3, "label": "seven"},
        "PartialEngine": {"ids": [28, 29, 30]},
        "GlobalStiffnessTimeStepper": {"active": False, "timeStepUpdateInterval": 33},
        "FieldApplier": {"fieldWorkIx": 34},
        "NewtonIntegrator": newton,
        **_body_settings(wrapper),
    }
    if hasattr(wrapper, "GlExtraDrawer"):
        settings["GlExtraDrawer"] = {"dead": True}
    return settings


def _scene_settings(wrapper: ModuleType) -> dict:
    """Those of a Scene."""
    return {
        **{"dt": 2.75, "iter": 31, "subStep": 3, "time": 4.5, "speed": 5.5},
        **{"stopAtIter": 61, "stopAtTime": 7.5},
        **{"isPeriodic": True, "trackEnergy": True, "doSort": True},
        "engines": [wrapper.ForceResetter()],
        "_nextEngines": 2 * [wrapper.ForceResetter()],
        "materials": 3 * [wrapper.FrictMat()],
        "energy": wrapper.EnergyTracker(),
    }


def _body_settings(wrapper: ModuleType) -> dict[str, dict]:
    """Those of a Body and of an Interaction of two."""
    parts = {
        "material": wrapper.FrictMat(),
        "state": wrapper.State(),
        "shape": wrapper.Sphere(),
        "bound": wrapper.Aabb(),
    }
    pair = {"id1": 24, "id2": 25, "iterMadeReal": 26, "linIx": 27}
    contact = {"geom": wrapper.ScGeom(), "phys": wrapper.FrictPhys()}
    touch = {"normal": (0.0, 0.6, 0.8), "contactPoint": (1.5, 2.5, 3.5), "refR1": 4.5, "refR2": 5.5}
    slip = {"penetrationDepth": 6.5, "shearInc": (7.5, 8.5, 9.5)}
    forces = {"normalForce": (9.5, 1.5, 2.5), "shearForce": (3.5, 4.5, 6.5)}
    return {
        "Body": {"id": 20, "groupMask": 21, "flags": 22, "clumpId": 23, **parts},
        "Interaction": {**pair, **contact},
        "ScGeom": {**touch, **slip},
        "NormShearPhys": {"kn": 7.5, "ks": 8.5, **forces},
    }
