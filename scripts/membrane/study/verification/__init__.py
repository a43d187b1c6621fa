# SPDX-License-Identifier: GPL-2.0-or-later
"""Verification: the plugin against closed forms, other codes and a second implementation.

Each module has `checks(full)`, which returns a list of Check; without `full` only what takes
seconds. Run them by scripts/verify.py.
"""

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from math import isfinite

import numpy as np
from membrane.study.text_table import aligned

TARGET, AT_MOST, MEASURED = "target", "at most", "measured"


@dataclass(frozen=True)
class Check:
    """A number that was measured, and what it is held against.

    `name` says what was measured, unique in its module; `source` where the target comes from, or
    why the tolerance is what it is. `tolerance`, >= 0, is the greatest distance from the target, in
    the same unit. `kind` is TARGET: the number must meet the target; AT_MOST: it must not exceed
    it by more than the tolerance; or MEASURED: the target is its value when last looked at, and
    the tolerance only tells when it changes.
    """

    name: str
    measured: float
    target: float
    tolerance: float
    source: str
    unit: str = "-"
    kind: str = TARGET

    def __post_init__(self) -> None:
        if self.kind not in (TARGET, AT_MOST, MEASURED):
            raise ValueError(f"kind = {self.kind!r}: must be {TARGET!r}, {AT_MOST!r}, {MEASURED!r}")
        if not (isfinite(self.target) and self.tolerance >= 0):
            raise ValueError(f"{self.name}: target must be finite and tolerance >= 0")

    @property
    def holds(self) -> bool:
        """Whether the number is as it should be; never for one that is not finite."""
        distance = self.measured - self.target
        distance = distance if self.kind == AT_MOST else abs(distance)
        return isfinite(self.measured) and bool(distance <= self.tolerance)

    def as_dict(self) -> dict:
        """All attributes and `holds`, ready for JSON; a number that is not finite becomes None."""
        found = asdict(self)
        for name in ("measured", "target", "tolerance"):
            found[name] = float(found[name]) if isfinite(found[name]) else None
        return {**found, "holds": self.holds}


def at_most(name: str, measured: float, most: float, source: str, unit: str = "-") -> Check:
    """A Check that `measured` does not exceed `most`."""
    return Check(name, measured, most, 0.0, source, unit, AT_MOST)


def recorded(
    name: str, value: float, last: float, tolerance: float, source: str, unit: str = "-"
) -> Check:
    """A Check that records `value`, and fails only if it is off its `last` one by `tolerance`."""
    return Check(name, value, last, tolerance, source, unit, MEASURED)


def order(errors: Sequence[float] | np.ndarray) -> float:
    """Order of convergence [-] from the last two of `errors`, between which a size is halved."""
    return float(np.log2(errors[-2] / errors[-1]))


def table(module: str, found: Iterable[Check]) -> list[str]:
    """Lines of text that show a list of Check of a module."""
    head = ("", "measured", "target", "tolerance", "unit", "")
    signs = {TARGET: "", AT_MOST: "<= ", MEASURED: "last "}
    rows = [
        (
            check.name,
            f"{check.measured:.6g}",
            signs[check.kind] + f"{check.target:.6g}",
            f"{check.tolerance:.2g}" if check.kind != AT_MOST or check.tolerance else "",
            check.unit,
            "holds" if check.holds else "DOES NOT HOLD",
        )
        for check in found
    ]
    return [module, *("  " + line for line in aligned([head, *rows], left=(0, 4, 5)))]
