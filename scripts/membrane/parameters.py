# SPDX-License-Identifier: GPL-2.0-or-later
"""Parameters of the paper's scene: Tables 1 and 2, and what MODEL.md assumes where they are silent.

One dataclass holds names, defaults, units and ranges; command line, yade-batch table, summary.json
and the README's table all come from it.
"""

import argparse
from dataclasses import asdict, dataclass, field, fields
from math import inf, pi

TABLE_1, TABLE_2, ASSUMED, RUN = "Table 1", "Table 2", "assumed", "run"


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


@dataclass(frozen=True)
class SailParameters:
    """Parameters of the deployment; `describe(name)` gives meaning, unit, range and source."""

    fold_lines: int = _parameter(7, "-", TABLE_1, "fold lines on each petal", least=1)
    outer_width: float = _parameter(0.455, "m", TABLE_1, "outer width", above=True)
    inner_width: float = _parameter(0.103, "m", TABLE_1, "inner width", above=True)
    thickness: float = _parameter(7.5e-6, "m", TABLE_1, "thickness h of the film", above=True)
    spool_radius: float = _parameter(0.025, "m", TABLE_1, "radius of the spool", above=True)
    young: float = _parameter(3.2e9, "Pa", TABLE_1, "Young's modulus E", above=True)
    poisson: float = _parameter(0.34, "-", TABLE_1, "Poisson's ratio nu", least=-1, most=0.5)
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
    tether_segments: int = _parameter(4, "-", ASSUMED, "segments of each tether", least=1)
    tether_stiffness: float = _parameter(200.0, "N", ASSUMED, "EA of the tethers", above=True)
    tether_density: float = _parameter(
        2e-4, "kg/m", ASSUMED, "mass a length of the tethers", above=True
    )
    tether_radius: float = _parameter(
        5e-4, "m", ASSUMED, "radius of tether masses in contact", above=True
    )
    spool_height: float = _parameter(0.06, "m", ASSUMED, "height of the spool", above=True)
    spool_facets: int = _parameter(36, "-", ASSUMED, "flat faces of the spool", least=3)
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
    shapes_interval: float = _parameter(1e-2, "s", RUN, "between shapes for ParaView; 0: none")
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
        for item in fields(self):
            _check(item, getattr(self, item.name))

    def as_dict(self):
        """Values by name."""
        return asdict(self)


def _check(item, value):
    """Raise ValueError naming parameter, value and range if it is out of range."""
    about = item.metadata
    if about["choices"]:
        if value not in about["choices"]:
            raise ValueError(
                f"{item.name} = {value!r} must be one of {', '.join(about['choices'])}"
            )
        return
    if item.type is int and value != int(value):
        raise ValueError(f"{item.name} = {value} must be a whole number")
    low = value > about["least"] if about["above"] else value >= about["least"]
    if not (low and value <= about["most"] and abs(value) < inf):
        unit = "" if about["unit"] == "-" else " " + about["unit"]
        raise ValueError(f"{item.name} = {value}{unit} must be {_range(about)}")


def _range(about):
    """The range of a parameter in words."""
    words = (">" if about["above"] else ">=") + f" {about['least']:g}"
    return words + (f" and <= {about['most']:g}" if about["most"] < inf else "")


def describe(item):
    """Meaning, unit, source and range of a field of SailParameters, for help texts."""
    about = item.metadata
    unit = "" if about["unit"] == "-" else f" [{about['unit']}]"
    allowed = ", ".join(about["choices"]) if about["choices"] else _range(about)
    extent = "" if item.type is bool else f", {allowed}"
    return f"{about['text']}{unit} ({about['source']}{extent}; default {item.default})"


def add_arguments(parser):
    """Add one option for every parameter to an argparse parser, grouped by source."""
    for source in (TABLE_1, TABLE_2, ASSUMED, RUN):
        group = parser.add_argument_group(f"parameters: {source}")
        for item in fields(SailParameters):
            if item.metadata["source"] == source:
                _add_argument(group, item)


def _add_argument(group, item):
    flag, text = "--" + item.name.replace("_", "-"), describe(item).replace("%", "%%")
    if item.type is bool:
        group.add_argument(
            flag, action=argparse.BooleanOptionalAction, default=item.default, help=text
        )
        return
    choices = item.metadata["choices"]
    metavar = None if choices else item.metadata["unit"].replace("-", "N")
    group.add_argument(
        flag, type=item.type, default=item.default, choices=choices, metavar=metavar, help=text
    )


def from_arguments(arguments, overrides=None):
    """SailParameters from parsed arguments; `overrides` (a dict, as from a batch table) win."""
    values = {item.name: getattr(arguments, item.name) for item in fields(SailParameters)}
    for name, value in (overrides or {}).items():
        if name not in values:
            known = ", ".join(sorted(values))
            raise ValueError(f"{name} is no parameter of the sail; known are {known}")
        values[name] = value
    return SailParameters(**values)
