# SPDX-License-Identifier: GPL-2.0-or-later
"""What the cases of a sweep came to: which parameters differ, and what came out."""

import csv
import io
from pathlib import Path

from membrane.files import replace_text
from membrane.measures import EVERY_OUTCOME, LEDGER_OUTCOMES, Outcome
from membrane.results.case_folder import Status, look
from membrane.run.sails import SAILS

from .grid import case_folders, text


def read(folder: Path) -> list[Status]:
    """All cases of a sweep in `folder`, by what differs between them; ValueError if there is none.

    A case that does not tell what it is about is about what was planned.
    """
    found = []
    for place, planned in case_folders(folder).items():
        status = look(place, planned or None)
        status.about = status.about or planned
        found.append(status)
    if not found:
        raise ValueError(f"{folder} holds no case")
    names = varied(found)
    return sorted(found, key=lambda case: ([_rank(v) for v in values(case, names)], case.name))


def _rank(value):
    """What a value is sorted by: none, numbers, words."""
    if value is None:
        return 0, 0, ""
    return (2, 0, value) if isinstance(value, str) else (1, value, "")


def varied(cases: list[Status]) -> list[str]:
    """Names of the parameters that are not the same in all cases, "sail" among them."""
    known = [case.parameters for case in cases if case.parameters]
    names = dict.fromkeys(name for parameters in known for name in parameters)
    return [name for name in names if len({repr(p.get(name)) for p in known}) > 1]


def values(case: Status, names: list[str]) -> tuple:
    """Those of some parameters of a case; None for what nobody knows."""
    return tuple(case.parameters.get(name) for name in names)


def outcomes(cases: list[Status]) -> list[Outcome]:
    """Those of the cases' kinds of sail, and what else their summaries tell but of the ledger."""
    sails = {case.about["sail"] for case in cases if case.about}
    told = dict.fromkeys(o.name for sail in sails for o in SAILS[sail].outcomes)
    told |= dict.fromkeys(name for case in cases for name in case.measures)
    known = {o.name: o for o in EVERY_OUTCOME}
    names = [n for n in known if n in told] + [n for n in told if n not in known]
    ledger = {o.name for o in LEDGER_OUTCOMES}
    others = {n: Outcome(n, "-", n.replace("_", " "), lambda history: None) for n in names}
    return [{**others, **known}[n] for n in names if n not in ledger]


def measured(case: Status, outcome: Outcome) -> float | None:
    """An outcome of a case in the unit that is shown; None if there is none."""
    value = case.measures.get(outcome.name)
    return None if value is None else outcome.form.factor * value


def write_table(cases: list[Status], path: Path) -> None:
    """cases.csv: one row a case; what there is not is left empty."""
    names, told = varied(cases), outcomes(cases)
    stream = io.StringIO()
    rows = csv.writer(stream, lineterminator="\n")
    rows.writerow(["case", *names, "outcome", "diverged_at_s", *map(_column, told), "reason"])
    for case in cases:
        found = (measured(case, outcome) for outcome in told)
        cells = [case.name, *values(case, names), case.state, case.time, *found, case.reason]
        rows.writerow(["" if cell is None else text(cell) for cell in cells])
    replace_text(path, stream.getvalue())


def _column(outcome):
    """Name of an outcome's column."""
    unit = outcome.form.unit.replace(" ", "_")
    return outcome.name if unit == "-" else f"{outcome.name}_{unit}"
