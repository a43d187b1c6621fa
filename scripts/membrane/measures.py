# SPDX-License-Identifier: GPL-2.0-or-later
"""What is measured on a sail: plain functions of a mesh and positions, and the lists of measures.

The mesh is a SailMesh, positions are (N, 3) arrays [m] in the order of its nodes, in the frame of
the spin axis. A measure is one entry of a list below: rows of history.csv, their units, plots,
pages, tables and summary.json all go through these lists.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, pi
from typing import Any, Callable, NamedTuple

import numpy as np

from .geometry import area_vectors, crease_angles, side_lengths, triangle_areas


class Shown(NamedTuple):
    """A unit that people read, and how much of it the SI unit is."""

    unit: str
    factor: float


DEGREES = Shown("deg", 180 / pi)
RPM = Shown("rpm", 30 / pi)
MILLIJOULES = Shown("mJ", 1e3)
MICROSTRAIN = Shown("10⁻⁶", 1e6)


class InUnits:
    """Something with a unit, SI, and perhaps another that is shown."""

    unit: str
    shown: Shown | None

    @property
    def form(self) -> Shown:
        """The unit that people read, SI if there is no other, and its factor."""
        return self.shown or Shown(self.unit, 1.0)


@dataclass(frozen=True)
class Measure(InUnits):
    """What is measured at every row of a history.

    Attributes
    ----------
    name, unit : str
        Of its column; SI.
    label : str
        Of its line in a plot, and of its values in tables.
    of : callable
        Its value at a `run.record.Instant`.
    plot : str
        Title of the plot that shows it; "": none does.
    shown : Shown or None
        Unit in plots and tables; None: SI.
    summary : tuple of str
        Which of its values summary.json tells: "final", "largest".
    minor : bool
        Drawn thin, as one of several alike.
    most : float
        What no sail exceeds, of either sign; beyond it a table is in `shown` or in percent.
    """

    name: str
    unit: str
    label: str
    of: Callable[[Any], float]
    plot: str = ""
    shown: Shown | None = None
    summary: tuple[str, ...] = ()
    minor: bool = False
    most: float = inf


@dataclass(frozen=True)
class Outcome(InUnits):
    """What summary.json tells of a whole run, among `measures`.

    Attributes
    ----------
    name, unit, label, shown
        As of a Measure.
    of : callable
        Its value, None if there is none, of a history: a dict of columns (S,).
    """

    name: str
    unit: str
    label: str
    of: Callable[[dict], float | None]
    shown: Shown | None = None


def deployment_rate(mesh: Any, positions: np.ndarray) -> float:
    """Area inside the outer edge, projected on the spin plane, over its flat value [-].

    1 for the flat sail. The shoelace formula: parts of the loop run through clockwise count
    negative.
    """
    x, y = positions[mesh.outer_edge, :2].T
    twice = x[:-1] @ y[1:] + x[-1] * y[0] - y[:-1] @ x[1:] - y[-1] * x[0]
    return float(0.5 * twice / mesh.outer_width**2)


def mean_tip_radius(mesh: Any, positions: np.ndarray) -> float:
    """Mean distance of the four tips from the axis [m]; flat: outer_width / sqrt(2)."""
    return float(_radius(positions[mesh.tips]).mean())


def mean_edge_middle_radius(mesh: Any, positions: np.ndarray) -> float:
    """Mean distance of the outer edges' middles from the axis [m]; flat: outer_width / 2."""
    middles = positions[mesh.outer_edge_middles]  # between two nodes, or twice the same
    return float(_radius(0.5 * (middles[:, 0] + middles[:, 1])).mean())


def area_strain(mesh: Any, positions: np.ndarray, rest: np.ndarray | None = None) -> np.ndarray:
    """Relative growth (T,) of the triangles' areas [-]; `rest` (T,) [m2] if known already."""
    if rest is None:
        rest = triangle_areas(mesh.nodes, mesh.triangles)
    return triangle_areas(positions, mesh.triangles) / rest - 1


def tip_azimuths(mesh: Any, positions: np.ndarray) -> np.ndarray:
    """Azimuths (4,) of the tips [rad] in (-pi, pi], counter-clockwise from +x."""
    x, y = positions[mesh.tips, :2].T
    return np.arctan2(y, x)


def nearest_turn(angle: np.ndarray, reference: np.ndarray) -> np.ndarray:
    """`angle` [rad] shifted by whole turns to within half a turn of `reference` [rad]."""
    return angle - 2 * np.pi * np.round((angle - reference) / (2 * np.pi))


def phase_difference(azimuths: np.ndarray, spool_angles: np.ndarray) -> np.ndarray:
    """Phase difference between each tip and the spool over time.

    Parameters
    ----------
    azimuths : (S, 4) float
        Azimuths of the tips [rad] at S times, the first one at release, in any turn.
    spool_angles : (S,) float
        Angle by which the spool has turned [rad].

    Returns
    -------
    (S, 4) float
        Azimuth minus spool angle [rad], continuous, 0 at release; positive = the tip leads.
        It must change by less than half a turn from one time to the next.
    """
    raw = np.asarray(azimuths) - np.asarray(spool_angles)[:, None]
    return np.unwrap(raw - raw[0], axis=0)


def _radius(points):
    """Distances (n,) [m] of points (n, 3) from the spin axis."""
    return np.hypot(points[:, 0], points[:, 1])


def first_time_above(time: np.ndarray, values: np.ndarray, level: float) -> float | None:
    """First of the times (S,) at which `values` (S,) exceed `level`; None if they never do."""
    above = np.flatnonzero(np.asarray(values) > level)
    return float(time[above[0]]) if len(above) else None


def swing(time: np.ndarray, phase: np.ndarray) -> dict[str, Any]:
    """How far and how fast the tips swing against the spool.

    Parameters
    ----------
    time : (S,) float
        Times since the release [s].
    phase : (S,) float
        Mean phase difference [rad].

    Returns
    -------
    dict
        `largest_lag` [rad] and its `time_of_largest_lag` [s]; `return_time` [s] when the phase
        difference first comes back to zero after it, None if it does not.
    """
    lag = int(np.argmin(phase))
    back = np.flatnonzero(np.asarray(phase[lag:]) >= 0)
    return {
        "largest_lag": float(-phase[lag]),
        "time_of_largest_lag": float(time[lag]),
        "return_time": float(time[lag + back[0]]) if len(back) else None,
    }


def lag_and_half_period(time: np.ndarray, phase: np.ndarray) -> tuple[float, float]:
    """Amplitude and half the period of the phase difference; parameters as in `swing`.

    Returns
    -------
    lag : float
        Largest lag of the mean tip [deg].
    half_period : float
        Time [s] from it to the largest lead that follows.
    """
    found = swing(time, phase)
    lagged = found["time_of_largest_lag"]
    after = time >= lagged
    lead = time[after][np.argmax(phase[after])]
    return float(np.degrees(found["largest_lag"])), float(lead - lagged)


# ------------------------------------------------------------------------------ rows of histories


def _phases(at):
    """Azimuths (4,) of the tips against the spool [rad], 0 at the first row, continuous since."""
    lead = tip_azimuths(at.mesh, at.x) - at.turned
    first = at.kept.setdefault("first_lead", lead.tolist())
    phases = nearest_turn(lead - first, np.array(at.kept.get("phases", [0.0] * 4)))
    at.kept["phases"] = phases.tolist()
    return phases


def _tip(number):
    """Measure of the phase difference of one tip."""
    name, label = f"phase_difference_{number}", f"tip {number}"
    return Measure(
        name, "rad", label, lambda at: at.once(_phases)[number], PHASE, DEGREES, minor=True
    )


PHASE = "phase difference"

SQUARE = (
    Measure(
        "deployment_rate",
        "-",
        "rate",
        lambda at: deployment_rate(at.mesh, at.x),
        "deployment rate",
        summary=("final", "largest"),
        most=1.5,
    ),
    Measure("mean_tip_radius", "m", "of the tips", lambda at: mean_tip_radius(at.mesh, at.x)),
    Measure(
        "mean_edge_middle_radius",
        "m",
        "of the outer edges' middles",
        lambda at: mean_edge_middle_radius(at.mesh, at.x),
    ),
    Measure(
        "phase_difference",
        "rad",
        "mean",
        lambda at: float(at.once(_phases).mean()),
        PHASE,
        DEGREES,
        most=pi,
    ),
    *map(_tip, range(4)),
)


def _radii(at):
    return _radius(at.x)


def _inertia(at):
    """Moment of inertia of the nodes about z [kg m2]."""
    return float(np.sum(at.masses * at.once(_radii) ** 2))


def _tip_radius(at):
    radii = at.once(_radii)
    return float(np.mean(radii[at.tips] if len(at.tips) else radii))


def _projected_area(at):
    return float(area_vectors(at.x, at.mesh.triangles)[:, 2].sum() / at.rest_areas.sum())


def _mean_crease_angle(at):
    mesh = at.mesh
    angles = crease_angles(at.x, mesh.triangles, mesh.creases, mesh.crease_signs)
    return float(angles.mean()) if len(angles) else pi


def _spin_rate(at):
    """Angular momentum of hub and sail over their moment of inertia [rad/s]."""
    hub = at.hub.inertia if at.hub else 0.0
    return float(at.ledger.angularMomentum / (at.once(_inertia) + hub))


SHEET = (
    Measure(
        "mean_radius",
        "m",
        "mean of the masses",
        lambda at: float(np.average(at.once(_radii), weights=at.masses)),
        summary=("final",),
    ),
    Measure("tip_radius", "m", "of the tips", _tip_radius, "radius", summary=("final",)),
    Measure(
        "projected_area",
        "-",
        "projected",
        _projected_area,
        "area over flat area",
        summary=("final", "largest"),
        most=1.5,
    ),
    Measure("height", "m", "height", lambda at: float(np.ptp(at.x[:, 2])), summary=("final",)),
    Measure(
        "mean_crease_angle",
        "rad",
        "mean",
        _mean_crease_angle,
        "crease angle",
        DEGREES,
        summary=("final",),
        most=2 * pi,
    ),
    Measure(
        "spin_rate",
        "rad/s",
        "mean of the sail",
        _spin_rate,
        "spin",
        summary=("final",),
    ),
)


def _film_strain(at):
    film = at.kinds < 2
    return float(np.max(side_lengths(at.x, at.sides[film]) / at.rest[film], initial=1.0) - 1)


ENERGY = "energy"
LEDGER = (
    Measure("kinetic_energy", "J", "kinetic", lambda at: at.ledger.kinetic, ENERGY),
    Measure("elastic_energy", "J", "elastic", lambda at: at.ledger.elastic, ENERGY),
    Measure("crease_energy", "J", "creases", lambda at: at.once(_crease_energy), ENERGY),
    Measure("gravity_energy", "J", "gravity", lambda at: at.ledger.potential),
    Measure("crease_work", "J", "work of creases", lambda at: at.ledger.creaseWork),
    Measure("damping_work", "J", "damping work", lambda at: at.ledger.dampingWork, ENERGY),
    Measure("drag_work", "J", "drag work", lambda at: at.ledger.dragWork),
    Measure("spool_work", "J", "spool work", lambda at: at.ledger.drivenWork, ENERGY),
    Measure("contact_work", "J", "work of contacts", lambda at: at.ledger.contactWork),
    Measure("energy_balance", "J", "balance", lambda at: at.ledger.balance),
    Measure("kink_error", "J", "error at kinks", lambda at: at.ledger.kinkError),
    Measure(
        "crease_defect",
        "J",
        "energy of creases less their work",
        lambda at: at.once(_crease_energy) - at.ledger.initialCrease + at.ledger.creaseWork,
    ),
    Measure("angular_momentum", "kg m2/s", "momentum", lambda at: at.ledger.angularMomentum),
    Measure("angular_impulse", "kg m2/s", "impulse", lambda at: at.ledger.angularImpulse),
    Measure(
        "buckled_sides",
        "-",
        "buckled sides",
        lambda at: int(np.sum(at.buckled)),
    ),
    Measure(
        "film_strain",
        "-",
        "largest of a side",
        _film_strain,
        "film strain",
        MICROSTRAIN,
        summary=("largest",),
    ),
)


def _crease_energy(at):
    return at.ledger.crease  # computed at each call


def moment_of_inertia(masses: np.ndarray, positions: np.ndarray) -> float:
    """Of masses (N,) [kg] at positions (N, 3) [m] about z [kg m2]."""
    return float(np.sum(masses * np.sum(positions[:, :2] ** 2, axis=1)))


def _hub_inertia(at):
    return at.hub.inertia + moment_of_inertia(at.masses, at.x)


HUB = (
    Measure(
        "hub_spin", "rad/s", "spin", lambda at: 0.5 * (at.hub.spinBefore + at.hub.spin), "hub", RPM
    ),
    Measure("hub_angle", "rad", "angle", lambda at: at.turned),
    Measure("hub_energy", "J", "energy", lambda at: at.hub.kinetic),
    Measure("hub_torque", "N m", "torque", lambda at: at.hub.torque),
    Measure("inertia", "kg m2", "of hub and sail", _hub_inertia),
)


# ------------------------------------------------------------------------------ outcomes of runs


def summarised(measures: Sequence[Measure]) -> tuple[Outcome, ...]:
    """Outcomes that the `summary` of Measures asks for."""
    words: dict[str, tuple] = {
        "final": ("{} at the end", lambda v: v[-1]),
        "largest": ("largest {}", np.max),
    }
    found = []
    for m in measures:
        for which in m.summary:
            word, pick = words[which]
            label = word.format(m.plot or m.label)
            found.append(
                Outcome(
                    f"{which}_{m.name}",
                    m.unit,
                    label,
                    _picked(m.name, pick),
                    m.shown,
                )
            )
    return tuple(found)


def _picked(column, pick):
    return lambda h: float(pick(h[column]))


def _time_above(column):
    return lambda h: first_time_above(h["time"], h[column], 0.9)


def _swing(name):
    return lambda h: swing(h["time"], h["phase_difference"])[name]


def _amplitude(h):
    """Largest lag [rad]; None where the run ends before it shows."""
    found = swing(h["time"], h["phase_difference"])
    return found["largest_lag"] if found["time_of_largest_lag"] < h["time"][-1] else None


def _period(h):
    """Twice the time [s] from the largest lag to the lead that follows, None as there."""
    _, half = lag_and_half_period(h["time"], h["phase_difference"])
    left = h["time"][-1] - _swing("time_of_largest_lag")(h)
    return 2 * half if 0 < half < left else None


SQUARE_OUTCOMES = (
    Outcome("amplitude", "rad", "amplitude of the tips' swing", _amplitude, DEGREES),
    Outcome("period", "s", "period of the tips' swing", _period),
    *summarised(SQUARE),
    Outcome(
        "time_of_rate_0.9", "s", "deployment rate above 0.9 from", _time_above("deployment_rate")
    ),
    Outcome("largest_lag", "rad", "largest lag of the tips", _swing("largest_lag"), DEGREES),
    Outcome("time_of_largest_lag", "s", "time of the largest lag", _swing("time_of_largest_lag")),
    Outcome("return_time", "s", "tips back at the spool's angle", _swing("return_time")),
)
SHEET_OUTCOMES = (
    *summarised(SHEET),
    Outcome("time_of_area_0.9", "s", "area above 0.9 from", _time_above("projected_area")),
    Outcome(
        "largest_change_of_angular_momentum",
        "kg m2/s",
        "largest change of angular momentum beyond the impulse",
        lambda h: float(np.ptp(h["angular_momentum"] - h["angular_impulse"])),
    ),
)


def _late(column):
    """Function of a history: mean of a column over the last quarter of the time."""
    return lambda h: float(np.mean(h[column][h["time"] >= 0.75 * h["time"][-1]]))


def spin_by_momentum(history: dict[str, np.ndarray]) -> np.ndarray:
    """Spin (S,) [rad/s] that the angular momentum makes of the shape, on a free hub."""
    return history["angular_momentum"] / history["inertia"]


def _drift(h):
    momentum = h["angular_momentum"]
    return float(np.abs(momentum / momentum[0] - 1).max())


HUB_OUTCOMES = (  # of a hub that turns freely; after: mean over the last quarter of the time
    Outcome(
        "spin_before", "rad/s", "spin of the hub before", lambda h: float(h["hub_spin"][0]), RPM
    ),
    Outcome("spin_after", "rad/s", "spin of the hub after", _late("hub_spin"), RPM),
    Outcome(
        "spin_after_by_momentum",
        "rad/s",
        "after, by angular momentum",
        lambda h: _late("spin")({**h, "spin": spin_by_momentum(h)}),
        RPM,
    ),
    Outcome("inertia_before", "kg m2", "inertia before", lambda h: float(h["inertia"][0])),
    Outcome("inertia_after", "kg m2", "inertia after", _late("inertia")),
    Outcome("kinetic_energy_after", "J", "kinetic energy after", _late("kinetic_energy")),
    Outcome(
        "largest_change_of_hub_energy",
        "J",
        "largest change of the hub's energy",
        lambda h: float(np.abs(h["hub_energy"] - h["hub_energy"][0]).max()),
    ),
    Outcome("angular_momentum_drift", "-", "drift of angular momentum", _drift),
)

LEDGER_OUTCOMES = (
    *summarised(LEDGER),
    Outcome(
        "largest_spool_work",
        "J",
        "largest work of the spool",
        lambda h: float(np.abs(h["spool_work"]).max()),
        MILLIJOULES,
    ),
    Outcome(
        "largest_energy",
        "J",
        "largest kinetic energy",
        lambda h: float(h["kinetic_energy"].max()),
        MILLIJOULES,
    ),
    Outcome(
        "largest_energy_imbalance",
        "J",
        "largest energy imbalance",
        lambda h: float(np.abs(h["energy_balance"]).max()),
        MILLIJOULES,
    ),
    Outcome(
        "largest_unexplained_energy",
        "J",
        "energy from nowhere, at most",
        lambda h: float(np.abs(h["energy_balance"] - h["kink_error"]).max()),
        MILLIJOULES,
    ),
)


# ------------------------------------------------------------------------------ plots


class Plot(NamedTuple):
    """A plot of a history: its title, the unit shown and its factor from SI, lines."""

    title: str
    unit: str
    factor: float
    lines: list[Measure]


def in_plots(measures: Sequence[Measure], history: dict[str, np.ndarray]) -> list[Plot]:
    """Plots of those Measures that have one and are columns of a history, in their order.

    What is 0 throughout, as the spool's work where there is none, would hide other lines: it is
    left out.
    """
    found: dict[str, list[Measure]] = {}
    for m in measures:
        if m.plot and m.name in history:
            found.setdefault(m.plot, []).append(m)
    result = []
    for title, lines in found.items():
        told = [m for m in lines if history[m.name].any()] or lines[:1]
        result.append(Plot(title, *lines[0].form, told))
    return result


EVERY = SQUARE + SHEET + HUB + LEDGER  # whichever a run has
EVERY_OUTCOME = SQUARE_OUTCOMES + SHEET_OUTCOMES + HUB_OUTCOMES + LEDGER_OUTCOMES


def table(found: dict) -> list[list[str]]:
    """Rows of label, value and unit, all texts, of what a summary tells among its measures."""
    known, rows = {outcome.name: outcome for outcome in EVERY_OUTCOME}, []
    for name, value in found.items():
        if name not in known:
            label, unit, factor = name.replace("_", " "), "", 1.0
        else:
            about = known[name]
            label, (unit, factor) = about.label, about.form
        if value is None:
            rows.append([label, "never", ""])
        elif type(value) in (int, float):
            if unit == MILLIJOULES.unit and abs(value) >= 1:
                unit, factor = "J", 1.0
            rows.append([label, f"{factor * value:.4g}", unit])
    return rows
