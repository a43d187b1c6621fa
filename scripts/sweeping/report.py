# SPDX-License-Identifier: GPL-2.0-or-later
"""The report of a sweep: cases.csv, pictures, and report.html, which shows them all."""

from dataclasses import fields
from pathlib import Path

from membrane import own
from membrane.case_folder import COMPLETE, DIVERGED
from membrane.files import replace_text
from membrane.parameters import SailParameters

from .grid import AXES, CURVES, PAGE, RESULTS, SWING, TABLE, refuse_other_results
from .page import render
from .pictures import plot_curves, plot_swing, three_digits
from .results import MEASURES, read, varied, write_table

CAPTIONS = (
    "Deployment rate of all cases, as in the paper's Figures 8 and 9.",
    "Mean phase difference between tips and spool of all cases, as in the paper's Figures 8 and 9; "
    "positive where the tips lead.",
)
NOT_SEEN = "not seen"  # where a run ends before what is asked for


def report(folder):
    """Write the report into the folder of a sweep.

    Parameters
    ----------
    folder : path
        That of scripts/sweep.py, or any that has folders of scripts/case.py in it.

    Returns
    -------
    list of Status
        Of all cases, also of those that are missing.

    Raises
    ------
    ValueError
        If there is no case, or the results of something else would be lost.
    """
    folder = Path(folder)
    refuse_other_results(folder)
    results = read(folder)
    own.write_list(folder, own.SWEEP, RESULTS)
    write_table(results, folder / TABLE)
    drawn = draw(results, folder)
    replace_text(folder / PAGE, render(**content(results, drawn, folder)))
    return [result.status for result in results]


def draw(results, folder):
    """Draw the pictures; returns their captions by file name.

    They have alpha_c and beta for axes: with further parameters that vary there are none. A case
    of which nobody knows the parameters has no place in them.
    """
    results = [result for result in results if result.status.parameters]
    places = [result.axes for result in results]
    if (
        not places
        or len(set(places)) < len(places)
        or None in {v for place in places for v in place}
    ):
        return {}
    curves = {r.axes: r for r in results if r.history is not None}
    ends = {r.axes for r in results if r.status.state == DIVERGED}
    drawn = {}
    if curves:
        rates = {
            axes: (r.history["time"], r.history["deployment_rate"]) for axes, r in curves.items()
        }
        phases = {axes: (r.history["time"], r.degrees) for axes, r in curves.items()}
        plot_curves(rates, ends, "deployment rate [-]", folder / CURVES[0])
        plot_curves(phases, ends, "mean phase difference [deg]", folder / CURVES[1])
        drawn |= zip(CURVES, CAPTIONS)
    maps = {
        f"{name} of the phase difference [{MEASURES[name][0]}]": {
            r.axes: r.measures[name] for r in results
        }
        for name in ("amplitude", "period")
    }
    plot_swing(maps, {r.axes: word(r.status) for r in results}, folder / SWING)
    meanings = "; ".join(f"{name}: {MEASURES[name][1]}" for name in ("amplitude", "period"))
    return {
        **drawn,
        SWING: f"The swing over alpha_c and beta. {meanings.capitalize()}. "
        f"{NOT_SEEN.capitalize()}: the run ends before. Runs of one case that start a nanometre "
        "apart differ, too: scripts/run.sh verify says by how much.",
    }


def word(status):
    """What stands in a heat map where there is no value."""
    if status.state == DIVERGED:
        return "diverged\n" + ("in spin-up" if status.time is None else f"at {status.time:.3g} s")
    return NOT_SEEN if status.state == COMPLETE else status.state


def content(results, drawn, folder):
    """What the page shows, ready for its template."""
    parameters = varied(results)
    known = next((r.status.parameters for r in results if r.status.parameters), {})
    about = {item.name: item.metadata for item in fields(SailParameters)}
    units = {name: item["unit"] for name, item in about.items()}
    states = [result.status.state for result in results]
    return {
        "states": {state: states.count(state) for state in dict.fromkeys(states)},
        "pictures": drawn,
        "columns": [
            *((name, units.get(name, "-"), "") for name in parameters),
            *((name, unit, meaning) for name, (unit, meaning) in MEASURES.items()),
        ],
        "cases": [_row(result, parameters, folder) for result in results],
        "others": [r.status for r in results if r.status.state != COMPLETE],
        "common": [
            (name, _short(value), about[name]["unit"], about[name]["text"], about[name]["source"])
            for name, value in known.items()
            if name not in parameters and name in about
        ],
        "versions": _versions(results),
        "table": TABLE,
        "axes": [name for name in parameters if _varies(results, name)] or AXES,
    }


def _varies(results, name):
    """Whether a parameter is not the same in all cases whose parameters are known."""
    known = (result.status.parameters for result in results)
    return len({repr(values[name]) for values in known if name in values}) > 1


def _row(result, parameters, folder):
    """A case as the page shows it."""
    status = result.status
    values = [status.parameters.get(name) for name in parameters]

    def place(path):
        return str(path.relative_to(folder)) if path.exists() else ""

    return {
        "name": status.name,
        "state": status.state,
        "place": place(status.folder),
        "page": place(status.folder / PAGE),
        "shapes": place(status.folder / "shapes.png"),
        "values": [_short(v) for v in values] + [_measure(v) for v in result.measures.values()],
    }


def _short(value):
    """A parameter as the page shows it; what there is not is ""."""
    if value is None:
        return ""
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def _measure(value):
    """A measure with as many digits as all others, as in the heat maps."""
    return "" if value is None else three_digits(value)


def _versions(results):
    """Versions by name; where cases differ, all of them."""
    found = {}
    for result in results:
        for name, value in result.status.versions.items():
            found.setdefault(name, []).append(str(value))
    return {name: ", ".join(dict.fromkeys(values)) for name, values in found.items()}
