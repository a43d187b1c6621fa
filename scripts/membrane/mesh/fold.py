# SPDX-License-Identifier: GPL-2.0-or-later
"""The folded sail: a cross of four standing strips (paper, 3.3).

Every petal is folded zig-zag into a strip that stands along z: even fold lines (and the inner
edge) at its foot, odd ones at its head. The strip is bent over its guide bar, and its two halves
run outwards along the diagonals, side by side with the neighbours' halves.

Each row of nodes follows the petal's centre line at an offset of its own, so that layers lie
`layer_gap` apart: row 0 innermost, the outer edge outermost. Along the arms each row draws nearer
to the diagonal, on which its seam node lies. On the straight parts of the centre line all sides
keep their length. Where it turns into the diagonal the outer layers take the inner lane and sides
across the turn become chords: there the film buckles, and is hardly stretched anywhere.
"""

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin, sqrt, tan
from typing import Any

import numpy as np

from ..geometry import crease_angles, side_lengths
from .square_sail import quarter_turn

SHORTENED = 1e-3


def fold(
    mesh: Any, bar_radius: float = 0.030, arm_radius: float = 0.040, layer_gap: float = 1e-4
) -> np.ndarray:
    """Positions (N, 3) [m] of all nodes of a SailMesh, the flat sail, in the folded state.

    Parameters
    ----------
    bar_radius : float
        Distance of the guide bars from the axis [m], more than the spool's radius.
    arm_radius : float
        Radius at which the strips' centre lines would reach the diagonal in a sharp corner [m],
        more than bar_radius / sqrt(2); the corner is rounded by twice the stack's thickness.
    layer_gap : float
        Distance between neighbouring layers [m], less than a twentieth of the strip width.

    Raises
    ------
    ValueError
        If a parameter is out of range or does not fit the sail; the message names it.
    """
    _check(mesh, bar_radius, arm_radius, layer_gap)
    line = _centre_line(mesh, bar_radius, arm_radius, layer_gap)
    _check_fit(mesh, line, arm_radius)
    positions = np.empty_like(mesh.nodes)
    for k, path in enumerate(_paths(mesh, line, layer_gap)):
        petal = np.column_stack([path, np.full(len(path), _height(mesh, k, layer_gap))])
        for p in range(4):
            positions[mesh.rows[k][p]] = quarter_turn(petal, p)
    _hang_tethers(mesh, positions)
    _check_layers(mesh, positions, layer_gap)
    return positions


def _offset(mesh, row, layer_gap):
    """Distance [m] of a row's layer from the centre line, half a gap for row 0."""
    return layer_gap * (row / mesh.refine + 0.5)


def _height(mesh, row, layer_gap):
    """Height z [m] of a row: a zig-zag that keeps the strips' width."""
    half = sqrt(mesh.strip_width**2 - layer_gap**2) / 2
    rise = abs((row / mesh.refine + 1) % 2 - 1)
    return half * (2 * rise - 1)


@dataclass(frozen=True)
class _CentreLine:
    """Right half of petal 0's centre line: straight, an arc to the right, then the diagonal."""

    bar: float  #: x of the start (bar, 0) [m]
    lean: float  #: angle of the first straight part from +y towards the axis [rad]
    straight: float  #: length of that part [m]
    radius: float  #: of the arc [m]
    turn: float  #: angle of the arc [rad]

    @property
    def bend_end(self):
        """Arc length [m] at which the line reaches the diagonal."""
        return self.straight + self.radius * self.turn

    def at(self, length, offset):
        """Points (n, 2) [m] at arc lengths (n,) [m] <= `bend_end`, `offset` [m] to the right."""
        first = np.minimum(length, self.straight)
        angle = np.clip((length - self.straight) / self.radius, 0, self.turn)
        ahead, right = _heading(self.lean)
        centre = np.array([self.bar, 0.0]) + first[:, None] * ahead + self.radius * right
        return centre + (offset - self.radius) * _heading(self.lean - angle)[1]


def _heading(lean):
    """Unit vectors ahead and to the right of a line that leans from +y towards -x [rad]."""
    ahead = np.stack([-np.sin(lean), np.cos(lean)], axis=-1)
    right = np.stack([np.cos(lean), np.sin(lean)], axis=-1)
    return ahead, right


def _centre_line(mesh, bar_radius, arm_radius, layer_gap):
    """Centre line from the bar to the arm; its bend is twice as wide as the stack of layers."""
    corner = arm_radius / sqrt(2)
    lean = atan2(bar_radius - corner, corner)
    turn = lean + pi / 4
    radius = 2 * _offset(mesh, len(mesh.rows) - 1, layer_gap)
    straight = hypot(bar_radius - corner, corner) - radius * tan(turn / 2)
    return _CentreLine(bar_radius, lean, straight, radius, turn)


def _paths(mesh, line, layer_gap):
    """Paths of all rows of petal 0 seen from above, (cells + 1, 2) [m] each, row 0 first.

    Chords across the bend may reach into the next layer's lane, so each row is laid on the one
    before.
    """
    below, paths = np.empty((0, 2)), []
    for k in range(len(mesh.rows)):
        arc, offset = mesh.row_arc(k), _offset(mesh, k, layer_gap)
        length = arc[arc >= 0] - offset * tan(line.lean)
        path = _lane(line, length, offset)
        bent = np.searchsorted(length, line.bend_end) + 1
        below = _lay(path[:bent], below, layer_gap / mesh.refine)
        inner = min(bent, len(path) - 1)
        path[:inner] = below[:inner]
        mirrored = path[::-1] * [1, -1]
        paths.append(np.concatenate([mirrored[: len(arc) - len(path)], path]))
    return paths


def _lane(line, length, offset):
    """Right half of a row's path (n, 2) [m]: parallel to the centre line, then to the seam.

    `length` (n,) [m] counts along the centre line from the guide bar; it is less than 0 for a
    node on the mitre in which the two halves meet there. Beyond the bend the path runs straight
    to the last node, the seam node, which lies on the diagonal itself.
    """
    ahead, right = _heading(-pi / 4)
    beyond = np.maximum(length - line.bend_end, 0)
    outward = sqrt(beyond[-1] ** 2 - offset**2) * ahead - offset * right
    bend = line.at(np.minimum(length, line.bend_end), offset)
    return bend + (beyond / beyond[-1])[:, None] * outward


def _lay(points, below, gap):
    """Move points (n, 2) [m] to the right until `gap` [m] clear of the layer `below` (m, 2) [m].

    The layer below turns right only and less than a right angle, so that clearing one of its
    sides never brings a point nearer to another.
    """
    for start, side in zip(below, np.diff(below, axis=0)):
        right = np.array([side[1], -side[0]]) / hypot(*side)
        points = points + np.maximum(gap - (points - start) @ right, 0)[:, None] * right
    return points


def _hang_tethers(mesh, positions):
    """Set the tether nodes: slack chains in the diagonal planes, hanging down between their ends.

    The anchor stays at its place on the spool; each segment keeps its rest length, as the chords
    of a circular arc.
    """
    chains = mesh.cables.reshape(4, -1, 2)
    corner = positions[mesh.inner_corners[0]]
    end = np.array([hypot(corner[0], corner[1]) - mesh.spool_radius, corner[2]])
    plane = _chain(end, mesh.tether_length, mesh.tether_segments)
    radius = mesh.spool_radius + plane[:, 0]
    for p, chain in enumerate(chains):
        outward = positions[mesh.inner_corners[p], :2] / hypot(corner[0], corner[1])
        positions[chain[:, 0], :2] = radius[:, None] * outward
        positions[chain[:, 0], 2] = plane[:, 1]


def _chain(end, length, segments):
    """First nodes (segments, 2) [m] of a chain from the origin to `end` that hangs below it."""
    piece = length / segments
    reach = hypot(*end) / piece
    half_turn = _chord_angle(min(reach, segments), segments)
    steps = np.arange(segments) * 2 + 1 - segments
    angles = atan2(end[1], end[0]) + half_turn * steps
    pieces = piece * np.column_stack([np.cos(angles), np.sin(angles)])
    return np.concatenate([np.zeros((1, 2)), np.cumsum(pieces, axis=0)[:-1]])


def _chord_angle(reach, segments):
    """Angle a in [0, pi / segments] with sin(segments a) = reach sin(a): half a joint's turn."""
    low, high = 0.0, pi / segments
    for _ in range(60):
        middle = (low + high) / 2
        if sin(segments * middle) > reach * sin(middle):
            low = middle
        else:
            high = middle
    return low


def _check(mesh, bar_radius, arm_radius, layer_gap):
    """Raise ValueError naming the first parameter out of range."""
    lengths = {"bar_radius": bar_radius, "arm_radius": arm_radius, "layer_gap": layer_gap}
    for name, value in lengths.items():
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} = {value} m: must be finite and > 0")
    if bar_radius <= mesh.spool_radius:
        raise ValueError(
            f"bar_radius = {bar_radius} m: must be > spool_radius = {mesh.spool_radius} m"
        )
    if layer_gap >= mesh.strip_width / 20:
        raise ValueError(
            f"layer_gap = {layer_gap} m: must be < {mesh.strip_width / 20:.6g} m, "
            "a twentieth of the strip width"
        )


def _check_fit(mesh, line, arm_radius):
    """Raise ValueError if the strip would cut the spool or bend where it cannot."""
    if line.turn >= pi / 2:
        raise ValueError(
            f"arm_radius = {arm_radius} m: must be > {line.bar / sqrt(2):.6g} m, "
            "bar_radius / sqrt(2)"
        )
    if line.straight <= 0:
        raise ValueError(
            f"arm_radius = {arm_radius} m: no room for the bend between bar and arm; raise it"
        )
    nearest = line.bar * cos(line.lean)
    if nearest <= mesh.spool_radius or arm_radius <= mesh.spool_radius:
        raise ValueError(
            f"arm_radius = {arm_radius} m: the strip passes the axis at {nearest:.6g} m, "
            f"inside the spool of radius {mesh.spool_radius} m; raise it"
        )
    room = mesh.row_distance(0) - line.bend_end
    if room < mesh.strip_width / 2:
        raise ValueError(
            f"arm_radius = {arm_radius} m: only {room:.6g} m of the inner edge would reach the "
            f"diagonal, at least {mesh.strip_width / 2:.6g} m is wanted; lower it"
        )


def _check_layers(mesh, positions, layer_gap):
    """Raise ValueError if tethers are too short or faces have passed through each other."""
    report = fold_report(mesh, positions)
    if report.cable_stretch > 1e-9:
        raise ValueError(
            f"bar_radius, arm_radius: tethers stretched by {report.cable_stretch:.3g}; "
            "a larger arm_radius brings the corners nearer the spool"
        )
    spool = mesh.spool_radius * (1 - 1e-9)
    if np.min(np.hypot(*positions[mesh.tether_nodes, :2].T)) < spool:
        raise ValueError("arm_radius: tethers are so slack that they cut the spool; raise it")
    if report.least_angle <= 0:
        raise ValueError(
            f"layer_gap = {layer_gap} m: layers cross (least crease angle "
            f"{report.least_angle:.3g} rad); raise it"
        )


@dataclass(frozen=True)
class FoldReport:
    """How well a folded state keeps the film's lengths and layers."""

    stretch: float  #: largest strain of the film's sides [-]; positive = stretched
    shortening: float  #: largest shortening of the film's sides [-]
    shortened: int  #: number of the film's sides shortened by more than 0.1 %
    cable_stretch: float  #: largest strain of a tether segment [-]
    cable_slack: float  #: 1 - end distance / length of a tether, least [-]
    least_angle: float  #: of the creases' opening angles [rad]
    largest_angle: float  #: of them, too [rad]
    layers: int  #: of each half strip
    tip_radius: float  #: mean distance of the tips from the axis [m]
    least_radius: float  #: of the film's nodes from the axis [m]
    height: float  #: extent of the film along z [m]


def fold_report(mesh: Any, positions: np.ndarray) -> Any:
    """FoldReport of the nodes of a SailMesh, the flat sail, at `positions` (N, 3) [m]."""
    strain = _strain(mesh.nodes, positions, mesh.sides)
    ends = np.column_stack([mesh.anchors, mesh.inner_corners])
    angles = crease_angles(positions, mesh.triangles, mesh.creases, mesh.crease_signs)
    film = positions[: mesh.film_size]
    radius = np.hypot(film[:, 0], film[:, 1])
    return FoldReport(
        stretch=float(strain.max()),
        shortening=float(-strain.min()),
        shortened=int(np.sum(strain < -SHORTENED)),
        cable_stretch=float(_strain(mesh.nodes, positions, mesh.cables).max()),
        cable_slack=float(-_strain(mesh.nodes, positions, ends).max()),
        least_angle=float(angles.min()),
        largest_angle=float(angles.max()),
        layers=mesh.strips,
        tip_radius=float(radius[mesh.tips].mean()),
        least_radius=float(radius.min()),
        height=float(np.ptp(film[:, 2])),
    )


def _strain(rest, positions, sides):
    """Strains (E,) [-] of sides between rest and present positions."""
    return side_lengths(positions, sides) / side_lengths(rest, sides) - 1
