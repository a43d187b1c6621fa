# SPDX-License-Identifier: GPL-2.0-or-later
"""What a running sail leaves behind: rows of measures, shapes, frames for the pictures."""

from array import array
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from yade import wrapper as yade

from . import measures
from .files import write_json
from .geometry import side_lengths, side_rows, triangle_areas
from .hub import inertia
from .history import read_history
from .output import HistoryWriter, VtkSeries, is_whole_series, is_whole_table

LEDGER_UNITS = {
    "kinetic_energy": "J",
    "elastic_energy": "J",
    "crease_energy": "J",
    "gravity_energy": "J",
    "crease_work": "J",
    "damping_work": "J",
    "drag_work": "J",
    "spool_work": "J",
    "contact_work": "J",
    "energy_balance": "J",
    "kink_error": "J",
    "crease_defect": "J",
    "angular_momentum": "kg m2/s",
    "angular_impulse": "kg m2/s",
    "buckled_sides": "-",
}
UNITS = {
    "time": "s",
    "deployment_rate": "-",
    "mean_tip_radius": "m",
    "mean_edge_middle_radius": "m",
    "phase_difference": "rad",
    "phase_difference_0": "rad",
    "phase_difference_1": "rad",
    "phase_difference_2": "rad",
    "phase_difference_3": "rad",
    **LEDGER_UNITS,
}


# Fields of the ParaView series: unit, and meaning on a side and on a triangle where it has one.
SHAPE_FIELDS = {
    "side_strain": {
        "unit": "-",
        "side": "length over rest length, less 1",
        "triangle": "mean of its three sides",
    },
    "tension": {
        "unit": "N",
        "side": "elastic force along the side, positive when taut",
        "triangle": "mean of its three sides",
    },
    "buckled": {
        "unit": "-",
        "side": "1 below the critical length, else 0",
        "triangle": "share of its three sides",
    },
    "crease_angle": {
        "unit": "rad",
        "side": "between the two triangles: 0 folded face to face, pi flat or no fold line",
        "triangle": "of its fold line farthest from flat",
    },
    "area_strain": {"unit": "-", "triangle": "area over rest area, less 1"},
    "fold": {"unit": "-", "side": "1 mountain, -1 valley, 0 no fold line"},
    "kind": {"unit": "-", "side": "0 film, 1 crease, 2 tether"},
}
HUB_UNITS = {
    "hub_spin": "rad/s",
    "hub_angle": "rad",
    "hub_energy": "J",
    "hub_torque": "N m",
    "inertia": "kg m2",
}


TABLE, SHAPES = "history.csv", "shapes"  # in the output folder

THIRDS = np.full(3, 1 / 3)  # of the three sides of a triangle


class Recorder:
    """Writes history.csv and the ParaView series of a run.

    Parameters
    ----------
    folder : path
        Output folder.
    mesh : SailMesh
    sail : MembraneScene
    spin_rate : float
        Of the spool [rad/s].
    state : dict, optional
        What `state()` gave in a run that this one continues in the same folder.

    Attributes
    ----------
    frames : Frames
        Positions (N, 3) [m] at each shape.
    frame_times : list of float
        Their times [s].
    """

    units = UNITS

    def __init__(self, folder, mesh, sail, spin_rate, state=None):
        self.mesh, self.sail, self.spin_rate = mesh, sail, spin_rate
        if sail.hub:
            self.units = {**self.units, **HUB_UNITS}
        state = state or {"history": None, "film": None, "first_lead": None, "phases": [0.0] * 4}
        table, shapes = Path(folder) / TABLE, Path(folder) / SHAPES
        self._history = HistoryWriter(table, self.units, state["history"])
        membrane = sail.membrane
        self._sides = np.array(membrane.sides)
        self._rest = np.array(membrane.restLengths)
        self._critical = np.array(membrane.criticalLengths)
        self._kinds = np.array(membrane.sideKinds, dtype=np.int8)
        creases = np.array(membrane.creases, dtype=int).reshape(-1, 2)
        self._crease_rows = side_rows(self._sides, creases)
        self._signs = np.zeros(len(self._sides), dtype=np.int8)
        self._signs[self._crease_rows] = membrane.creaseSigns
        ahead = np.roll(mesh.triangles, -1, axis=1)
        pairs = np.stack([mesh.triangles, ahead], axis=-1).reshape(-1, 2)
        self._triangle_sides = side_rows(self._sides, pairs).reshape(-1, 3)
        self._rest_areas = triangle_areas(mesh.nodes, mesh.triangles)
        self.frame_times = list(state["film"]["times"]) if state["film"] else []
        self._film = VtkSeries(shapes, "film", mesh.triangles, self.frame_times)
        self._lines = VtkSeries(shapes, "sides", self._sides, self.frame_times)
        write_json(shapes / "fields.json", SHAPE_FIELDS)
        self._columns = {name: array("d", values) for name, values in read_history(table).items()}
        self.frames = Frames(self._film)
        # Of the tips against the spool [rad]: at the first row, where its time is 0, and since.
        self._first_lead, self._phases = state["first_lead"], np.array(state["phases"])

    def state(self):
        """What a Recorder needs to continue this one, ready for JSON; it is on the disk then."""
        return {
            "history": self._history.state(),
            "film": self._film.state(),
            "sides": self._lines.state(),
            "first_lead": self._first_lead,
            "phases": self._phases.tolist(),
        }

    def history(self, time):
        """Append the measures of the last step, whose forces acted `time` [s] after the release."""
        x = self.sail.last_positions()
        row = {"time": time, **self.measured(time, x), **self._booked(x)}
        self._history.write(row)
        for name, column in self._columns.items():
            column.append(row[name])
        return row

    def measured(self, time, x):
        """Measures of the shape `x` (N, 3) [m] at `time` [s] by name."""
        hub = self.sail.hub
        turned = _angle(hub) if hub else self.spin_rate * time
        lead = measures.tip_azimuths(self.mesh, x) - turned
        if self._first_lead is None:
            self._first_lead = lead.tolist()
        self._phases = phases = measures.nearest_turn(lead - self._first_lead, self._phases)
        return {
            "deployment_rate": measures.deployment_rate(self.mesh, x),
            "mean_tip_radius": measures.mean_tip_radius(self.mesh, x),
            "mean_edge_middle_radius": measures.mean_edge_middle_radius(self.mesh, x),
            "phase_difference": float(phases.mean()),
            **{f"phase_difference_{i}": phases[i] for i in range(4)},
        }

    def _booked(self, x):
        """What the ledger holds, and the number of buckled sides, by name."""
        length = side_lengths(x, self._sides)
        ledger = self.sail.ledger
        crease = ledger.crease  # computed at each call
        return {
            "kinetic_energy": ledger.kinetic,
            "elastic_energy": ledger.elastic,
            "crease_energy": crease,
            "gravity_energy": ledger.potential,
            "crease_work": ledger.creaseWork,
            "damping_work": ledger.dampingWork,
            "drag_work": ledger.dragWork,
            "spool_work": ledger.drivenWork,
            "contact_work": ledger.contactWork,
            "energy_balance": ledger.balance,
            "kink_error": ledger.kinkError,
            "crease_defect": crease - ledger.initialCrease + ledger.creaseWork,
            "angular_momentum": ledger.angularMomentum,
            "angular_impulse": ledger.angularImpulse,
            "buckled_sides": int(np.sum(length < self._critical)),
            **self._hub(x),
        }

    def _hub(self, x):
        """The free hub in the last step, with nodes at `x`; nothing if it is driven."""
        hub = self.sail.hub
        if not hub:
            return {}
        return {
            "hub_spin": 0.5 * (hub.spinBefore + hub.spin),
            "hub_angle": _angle(hub),
            "hub_energy": hub.kinetic,
            "hub_torque": hub.torque,
            "inertia": inertia(self.sail, x),
        }

    def shape(self, time):
        """Append the shape of the last step, at `time` [s], to the ParaView series."""
        x = self.sail.last_positions()
        length = side_lengths(x, self._sides)
        angle = np.full(len(self._sides), np.pi)
        angle[self._crease_rows] = self.sail.forces.creaseAngles(x)
        fields = {
            "side_strain": length / self._rest - 1,
            "tension": np.array(self.sail.membrane.tensions(x)),
            "buckled": (length < self._critical).astype(np.int8),
            "crease_angle": angle,
        }
        lines = {**fields, "fold": self._signs, "kind": self._kinds}
        self._film.write(time, x, _single_precision(self._of_triangles(x, fields)))
        self._lines.write(time, x, _single_precision(lines))
        self.frame_times.append(time)

    def _of_triangles(self, x, fields):
        """Fields (T,) of the triangles from those of the sides (E,): see SHAPE_FIELDS."""
        three = {name: values[self._triangle_sides] for name, values in fields.items()}
        angles = three["crease_angle"]
        most = np.argmax(np.abs(angles - np.pi), axis=1)
        return {
            "area_strain": measures.area_strain(self.mesh, x, self._rest_areas),
            **{name: three[name] @ THIRDS for name in ("side_strain", "tension", "buckled")},
            "crease_angle": angles[np.arange(len(angles)), most],
        }

    def columns(self):
        """What was written to history.csv: arrays (S,) by name."""
        return {name: np.array(values) for name, values in self._columns.items()}

    def close(self):
        """Close history.csv."""
        self._history.close()


def is_whole(folder, state):
    """Whether a folder still holds what the `state` of a Recorder tells of."""
    folder = Path(folder)
    return is_whole_table(folder / TABLE, state["history"]) and all(
        is_whole_series(folder / SHAPES, name, state[name]) for name in ("film", "sides")
    )


class Frames(Sequence):
    """Shapes (N, 3) [m] of a series, each read back when it is asked for: all would fill memory."""

    def __init__(self, series):
        self._series = series

    def __len__(self):
        return len(self._series.frames)

    def __getitem__(self, number):
        return self._series.positions(number)


def _single_precision(fields):
    """The fields, those of double precision rounded to single: enough to look at, half the file."""
    return {
        name: values.astype(np.float32) if values.dtype == float else values
        for name, values in fields.items()
    }


def _angle(hub):
    """Angle [rad] of a free hub in the last step, which has turned it on since."""
    return hub.angle - hub.spin * yade.Omega().dt
