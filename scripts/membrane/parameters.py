# SPDX-License-Identifier: GPL-2.0-or-later
"""Parameters of the paper's scene: Tables 1 and 2, and what is assumed where they are silent.

One dataclass holds names, defaults, units and ranges; command line, yade-batch table and
summary.json all come from it.
"""

import argparse
import os
from dataclasses import asdict, dataclass, field, fields
from math import inf, pi
from numbers import Real

from .files import BadFile, read_object, shown

TABLE_1, TABLE_2, ASSUMED, RUN = "Table 1", "Table 2", "assumed", "run"

# The cases that the paper compares, and how long it takes to see the largest lag of the tips and
# the largest lead that follows [s].
TABLE_2_CASES = {"alpha_crease": (100.0, 1000.0), "beta": (0.0, 3.0, 30.0)}
TABLE_2_DURATION = 1.2

LARGEST_WHOLE = 2**31 - 1
MOST_STEPS = 2**53  # of a run: more cannot be told apart


def _parameter(default, unit, source, text, least=0.0, most=inf, above=False, choices=None):
    """A field with its unit, source, meaning and range; `above`: `least` itself is excluded."""
    return field(
        default=default,
        metadata={
            "unit": unit,
            "source": source,
            "text": text,
            "least": least,
            "most": most,
            "above": above,
            "choices": choices,
        },
    )


parameter = _parameter  # for other scenes


class Refused(argparse.ArgumentTypeError, ValueError):
    """A word that cannot be what it should: argparse tells why, and others may catch it."""


def number(word):
    """A number from a word, as of the command line."""
    try:
        return float(word)
    except ValueError:
        raise Refused(f"must be a number, not {shown(word)}") from None


def whole(word):
    """A whole number from a word: 36, 36.0 and 1e3 are such."""
    try:
        value = int(word)
    except ValueError:  # it has a point, an exponent, too many digits, or is none
        value = number(word)
        if value not in (inf, -inf) and not value.is_integer():
            raise Refused(f"must be a whole number, not {shown(word)}") from None
    if abs(value) > LARGEST_WHOLE:
        raise Refused(f"{shown(word)} is too large a number")
    return int(value)


def check_name(path):
    """Raise Refused unless the whole name of a file or a folder can be written as UTF-8."""
    try:
        os.path.abspath(path).encode()
    except UnicodeEncodeError:
        raise Refused(f"{str(path)!a}: names of files and folders must be UTF-8") from None


PARSERS = {int: whole, float: number, str: str}  # of words


@dataclass(frozen=True)
class SailParameters:
    """Parameters of the deployment.

    `dataclasses.fields(SailParameters)` lists them; `metadata` of each has the meaning ("text"),
    "unit", "source" and range ("least", "most", "choices"), `describe` puts these into words.

    Raises
    ------
    ValueError
        Naming parameter, value and range, if one is out of range.
    """

    fold_lines: int = _parameter(7, "-", TABLE_1, "fold lines on each petal", least=1, most=1000)
    outer_width: float = _parameter(0.455, "m", TABLE_1, "outer width", above=True)
    inner_width: float = _parameter(0.103, "m", TABLE_1, "inner width", above=True)
    thickness: float = _parameter(7.5e-6, "m", TABLE_1, "thickness h of the film", above=True)
    spool_radius: float = _parameter(0.025, "m", TABLE_1, "radius of the spool", above=True)
    young: float = _parameter(3.2e9, "Pa", TABLE_1, "Young's modulus E", above=True)
    poisson: float = _parameter(
        0.34, "-", TABLE_1, "Poisson's ratio nu", least=-1, most=0.5, above=True
    )
    density: float = _parameter(1420.0, "kg/m3", TABLE_1, "density rho of the film", above=True)
    tip_mass: float = _parameter(0.36e-3, "kg", TABLE_1, "mass at each of the four corners")
    omega: float = _parameter(6 * pi, "rad/s", TABLE_1, "spin rate of the spool", above=True)

    theta0: float = _parameter(0.0, "rad", TABLE_2, "natural angle of the creases", most=pi)
    alpha: float = _parameter(100.0, "-", TABLE_2, "buckling parameter of the film")
    alpha_crease: float = _parameter(1000.0, "-", TABLE_2, "buckling parameter alpha_c of creases")
    beta: float = _parameter(30.0, "-", TABLE_2, "crease stiffness; 0: no creases")
    gamma: float = _parameter(100.0, "-", TABLE_2, "penalty on creases that passed through")
    zeta: float = _parameter(0.02, "-", TABLE_2, "damping ratio; 0: none")

    crease_law: str = _parameter(
        "paper",
        "-",
        ASSUMED,
        "(7) as printed or derived from an energy",
        choices=("paper", "conservative"),
    )
    air_density: float = _parameter(1.2e-3, "kg/m3", ASSUMED, "air left in the chamber; 0: none")
    gravity: float = _parameter(9.81, "m/s2", ASSUMED, "along -z")
    hub_inertia: float = _parameter(
        0.0, "kg m2", ASSUMED, "of a spool that turns freely, about the axis; 0: driven at omega"
    )
    tether_segments: int = _parameter(
        4, "-", ASSUMED, "segments of each tether", least=1, most=10_000
    )
    tether_stiffness: float = _parameter(200.0, "N", ASSUMED, "EA of the tethers", above=True)
    tether_density: float = _parameter(
        2e-4, "kg/m", ASSUMED, "mass a length of the tethers", above=True
    )
    tether_radius: float = _parameter(
        5e-4, "m", ASSUMED, "radius of tether masses in contact", above=True
    )
    spool_height: float = _parameter(0.06, "m", ASSUMED, "height of the spool", above=True)
    spool_facets: int = _parameter(
        36, "-", ASSUMED, "flat faces of the spool", least=3, most=10_000
    )
    spool_young: float = _parameter(
        1e6, "Pa", ASSUMED, "stiffness of the spool's contact", above=True
    )
    spool_friction: float = _parameter(
        0.3, "rad", ASSUMED, "friction angle of tethers on the spool", most=1.5
    )
    bar_radius: float = _parameter(
        0.030, "m", ASSUMED, "distance of the guide bars from the axis", above=True
    )
    arm_radius: float = _parameter(
        0.040, "m", ASSUMED, "where a folded strip reaches its arm", above=True
    )
    layer_gap: float = _parameter(1e-4, "m", ASSUMED, "distance of the folded layers", above=True)

    refine: int = _parameter(1, "-", RUN, "strips and cells are divided by it", least=1, most=32)
    dt: float = _parameter(5e-6, "s", RUN, "time step of the run", above=True)
    duration: float = _parameter(1.0, "s", RUN, "time to run after the release")
    history_interval: float = _parameter(1e-3, "s", RUN, "between rows of history.csv", above=True)
    shapes_interval: float = _parameter(1e-2, "s", RUN, "between shapes; 0: only first and last")
    spin_up_damping: float = _parameter(
        0.3, "-", RUN, "local damping during spin-up", above=True, most=0.99
    )
    spin_up_tolerance: float = _parameter(
        1e-6, "-", RUN, "residual energy that ends the spin-up", above=True
    )
    energy_tolerance: float = _parameter(
        0.1, "-", RUN, "energy from nowhere, over all energy, that stops the run", above=True
    )
    path: str = _parameter(
        "fused",
        "-",
        RUN,
        "who moves the nodes: law2, YADE's loops, the reference; fused, one engine, faster",
        choices=("law2", "fused"),
    )
    exchange_period: int = _parameter(
        100, "-", RUN, "path fused: steps between two updates of YADE's bodies", least=1
    )
    force_time_step: bool = _parameter(False, "-", RUN, "run even above the critical time step")

    def __post_init__(self):
        check(self)
        check_steps(self.duration, self.dt)

    def as_dict(self):
        """Values by name."""
        return asdict(self)


def check(parameters):
    """Raise ValueError naming the first of some parameters that is out of range.

    Others get the type that is theirs: 36.0 becomes 36, and 3 becomes 3.0, as may be.
    """
    for item in fields(parameters):
        value = getattr(parameters, item.name)
        _check(item, value)
        object.__setattr__(parameters, item.name, item.type(value))


def check_steps(duration, dt):
    """Raise ValueError if a duration [s] is more steps of `dt` [s] than can be counted."""
    if duration / dt > MOST_STEPS:
        raise ValueError(
            f"duration = {duration} s must be at most {MOST_STEPS} steps of dt = {dt} s"
        )


def _check(item, value):
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
    if not isinstance(value, Real) or isinstance(value, bool):
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


def describe(item, default=None):
    """Meaning, unit, range and default of a parameter in words, for help texts.

    Parameters
    ----------
    item : dataclasses.Field
        Of SailParameters or another class of parameters.
    default : optional
        In place of the field's own: a value, or a list of them where several may be given.
    """
    about = item.metadata
    default = item.default if default is None else default
    unit = "" if about["unit"] == "-" else f" [{about['unit']}]"
    extent = "" if item.type is bool or about["choices"] else f"{_range(about)}; "
    more = "one or more; " if isinstance(default, list) else ""
    values = default if isinstance(default, list) else [default]
    words = " ".join(f"{v:g}" if isinstance(v, float) else str(v) for v in values)
    return f"{about['text']}{unit} ({extent}{more}default {words})"


def add_arguments(parser, kind=SailParameters, several=None, defaults=None):
    """Add one option for every parameter to an argparse parser, grouped by source.

    Parameters
    ----------
    parser : ArgumentParser
    kind : class
        Of the parameters.
    several : dict, optional
        Defaults, a sequence each, of those parameters that take one value or more.
    defaults : dict, optional
        Of the others, in place of those of `kind`.
    """
    chosen = {**(defaults or {}), **{name: list(v) for name, v in (several or {}).items()}}
    for source in dict.fromkeys(item.metadata["source"] for item in fields(kind)):
        group = parser.add_argument_group(f"parameters, {source}")
        for item in fields(kind):
            if item.metadata["source"] == source:
                add_argument(group, item, chosen.get(item.name, item.default))


def parse(parser, kind=SailParameters, *, several=None, defaults=None, root=None):
    """Arguments of an argparse parser with options for all parameters and one for a file of them.

    What is given on the command line wins over the file, which wins over `defaults`, a dict.

    Parameters
    ----------
    parser : ArgumentParser
        Gets the options.
    kind : class
        Of the parameters.
    several : dict, optional
        See add_arguments; the file's values of these parameters do not count.
    defaults : dict, optional
        In place of those of `kind`.
    root : ArgumentParser, optional
        Parses, if `parser` is one of its commands.

    Raises
    ------
    BadFile or OSError
    """
    add_arguments(parser, kind, several, defaults)
    text = "take parameters that are not given from this JSON file, as summary.json of a run"
    parser.add_argument("--parameters", type=_named, metavar="FILE", help=text)
    root = root or parser
    arguments = root.parse_args()
    file = getattr(arguments, "parameters", None)
    if file is not None:
        values = read_values(file, kind)
        parser.set_defaults(**{n: v for n, v in values.items() if n not in (several or {})})
        arguments = root.parse_args()
    return arguments


def _named(word):
    """The name of a file from a word of the command line."""
    check_name(word)
    return word


def add_argument(group, item, default):
    """Add the option for one parameter to an argparse parser or group.

    Parameters
    ----------
    group : ArgumentParser or its group
    item, default
        As of `describe`.
    """
    flag = "--" + item.name.replace("_", "-")
    text = describe(item, default).replace("%", "%%")
    if item.type is bool:
        group.add_argument(flag, action=argparse.BooleanOptionalAction, default=default, help=text)
        return
    choices = item.metadata["choices"]
    metavar = None if choices else item.metadata["unit"].replace("-", "N")
    more = {"nargs": "+"} if isinstance(default, list) else {}
    group.add_argument(
        flag,
        type=PARSERS[item.type],
        default=default,
        choices=choices,
        metavar=metavar,
        help=text,
        **more,
    )


def from_arguments(arguments, overrides=None, kind=SailParameters):
    """Parameters from parsed arguments; `overrides` (a dict, as from a batch table) win."""
    values = {item.name: getattr(arguments, item.name) for item in fields(kind)}
    for name, value in (overrides or {}).items():
        if name not in values:
            known = ", ".join(sorted(values))
            raise ValueError(f"{name} is no parameter of the sail; known are {known}")
        values[name] = value
    return kind(**values)


def read_values(path, kind=SailParameters):
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


def from_values(path, values, kind=SailParameters):
    """Parameters from a dict of values by name that a file holds; BadFile if one is wrong."""
    known = {item.name for item in fields(kind)}
    for name in values:
        if name not in known:
            raise BadFile(path, shown(name)[1:-1], "is no parameter")
    try:
        return kind(**values)
    except ValueError as error:
        raise BadFile(path, "", str(error)) from None


def read_parameters(path, kind=SailParameters):
    """Parameters from a JSON file, see read_values; those it does not name have their defaults."""
    return kind(**read_values(path, kind))
