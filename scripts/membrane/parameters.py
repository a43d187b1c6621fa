# SPDX-License-Identifier: GPL-2.0-or-later
"""Parameters of the paper's scene: Tables 1 and 2, and what is assumed where they are silent.

And those of a sail from a file. A dataclass of each holds names, defaults, units and ranges;
command line, yade-batch table and summary.json all come from it.
"""

import argparse
import os
from collections.abc import Callable
from dataclasses import Field, asdict, dataclass, field, fields, is_dataclass
from math import inf, pi
from numbers import Real
from pathlib import Path
from typing import Any, ClassVar

from .files import BadFile, read_object, shown

TABLE_1, TABLE_2, ASSUMED, RUN = "Table 1", "Table 2", "assumed", "run"
SHEET, SPIN = "sheet", "spin"
PATHS = ("law2", "fused")  # who moves the nodes

# The cases that the paper compares, and how long it takes to see the largest lag of the tips and
# the largest lead that follows [s].
TABLE_2_CASES = {"alpha_crease": (100.0, 1000.0), "beta": (0.0, 3.0, 30.0)}
TABLE_2_DURATION = 1.2

LARGEST_WHOLE = 2**31 - 1
MOST_STEPS = 2**53  # of a run: more cannot be told apart


def parameter(
    default: Any,
    unit: str,
    source: str,
    text: str,
    least: float = 0.0,
    most: float = inf,
    above: bool = False,
    choices: tuple[str, ...] | None = None,
    sets: str | None = None,
) -> Any:
    """A field of a dataclass of parameters.

    Parameters
    ----------
    default : int, float, str or bool
    unit, source, text : str
        SI unit or "-"; where the value comes from; meaning.
    least, most : float
        Its range; `above`: `least` itself is excluded.
    choices : tuple of str, optional
        Of a word.
    sets : str, optional
        The attribute of a class of YADE that it sets, as "Membrane.alpha".
    """
    about: dict[str, Any] = {
        "unit": unit,
        "source": source,
        "text": text,
        "least": least,
        "most": most,
    }
    return field(
        default=default, metadata={**about, "above": above, "choices": choices, "sets": sets}
    )


def changed(default: Any, **about: Any) -> Any:
    """A field for `with_defaults`, of another default and with other metadata than it had."""
    return field(default=default, metadata=about)


class Refused(argparse.ArgumentTypeError, ValueError):
    """A word that cannot be what it should: argparse tells why, and others may catch it."""


def number(word: str) -> float:
    """A number from a word, as of the command line."""
    try:
        return float(word)
    except ValueError:
        raise Refused(f"must be a number, not {shown(word)}") from None


def whole(word: str) -> int:
    """A whole number from a word such as 36, 36.0 or 1e3."""
    try:
        value: float = int(word)
    except ValueError:  # it has a point, an exponent, too many digits, or is none
        value = number(word)
        if value not in (inf, -inf) and not float(value).is_integer():
            raise Refused(f"must be a whole number, not {shown(word)}") from None
    if abs(value) > LARGEST_WHOLE:
        raise Refused(f"{shown(word)} is too large a number")
    return int(value)


def check_name(path: str | Path) -> None:
    """Raise Refused unless the whole name of a file or a folder can be written as UTF-8."""
    try:
        os.path.abspath(path).encode()
    except UnicodeEncodeError:
        raise Refused(f"{str(path)!a}: names of files and folders must be UTF-8") from None


PARSERS = {int: whole, float: number, str: str}  # of words


@dataclass(frozen=True)
class Film:
    """The material of the film and how it buckles."""

    thickness: float = parameter(
        7.5e-6, "m", TABLE_1, "thickness h of the film", above=True, sets="MembraneMat.thickness"
    )
    young: float = parameter(
        3.2e9, "Pa", TABLE_1, "Young's modulus E", above=True, sets="MembraneMat.young"
    )
    poisson: float = parameter(
        0.34,
        "-",
        TABLE_1,
        "Poisson's ratio nu",
        least=-1,
        most=0.5,
        above=True,
        sets="MembraneMat.poisson",
    )
    density: float = parameter(
        1420.0, "kg/m3", TABLE_1, "density rho of the film", above=True, sets="MembraneMat.density"
    )
    film: str = parameter(
        "springs",
        "-",
        ASSUMED,
        "the film's law: springs (3), (5), (6), or plane_stress, one film on any mesh",
        choices=("springs", "plane_stress"),
        sets="Membrane.film",
    )
    alpha: float = parameter(
        100.0, "-", TABLE_2, "buckling parameter of the film", sets="Membrane.alpha"
    )
    buckling_length: float = parameter(
        0.0,
        "m",
        ASSUMED,
        "half-wavelength at which the film buckles, on any mesh; 0: by alpha",
        sets="Membrane.bucklingLength",
    )
    zeta: float = parameter(
        0.02, "-", TABLE_2, "damping ratio; 0: none", sets="MembraneForceEngine.zeta"
    )
    damping_time: float = parameter(
        0.0,
        "s",
        ASSUMED,
        "damping time tau of the film, on any mesh; 0: by zeta",
        sets="MembraneForceEngine.dampingTime",
    )


@dataclass(frozen=True)
class Creases:
    """The fold lines."""

    theta0: float = parameter(
        0.0,
        "rad",
        TABLE_2,
        "natural angle of the creases",
        most=pi,
        sets="MembraneForceEngine.theta0",
    )
    alpha_crease: float = parameter(
        1000.0, "-", TABLE_2, "buckling parameter alpha_c of creases", sets="Membrane.alphaCrease"
    )
    crease_buckling_length: float = parameter(
        0.0,
        "m",
        ASSUMED,
        "as buckling_length, of springs on creases; 0: by alpha_crease",
        sets="Membrane.creaseBucklingLength",
    )
    beta: float = parameter(
        30.0, "-", TABLE_2, "crease stiffness; 0: no creases", sets="MembraneForceEngine.beta"
    )
    crease_length: float = parameter(
        0.0,
        "m",
        ASSUMED,
        "the creases' own length L*, which tells their stiffness on any mesh; 0: by beta",
        sets="MembraneForceEngine.creaseLength",
    )
    gamma: float = parameter(
        100.0,
        "-",
        TABLE_2,
        "penalty on creases whose faces passed through each other",
        sets="MembraneForceEngine.gamma",
    )
    crease_law: str = parameter(
        "paper",
        "-",
        ASSUMED,
        "(7) as printed or derived from an energy",
        choices=("paper", "conservative"),
        sets="MembraneForceEngine.creaseLaw",
    )


@dataclass(frozen=True)
class Air:
    """What is around the sail."""

    air_density: float = parameter(
        1.2e-3,
        "kg/m3",
        ASSUMED,
        "density of the air left in the chamber; 0: none",
        sets="MembraneForceEngine.airDensity",
    )
    gravity: float = parameter(9.81, "m/s2", ASSUMED, "gravity, along -z")


@dataclass(frozen=True)
class Hub:
    """What turns, about z."""

    omega: float = parameter(6 * pi, "rad/s", TABLE_1, "spin rate of the spool", above=True)
    hub_inertia: float = parameter(
        0.0,
        "kg m2",
        ASSUMED,
        "inertia of a hub that turns freely, about the axis; 0: driven at omega",
    )


@dataclass(frozen=True)
class Spool:
    """The cylinder in the middle, of facets."""

    spool_radius: float = parameter(0.025, "m", TABLE_1, "radius of the spool", above=True)
    spool_height: float = parameter(0.06, "m", ASSUMED, "height of the spool", above=True)
    spool_facets: int = parameter(36, "-", ASSUMED, "flat faces of the spool", least=3, most=10_000)
    spool_young: float = parameter(
        1e6, "Pa", ASSUMED, "stiffness of the spool's contact", above=True
    )
    spool_friction: float = parameter(
        0.3, "rad", ASSUMED, "friction angle of tethers on the spool", most=1.5
    )


@dataclass(frozen=True)
class Tethers:
    """Between spool and sail."""

    tether_segments: int = parameter(
        4, "-", ASSUMED, "segments of each tether", least=1, most=10_000
    )
    tether_stiffness: float = parameter(
        200.0, "N", ASSUMED, "EA of the tethers", above=True, sets="Membrane.cableStiffness"
    )
    tether_density: float = parameter(
        2e-4,
        "kg/m",
        ASSUMED,
        "mass per length of the tethers",
        above=True,
        sets="Membrane.cableDensity",
    )
    tether_radius: float = parameter(
        5e-4, "m", ASSUMED, "radius of tether masses in contact", above=True
    )


@dataclass(frozen=True)
class SquareSail:
    """The paper's square of four petals, and how it is folded."""

    fold_lines: int = parameter(7, "-", TABLE_1, "fold lines on each petal", least=1, most=1000)
    outer_width: float = parameter(0.455, "m", TABLE_1, "outer width", above=True)
    inner_width: float = parameter(0.103, "m", TABLE_1, "inner width", above=True)
    tip_mass: float = parameter(0.36e-3, "kg", TABLE_1, "mass at each of the four corners")
    bar_radius: float = parameter(
        0.030, "m", ASSUMED, "distance of the guide bars from the axis", above=True
    )
    arm_radius: float = parameter(
        0.040, "m", ASSUMED, "radius at which a folded strip reaches its arm", above=True
    )
    layer_gap: float = parameter(1e-4, "m", ASSUMED, "distance between folded layers", above=True)
    refine: int = parameter(
        1, "-", RUN, "finer mesh: strips and cells are divided by this", least=1, most=32
    )
    as_printed: bool = parameter(
        False,
        "-",
        RUN,
        "the paper's numbers on every mesh, not only on refine 1",
    )


@dataclass(frozen=True)
class Engines:
    """Who computes, and what is watched."""

    path: str = parameter(
        "fused",
        "-",
        RUN,
        "who moves the nodes: law2 (YADE's loops, the reference) or fused (one engine, faster)",
        choices=PATHS,
    )
    exchange_period: int = parameter(
        100,
        "-",
        RUN,
        "steps between two updates of YADE's bodies, on path fused",
        least=1,
        sets="MembraneIntegrator.exchangePeriod",
    )
    energy_tolerance: float = parameter(
        0.1, "-", RUN, "share of energy from nowhere that stops the run; 0: no watch"
    )
    check_period: int = parameter(
        5000,
        "-",
        RUN,
        "steps between two checks of dt against the critical time step",
        least=1,
        sets="MembraneForceEngine.timeStepCheckPeriod",
    )
    force_time_step: bool = parameter(
        False,
        "-",
        RUN,
        "run even above the critical time step",
        sets="MembraneForceEngine.forceTimeStep",
    )


@dataclass(frozen=True)
class Run:
    """Steps, and what is written down."""

    dt: float = parameter(0.0, "s", RUN, "time step; 0: half the critical one")
    duration: float = parameter(1.0, "s", RUN, "time to run after the release")
    history_interval: float = parameter(
        1e-3, "s", RUN, "time between rows of history.csv", above=True
    )
    shapes_interval: float = parameter(
        1e-2, "s", RUN, "time between shapes; 0: only first and last"
    )


@dataclass(frozen=True)
class SpinUp:
    """How a folded sail is brought to rest in the turning frame."""

    spin_up_damping: float = parameter(
        0.3, "-", RUN, "local damping during spin-up", above=True, most=0.99
    )
    spin_up_tolerance: float = parameter(
        1e-6, "-", RUN, "residual energy that ends the spin-up", above=True
    )


def with_defaults(**values: Any) -> Callable:
    """Decorator of a dataclass of parameters, whose parts have other defaults than these `values`.

    Some have another text, too: then a value is a field.
    """

    def change(kind):
        known = {item.name: item for base in kind.__mro__[:0:-1] for item in _fields_of(base)}
        for name, value in values.items():
            item = known[name]
            about = {**item.metadata, **(value.metadata if isinstance(value, Field) else {})}
            default = value.default if isinstance(value, Field) else value
            kind.__annotations__[name] = item.type
            setattr(kind, name, field(default=default, metadata=about))
        return kind

    return change


def _fields_of(kind):
    """Fields of a class, () if it is not a dataclass."""
    return fields(kind) if is_dataclass(kind) else ()


@dataclass(frozen=True)
class SceneParts(Engines, Hub, Air, Creases, Film):
    """What add_membrane and set_engines need, with the values of the paper's Tables."""

    def __post_init__(self) -> None:
        check(self)
        check_once(self)


@dataclass(frozen=True)
@with_defaults(
    alpha_crease=100.0,
    beta=0.0,
    zeta=0.0,
    air_density=0.0,
    gravity=0.0,
    omega=changed(0.0, source=SPIN, text="spin rate of what is driven", above=False),
    path="law2",
    exchange_period=1,
)
class SceneParameters(SceneParts):
    """What add_membrane and set_engines need: by default film alone, and YADE's own loops.

    `dataclasses.fields(SceneParameters)` lists them; `metadata` of each has the meaning ("text"),
    "unit", "source" and range ("least", "most", "choices"), `describe` puts these into words, and
    "sets" names the attribute of YADE's class that follows from it, if it is just one.

    Raises
    ------
    ValueError
        Naming parameter, value and range, if one is out of range.
    """


KINDS = {}  # classes of parameters by the name of their kind of sail


@dataclass(frozen=True)
class RunParameters(Run, SceneParts):
    """What any run of a sail needs. A class of a kind of sail is one of KINDS from then on."""

    sail: ClassVar[str]

    def __init_subclass__(cls, sail: str | None = None) -> None:
        super().__init_subclass__()
        if sail:
            cls.sail = sail
            KINDS[sail] = cls

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.dt:
            check_steps(self.duration, self.dt)

    def as_dict(self) -> dict[str, Any]:
        """Values by name."""
        return asdict(self)


@dataclass(frozen=True)
@with_defaults(dt=5e-6)
class SailParameters(RunParameters, SpinUp, Tethers, Spool, SquareSail, sail="square"):
    """Parameters of the paper's deployment: as of SceneParameters."""


def check(parameters: Any) -> None:
    """Raise ValueError naming the first of some parameters that is out of range.

    The others get their type: 36.0 becomes 36, or 3 becomes 3.0.
    """
    for item in fields(parameters):
        value = getattr(parameters, item.name)
        _check(item, value)
        object.__setattr__(parameters, item.name, item.type(value))


# What the paper gives as numbers of its own mesh, by what a film has on any.
PHYSICAL = {
    "buckling_length": "alpha",
    "crease_buckling_length": "alpha_crease",
    "crease_length": "beta",
    "damping_time": "zeta",
}


def check_once(parameters: Any) -> None:
    """Raise ValueError if something is given twice: as a number of a mesh, and in SI."""
    defaults = {item.name: item.default for item in fields(parameters)}
    for name, number in PHYSICAL.items():
        value, other = getattr(parameters, name), getattr(parameters, number)
        if value > 0 and other not in (0, defaults[number]):
            unit = next(f.metadata["unit"] for f in fields(parameters) if f.name == name)
            raise ValueError(
                f"{name} = {value} {unit} takes the place of {number} = {other}: give one of them"
            )


def check_steps(duration: float, dt: float) -> None:
    """Raise ValueError if a duration [s] is more steps of `dt` [s] than can be counted."""
    if duration / dt > MOST_STEPS:
        raise ValueError(
            f"duration = {duration} s must be at most {MOST_STEPS} steps of dt = {dt} s"
        )


def _check(item: Field, value: Any) -> None:
    """Raise ValueError naming parameter, value and range if it is out of range."""
    about = item.metadata
    if item.type is bool:
        if value not in (True, False):
            raise ValueError(f"{item.name} = {shown(value)} must be true or false")
        return
    if about["choices"]:
        if value not in about["choices"]:
            raise ValueError(
                f"{item.name} = {shown(value)} must be one of {', '.join(about['choices'])}"
            )
        return
    if item.type is str:
        if not isinstance(value, str) or "\0" in value:
            raise ValueError(f"{item.name} = {shown(value)} must be a text")
        return
    is_number = isinstance(value, Real) and not isinstance(value, bool)
    if not is_number:
        raise ValueError(f"{item.name} = {shown(value)} must be a number")
    try:
        float(value)
    except OverflowError:
        raise ValueError(f"{item.name} = {shown(value)} is too large a number") from None
    if item.type is int and not (abs(value) < inf and value == int(value)):
        raise ValueError(f"{item.name} = {value} must be a whole number")
    if item.type is int and abs(value) > LARGEST_WHOLE:
        raise ValueError(f"{item.name} = {shown(value)} is too large a number")
    low = value > about["least"] if about["above"] else value >= about["least"]
    if not (low and value <= about["most"] and abs(value) < inf):
        unit = "" if about["unit"] == "-" else " " + about["unit"]
        finite = " and finite" if value == inf else ""
        raise ValueError(f"{item.name} = {value}{unit} must be {_range(about)}{finite}")


def _range(about):
    """The range of a parameter in words."""
    words = (">" if about["above"] else ">=") + f" {about['least']:g}"
    return words + (f" and <= {about['most']:g}" if about["most"] < inf else "")


def describe(item: Field) -> str:
    """Meaning, unit, range and default of a parameter, a Field, in words, for help texts."""
    about, default = item.metadata, item.default
    unit = "" if about["unit"] == "-" else f" [{about['unit']}]"
    extent = "" if item.type is bool or about["choices"] else f"{_range(about)}; "
    word = f"{default:g}" if isinstance(default, float) else str(default)
    return f"{about['text']}{unit} ({extent}default {word})"


def attributes(kind: str, parameters: Any) -> dict[str, Any]:
    """Attributes of a class of YADE, by name, that follow from parameters: a dict.

    A number whose place something in SI takes is 0: see PHYSICAL.

    Parameters
    ----------
    kind : str
        As "MembraneMat".
    parameters : dataclass
    """
    found = {}
    replaced = {number for name, number in PHYSICAL.items() if getattr(parameters, name, 0) > 0}
    for item in fields(parameters):
        owner, _, name = (item.metadata["sets"] or "").partition(".")
        if owner == kind:
            found[name] = 0.0 if item.name in replaced else getattr(parameters, item.name)
    return found


def read_values(path: str | Path, kind: Any = SailParameters) -> dict[str, Any]:
    """Values of parameters by name from a JSON file: such an object, or a summary.json of a run.

    Raises
    ------
    BadFile
        If a name is unknown or a value out of range.
    """
    values = read_object(path)
    values = values.get("parameters", values)
    if not isinstance(values, dict):
        raise BadFile(path, "parameters", f"must be an object, not {shown(values)}")
    complete = from_values(path, values, kind)
    return {name: getattr(complete, name) for name in values}


def from_values(path: str | Path, values: dict, kind: Any = SailParameters) -> Any:
    """Parameters from a dict of values by name that a file holds; BadFile if one is wrong."""
    known = {item.name for item in fields(kind)}
    for name in values:
        if name not in known:
            raise BadFile(path, shown(name)[1:-1], "is not a parameter")
    try:
        return kind(**values)
    except ValueError as error:
        raise BadFile(path, "", str(error)) from None
