# SPDX-License-Identifier: GPL-2.0-or-later
"""The report of a sweep: cases.csv, pictures, and report.html, which shows them all."""

from dataclasses import fields
from pathlib import Path

from membrane.files import replace_text
from membrane.measures import HUB, in_plots
from membrane.parameters import KINDS
from membrane.results import own
from membrane.results.case_folder import COMPLETE, DIVERGED, Status
from membrane.run.sails import SAILS

from .grid import MAPS, PAGE, RESULTS, TABLE, picture_of, refuse_other_results
from .page import render
from .pictures import Axes, plot_curves, plot_maps, three_digits
from .results import measured, outcomes, read, values, varied, write_table

MAPPED = 4  # outcomes that have heat maps
NOT_SEEN = "not seen"  # where a run ends before what is asked for


def report(folder: str | Path) -> list[Status]:
    """Write the report into the folder of a sweep; returns all its cases, also those missing.

    It is that of scripts/sweep.py, or any that has folders of scripts/case.py in it. ValueError if
    there is no case, or the results of something else would be lost.
    """
    folder = Path(folder)
    refuse_other_results(folder)
    cases = read(folder)
    own.write_list(folder, own.SWEEP, RESULTS)
    write_table(cases, folder / TABLE)
    drawn = draw(cases, folder)
    replace_text(folder / PAGE, render(**content(cases, drawn, folder)))
    return cases


def draw(cases: list[Status], folder: Path) -> dict[str, str]:
    """Draw the pictures; returns their captions by file name.

    A case of which nobody knows the parameters has no place in them. There are none where two
    cases have one place, or a parameter is not known of all.
    """
    cases = [case for case in cases if case.parameters]
    names = varied(cases)
    placed = {values(case, names): case for case in cases}
    if not names or len(placed) < len(cases) or None in {v for place in placed for v in place}:
        return {}
    axes = Axes(names, _units(cases))
    return {**_draw_curves(placed, axes, folder), **_draw_maps(placed, axes, folder)}


def _draw_curves(placed, axes, folder):
    """The plots of the kinds of sail, the first line of each, of all cases."""
    told = {place: case.history for place, case in placed.items() if case.history}
    ends = {place for place, case in placed.items() if case.state == DIVERGED}
    columns = {name: values for history in told.values() for name, values in history.items()}
    sails = dict.fromkeys(case.about["sail"] for case in placed.values())
    measures = dict.fromkeys(m for sail in sails for m in (*SAILS[sail].measures, *HUB))
    drawn = {}
    for title, unit, factor, (line, *_) in in_plots([*measures], columns):
        curves = {
            place: (history["time"], factor * history[line.name])
            for place, history in told.items()
            if line.name in history
        }
        plot_curves(curves, ends, f"{title} [{unit}]", folder / picture_of(title), axes)
        drawn[picture_of(title)] = f"{title.capitalize()}, {line.label}, of all cases over time."
    return drawn


def _draw_maps(placed, axes, folder):
    """Heat maps of the first outcomes, where two numbers vary."""
    numbers = all(isinstance(v, (int, float)) for place in placed for v in place)
    if len(axes.names) != 2 or not numbers:
        return {}
    told = outcomes(list(placed.values()))[:MAPPED]
    maps = {
        f"{_words(o.name)} [{o.form.unit}]": {
            place: measured(case, o) for place, case in placed.items()
        }
        for o in told
    }
    plot_maps(maps, {place: word(case) for place, case in placed.items()}, folder / MAPS, axes)
    meanings = "; ".join(f"{_words(o.name)}: {o.label}" for o in told)
    return {
        MAPS: f"Outcomes over {_words(axes.names[0])} and {_words(axes.names[1])}. "
        f"{meanings.capitalize()}. {NOT_SEEN.capitalize()}: the run ends before. Runs of one case "
        "that start a nanometre apart differ, too: scripts/run.sh verify says by how much."
    }


def _words(name):
    return name.replace("_", " ")


def word(case: Status) -> str:
    """What stands in a heat map where there is no value."""
    if case.state == DIVERGED:
        return "diverged\n" + ("in spin-up" if case.time is None else f"at {case.time:.3g} s")
    return NOT_SEEN if case.state == COMPLETE else case.state


def _fields(cases):
    """What is known of the parameters of the cases' kinds of sail, by name."""
    kinds = [KINDS[case.about["sail"]] for case in cases if case.about]
    return {item.name: item.metadata for kind in kinds for item in fields(kind)}


def _units(cases):
    """Units of what varies."""
    about = _fields(cases)
    return [about[name]["unit"] if name in about else "-" for name in varied(cases)]


def content(cases: list[Status], drawn: dict[str, str], folder: Path) -> dict:
    """What the page shows, ready for its template."""
    names, told, about = varied(cases), outcomes(cases), _fields(cases)
    known: dict = next((case.parameters for case in cases if case.parameters), {})
    states = [case.state for case in cases]
    return {
        "states": {state: states.count(state) for state in dict.fromkeys(states)},
        "pictures": drawn,
        "columns": [
            *((name, unit, "") for name, unit in zip(names, _units(cases))),
            *((o.name, o.form.unit, o.label) for o in told),
        ],
        "cases": [_row(case, names, told, folder) for case in cases],
        "others": [case for case in cases if case.state != COMPLETE],
        "common": [
            (name, _short(value), about[name]["unit"], about[name]["text"], about[name]["source"])
            for name, value in known.items()
            if name not in names and name in about
        ],
        "versions": _versions(cases),
        "table": TABLE,
        "axes": names,
    }


def _row(case, names, told, folder):
    """A case as the page shows it; its outcomes with as many digits as all others."""

    def place(path):
        return str(path.relative_to(folder)) if path.exists() else ""

    found = (measured(case, outcome) for outcome in told)
    return {
        "name": case.name,
        "state": case.state,
        "place": place(case.folder),
        "page": place(case.folder / PAGE),
        "shapes": place(case.folder / "shapes.png"),
        "values": [_short(v) for v in values(case, names)]
        + ["" if value is None else three_digits(value) for value in found],
    }


def _short(value):
    """A parameter as the page shows it; what there is not is ""."""
    if value is None:
        return ""
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def _versions(cases):
    """Versions by name; where cases differ, all of them."""
    found: dict = {}
    for case in cases:
        for name, value in case.about.get("versions", {}).items():
            found.setdefault(name, []).append(str(value))
    return {name: ", ".join(dict.fromkeys(values)) for name, values in found.items()}
