# SPDX-License-Identifier: GPL-2.0-or-later
"""Picture of a calibration: target and fit, what is left, and where the runs and the fit lie."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator
from membrane.view.plots import save

from . import columns_of

DPI = 120
WIDEST = 3.0  # of a logarithm, that is shown of an uncertainty


def draw(
    path: str | Path,
    kind: Any,
    target: Any,
    fit: Any,
    surface: Any,
    found: Any,
    names: Any,
    runs: Any,
) -> None:
    """Draw it, as a picture at `path`.

    `kind` is the class of the parameters, `fit` (C, S) has the curves of the run with the
    parameters found, an Estimate, of d `names`; `runs` (n, d) are logarithms of the parameters of
    all runs. `target` is a Target, `surface` a Surface.
    """
    curves = len(target.columns)
    width = 4.2 * (curves + (len(names) == 2))
    figure = Figure(figsize=(max(width, 5.5), 5.2), layout="constrained")
    grid = figure.add_gridspec(2, curves + (len(names) == 2), height_ratios=(2.2, 1))
    for i, name in enumerate(target.columns):
        above = figure.add_subplot(grid[0, i])
        below = figure.add_subplot(grid[1, i], sharex=above)
        _draw_curve(above, below, target, i, columns_of(kind.sail)[name], fit, surface.scatter)
        above.legend(frameon=False)
    if len(names) == 2:
        axes = figure.add_subplot(grid[:, -1])
        _draw_parameters(axes, found, runs, surface.region)
        units = {item.name: item.metadata["unit"] for item in fields(kind)}
        labels = [f"{name.replace('_', ' ')} [{units[name]}]" for name in names]
        axes.set(xlabel=labels[0], ylabel=labels[1])
    save(figure, path, dpi=DPI)


def _draw_curve(above, below, target, i, measure, fit, scatter):
    """The curve of a Measure, and below it what target and runs are off the fit."""
    unit, scale = measure.form
    times, label = 1e3 * target.times, measure.name.replace("_", " ")
    above.plot(times, scale * target.values[i], ".", color="0.5", markersize=4, label="target")
    above.plot(times, scale * fit[i], color="C0", label="fit")
    above.set(ylabel=f"{label} [{unit}]")
    above.tick_params(labelbottom=False)
    band = scale * scatter[i]
    below.fill_between(
        times, -band, band, color="C0", alpha=0.25, linewidth=0, label="scatter of runs"
    )
    below.plot(times, scale * (target.values - fit)[i], ".", color="0.5", markersize=3)
    below.legend(frameon=False, loc="lower left", fontsize=8)
    below.set(xlabel="time [ms]", ylabel=f"target - fit [{unit}]")
    for axes in (above, below):
        axes.grid(alpha=0.3)
        axes.margins(x=0)


def _draw_parameters(axes, found, runs, region):
    """All runs, the estimate, and its curves of one and two standard deviations."""
    axes.loglog(*np.exp(runs.T), ".", color="0.6", markersize=4, label="runs")
    values, vectors = np.linalg.eigh(found.covariance)
    turn = np.linspace(0, 2 * np.pi, 73)
    circle = vectors @ (np.sqrt(np.maximum(values, 0))[:, None] * [np.cos(turn), np.sin(turn)])
    for sigmas in (1, 2):
        axes.plot(*np.exp(found.point[:, None] + sigmas * circle), color="C3", linewidth=1)
    axes.plot(*np.exp(found.point), "+", color="C3", label="fit, 1 and 2 sigma")
    room = 0.3 * (region.high - region.low)
    reach = np.minimum(2.5 * found.sigma, WIDEST)
    low = np.exp(np.minimum(region.low - room, found.point - reach))
    high = np.exp(np.maximum(region.high + room, found.point + reach))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    for axis, decades in zip((axes.xaxis, axes.yaxis), np.log10(high / low)):
        ticks = (1, 2, 3, 5, 7) if decades < 1 else (1, 3) if decades < 2 else (1,)
        axis.set_major_locator(LogLocator(subs=ticks))
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter("{x:g}")
    axes.grid(alpha=0.3)
    axes.legend(frameon=False)
