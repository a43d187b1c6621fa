# SPDX-License-Identifier: GPL-2.0-or-later
"""The picture of scripts/chart.py: error against processor time, with the Pareto fronts."""

import itertools
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.ticker import LogLocator, NullFormatter
from matplotlib.transforms import Bbox
from membrane.view.plots import save

TITLES = {
    "deployment": ("Early deployment curve", "processor time for 1 s [s]", "rms error of rate [-]"),
    "disk": ("Spinning disk", "processor time for a turn [s]", "error of frequencies [-]"),
    "ledger": ("Energy ledger", "processor time for 1 s [s]", "imbalance / kinetic energy [-]"),
}
COLOURS = {1: "C0", 2: "C1", 3: "C2", 4: "C3", 8: "C0", 16: "C1", 32: "C2"}
MARKERS = {"fused": "o", "law2": "s"}
LEFT_OUT = "x"
SMALL = 8  # letters [points]
AWAY = (7, 14, 21, 28, 42)  # of a label from its point, the nearest that is free [points]
AROUND = (20, -20, 160, 200, 90, -90, 50, -50, 130, -130)  # directions tried in turn [degrees]
CLEAR = 9  # of a label from other points [pixels]


def draw(points: list, path: Path | str) -> Figure:
    """Draw the three questions side by side, from each Point of scripts/chart.py, to `path`."""
    figure = Figure(figsize=(10.5, 4.8), dpi=150)
    figure.subplots_adjust(left=0.07, right=0.99, bottom=0.26, top=0.94, wspace=0.3)
    panels = dict(zip(TITLES, figure.subplots(1, len(TITLES))))
    for question, axes in panels.items():
        _draw_question(axes, question, [p for p in points if p.question == question])
    figure.legend(
        handles=_legend(points), loc="lower center", ncol=4, fontsize=SMALL, frameon=False
    )
    for question, axes in panels.items():
        _add_labels(axes, [p for p in points if p.question == question])
    save(figure, path)
    return figure


def _draw_question(axes, question, points):
    """Points and front, without words."""
    title, cost, error = TITLES[question]
    for p in points:
        marker = LEFT_OUT if p.part else MARKERS[p.path]
        fill = "none" if p.path == "law2" else "full"
        axes.plot(p.cost, p.error, marker, color=COLOURS[p.mesh], fillstyle=fill)
    front = sorted((p.cost, p.error) for p in points if p.pareto)
    axes.plot(*np.transpose(front), "k--", lw=0.8, zorder=0)
    axes.set(xscale="log", yscale="log", title=title, xlabel=cost, ylabel=error)
    axes.margins(0.12)
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < 1000 * low else (1,)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    axes.tick_params(labelsize=SMALL)
    axes.grid(alpha=0.3)


def _legend(points):
    """Handles of the signs that all three share."""

    def sign(label, **style):
        return Line2D([], [], label=label, **{"ls": "", "color": "grey", **style})

    kinds = {"deployment": "refine = {}", "disk": "disk of {} cells"}
    named = sorted(
        {(p.mesh, kinds[p.question].format(p.mesh)) for p in points if p.question in kinds}
    )
    return [
        *(sign(label, marker="o", color=COLOURS[n]) for n, label in named),
        sign("fused", marker=MARKERS["fused"]),
        sign("law2", marker=MARKERS["law2"], mfc="none"),
        sign("fused, without what is named", marker=LEFT_OUT),
        sign("Pareto front, with dt", color="k", ls="--", lw=0.8),
    ]


def _add_labels(axes, points):
    """Name what was left out, and the steps of the front, each where there is room."""
    places = axes.transData.transform([(p.cost, p.error) for p in points])
    taken = [Bbox([place - CLEAR, place + CLEAR]) for place in places]
    front = [p for p in points if p.pareto]
    for p in sorted(points, key=lambda p: p.cost):
        words = ", ".join([p.part] * bool(p.part) + [f"{p.dt:.2g} s"] * (p in front))
        if words:
            taken.append(_label(axes, words, (p.cost, p.error), taken))


def _label(axes, words, point, taken):
    """Write words near a point, clear of all boxes `taken` if there is room; returns their box."""
    for away, angle in itertools.product(AWAY, AROUND):
        label = _write(axes, words, point, away, angle)
        box = words_box(label)
        if _holds(axes.bbox, box) and not any(box.overlaps(other) for other in taken):
            return box
        label.remove()
    return words_box(_write(axes, words, point, AWAY[0], AROUND[0]))


def _write(axes, words, point, away, angle):
    """An annotation of a point, `away` [points] from it at an angle [degrees]."""
    x, y = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return axes.annotate(
        words,
        point,
        (away * x, away * y),
        textcoords="offset points",
        fontsize=SMALL - 1,
        ha="left" if x > 0.3 else "right" if x < -0.3 else "center",
        va="center" if abs(y) < 0.5 else "bottom" if y > 0 else "top",
        bbox={"fc": "w", "ec": "none", "pad": 0.5, "alpha": 0.8},  # over the front alone
        zorder=1,
        arrowprops={"arrowstyle": "-", "lw": 0.4, "color": "0.5", "shrinkA": 0},
    )


def words_box(label: Text) -> Bbox:
    """Where the words of an annotation are, without its line [pixels]."""
    label.get_window_extent()  # puts them there
    return Text.get_window_extent(label)


def _holds(room, box):
    """Whether a box lies within another."""
    return bool(np.all(room.min <= box.min) and np.all(box.max <= room.max))
