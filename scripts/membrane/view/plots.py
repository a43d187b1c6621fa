# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of results: curves as Figures 8 and 9, and shapes as Figure 7.

Figures are drawn to files only; no window system is needed.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from numpy.typing import ArrayLike

from ..files import replacing
from ..measures import Plot
from ..mesh import SailMesh

FILM = np.array([0.98, 0.80, 0.42])
SPOOL = np.array([0.45, 0.48, 0.55])
LIGHT = np.array([0.35, -0.45, 0.82]) / np.linalg.norm([0.35, -0.45, 0.82])
VIEW = {"elev": 32, "azim": -65}
DPI = 150


def save(figure: Figure, path: Path | str, **options: Any) -> None:
    """Write a matplotlib Figure whole or not at all; the ending of `path` gives the format.

    `options` are those of `savefig`, of which `dpi` is DPI by default.
    """
    with replacing(path) as part:
        figure.savefig(part, **{"format": Path(path).suffix[1:], "dpi": DPI, **options})


def plot_history(
    history: Mapping[str, np.ndarray], plots: Sequence[Plot], path: Path | str
) -> None:
    """Plots of a history, columns (S,) with `time` [s] among them, one above the other.

    The ending of `path` gives the format of the picture.
    """
    height = max(1 + 1.7 * len(plots), 6)
    figure = Figure(figsize=(7, height), layout="constrained")
    every = figure.subplots(len(plots), 1, sharex=True, squeeze=False)[:, 0]
    for axes, plot in zip(every, plots):
        _draw_lines(axes, history, plot)
    every[-1].set(xlabel="time [s]")
    figure.align_ylabels(every)
    save(figure, path)


def _draw_lines(axes, history, plot):
    """Draw a measures.Plot; measures that are one of several alike are thin, and named once."""
    minor = [m for m in plot.lines if m.minor]
    alike = minor and minor[0].label.rstrip(" 0123456789") + "s"
    for m in sorted(plot.lines, key=lambda m: not m.minor):
        style = {"color": "C1", "linewidth": 0.6, "alpha": 0.6} if m.minor else {}
        label = m.label if not m.minor else alike if m is minor[0] else None
        axes.plot(history["time"], plot.factor * history[m.name], label=label, **style)
    axes.set(ylabel=f"{plot.title}\n[{plot.unit}]")
    drawn = plot.factor * np.array([history[m.name] for m in plot.lines])
    if drawn.min() >= 0:
        axes.set(ylim=(0, 1.05 * drawn.max() or None))
    if len(plot.lines) > 1:
        axes.legend(frameon=False)
    axes.grid(alpha=0.3)
    axes.margins(x=0)


def plot_shapes(
    frames: ArrayLike, mesh: SailMesh, path: Path | str, times: Sequence[float] | np.ndarray
) -> None:
    """Views of a SailMesh at up to six times, all from the same camera and at the same scale.

    `frames` (S, N, 3) are positions [m] at `times` (S,) [s], 1 <= S <= 6.
    """
    _plot_views(frames, times, path, lambda axes, x, radius: draw_sail(axes, mesh, x, radius))


def plot_sheets(
    frames: ArrayLike,
    triangles: np.ndarray,
    marked: np.ndarray,
    path: Path | str,
    times: Sequence[float] | np.ndarray,
) -> None:
    """Views of any sheet at up to six times, all from the same camera and at the same scale.

    `frames` (S, N, 3) are positions [m] at `times` (S,) [s], 1 <= S <= 6, `triangles` (T, 3) node
    ids; nodes `marked` (n,) are drawn as dots, as those with tip masses.
    """

    def draw(axes: Axes, positions: np.ndarray, radius: float) -> None:
        _draw_faces(axes, positions[triangles])
        _draw_dots(axes, positions[marked])
        _set_view(axes, radius, zoom=1.6)

    _plot_views(frames, times, path, draw)


def _plot_views(frames, times, path, draw):
    """Six views or fewer; `draw(axes, positions, radius)` draws one."""
    if not 1 <= len(frames) <= 6 or len(times) != len(frames):
        raise ValueError(f"frames, times: {len(frames)} and {len(times)}; must be equal, 1 to 6")
    frames = np.asarray(frames)
    figure = Figure(figsize=(10.5, 4.8))
    radius = np.max(np.hypot(frames[..., 0], frames[..., 1]))
    figure.subplots_adjust(left=0, right=1, bottom=0, top=0.98, wspace=0, hspace=0)
    for i, (positions, time) in enumerate(zip(frames, times)):
        axes = figure.add_subplot(2, 3, i + 1, projection="3d")
        draw(axes, positions, radius)
        axes.set_title(f"{time:.3f} s", y=0.9, fontsize=11)
        if i == 0:
            draw_scale_bar(axes, radius)
    save(figure, path)


def draw_sail(axes: Axes, mesh: SailMesh, positions: np.ndarray, radius: float) -> None:
    """Draw a SailMesh, shaded, with tips, tethers and spool; nodes at `positions` (N, 3) [m].

    The 3-D `axes` reach to `radius` [m] from the axis of spin. The spool is as tall as the strips:
    the mesh does not tell its height.
    """
    spool = _spool_faces(mesh.spool_radius, mesh.strip_width)
    _draw_faces(axes, positions[mesh.triangles], spool)
    cables = positions[mesh.cables]
    axes.add_collection3d(Line3DCollection(cables, colors="0.3", linewidths=0.6, clip_on=False))
    _draw_dots(axes, positions[mesh.tips])
    _set_view(axes, radius)


def draw_scale_bar(axes: Axes, radius: float) -> None:
    """Draw a bar below a sail that reaches to `radius` [m]: 1, 2 or 5 times a power of ten long.

    It stands in the plane through the origin across the view, and holds for lengths there.
    """
    widest = 0.7 * radius
    power = 10 ** np.floor(np.log10(widest))
    length = max(step * power for step in (1, 2, 5) if step * power <= widest)
    elevation, azimuth = np.radians([VIEW["elev"], VIEW["azim"]])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    up = np.array([0, 0, np.cos(elevation)])
    up[:2] = -np.sin(elevation) * np.array([np.cos(azimuth), np.sin(azimuth)])
    left, low, tick = -0.95 * radius, -0.62 * radius, 0.03 * radius
    corners = [(left, low + tick), (left, low), (left + length, low), (left + length, low + tick)]
    bar = np.array([x * right + y * up for x, y in corners])
    axes.plot(*bar.T, color="0.2", linewidth=1, clip_on=False)
    text = f"{length:g} m" if length >= 1 else f"{1e3 * length:g} mm"
    middle = (left + length / 2) * right + (low + tick) * up
    axes.text(*middle, text, ha="center", va="bottom", fontsize=8, color="0.2")


def _draw_faces(axes, film, spool=()):
    """Draw shaded triangles of film (T, 3, 3) and faces of a spool, each (n, 3)."""
    normals = np.cross(film[:, 1] - film[:, 0], film[:, 2] - film[:, 0])
    colours = _lambert(FILM, normals)
    if len(spool):
        metal = _lambert(SPOOL, np.array([np.cross(f[1] - f[0], f[2] - f[0]) for f in spool]))
        colours = np.concatenate([colours, metal])
    style = {"facecolors": colours, "edgecolors": 0.8 * colours, "linewidths": 0.2}
    axes.add_collection3d(Poly3DCollection([*film, *spool], clip_on=False, **style))


def _draw_dots(axes, points):
    """Draw masses (n, 3)."""
    axes.scatter(*points.T, color="0.1", s=9, depthshade=False, clip_on=False)


def _set_view(axes, radius, zoom=1.9):
    """The camera, and the space it shows: up to `radius` [m] from the axis."""
    height = 0.45 * radius
    axes.set(xlim=(-radius, radius), ylim=(-radius, radius), zlim=(-height, height))
    axes.set_box_aspect((1, 1, 0.45), zoom=zoom)
    axes.view_init(**VIEW)
    axes.set_axis_off()


def _lambert(colour, normals):
    """Colours (n, 3) of faces with `normals` (n, 3) of any length, lit from both sides alike."""
    length = np.linalg.norm(normals, axis=1)
    cosine = np.abs(normals @ LIGHT) / np.where(length > 0, length, 1)
    return (0.45 + 0.55 * cosine)[:, None] * colour


def _spool_faces(radius, height, facets=24):
    """Faces of a cylinder about the axis: `facets` rectangles and a lid, each (n, 3) [m]."""
    angle = 2 * np.pi * np.arange(facets + 1) / facets
    ring = radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(facets + 1)])
    foot, head = ring - [0, 0, height / 2], ring + [0, 0, height / 2]
    sides = [np.array([foot[i], foot[i + 1], head[i + 1], head[i]]) for i in range(facets)]
    return sides + [head[:-1]]
