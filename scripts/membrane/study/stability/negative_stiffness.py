# SPDX-License-Identifier: GPL-2.0-or-later
"""Sheets with flat triangles, to whose longest side (5) gives a negative stiffness.

A side shared by two triangles has the sum of both stiffnesses, so a flat triangle beside a
well-shaped one may be borne. Two free sheets are scanned: all triangles flat, and rows of flat
triangles between rows of equilateral ones. Measured: the lowest eigenvalue of the assembled
stiffness in the plane, beyond the three rigid motions, and the growth of a tiny perturbation in a
run. Predicted: the sign of the least side's sum.
"""

from itertools import product

import membrane as plugin
import numpy as np
from matplotlib.figure import Figure
from membrane import scene

from .common import Model, O, advance_below, bisect, figure, grid, publish

LENGTH = 0.02
KINDS = {"uniform": "all triangles flat", "mixed": "between equilateral rows"}
HEADER = (
    "sheet; apex angle [deg]; poisson [-]; least side stiffness [N/m]; "
    "lowest eigenvalue / highest [-]; stable by eigenvalue; stable in a run"
)


def height(angle: float) -> float:
    """Height [m] of an isosceles triangle on a base LENGTH with an apex angle [deg]."""
    return 0.5 * LENGTH / np.tan(0.5 * np.radians(angle))


def stiffness_matrix(net: plugin.Membrane, nodes: np.ndarray) -> np.ndarray:
    """K (2 N, 2 N) [N/m] of the sheet in its plane, unstressed."""
    k = np.zeros((2 * len(nodes), 2 * len(nodes)))
    for (a, b), stiffness in zip(net.sides, net.stiffnesses):
        along = (nodes[b] - nodes[a])[:2]
        block = stiffness * np.outer(along, along) / (along @ along)
        for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            k[2 * i : 2 * i + 2, 2 * j : 2 * j + 2] += sign * block
    return k


def film(nodes: np.ndarray, triangles: np.ndarray, poisson: float) -> plugin.Membrane:
    """A Membrane of nodes (N, 3) [m] and triangles (T, 3), not in the scene."""
    return plugin.Membrane(
        material=scene.film(poisson=poisson),
        nodes=nodes.tolist(),
        triangles=triangles.tolist(),
        allowNegativeStiffness=True,
    )


def membrane(
    kind: str, angle: float, poisson: float
) -> tuple[np.ndarray, np.ndarray, plugin.Membrane]:
    """Nodes, triangles, Membrane of a free sheet: `uniform`, or `mixed` with equilateral rows."""
    flat, good = height(angle), height(60.0)
    nodes, triangles = grid(
        5, LENGTH, flat if kind == "uniform" else [good, flat, good, flat, good]
    )
    return nodes, triangles, film(nodes, triangles, poisson)


def lowest_eigenvalue(net: plugin.Membrane, nodes: np.ndarray) -> float:
    """Lowest eigenvalue of K beyond rigid motion over the highest [-]; 0 for a mechanism."""
    values = np.linalg.eigvalsh(stiffness_matrix(net, nodes))
    rest = np.delete(values, np.argsort(np.abs(values))[:3])
    return float(rest[0] / values[-1])


def runs_stably(
    nodes: np.ndarray, triangles: np.ndarray, poisson: float, steps: int = 2000
) -> bool:
    """Whether a tiny perturbation of the sheet in its plane stays bounded."""
    material = scene.film(poisson=poisson)
    model = Model(nodes, triangles, material=material, alpha=1e6, allowNegativeStiffness=True)
    noise = np.random.default_rng(2).normal(size=nodes.shape)
    model.place(nodes, 1e-7 * noise * [1, 1, 0])
    O.dt = 0.5 * model.forces.criticalTimeStep()
    return advance_below(model, steps, 30 * model.kinetic(), 50)


def base_stiffness(angle: float, poisson: float) -> float:
    """Stiffness [N/m] by (5) of the base of an isosceles triangle, apex angle [deg]."""
    nodes = np.array([(0, 0, 0), (LENGTH, 0, 0), (0.5 * LENGTH, height(angle), 0)])
    return film(nodes, np.array([(0, 1, 2)]), poisson).stiffnesses[0]


def zero_angle(poisson: float, kind: str = "uniform") -> float:
    """Apex angle [deg] at which a base, alone or beside an equilateral one, has no stiffness."""
    beside = base_stiffness(60.0, poisson) if kind == "mixed" else 0.0
    return bisect(lambda a: base_stiffness(a, poisson) + beside < 0, 90.0, 179.0, rounds=30)


def run(quick: bool) -> str:
    """Scan both sheets; returns a line of text."""
    angles = np.arange(80.0, 171.0, 30.0 if quick else 7.5)
    ratios = np.linspace(-0.5, 0.5, 3 if quick else 6)
    rows = []
    for kind, angle, poisson in product(KINDS, angles, ratios.tolist()):
        nodes, triangles, net = membrane(kind, angle, poisson)
        lowest = lowest_eigenvalue(net, nodes)
        stable = int(lowest > -1e-12), int(runs_stably(nodes, triangles, poisson))
        rows.append([kind, angle, poisson, min(net.stiffnesses), lowest, *stable])
    differ = sum(row[5] != row[6] for row in rows)
    borne = sum(row[3] < 0 and row[5] for row in rows)
    wrong = sum((row[3] >= 0) != row[5] for row in rows)
    scanned = len(rows)
    curves = {k: [(zero_angle(nu, k), nu) for nu in np.linspace(-0.5, 0.5, 21)] for k in KINDS}
    drawing = draw(rows, curves)
    for kind, name in zip(KINDS, ("zero of one triangle", "zero beside equilateral")):
        rows += [[name, *point, 0.0, 0.0, "", ""] for point in curves[kind]]
    publish("negative_stiffness", quick, HEADER, rows, drawing)
    zeros = [zero_angle(nu, kind) for kind in KINDS for nu in (0.0, 0.34)]
    return (
        f"the base of one triangle loses its stiffness at an apex of {zeros[0]:.2f} deg (nu = 0), "
        f"{zeros[1]:.2f} deg (nu = 0.34), beside an equilateral one at {zeros[2]:.2f} and "
        f"{zeros[3]:.2f} deg; of {scanned} sheets {borne} are stable with a negative side; the "
        f"sign of the least side is wrong in {wrong}; eigenvalue and run disagree in {differ}"
    )


def draw(rows: list[list], curves: dict[str, list[tuple[float, float]]]) -> Figure:
    """Stable and unstable sheets over apex angle and Poisson's ratio."""
    drawing, panels = figure(columns=2)
    for axis, (kind, title) in zip(panels, KINDS.items()):
        mine = [row for row in rows if row[0] == kind]
        series: tuple[tuple[str, str, list], ...] = (
            ("stable", "C0s", [r[1:3] for r in mine if r[5]]),
            ("unstable", "C3s", [r[1:3] for r in mine if not r[5]]),
            ("run grows", "kx", [r[1:3] for r in mine if not r[6]]),
            ("predicted: stiffness of the base 0", "k-", curves[kind]),
        )
        for label, sign, points in series:
            axis.plot(*np.reshape(points, (-1, 2)).T, sign, label=label)
        axis.set(xlabel="apex angle [deg]", ylabel="Poisson's ratio [-]", title=title)
    panels[0].legend(fontsize=7)
    return drawing
