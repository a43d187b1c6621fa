# SPDX-License-Identifier: GPL-2.0-or-later
"""The cases of a sweep over any parameters, and the folder where they go."""

import re
from contextlib import suppress
from dataclasses import fields
from itertools import product
from pathlib import Path, PurePath
from typing import Any

from membrane.files import BadFile, read_object, shown, write_json
from membrane.measures import HUB
from membrane.parameters import TABLE_2_CASES, TABLE_2_DURATION, RunParameters, check_name
from membrane.results import own
from membrane.results.case_folder import Damaged, check_identity, finished, identity
from membrane.results.unfinished import BEGUN, RESULT, UNFINISHED, refuse_begun
from membrane.run.sails import SAILS

PLAN = "sweep.json"  # what a sweep consists of
CASES = "cases"  # folder of the cases
TABLE, PAGE, MAPS = "cases.csv", "report.html", "maps.png"
OF_ONE_RUN = ("summary.json", UNFINISHED)  # what single runs leave in their folders


def picture_of(title: str) -> str:
    """Name of the file with the plot of this title, of all cases."""
    return f"{title.replace(' ', '_')}.png"


PLOTS = {m.plot for kind in SAILS.values() for m in (*kind.measures, *HUB) if m.plot}
RESULTS = (PLAN, TABLE, PAGE, MAPS, *map(picture_of, PLOTS))  # what a sweep leaves beside folders


def text(value: Any) -> str:
    """A value as short as it can be without loss."""
    return repr(value).removesuffix(".0") if isinstance(value, float) else str(value)


def case_name(values: dict) -> str:
    """Name of the case with these values, by name of the parameter, fit for a folder."""
    name = "-".join(f"{name}_{text(value)}" for name, value in values.items())
    return re.sub(r"[^\w.+-]", "_", name)


def check_values(kind: type[RunParameters], given: dict[str, list]) -> None:
    """Raise ValueError if one of some parameters' values is out of range or given twice."""
    for name, values in given.items():
        for value in values:
            kind(**{name: value})
        if len(set(values)) < len(values):
            raise ValueError(f"{name}: {' '.join(map(text, values))}: a value is given twice")


def grid(
    kind: type[RunParameters], given: dict[str, list], base: dict | None = None
) -> dict[str, RunParameters]:
    """The cases, by name, of a grid; without one, for the paper's sail, those of its Table 2.

    `given` has lists of values of parameters of a class `kind` by name: several are an axis of the
    grid; `base` has values of those that are not given. ValueError if a value is out of range or
    given twice, or there is no grid.
    """
    check_values(kind, given)
    base = base or {}
    axes = {name: values for name, values in given.items() if len(values) > 1}
    if not axes:
        if kind.sail != "square":
            raise ValueError(
                "give several values of a parameter, such as --omega 10 20: they make the grid"
            )
        axes = {name: given.get(name, [*values]) for name, values in TABLE_2_CASES.items()}
        base = {"duration": TABLE_2_DURATION, **base}
    common = {**base, **{name: v[0] for name, v in given.items() if name not in axes}}
    points = [dict(zip(axes, values)) for values in product(*axes.values())]
    cases = {case_name(point): kind(**{**common, **point}) for point in points}
    if len(cases) < len(points):
        raise ValueError("two cases would have one name: choose values whose names differ more")
    return cases


def case_words(p: RunParameters) -> list[str]:
    """Words for scripts/case.py that ask for these parameters."""
    words = [p.sail]
    for item in fields(p):
        value, flag = getattr(p, item.name), item.name.replace("_", "-")
        if item.name == "file" and not item.default:
            words.append(value)
        elif item.type is bool and value != item.default:
            words.append(f"--{flag}" if value else f"--no-{flag}")
        elif value != item.default:
            words.append(f"--{flag}={value}")
    return words


def plan(folder: Path, cases: dict[str, RunParameters]) -> None:
    """Note in `folder` which cases the sweep consists of. From then on all RESULTS in it are ours.

    ValueError if one is there already with other parameters, finished or not.
    """
    (folder / CASES).mkdir(parents=True, exist_ok=True)
    about = {name: identity(p) for name, p in cases.items()}
    for name in cases:
        with suppress(Damaged):  # is told when its turn comes
            finished(folder / CASES / name, about[name])
        refuse_begun(folder / CASES / name / UNFINISHED, about[name])
    own.write_list(folder, own.SWEEP, RESULTS)
    write_json(folder / PLAN, {"cases": about})


def refuse_other_results(folder: Path) -> None:
    """Raise ValueError if a folder holds what a sweep's report would write over and is not ours."""
    found = next((folder / name for name in OF_ONE_RUN if (folder / name).exists()), None)
    if found and not (folder / PLAN).exists():
        raise ValueError(
            f"{found} is a single run's, whose results would be lost: choose another folder"
        )
    own.refuse_others(folder, own.SWEEP, RESULTS)


def planned_cases(folder: Path) -> dict[str, dict]:
    """What the cases are about that a sweep consists of, by name; {} if nobody planned any.

    BadFile if the file is damaged.
    """
    path = folder / PLAN
    if not path.exists():
        return {}
    cases = read_object(path).get("cases")
    if not isinstance(cases, dict):
        raise BadFile(path, "cases", f"must be an object, not {shown(cases)}")
    for name, about in cases.items():
        place = f"cases.{shown(name)[1:-1]}"
        if PurePath(name).name != name or "\0" in name:
            raise BadFile(path, place, "is no name of a folder")
        check_identity(path, place, about)
    return cases


def case_folders(folder: Path) -> dict[Path, dict]:
    """Folders of the cases of a sweep, planned or found, each with what is planned or {}.

    A case is found where there is a case.json, or an unfinished case, one or two levels below
    `folder`.
    """
    planned = {folder / CASES / name: about for name, about in planned_cases(folder).items()}
    found = {path.parent for level in ("*", "*/*") for path in folder.glob(f"{level}/{RESULT}")}
    begun = (folder.glob(f"{level}/{UNFINISHED}/{BEGUN}") for level in ("*", "*/*"))
    found |= {path.parents[1] for paths in begun for path in paths}
    others = sorted(path for path in found - set(planned) if path.name != UNFINISHED)
    cases = {**planned, **dict.fromkeys(others, {})}
    for path in cases:
        check_name(path)
    return cases
