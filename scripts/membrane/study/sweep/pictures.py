# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of a sweep: curves of all cases as Figures 8 and 9, and outcomes over two parameters.

Figures are drawn to files only; no window system is needed.
"""

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from membrane.view.plots import save

DPI = 110
SYMBOLS = {"alpha_crease": r"$\alpha_c$", "beta": r"$\beta$"}
STYLES = (":", "-", "--", "-.")  # of all parameters but the last; else these get panels
MANY = 12  # at most so many curves in one panel, panels, and values written along an axis
COLOURS = ("#31688e", "#e07b00", "#35a05f", "#b5367a", "#7a5fb0", "#8c6d31")  # of the last one


class Axes(NamedTuple):
    """The parameters that vary: names and units. A place is a tuple of their values."""

    names: Sequence[str] = ("alpha_crease", "beta")
    units: Sequence[str] = ("-", "-")

    def symbol(self, number: int) -> str:
        """What stands for a parameter."""
        name = self.names[number]
        return SYMBOLS.get(name, name.replace("_", " "))

    def words(self, values: Sequence, first: int = 0) -> str:
        """Parameters from the one of number `first` on, with their values."""
        named = (f"{self.symbol(first + i)} = {short(v)}" for i, v in enumerate(values))
        return ", ".join(named)


TABLE_2 = Axes()


def short(value: float | str) -> str:
    """A value of a parameter in words."""
    return f"{value:g}" if isinstance(value, (int, float)) else str(value)


def draw_curves(axes: Any, curves: dict, lasts: Sequence = (), about: Axes = TABLE_2) -> dict:
    """Draw curves of cases: the colour tells the last parameter, the kind of line the others.

    `curves` are (times (S,), values (S,)) by place. `lasts` are all values of the last parameter
    that get a colour of their own, in turn; by default those of `curves`. Gives lines by place.
    """
    others = sorted({place[:-1] for place in curves})
    lasts = lasts or sorted({place[-1] for place in curves})
    lines = {}
    for place, (times, values) in curves.items():
        style = STYLES[others.index(place[:-1])] if 1 < len(others) <= len(STYLES) else "-"
        look = {"color": _colour(lasts, place[-1]), "linestyle": style}
        (lines[place],) = axes.plot(times, values, label=about.words(place), **look)
    return lines


def _colour(lasts, value):
    """Colour of a value of the last parameter among all."""
    if len(lasts) <= len(COLOURS):
        return COLOURS[lasts.index(value)]
    return colormaps["viridis"](0.95 * lasts.index(value) / (len(lasts) - 1))


def plot_curves(
    curves: dict, ends: Collection, label: str, path: str | Path, about: Axes = TABLE_2
) -> None:
    """Curves of all cases over time: in one panel, or in up to MANY if they are many.

    `curves` are (times (S,), values (S,)) by place; `ends` are places of the cases that diverged:
    where they ended is marked; `label` is of the values, with unit.
    """
    others = sorted({place[:-1] for place in curves})
    together = len(others) == 1 or len(curves) <= MANY and len(others) <= len(STYLES)
    count = 1 if together else min(len(others), MANY)
    chunks = np.array_split(np.arange(len(others)), count)
    figure, panels, columns = _panels(count)
    handles: dict = {}
    for number, (panel, chunk) in enumerate(zip(panels, chunks)):
        group = [others[i] for i in chunk]
        chosen = {place: curve for place, curve in curves.items() if place[:-1] in group}
        lasts = sorted({place[-1] for place in curves})
        handles |= _draw_panel(panel, chosen, ends, lasts, about, together)
        if not together:
            values = dict.fromkeys([about.words(group[0]), about.words(group[-1])])
            panel.set_title(" … ".join(values), fontsize=10)
        if number % columns == 0:
            panel.set_ylabel(label)
        if number + columns >= count:
            panel.set_xlabel("time after the release [s]")
            panel.tick_params(labelbottom=True)
    if all(np.min(values) >= 0 for _, values in curves.values()):
        panels[0].set_ylim(0, None)  # of all
    form = {"frameon": False, "fontsize": 8, "loc": "upper left", "bbox_to_anchor": (1, 1)}
    panels[columns - 1].legend(handles.values(), handles, **form)
    save(figure, path, dpi=DPI)


def _panels(count):
    """A Figure, its `count` panels, and in how many columns they are."""
    rows = -(-count // 3)
    columns = -(-count // rows)
    size = (8.5, 4.6) if count == 1 else (3.6 * columns + 1.4, 3.2 * rows)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
    for panel in panels[count:]:
        panel.set_axis_off()
    return figure, panels, columns


def _draw_panel(panel, curves, ends, lasts, about, together):
    """Draw curves into a panel; returns lines for the legend by label."""
    handles, lines = {}, draw_curves(panel, curves, lasts, about)
    for place, line in lines.items():
        if place[-1] in some(lasts):
            last = about.words(place[-1:], len(place) - 1)
            handles[line.get_label() if together else last] = line
    for place in (place for place in curves if place in ends):
        times, values = curves[place]
        colour = lines[place].get_color()
        (cross,) = panel.plot(times[-1], values[-1], "x", color=colour, markersize=9, mew=2)
        handles["diverged"] = cross
    panel.grid(alpha=0.3)
    panel.margins(x=0.01)
    return handles


def some(values: Sequence) -> Sequence:
    """All of some values, or evenly chosen ones if they are more than MANY."""
    return values[:: -(-len(values) // MANY)]


def plot_maps(maps: dict, words: dict, path: str | Path, about: Axes = TABLE_2) -> None:
    """Heat maps over two parameters, side by side; with numbers where these are not too many.

    `maps` are by title dicts of values by place, None where there is none; `words` tell by place
    what to write there.
    """
    firsts, seconds = (sorted(set(values)) for values in zip(*words))
    width = max(4.2, 1.1 * min(MANY, len(firsts)) + 2.2)
    height = max(3.0, 0.62 * min(MANY, len(seconds)) + 1.3)
    rows = -(-len(maps) // 2)
    columns = -(-len(maps) // rows)
    figure = Figure(figsize=(width * columns, height * rows), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for panel in panels[len(maps) :]:
        panel.set_axis_off()
    for panel, (title, values) in zip(panels, maps.items()):
        table = [[values.get((a, b)) for a in firsts] for b in seconds]
        image = _draw_map(panel, np.array(table, dtype=float))  # None: NaN
        if max(len(firsts), len(seconds)) <= MANY:
            _write(panel, image, [[words.get((a, b), "") for a in firsts] for b in seconds])
        labels = [f"{about.symbol(i)} [{about.units[i]}]" for i in (0, 1)]
        panel.set(title=title, xlabel=labels[0], ylabel=labels[1])
        panel.set_xticks(some(range(len(firsts))), map(short, some(firsts)))
        panel.set_yticks(some(range(len(seconds))), map(short, some(seconds)))
    save(figure, path, dpi=DPI)


def _draw_map(panel, table):
    """Draw a table of values as colours; returns the image."""
    image = panel.imshow(table, origin="lower", aspect="auto", cmap="viridis")
    image.cmap.set_bad("0.9")
    if np.isfinite(table).any():
        panel.figure.colorbar(image, ax=panel)
    return image


def three_digits(value: float) -> str:
    """A value with three digits, so that those of others can be compared with it."""
    return f"{value:#.3g}".removesuffix(".")


def _write(panel, image, words):
    """Write the cells' values, in a colour that can be read, or `words` in their places."""
    for (row, column), value in np.ndenumerate(np.ma.filled(image.get_array(), np.nan)):
        middle = {"ha": "center", "va": "center"}
        if np.isfinite(value):
            colour = image.cmap(image.norm(value))
            bright = np.dot(colour[:3], (0.299, 0.587, 0.114)) > 0.5
            panel.text(column, row, three_digits(value), color="k" if bright else "w", **middle)
        else:
            panel.text(column, row, words[row][column], color="0.35", fontsize=8, **middle)
