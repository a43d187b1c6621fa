# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper's deployment with something changed or left out, and what time a step of it takes."""

import time
from dataclasses import dataclass, field, replace

import numpy as np
from membrane import scene
from membrane.parameters import SailParameters
from membrane.run.kind import Sail
from yade import wrapper as yade

from . import deployment


@dataclass(frozen=True)
class Variant:
    """What is changed, and what is left out.

    `changes` of SailParameters; `duration` of its run [s]; whether the sail `rests` elsewhere so,
    and must be spun up anew; whether the `ledger` is kept, and the collider, for `contact`.
    """

    changes: dict = field(default_factory=dict)
    duration: float = SailParameters().duration
    rests: bool = False
    ledger: bool = True
    contact: bool = True

    def parameters(self) -> SailParameters:
        """Its SailParameters; those of the paper as printed on every mesh."""
        printed = {"as_printed": self.changes.get("refine", 1) > 1}
        return replace(SailParameters(duration=self.duration), **printed, **self.changes)

    def start(self) -> np.ndarray:
        """Positions (N, 3) [m] at the release; the fused path finds them for both."""
        p = self.parameters()
        rested = p if self.rests else SailParameters(refine=p.refine, as_printed=p.as_printed)
        return deployment.equilibrium(replace(rested, path="fused"))

    def begin(self, positions: np.ndarray | None = None) -> tuple[Sail, scene.MembraneScene]:
        """Release the sail from `positions` (N, 3) [m], by default its `start`."""
        start = self.start() if positions is None else positions
        built = deployment.begin(self.parameters(), start, self.ledger)
        if not self.contact:
            drop_collider()
        return built

    def step_time(self, steps: int) -> float:
        """Processor time of a step [s], soon after the release, on one thread."""
        self.begin()
        scene.advance(steps // 10)
        begun = time.process_time()
        scene.advance(steps)
        return (time.process_time() - begun) / steps


def drop_collider() -> None:
    """Take the collider out of the engines: nothing touches the spool any more."""
    omega = yade.Omega()
    collider = yade.InsertionSortCollider
    omega.engines = [engine for engine in omega.engines if not isinstance(engine, collider)]
