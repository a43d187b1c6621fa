# SPDX-License-Identifier: GPL-2.0-or-later
"""What a kind of sail gives to the driver, which does everything else. Needs no YADE."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from ..measures import Measure, Outcome
from ..parameters import PHYSICAL, RunParameters


@dataclass(frozen=True, eq=False)
class Sail:
    """A sail ready to be put into a scene, about the z axis. N nodes.

    Attributes
    ----------
    mesh : object
        With nodes (N, 3) at rest [m], triangles (T, 3), creases (C, 2) and crease_signs (C,), tips.
    start : (N, 3) float, node
        Where to put the nodes [m].
    tips, tip_mass : (n,) int, node; float
        Which nodes bear tip masses, and how much each [kg].
    cables : (K, 2) int, node
        Tethers.
    hub : (n,) int, node
        Driven, or on a hub that turns freely.
    touching : (n,) int, node
        That touch the spool.
    held : (n,) int, node
        Held in the turning frame until the release; with any, there is a spin-up.
    facts : dict
        What summary.json tells of it.
    doubts : sequence of str
        Warnings.
    words : str
        What to tell first of all.
    """

    mesh: Any
    start: np.ndarray
    tips: np.ndarray
    tip_mass: float
    cables: np.ndarray = field(default_factory=lambda: np.empty((0, 2), dtype=int))
    hub: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=int))
    touching: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=int))
    held: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=int))
    facts: Mapping = field(default_factory=dict)
    doubts: Sequence[str] = ()
    words: str = ""

    @property
    def point_masses(self) -> np.ndarray:
        """Masses (N,) [kg] of the tips at the nodes, without the film."""
        masses = np.zeros(len(self.start))
        masses[self.tips] = self.tip_mass
        return masses


@dataclass(frozen=True, eq=False)
class FinishedSail:
    """What is left of a run for pictures and files.

    Attributes
    ----------
    sail : Sail
    parameters : RunParameters
    built : MembraneScene
    history : dict of (S,) float
        Columns of history.csv.
    times : (F,) float
        Of the shapes [s].
    frames : sequence of (N, 3) float
        The shapes [m].
    folder : Path
        Of the results.
    """

    sail: Sail
    parameters: Any
    built: Any
    history: dict[str, np.ndarray]
    times: np.ndarray
    frames: Sequence
    folder: Path

    def show(self, instants: Sequence[float] | np.ndarray) -> tuple[list, np.ndarray]:
        """Shapes (n, N, 3) [m] nearest to some `instants` [s], each once, and their times (n,)."""
        picks = np.unique([int(np.argmin(np.abs(self.times - t))) for t in instants])
        return [self.frames[i] for i in picks], self.times[picks]

    def until(self, last: int) -> np.ndarray:
        """Six instants [s] up to that of the shape `last`, closer together early on."""
        return self.times[last] * (np.arange(6) / 5) ** 1.5


P = TypeVar("P", bound=RunParameters)


def in_si(mesh: Any, p: P) -> P:
    """Parameters with what the paper's numbers are on a mesh in SI, in their place."""
    from ..scene.physical import physical_parameters  # needs YADE

    return replace(p, **physical_parameters(mesh, p), **dict.fromkeys(PHYSICAL.values(), 0.0))


class Kind(Generic[P]):
    """A kind of sail; its parameters name it: `RunParameters.sail`.

    Attributes
    ----------
    title : str
        In one line.
    parameters : class
        Of RunParameters.
    measures : tuple of Measure
        In history.csv, before those of ledger and hub.
    outcomes : tuple of Outcome
        In summary.json, before those of the ledger.
    told : str
        Measure that is shown beside the progress.
    """

    title: ClassVar[str]
    parameters: ClassVar[type[RunParameters]]
    measures: ClassVar[tuple[Measure, ...]]
    outcomes: ClassVar[tuple[Outcome, ...]]
    told: ClassVar[str]

    def sail(self, p: P) -> Sail:
        """The sail of parameters `p`; ValueError, in one sentence, if there is none."""
        raise NotImplementedError

    def film(self, sail: Sail, p: P) -> P:
        """The parameters with which the membrane of a sail is built.

        A film of plane stress takes the paper's numbers, where they are not given in SI, for
        those of the sail's mesh.
        """
        return p if p.film == "springs" else in_si(sail.mesh, p)

    def about_film(self, p: P) -> list[str]:
        """A sentence, if the film of a sail of plane stress depends on its mesh."""
        missing = [name for name, n in PHYSICAL.items() if not getattr(p, name) and getattr(p, n)]
        missing = [name for name in missing if name != "crease_buckling_length"]
        if p.film == "springs" or not missing:
            return []
        numbers = ", ".join(PHYSICAL[name] for name in missing)
        return [
            f"film = {p.film}: {', '.join(missing)} follow from {numbers} on this mesh; give them "
            "for the same film on any"
        ]

    def explained(self, refusal: str) -> str:
        """What to tell where the plugin refuses the sail's membrane."""
        return refusal

    def equip(self, sail: Sail, built: Any, p: P) -> None:
        """Add engines of its own to a scene, if any."""

    def release_rate(self, built: Any, p: P) -> float:
        """Spin [rad/s] at the release; by default omega."""
        return p.omega

    def draw(self, run: FinishedSail) -> None:
        """Write pictures of a run."""

    def leave(self, run: FinishedSail) -> dict:
        """Write further files; returns what else the summary tells among its measures."""
        return {}
