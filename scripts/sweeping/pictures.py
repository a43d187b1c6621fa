# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of a sweep: curves of all cases as Figures 8 and 9, and the swing over alpha_c and beta.

Figures are drawn to files only; no window system is needed.
"""

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from membrane.plots import save

DPI = 110
ALPHA, BETA = r"$\alpha_c$", r"$\beta$"
STYLES = (":", "-", "--", "-.")  # of alpha_c; more than these get panels of their own
MANY = 12  # at most so many curves in one panel, panels, and values written along an axis
COLOURS = ("#31688e", "#e07b00", "#35a05f", "#b5367a", "#7a5fb0", "#8c6d31")  # of beta


def draw_curves(axes, curves, betas=()):
    """Draw curves of cases: the colour tells beta, the kind of line alpha_c.

    Parameters
    ----------
    axes : matplotlib Axes
    curves : dict
        (times (S,), values (S,)) by (alpha_c, beta).
    betas : sequence of float, optional
        All betas that get a colour of their own, in turn; default: those of `curves`.

    Returns
    -------
    dict of matplotlib lines by (alpha_c, beta)
    """
    alphas = sorted({alpha for alpha, _ in curves})
    betas = betas or sorted({beta for _, beta in curves})
    lines = {}
    for (alpha, beta), (times, values) in curves.items():
        (lines[alpha, beta],) = axes.plot(
            times,
            values,
            color=_colour(betas, beta),
            linestyle=STYLES[alphas.index(alpha)] if 1 < len(alphas) <= len(STYLES) else "-",
            label=f"{ALPHA} = {alpha:g}, {BETA} = {beta:g}",
        )
    return lines


def _colour(betas, beta):
    """Colour of a beta among all."""
    if len(betas) <= len(COLOURS):
        return COLOURS[betas.index(beta)]
    return colormaps["viridis"](0.95 * betas.index(beta) / (len(betas) - 1))


def plot_curves(curves, ends, label, path):
    """Curves of all cases over time: in one panel, or in up to MANY by alpha_c if they are many.

    Parameters
    ----------
    curves : dict
        (times (S,), values (S,)) by (alpha_c, beta).
    ends : collection of (alpha_c, beta)
        Cases that diverged: where they ended is marked.
    label : str
        Of the values, with unit.
    path : path
    """
    alphas = sorted({alpha for alpha, _ in curves})
    together = len(curves) <= MANY and len(alphas) <= len(STYLES)
    count = 1 if together else min(len(alphas), MANY)
    groups = [group.tolist() for group in np.array_split(alphas, count)]
    betas = sorted({beta for _, beta in curves})
    rows = -(-len(groups) // 3)
    columns = -(-len(groups) // rows)
    size = (8.5, 4.6) if len(groups) == 1 else (3.6 * columns + 1.4, 3.2 * rows)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
    for panel in panels[len(groups) :]:
        panel.set_axis_off()
    handles = {}
    for number, (panel, group) in enumerate(zip(panels, groups)):
        chosen = {case: curve for case, curve in curves.items() if case[0] in group}
        lines = draw_curves(panel, chosen, betas)
        for (alpha, beta), line in lines.items():
            if beta in some(betas):
                handles[line.get_label() if together else f"{BETA} = {beta:g}"] = line
        for case in (case for case in chosen if case in ends):
            times, values = chosen[case]
            colour = lines[case].get_color()
            (cross,) = panel.plot(times[-1], values[-1], "x", color=colour, markersize=9, mew=2)
            handles["diverged"] = cross
        if not together:
            values = dict.fromkeys([f"{group[0]:g}", f"{group[-1]:g}"])
            panel.set_title(f"{ALPHA} = {' … '.join(values)}", fontsize=10)
        if number % columns == 0:
            panel.set_ylabel(label)
        if number + columns >= len(groups):
            panel.set_xlabel("time after the release [s]")
            panel.tick_params(labelbottom=True)
        panel.grid(alpha=0.3)
        panel.margins(x=0.01)
    if all(np.min(values) >= 0 for _, values in curves.values()):
        panels[0].set_ylim(0, None)  # of all
    panels[columns - 1].legend(
        handles.values(),
        handles,
        frameon=False,
        fontsize=8,
        loc="upper left",
        bbox_to_anchor=(1, 1),
    )
    save(figure, path, dpi=DPI)


def some(values):
    """All of some values, or evenly chosen ones if they are more than MANY."""
    return values[:: -(-len(values) // MANY)]


def plot_swing(maps, words, path):
    """Heat maps over alpha_c and beta, side by side; with numbers where these are not too many.

    Parameters
    ----------
    maps : dict
        By title: a dict of values by (alpha_c, beta), None where there is none.
    words : dict of str
        By (alpha_c, beta): what to write where there is no value.
    path : path
    """
    alphas, betas = (sorted(set(values)) for values in zip(*words))
    width = max(4.2, 1.1 * min(MANY, len(alphas)) + 2.2)
    height = max(3.0, 0.62 * min(MANY, len(betas)) + 1.3)
    cells = [(row, column) for row in range(len(betas)) for column in range(len(alphas))]
    figure = Figure(figsize=(width * len(maps), height), layout="constrained")
    for panel, (title, values) in zip(
        figure.subplots(1, len(maps), squeeze=False)[0], maps.items()
    ):
        table = np.array(
            [[values.get((a, b)) for a in alphas] for b in betas], dtype=float  # None: NaN
        )
        image = panel.imshow(table, origin="lower", aspect="auto", cmap="viridis")
        image.cmap.set_bad("0.9")
        for row, column in cells if max(len(alphas), len(betas)) <= MANY else ():
            word = words.get((alphas[column], betas[row]), "")
            _write(panel, image, row, column, table[row, column], word)
        panel.set(title=title, xlabel=f"{ALPHA} [-]", ylabel=f"{BETA} [-]")
        panel.set_xticks(some(range(len(alphas))), [f"{a:g}" for a in some(alphas)])
        panel.set_yticks(some(range(len(betas))), [f"{b:g}" for b in some(betas)])
        if np.isfinite(table).any():
            figure.colorbar(image, ax=panel)
    save(figure, path, dpi=DPI)


def three_digits(value):
    """A value with three digits, so that those of others can be compared with it."""
    return f"{value:#.3g}".removesuffix(".")


def _write(panel, image, row, column, value, word):
    """Write a cell's value into it, in a colour that can be read, or a word in its place."""
    if np.isfinite(value):
        colour = image.cmap(image.norm(value))
        bright = np.dot(colour[:3], (0.299, 0.587, 0.114)) > 0.5
        panel.text(
            column, row, three_digits(value), ha="center", va="center", color="k" if bright else "w"
        )
    else:
        panel.text(column, row, word, ha="center", va="center", color="0.35", fontsize=8)
