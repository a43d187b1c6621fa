# SPDX-License-Identifier: GPL-2.0-or-later
"""Draws the guide's figures: `/usr/bin/python3 reference/guide/figures.py`."""

from pathlib import Path

import numpy as np
from matplotlib import rcParams
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch, Polygon

INK, SOFT = "#22303c", "#7b8794"
BLUE, RED, GREEN, AMBER = "#2f6db3", "#c0392b", "#3a8a5f", "#b9770e"
TINTS = {BLUE: "#e3eefa", RED: "#fbe9e7", GREEN: "#e4f3ea", AMBER: "#fbf1de", SOFT: "#f1f3f5"}

rcParams.update(
    {
        "font.family": "DejaVu Sans",
        "mathtext.fontset": "stix",
        "font.size": 10,
        "text.color": INK,
        "svg.hashsalt": "guide",  # the same picture is the same file
    }
)


def canvas(width, height, low=0.0):
    """Axes without frame in which a unit is an inch; the lower left corner is at (0, `low`)."""
    figure = Figure(figsize=(width, height))
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, width), ylim=(low, low + height), aspect="equal")
    axes.axis("off")
    return axes


def box(axes, left, bottom, width, height, colour=SOFT, **style):
    """A rounded box; returns its patch."""
    form = f"round,pad=0,rounding_size={style.pop('round', 0.07)}"
    style = {"facecolor": TINTS[colour], "edgecolor": colour, "linewidth": 1.1, **style}
    return axes.add_patch(FancyBboxPatch((left, bottom), width, height, boxstyle=form, **style))


def arrow(axes, start, end, colour=INK, style="-|>", width=1.3, **more):
    """An arrow from one point to another."""
    about = {"mutation_scale": 11, "shrinkA": 0, "shrinkB": 0, **more}
    line = {"arrowstyle": style, "color": colour, "linewidth": width}
    return axes.add_patch(FancyArrowPatch(start, end, **line, **about))


def text(axes, x, y, words, size=10, colour=INK, **more):
    """Words centred at a point, unless told otherwise."""
    about = {"ha": "center", "va": "center", "linespacing": 1.35, **more}
    return axes.text(x, y, words, fontsize=size, color=colour, **about)


# ------------------------------------------------------------------------------------------- parts


def room(axes, left, bottom, width, height, name, words, colour):
    """A box with a name and what is in it."""
    box(axes, left, bottom, width, height, colour)
    lines = 1 + words.count("\n")
    top = bottom + height / 2 + 0.1 + 0.085 * (lines - 1)
    text(axes, left + width / 2, top + 0.04, name, 10.5, colour, weight="bold")
    text(axes, left + width / 2, top - 0.2, words, 8.5, va="top" if lines > 1 else "center")


def parts():
    """The parts of the program: rooms of the Python package above, the plugin and YADE below."""
    axes = canvas(9.0, 5.15)
    width, gap, high = 1.97, 0.207, 0.95
    columns = [0.25 + k * (width + gap) for k in range(4)]
    text(axes, 0.25, 4.95, "Python: scripts/membrane", 9, SOFT, ha="left")
    words = "each room imports only from rooms below it and to its left"
    text(axes, 8.75, 4.95, words, 9, SOFT, ha="right")
    two = 2 * width + gap
    words = "the commands of scripts/run.sh, their options and errors"
    room(axes, 0.25, 4.2, 2 * two + gap, 0.58, "cli", words, SOFT)
    words = "one run: the driver; a file for each kind of sail"
    room(axes, 0.25, 3.5, two, 0.58, "run", words, SOFT)
    words = "many runs: sweep, calibrate, verify, bench, stability"
    room(axes, columns[2], 3.5, two, 0.58, "study", words, SOFT)
    for left, name, words in zip(
        columns,
        ("mesh", "scene", "results", "view"),
        (
            "nodes, triangles, creases;\nfolding; FOLD and gmsh",
            "bodies and engines,\nspin-up, release, hub",
            "history.csv, shapes,\nsummary.json",
            "plots, report.html, film,\nYADE's own window",
        ),
    ):
        room(axes, left, 2.43, width, high, name, words, BLUE)
        if name != "mesh":
            arrow(axes, (left - gap, 2.43 + high / 2), (left, 2.43 + high / 2), BLUE)
    box(axes, 0.25, 1.93, 8.5, 0.38)
    text(axes, columns[0] + width / 2, 2.12, "the ground", 10.5, SOFT, weight="bold")
    words = "parameters  ·  measures  ·  geometry  ·  files  ·  progress"
    text(axes, columns[2] + width / 2 + 0.6, 2.12, words, 8.5)

    axes.plot([0.25, 8.75], [1.72, 1.72], color=SOFT, linewidth=0.8, linestyle=(0, (4, 3)))
    text(axes, columns[2], 1.53, "C++: pkg/membrane", 9, SOFT, ha="left")
    for left, name, words, colour in zip(
        columns,
        ("YADE", "plugin", "kernels", "mechanics"),
        (
            "bodies, contacts,\nNewtonIntegrator, O.run()",
            "functors and engines:\nfetch, call, scatter",
            "loops over blocks of\nelements, vectorised",
            "the equations, as\nplain functions",
        ),
        (AMBER, GREEN, GREEN, GREEN),
    ):
        room(axes, left, 0.2, width, high, name, words, colour)
    level = 0.2 + high / 2
    arrow(axes, (columns[1] - gap, level), (columns[1], level), AMBER, "<|-|>", mutation_scale=8)
    for left in columns[2:]:
        arrow(axes, (left, level), (left - gap, level), GREEN)
    middle = columns[1] + width / 2
    arrow(axes, (middle, 2.43), (middle, 0.2 + high), BLUE, "<|-|>")
    return axes.figure


# -------------------------------------------------------------------------------------------- step


def step():
    """One step in time: the leapfrog, and which engine does what on both paths."""
    axes = canvas(9.0, 7.75, -0.42)
    draw_leapfrog(axes)
    draw_engines(axes)
    return axes.figure


def draw_leapfrog(axes):
    """Positions, forces and velocities over time, and what follows from what."""

    def at(steps):
        return 5.2 + 2.75 * steps

    places, forces, speeds, line = 6.75, 5.95, 5.15, 4.15
    for steps in (0, 1):
        axes.plot([at(steps)] * 2, [line, places], color=SOFT, linewidth=0.8, zorder=0)
    for steps in (-1.5, -0.5, 0.5):
        dots = {"linestyle": (0, (1, 3)), "linewidth": 1.0, "color": SOFT, "zorder": 0}
        axes.plot([at(steps)] * 2, [line, speeds], **dots)
    arrow(axes, (0.35, line), (8.75, line), SOFT, width=1.0)
    text(axes, 8.75, line - 0.2, "time", 9, SOFT, ha="right")
    names = ((-1.5, r"n-\frac{3}{2}"), (-0.5, r"n-\frac{1}{2}"), (0, "n"), (0.5, r"n+\frac{1}{2}"))
    for steps, name in (*names, (1, "n+1")):
        axes.plot([at(steps)] * 2, [line - 0.05, line + 0.05], color=SOFT, linewidth=1)
        text(axes, at(steps), line - 0.21, f"${name}$", 10, SOFT)
    for level, words in ((places, "positions"), (forces, "forces"), (speeds, "velocities")):
        text(axes, 0.25, level + (0.26 if level == speeds else 0), words, 9, SOFT, ha="left")

    round_, square = {"marker": "o", "markersize": 30}, {"marker": "s", "markersize": 28}
    for level, steps, name, colour, form in (
        (places, 0, r"x_n", GREEN, round_),
        (places, 1, r"x_{n+1}", GREEN, round_),
        (forces, 0, r"f_n", RED, {"marker": "D", "markersize": 22}),
        (speeds, -1.5, r"v_{n-\frac{3}{2}}", BLUE, square),
        (speeds, -0.5, r"v_{n-\frac{1}{2}}", BLUE, square),
        (speeds, 0.5, r"v_{n+\frac{1}{2}}", BLUE, square),
        (speeds, 0, r"v_n", AMBER, square),
    ):
        face = "white" if colour == AMBER else TINTS[colour]
        edge = {"markerfacecolor": face, "markeredgecolor": colour, "markeredgewidth": 1.3}
        axes.plot(at(steps), level, **form, **edge, linestyle="none", zorder=3)
        text(axes, at(steps), level, f"$\\mathbf{{{name[0]}}}{name[1:]}$", 11.5, zorder=4)

    edge = 0.2
    dashed = {"linestyle": (0, (4, 2)), "width": 1.2}
    arrow(axes, (at(-1.5) + edge, speeds), (at(-0.5) - edge, speeds), AMBER, "-", **dashed)
    arrow(axes, (at(-0.5) + edge, speeds), (at(0) - edge, speeds), AMBER, **dashed)
    words = r"$\mathbf{v}_n=\frac{3}{2}\,\mathbf{v}_{n-\frac{1}{2}}"
    words += r"-\frac{1}{2}\,\mathbf{v}_{n-\frac{3}{2}}$"
    text(axes, at(-1), speeds + 0.25, words, 11.5, AMBER)
    arrow(axes, (at(0), speeds + edge), (at(0), forces - 0.23), AMBER)
    text(axes, at(0) - 0.08, (speeds + forces) / 2, "damping, drag", 8.5, AMBER, ha="right")
    arrow(axes, (at(0), places - edge), (at(0), forces + 0.23), RED)
    text(
        axes, at(0) - 0.08, (places + forces) / 2, "sides, creases, contacts", 8.5, RED, ha="right"
    )
    arrow(axes, (at(0) + 0.2, forces - 0.06), (at(0.5) - 0.14, speeds + edge + 0.03), BLUE)
    below = {"connectionstyle": "arc3,rad=0.28", "width": 1.3}
    arrow(axes, (at(-0.5) + 0.05, speeds - edge), (at(0.5) - 0.05, speeds - edge), BLUE, **below)
    words = r"$\mathbf{v}_{n+\frac{1}{2}}=\mathbf{v}_{n-\frac{1}{2}}+\Delta t\;\mathbf{f}_n/m$"
    white = {"facecolor": "white", "edgecolor": "none", "pad": 1}
    text(axes, at(0.5) + 0.3, speeds - 0.52, words, 11.5, BLUE, ha="left", bbox=white)
    arrow(axes, (at(0) + edge, places), (at(1) - edge, places), GREEN)
    arrow(axes, (at(0.5) + 0.14, speeds + edge + 0.03), (at(1) - 0.12, places - edge - 0.02), GREEN)
    words = r"$\mathbf{x}_{n+1}=\mathbf{x}_n+\Delta t\;\mathbf{v}_{n+\frac{1}{2}}$"
    text(axes, at(0.5), places + 0.24, words, 11.5, GREEN)


def draw_engines(axes):
    """The engines in the order in which O.engines has them, on both paths."""
    left, middle, right, high = 1.1, 4.925, 8.75, 0.36
    top = 3.42
    text(axes, 0.25, top + 0.03, "O.engines", 9, SOFT, ha="left")
    text(axes, (left + middle) / 2, top + 0.03, "path law2", 10.5, weight="bold")
    text(axes, (middle + right) / 2 + 0.05, top + 0.03, "path fused", 10.5, weight="bold")
    rows = (  # task, colour, words on one path and on the other, if they differ
        ("begin", SOFT, "ForceResetter: O.forces become 0"),
        ("drive", SOFT, "SpoolRotation, RotationEngine: facets and nodes that are driven"),
        ("forces", RED, "InteractionLoop: sides, contacts", "InteractionLoop: contacts, if any"),
        ("", RED, "CentrifugalField: during the spin-up only"),
        (
            "",
            RED,
            "MembraneForceEngine: creases, damping, drag",
            "MembraneIntegrator: all forces of the film",
        ),
        (
            "move",
            GREEN,
            "NewtonIntegrator: all nodes, other bodies",
            "MembraneIntegrator: nodes, but for those below",
            "NewtonIntegrator: other bodies that move, if any,\n"
            "and nodes that can touch or are held",
        ),
        ("", GREEN, "FreeHub, if any: the hub and the nodes on it"),
        ("check", BLUE, "MembraneLedger: energies and works; MembraneWatch: stops a run"),
    )
    level, gap = top - 0.2, 0.07
    for task, colour, ours, *theirs in rows:
        heights = [high + 0.14 * words.count("\n") for words in theirs] or [high]
        bottom = level - sum(heights)
        first = level - heights[0]
        text(axes, 0.25, first + (heights[0] - gap) / 2, task, 9, SOFT, ha="left")
        cells = [(left, middle - gap / 2, bottom, sum(heights), ours)]
        if not theirs:
            cells = [(left, right, bottom, high, ours)]
        for words, tall in zip(theirs, heights):
            level -= tall
            cells.append((middle + gap / 2, right, level, tall, words))
        level = bottom
        for start, end, low, tall, words in cells:
            box(axes, start, low, end - start, tall - gap, colour)
            text(axes, (start + end) / 2, low + (tall - gap) / 2, words, 8.5)


# ------------------------------------------------------------------------------------------ crease


def crease():
    """A crease: its nodes, its angle and forces; the angle on mountains and valleys."""
    axes = canvas(9.0, 7.1)
    draw_faces(axes)
    draw_ends(axes)
    return axes.figure


def seen(x, y, z):
    """Where a point in space is in the drawing of the faces: from the front, from above."""
    turn, high = np.radians(17), np.radians(43)
    across = x * np.cos(turn) + y * np.sin(turn)
    away = y * np.cos(turn) - x * np.sin(turn)
    return np.array([3.1 + across, 4.62 + away * np.sin(high) + z * np.cos(high)])


def draw_faces(axes):
    """The faces of a valley, their heights, its angle and forces."""
    half = np.radians(58)  # of the angle between the faces

    def on(y, away, side, up=0.0):
        """A point of a face, `away` from AB, or `up` along its normal over it."""
        x = side * (away * np.sin(half) - up * np.cos(half))
        return seen(x, y, away * np.cos(half) + up * np.sin(half))

    a, b, foot_c, foot_d = -1.3, 2.2, 0.35, 0.75
    c, d = on(foot_c, 2.15, -1), on(foot_d, 1.95, 1)
    at_a, at_b, e, f = (seen(0, y, 0) for y in (a, b, foot_c, foot_d))
    for apex, tint in ((c, "#dce9f7"), (d, "#edf4fc")):
        axes.add_patch(Polygon([at_a, at_b, apex], facecolor=tint, edgecolor=INK, linewidth=1.2))
    axes.plot(*np.transpose([at_a, at_b]), color=BLUE, linewidth=3.2, solid_capstyle="round")
    thin = {"color": SOFT, "linewidth": 1.1, "linestyle": (0, (4, 2))}
    for foot, apex, name, shift in ((e, c, "l_{CE}", (0.1, 0.15)), (f, d, "l_{DF}", (0.15, -0.17))):
        axes.plot(*np.transpose([foot, apex]), **thin)
        text(axes, *(0.55 * foot + 0.45 * apex + shift), f"${name}$", 12, SOFT)

    level, radius = -0.45, 0.46
    angles = np.linspace(-half, half, 40)
    bow = np.array([seen(radius * np.sin(t), level, radius * np.cos(t)) for t in angles])
    axes.plot(*bow.T, color=AMBER, linewidth=1.5)
    for side in (-1, 1):
        ends = on(level, 0, side), on(level, radius, side)
        axes.plot(*np.transpose(ends), color=AMBER, linewidth=1.2)
    text(axes, *(bow[20] + (-0.16, 0.13)), r"$\theta$", 15, AMBER)

    for name, place, tip, shift in (
        ("C", c, on(foot_c, 2.15, -1, 0.75), (-0.06, 0.15)),
        ("D", d, on(foot_d, 1.95, 1, 0.75), (0.02, 0.15)),
        ("A", at_a, at_a - (0, 0.42), (0.28, 0.02)),
        ("B", at_b, at_b - (0, 0.36), (0.27, 0.02)),
    ):
        arrow(axes, place, tip, RED, width=1.8, mutation_scale=13)
        text(axes, *(tip + shift), rf"$\mathbf{{F}}_{name}$", 12.5, RED)
    for name, place, shift in (
        ("A", at_a, (-0.2, -0.02)),
        ("B", at_b, (0.14, 0.15)),
        ("C", c, (-0.2, -0.02)),
        ("D", d, (0.2, -0.02)),
        ("E", e, (0.16, -0.1)),
        ("F", f, (-0.13, 0.1)),
    ):
        small = name in "EF"
        axes.plot(*place, "o", color=INK, markersize=3 if small else 5.5, zorder=4)
        text(axes, *(place + shift), f"${name}$", 11 if small else 14)

    corner = np.array([0.55, 3.75])
    for ahead, name in (((1, 0, 0), "x"), ((0, 1, 0), "y"), ((0, 0, 1), "z")):
        way = 0.62 * (seen(*ahead) - seen(0, 0, 0))
        arrow(axes, corner, corner + way, SOFT, width=1.0, mutation_scale=8)
        text(axes, *(corner + 1.25 * way), f"${name}$", 10, SOFT)
    for k, line in enumerate(
        (
            "The crease is the side $AB$; $C$ and $D$ are the apexes",
            "of its triangles. Seen from $+z$, $A, B, C$ run",
            "counter-clockwise.",
            "",
            r"$\theta$ is the angle between the triangles.",
            "",
            r"$\mathbf{F}_C$ and $\mathbf{F}_D$ are normal to the triangles and",
            r"lead towards $\theta_0$, here 0: they close the fold.",
            r"$\mathbf{F}_A$ and $\mathbf{F}_B$ balance them.",
        )
    ):
        text(axes, 5.55, 6.55 - 0.235 * k, line, 9.2, ha="left")


def draw_ends(axes):
    """A valley and a mountain at several angles, seen along the crease from A to B."""
    states = (
        (4 / 3, r"$\theta=\frac{4}{3}\pi$", "bent the other way"),
        (1, r"$\theta=\pi$", "flat"),
        (0.5, r"$\theta=\frac{1}{2}\pi$", "half open"),
        (0, r"$\theta=0$", "folded"),
        (-1 / 6, r"$\theta=-\frac{1}{6}\pi$", "passed through"),
    )
    axes.plot([0.25, 8.75], [3.1, 3.1], color=SOFT, linewidth=0.8, linestyle=(0, (4, 3)))
    text(axes, 0.25, 2.9, "seen along the crease, from A to B, with +z up", 9, SOFT, ha="left")
    for row, (sign, colour, words) in enumerate(
        (
            (1, BLUE, "valley\ncreaseSigns: -1\nFOLD: V"),
            (-1, RED, "mountain\ncreaseSigns: +1\nFOLD: M"),
        )
    ):
        level = 2.0 - 1.05 * row
        text(axes, 0.25, level + 0.05, words, 9, colour, ha="left")
        for k, (angle, _, _) in enumerate(states):
            middle = np.array([2.45 + 1.45 * k, level - (0.3 if angle < 0.8 else 0) * sign])
            half = 0.5 * np.pi * angle
            arm = 0.5 * np.array([np.sin(half), sign * np.cos(half)])
            apart = np.array([0.025 if angle == 0 else 0, 0])
            for name, side in (("C", -1), ("D", 1)):
                tip = middle + arm * [side, 1] + side * apart
                line = {"color": INK, "linewidth": 1.6, "solid_capstyle": "round"}
                axes.plot(*np.transpose([middle + side * apart, tip]), **line)
                out = side * (1 if angle >= 0 else -1)
                near = (0.11 * out, 0) if abs(angle) < 0.7 else (0.0, -0.14 * sign)
                near = (0.12 * side, 0.0) if angle == 1 else near
                text(axes, *(tip + near), f"${name}$", 9.5, SOFT)
            axes.plot(*middle, "o", color=colour, markersize=6, zorder=4)
            if 0 < angle < 1 or angle > 1:
                ways = np.linspace(-half, half, 40)
                bow = middle + 0.2 * np.column_stack([np.sin(ways), sign * np.cos(ways)])
                axes.plot(*bow.T, color=AMBER, linewidth=1.3)
    for k, (_, name, words) in enumerate(states):
        text(axes, 2.45 + 1.45 * k, 0.37, name, 11)
        text(axes, 2.45 + 1.45 * k, 0.13, words, 8.5, SOFT)


def main():
    """Write all figures beside this file."""
    for draw in (parts, step, crease):
        file = Path(__file__).resolve().with_name(f"{draw.__name__}.svg")
        draw().savefig(file, metadata={"Date": None})


if __name__ == "__main__":
    main()
