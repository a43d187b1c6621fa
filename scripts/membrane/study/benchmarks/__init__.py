# SPDX-License-Identifier: GPL-2.0-or-later
"""Speed of the plugin: beside YADE's own functors, beside LAMMPS, of its paths, threads and sizes.

Each module named in scripts/bench.py has `measure(settings)`, which returns a list of Entry.
What is compared is measured in one run, turn by turn, because machines drift: `turns` does it.
"""

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from math import isfinite

from .quiet import Quiet

FUSED, LAW2 = "fused", "law2"
PATHS = (FUSED, LAW2)  # of the plugin, as scene.set_engines knows them
AT_MOST, AT_LEAST = "at most", "at least"


@dataclass(frozen=True)
class Settings:
    """What is measured how thoroughly.

    Attributes
    ----------
    rounds : int
        Of each comparison.
    quick : bool
        Only small sizes and short turns.
    quiet : Quiet
        Through which all is measured.
    tell : callable
        Takes a line about progress.
    """

    rounds: int
    quick: bool
    quiet: Quiet
    tell: Callable[[str], None]

    def work(self, node_steps: float) -> float:
        """Nodes times steps of a turn."""
        return node_steps / 5 if self.quick else node_steps

    def sizes(self, sides: Iterable[int]) -> list[int]:
        """Those of the `sides` (nodes along an edge of a sheet) that are to be measured."""
        return [side for side in sides if not self.quick or side <= 100]


@dataclass(frozen=True)
class Entry:
    """A number that was measured.

    Attributes
    ----------
    name : str
        What it is; with `nodes` and `threads` unique in its module.
    value : float
        The median over the rounds.
    unit : str
    nodes : int or None
    threads : int
    spread : (2,) float or None
        The least and the largest over the rounds.
    best : float or None
        Of a ratio: that of the shortest times, which other work on the machine touches least.
    target : float or None
        What it should be at most, or at least.
    bound : str or None
        AT_MOST or AT_LEAST; None: no target.
    other_work : float or None
        Cores that were busy with something else meanwhile, mean.
    """

    name: str
    value: float
    unit: str
    nodes: int | None
    threads: int = 1
    spread: tuple | None = None
    best: float | None = None
    target: float | None = None
    bound: str | None = None
    other_work: float | None = None

    def __post_init__(self) -> None:
        if (self.target is None) != (self.bound is None):
            raise ValueError(f"{self.name}: target and bound go together")
        if self.bound not in (None, AT_MOST, AT_LEAST):
            raise ValueError(f"bound = {self.bound!r}: must be {AT_MOST!r} or {AT_LEAST!r}")
        if not isfinite(self.value):
            raise ValueError(f"{self.name}: value = {self.value} must be finite")

    @property
    def holds(self) -> bool | None:
        """Whether the target is met; None if there is none."""
        if self.target is None:
            return None
        return self.value <= self.target if self.bound == AT_MOST else self.value >= self.target

    def as_dict(self) -> dict:
        """All attributes and `holds`, ready for JSON; without target only what is there."""
        known = {**asdict(self), "holds": self.holds}
        return {key: value for key, value in known.items() if value is not None or key == "nodes"}
