# SPDX-License-Identifier: GPL-2.0-or-later
"""The cases of a sweep over alpha_c and beta, and the folder where they go."""

from contextlib import suppress
from dataclasses import fields, replace
from pathlib import PurePath

from membrane import own
from membrane.case_folder import PART, RESULT, Damaged, check_parameters, finished
from membrane.case_folder import refuse_another
from membrane.files import BadFile, read_object, shown, write_json
from membrane.parameters import TABLE_2_CASES, SailParameters, check_name

AXES = tuple(TABLE_2_CASES)  # alpha_crease, beta
PLAN = "sweep.json"  # what a sweep consists of
CASES = "cases"  # folder of the cases
TABLE, PAGE = "cases.csv", "report.html"
CURVES = ("deployment_rate.png", "phase_difference.png")
SWING = "swing.png"
RESULTS = (PLAN, TABLE, PAGE, *CURVES, SWING)  # what a sweep leaves beside folders
OF_ONE_RUN = ("summary.json", "unfinished")  # what single runs leave in their folders


def text(value):
    """A number as short as it can be without loss."""
    return repr(value).removesuffix(".0") if isinstance(value, float) else str(value)


def case_name(values):
    """Name of the case with these values (dict by name), fit for a file."""
    return "-".join(f"{name}_{text(value)}" for name, value in values.items())


def grid(base, alpha_crease, beta):
    """The cases of a grid.

    Parameters
    ----------
    base : SailParameters
        What they have in common.
    alpha_crease, beta : sequences of float
        [-]

    Returns
    -------
    dict of SailParameters by name

    Raises
    ------
    ValueError
        If a value is out of range or given twice.
    """
    for name, values in zip(AXES, (alpha_crease, beta)):
        if len(set(values)) < len(values):
            raise ValueError(f"{name}: {' '.join(map(text, values))}: a value is given twice")
    cases = [{"alpha_crease": a, "beta": b} for a in alpha_crease for b in beta]
    return {case_name(values): replace(base, **values) for values in cases}


def plan(folder, cases):
    """Note in `folder` which cases (dict of SailParameters by name) the sweep consists of.

    From then on all RESULTS in it are ours.

    Raises
    ------
    ValueError
        If one is there already with other parameters, finished or not.
    """
    (folder / CASES).mkdir(parents=True, exist_ok=True)
    for name, p in cases.items():
        with suppress(Damaged):  # is told when its turn comes
            finished(folder / CASES / name, p.as_dict())
        refuse_another(folder / CASES / name, p.as_dict())
    own.write_list(folder, own.SWEEP, RESULTS)
    write_json(folder / PLAN, {"cases": {name: p.as_dict() for name, p in cases.items()}})


def refuse_other_results(folder):
    """Raise ValueError if a folder holds what a sweep's report would write over and is not ours."""
    found = next((folder / name for name in OF_ONE_RUN if (folder / name).exists()), None)
    if found and not (folder / PLAN).exists():
        raise ValueError(
            f"{found} is a single run's, whose results would be lost: choose another folder"
        )
    own.refuse_others(folder, own.SWEEP, RESULTS)


def planned_cases(folder):
    """Parameters (dict) of the cases that a sweep consists of, by name; {} if nobody planned any.

    Raises
    ------
    BadFile
    """
    path = folder / PLAN
    if not path.exists():
        return {}
    cases = read_object(path).get("cases")
    if not isinstance(cases, dict):
        raise BadFile(path, "cases", f"must be an object, not {shown(cases)}")
    for name, parameters in cases.items():
        place = f"cases.{shown(name)[1:-1]}"
        if PurePath(name).name != name or "\0" in name:
            raise BadFile(path, place, "is no name of a folder")
        check_parameters(path, place, parameters)
    return cases


def case_folders(folder):
    """Folders of the cases of a sweep, planned or found, each with the parameters planned or {}.

    A case is found where there is a case.json, or a folder of an unfinished case, one or two levels
    below `folder`.
    """
    planned = {folder / CASES / name: p for name, p in planned_cases(folder).items()}
    found = {path.parent for level in ("*", "*/*") for path in folder.glob(f"{level}/{RESULT}")}
    found = {path.with_name(path.name.removesuffix(PART)) for path in found}
    for level in ("*", "*/*"):
        parts = (path for path in folder.glob(level + PART) if path.is_dir())
        found |= {path.with_name(path.name.removesuffix(PART)) for path in parts}
    cases = {**planned, **{path: {} for path in sorted(found - set(planned))}}
    for path in cases:
        check_name(path)
    return cases


def table(cases, own):
    """Text of a table for yade-batch.

    Parameters
    ----------
    cases : dict of SailParameters by name
    own : dict of dict
        Further columns of each case, by its name.
    """
    default = SailParameters()
    varied = [
        item.name
        for item in fields(SailParameters)
        if item.name in AXES
        or any(getattr(p, item.name) != getattr(default, item.name) for p in cases.values())
    ]
    others = list(next(iter(own.values())))
    lines = [["description", *others, *varied]]
    for name, p in cases.items():
        values = [own[name][column] for column in others] + [getattr(p, v) for v in varied]
        lines.append([name, *map(repr, values)])
    return "".join(" ".join(line) + "\n" for line in lines)
