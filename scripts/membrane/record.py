# SPDX-License-Identifier: GPL-2.0-or-later
"""What a running sail leaves behind: rows of measures, shapes, frames for the pictures."""

from pathlib import Path

import numpy as np
from yade import wrapper as yade

from . import measures
from .hub import inertia
from .output import HistoryWriter, VtkSeries

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
HUB_UNITS = {
    "hub_spin": "rad/s",
    "hub_angle": "rad",
    "hub_energy": "J",
    "hub_torque": "N m",
    "inertia": "kg m2",
}


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

    Attributes
    ----------
    rows : list of dict
        What was written to history.csv.
    frames : list of (N, 3) float
        Positions [m] at each shape.
    frame_times : list of float
        Their times [s].
    """

    def __init__(self, folder, mesh, sail, spin_rate):
        self.mesh, self.sail, self.spin_rate = mesh, sail, spin_rate
        self.rows, self.frames, self.frame_times = [], [], []
        self._units = {**UNITS, **HUB_UNITS} if sail.hub else UNITS
        self._history = HistoryWriter(Path(folder) / "history.csv", self._units)
        membrane = sail.membrane
        self._sides = np.array(membrane.sides)
        self._rest = np.array(membrane.restLengths)
        self._critical = np.array(membrane.criticalLengths)
        self._kinds = np.array(membrane.sideKinds)
        self._crease_rows = self._rows_of_creases(np.array(membrane.creases))
        shapes = Path(folder) / "shapes"
        self._film = VtkSeries(shapes, "film", mesh.triangles)
        self._lines = VtkSeries(shapes, "sides", self._sides)
        # Of the tips against the spool [rad]: at the first row, where its time is 0, and since.
        self._first_lead, self._phases = None, np.zeros(4)

    def _rows_of_creases(self, creases):
        """Row in the membrane's sides of each crease (C,)."""
        row = {tuple(pair): i for i, pair in enumerate(self._sides.tolist())}
        return np.array([row[tuple(sorted(pair))] for pair in creases.tolist()], dtype=int)

    def history(self, time):
        """Append the measures of the last step, whose forces acted `time` [s] after the release."""
        x = self.sail.last_positions()
        hub = self._hub(x)
        turned = hub["hub_angle"] if hub else self.spin_rate * time
        lead = measures.tip_azimuths(self.mesh, x) - turned
        if self._first_lead is None:
            self._first_lead = lead
        self._phases = phases = measures.nearest_turn(lead - self._first_lead, self._phases)
        length = np.linalg.norm(x[self._sides[:, 1]] - x[self._sides[:, 0]], axis=1)
        ledger = self.sail.ledger
        row = {
            "time": time,
            "deployment_rate": measures.deployment_rate(self.mesh, x),
            "mean_tip_radius": measures.mean_tip_radius(self.mesh, x),
            "mean_edge_middle_radius": measures.mean_edge_middle_radius(self.mesh, x),
            "phase_difference": float(phases.mean()),
            **{f"phase_difference_{i}": phases[i] for i in range(4)},
            "kinetic_energy": ledger.kinetic,
            "elastic_energy": ledger.elastic,
            "crease_energy": ledger.crease,
            "gravity_energy": ledger.potential,
            "crease_work": ledger.creaseWork,
            "damping_work": ledger.dampingWork,
            "drag_work": ledger.dragWork,
            "spool_work": ledger.drivenWork,
            "contact_work": ledger.contactWork,
            "energy_balance": ledger.balance,
            "kink_error": ledger.kinkError,
            "crease_defect": ledger.creaseDefect,
            "angular_momentum": ledger.angularMomentum,
            "angular_impulse": ledger.angularImpulse,
            "buckled_sides": int(np.sum(length < self._critical)),
            **hub,
        }
        self._history.write(row)
        self.rows.append(row)
        return row

    def _hub(self, x):
        """The free hub in the last step, with nodes at `x`; nothing if it is driven."""
        hub = self.sail.hub
        if not hub:
            return {}
        return {
            "hub_spin": 0.5 * (hub.spinBefore + hub.spin),
            "hub_angle": hub.angle - hub.spin * yade.Omega().dt,
            "hub_energy": hub.kinetic,
            "hub_torque": hub.torque,
            "inertia": inertia(self.sail, x),
        }

    def shape(self, time):
        """Append the shape of the last step, at `time` [s], to the ParaView series."""
        x = self.sail.last_positions()
        length = np.linalg.norm(x[self._sides[:, 1]] - x[self._sides[:, 0]], axis=1)
        angle = np.full(len(self._sides), np.pi)
        angle[self._crease_rows] = self.sail.forces.creaseAngles(x.tolist())
        side_data = {
            "force": np.array(self.sail.membrane.tensions(x.tolist())),
            "strain": length / self._rest - 1,
            "buckled": (length < self._critical).astype(int),
            "crease_angle": angle,
            "kind": self._kinds,
        }
        self._film.write(time, x, {"area_strain": measures.area_strain(self.mesh, x)})
        self._lines.write(time, x, side_data)
        self.frames.append(x)
        self.frame_times.append(time)

    def columns(self):
        """The rows as arrays (S,) by name."""
        return {name: np.array([row[name] for row in self.rows]) for name in self._units}

    def close(self):
        """Close history.csv."""
        self._history.close()
