# SPDX-License-Identifier: GPL-2.0-or-later
"""What a running sail leaves behind: rows of measures, shapes, frames for the pictures."""

from array import array
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from yade import wrapper as yade

from ..files import write_json
from ..geometry import side_lengths, side_rows, triangle_areas
from ..measures import HUB, LEDGER, Measure, area_strain
from ..results.history import read_history
from ..results.output import HistoryWriter, VtkSeries, is_whole_series, is_whole_table
from .kind import Sail

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
        "side": "1 buckled, or beside a wrinkled or slack triangle; else 0",
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
# Those of the triangles of a film of plane stress.
FILM_FIELDS = {
    "film_state": {"unit": "-", "triangle": "0 taut, 1 wrinkled, 2 slack"},
    "first_stress": {"unit": "Pa", "triangle": "larger principal stress, second Piola-Kirchhoff"},
    "second_stress": {"unit": "Pa", "triangle": "smaller principal stress, alike"},
    "wrinkles": {"unit": "-", "triangle": "unit vector along which wrinkles run; 0 without"},
}
TABLE, SHAPES = "history.csv", "shapes"  # in the output folder

THIRDS = np.full(3, 1 / 3)  # of the three sides of a triangle


class Instant:
    """The last step, in which forces acted at `time` [s] after the release, as Measures see it.

    Attributes
    ----------
    time : float
        [s]
    x : (N, 3) float
        Positions of the nodes [m].
    mesh, tips
        Of the Sail.
    ledger, hub
        Engines; hub is None where it is driven.
    turned : float
        Angle of the hub, or what it is driven by, since the release [rad].
    masses : (N,) float
        [kg]
    sides, kinds : (E, 2) int, (E,) int
        Nodes of each side; 0 film, 1 crease, 2 tether.
    rest, buckled, rest_areas : (E,) float, (E,) bool, (T,) float
        Lengths at rest [m], which sides are buckled, areas at rest [m2].
    kept : dict
        What measures keep from row to row; it goes into JSON.
    """

    def __init__(self, recorder: Any, time: float) -> None:
        sail, built = recorder.sail, recorder.built
        self.time, self.x = time, built.last_positions()
        self.mesh, self.tips, self.kept = sail.mesh, sail.tips, recorder.kept
        self.ledger, self.hub = built.ledger, built.hub
        self.turned = _angle(built.hub) if built.hub else recorder.spin_rate * time
        self.masses, self.rest_areas = recorder.masses, recorder.rest_areas
        self.sides, self.kinds = recorder.sides, recorder.kinds
        self.rest, self.buckled = recorder.rest, recorder.buckled(self.x)
        self._once: dict[Callable, Any] = {}

    def once(self, function: Callable) -> Any:
        """What a function makes of this instant, computed once."""
        if function not in self._once:
            self._once[function] = function(self)
        return self._once[function]


class Recorder:
    """Writes history.csv and the ParaView series of a run.

    Parameters
    ----------
    folder : path
        Output folder.
    sail : Sail
    built : MembraneScene
    measures : tuple of Measure
        Of the kind of sail.
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

    def __init__(
        self,
        folder: str | Path,
        sail: Sail,
        built: Any,
        measures: Sequence[Measure],
        spin_rate: float,
        state: dict | None = None,
    ) -> None:
        self.sail, self.built, self.spin_rate = sail, built, spin_rate
        self.measures = (*measures, *LEDGER, *(HUB if built.hub else ()))
        units = {"time": "s", **{measure.name: measure.unit for measure in self.measures}}
        state = state or {"history": None, "film": None, "kept": {}}
        self.kept = state["kept"]
        table, shapes = Path(folder) / TABLE, Path(folder) / SHAPES
        self._history = HistoryWriter(table, units, state["history"])
        membrane, mesh = built.membrane, sail.mesh
        self.masses = built.masses()
        self.sides = np.array(membrane.sides)
        self.critical = np.array(membrane.criticalLengths)
        self.rest_areas = triangle_areas(mesh.nodes, mesh.triangles)
        self.rest = np.array(membrane.restLengths)
        self.kinds = np.array(membrane.sideKinds, dtype=np.int8)
        creases = np.array(membrane.creases, dtype=int).reshape(-1, 2)
        self._crease_rows = side_rows(self.sides, creases)
        self._signs = np.zeros(len(self.sides), dtype=np.int8)
        self._signs[self._crease_rows] = membrane.creaseSigns
        ahead = np.roll(mesh.triangles, -1, axis=1)
        pairs = np.stack([mesh.triangles, ahead], axis=-1).reshape(-1, 2)
        self._triangle_sides = side_rows(self.sides, pairs).reshape(-1, 3)
        self.frame_times = list(state["film"]["times"]) if state["film"] else []
        self._film = VtkSeries(shapes, "film", mesh.triangles, self.frame_times)
        self._lines = VtkSeries(shapes, "sides", self.sides, self.frame_times)
        self._plane_stress = membrane.film == "plane_stress"
        film_fields = FILM_FIELDS if self._plane_stress else {}
        write_json(shapes / "fields.json", {**SHAPE_FIELDS, **film_fields})
        self._columns = {name: array("d", values) for name, values in read_history(table).items()}
        self.frames = Frames(self._film)

    def state(self) -> dict:
        """What a Recorder needs to continue this one, ready for JSON; it is on the disk then."""
        return {
            "history": self._history.state(),
            "film": self._film.state(),
            "sides": self._lines.state(),
            "kept": self.kept,
        }

    def history(self, time: float) -> dict[str, float]:
        """Append the measures of the last step, whose forces acted `time` [s] after the release."""
        at = Instant(self, time)
        row = {"time": time, **{measure.name: measure.of(at) for measure in self.measures}}
        self._history.write(row)
        for name, column in self._columns.items():
            column.append(row[name])
        return row

    def told(self, name: str, row: dict[str, float]) -> str:
        """One of the measures of a row, in words."""
        (m,) = [measure for measure in self.measures if measure.name == name]
        unit, factor = m.form
        return f"{m.label} {factor * row[name]:.3f}{'' if unit == '-' else ' ' + unit}"

    def shape(self, time: float) -> None:
        """Append the shape of the last step, at `time` [s], to the ParaView series."""
        x = self.built.last_positions()
        length, states = side_lengths(x, self.sides), self._states(x)
        angle = np.full(len(self.sides), np.pi)
        angle[self._crease_rows] = self.built.forces.creaseAngles(x)
        fields = {
            "side_strain": length / self.rest - 1,
            "tension": np.array(self.built.membrane.tensions(x)),
            "buckled": self._buckled(length, states).astype(np.int8),
            "crease_angle": angle,
        }
        lines = {**fields, "fold": self._signs, "kind": self.kinds}
        self._film.write(time, x, _single_precision(self._of_triangles(x, fields, states)))
        self._lines.write(time, x, _single_precision(lines))
        self.frame_times.append(time)

    def _of_triangles(self, x, fields, states):
        """Fields (T,) of the triangles from those of the sides (E,): see SHAPE_FIELDS."""
        three = {name: values[self._triangle_sides] for name, values in fields.items()}
        angles = three["crease_angle"]
        most = np.argmax(np.abs(angles - np.pi), axis=1)
        return {
            "area_strain": area_strain(self.sail.mesh, x, self.rest_areas),
            **{name: three[name] @ THIRDS for name in ("side_strain", "tension", "buckled")},
            "crease_angle": angles[np.arange(len(angles)), most],
            **({} if states is None else self._of_film(x, states)),
        }

    def _states(self, x):
        """States (T,) of the triangles of a film of plane stress; None if it is one of springs."""
        film = self.built.membrane
        return np.array(film.filmStates(x), dtype=np.int8) if self._plane_stress else None

    def _of_film(self, x, states):
        """FILM_FIELDS (T,) and (T, 3) at positions (N, 3) [m]."""
        film = self.built.membrane
        first, second = np.array(film.filmStresses(x)).T
        return {
            "film_state": states,
            "first_stress": first,
            "second_stress": second,
            "wrinkles": np.array(film.wrinkleDirections(x)),
        }

    def buckled(self, x: np.ndarray) -> np.ndarray:
        """Which sides (E,) are buckled at positions (N, 3) [m].

        Those below their critical length; of a film of plane stress those of triangles that are
        not taut.
        """
        return self._buckled(side_lengths(x, self.sides), self._states(x))

    def _buckled(self, length, states):
        """The same from lengths (E,) [m] and `_states`."""
        short = length < self.critical
        if states is None:
            return short
        beside = np.zeros(len(short), dtype=bool)
        beside[self._triangle_sides[states > 0]] = True
        return np.where(self.kinds < 2, beside, short)

    def columns(self) -> dict[str, np.ndarray]:
        """What was written to history.csv: arrays (S,) by name."""
        return {name: np.array(values) for name, values in self._columns.items()}

    def close(self) -> None:
        """Close history.csv."""
        self._history.close()


def is_whole(folder: str | Path, state: dict) -> bool:
    """Whether a folder still holds what the `state` of a Recorder tells of."""
    folder = Path(folder)
    return is_whole_table(folder / TABLE, state["history"]) and all(
        is_whole_series(folder / SHAPES, name, state[name]) for name in ("film", "sides")
    )


class Frames(Sequence):
    """Shapes (N, 3) [m] of a series, each read back when it is asked for: all would fill memory."""

    def __init__(self, series: VtkSeries) -> None:
        self._series = series

    def __len__(self) -> int:
        return len(self._series.frames)

    def __getitem__(self, number: Any) -> Any:
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
