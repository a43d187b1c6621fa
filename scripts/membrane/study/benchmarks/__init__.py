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
    """What is measured how thoroughly."""

    rounds: int  #: of each comparison
    quick: bool  #: only small sizes and short turns
    quiet: Quiet  #: through which all is measured
    tell: Callable[[str], None]  #: takes a line about progress

    def work(self, node_steps: float) -> float:
        """Nodes times steps of a turn."""
        return node_steps / 5 if self.quick else node_steps

    def sizes(self, sides: Iterable[int]) -> list[int]:
        """Those of the `sides` (nodes along an edge of a sheet) that are to be measured."""
        return [side for side in sides if not self.quick or side <= 100]


@dataclass(frozen=True)
class Entry:
    """A number that was measured."""

    name: str  #: what it is; with `nodes` and `threads` unique in its module
    value: float  #: the median over the rounds
    unit: str
    nodes: int | None
    threads: int = 1
    spread: tuple | None = None  #: the least and the largest over the rounds, (2,)
    best: float | None = None  #: ratio of the shortest times, least touched by other work
    target: float | None = None  #: what it should be at most, or at least
    bound: str | None = None  #: AT_MOST or AT_LEAST; None: no target
    other_work: float | None = None  #: cores busy with something else meanwhile, mean

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
