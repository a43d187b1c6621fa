# SPDX-License-Identifier: GPL-2.0-or-later
"""Paired measurements: everything once in every round, ratios within a round, medians over them."""

import statistics
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from . import Entry
from .quiet import Quiet

FEWER = 3  # rounds beside other work, where wall time counts


def take_turns(
    takers: Mapping[Any, Callable[[], Any]], rounds: int, quiet: Quiet, wait: bool = False
) -> dict[Any, list]:
    """Measure everything `rounds` times, turn by turn, every other round in reverse.

    `takers` are functions without arguments that return a number, by name; `wait` for a machine
    that does nothing else: where wall time counts. Gives a list of `rounds` numbers for each name;
    of FEWER if the wait was in vain.
    """
    found: dict[Any, list] = {name: [] for name in takers}

    def take(names: Sequence) -> list[tuple]:
        return [(name, takers[name]()) for name in names]

    for number in range(rounds):
        if wait and quiet.patience <= 0 and number >= FEWER:
            break  # more of them would tell no more, and take long
        names = list(takers) if number % 2 == 0 else list(reversed(takers))
        for name, taken in quiet.measure(partial(take, names), wait):
            found[name].append(taken)
    return found


def ratios(above: Sequence[float], below: Sequence[float]) -> list[float]:
    """Ratios of two lists of paired numbers, pair by pair."""
    if len(above) != len(below) or not above:
        raise ValueError(f"{len(above)} and {len(below)} numbers make no pairs")
    return [a / b for a, b in zip(above, below)]


def entry(name: str, numbers: Sequence[float], unit: str, nodes: int | None, **more: Any) -> Entry:
    """An Entry of the median of `numbers`, with their spread."""
    return Entry(
        name, statistics.median(numbers), unit, nodes, spread=(min(numbers), max(numbers)), **more
    )


def ratio_entry(
    name: str, above: Sequence[float], below: Sequence[float], nodes: int | None, **more: Any
) -> Entry:
    """An Entry of the median of paired ratios, and of the ratio of the best of either."""
    best = min(above) / min(below)
    return entry(name, ratios(above, below), "-", nodes, best=best, **more)
