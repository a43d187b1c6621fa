# SPDX-License-Identifier: GPL-2.0-or-later
"""Sheets with flat triangles, to whose longest side (5) gives a negative stiffness.

A side shared by two triangles has the sum of both stiffnesses, so a flat triangle beside a
well-shaped one may be borne. Two free sheets are scanned: all triangles flat, and rows of flat
triangles between rows of equilateral ones. Measured: the lowest eigenvalue of the assembled
stiffness in the plane, beyond the three rigid motions, and the growth of a tiny perturbation in a
run. Predicted: the sign of the least side's sum.
"""

from itertools import product
from pathlib import Path

import membrane as plugin
import numpy as np
from membrane import scene

from .common import Model, O, advance_below, bisect, figure, folder, grid, save, write_table

LENGTH = 0.02
HEADER = (
    "sheet",
    "apex angle [deg]",
    "poisson [-]",
    "least side stiffness [N/m]",
    "lowest eigenvalue / highest [-]",
    "stable by eigenvalue",
    "stable in a run",
)


def height(angle: float) -> float:
    """Height [m] of an isosceles triangle on a base LENGTH with an apex angle [deg]."""
    return 0.5 * LENGTH / np.tan(0.5 * np.radians(angle))


def sheet(kind: str, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes, triangles of a free sheet: `uniform`, or `mixed` with equilateral rows."""
    flat, good = height(angle), height(60.0)
    return grid(5, LENGTH, flat if kind == "uniform" else [good, flat, good, flat, good])


def stiffness_matrix(net: plugin.Membrane, nodes: np.ndarray) -> np.ndarray:
    """K (2 N, 2 N) [N/m] of the sheet in its plane, unstressed."""
    k = np.zeros((2 * len(nodes), 2 * len(nodes)))
    for (a, b), stiffness in zip(net.sides, net.stiffnesses):
        along = (nodes[b] - nodes[a])[:2]
        block = stiffness * np.outer(along, along) / (along @ along)
        for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            k[2 * i : 2 * i + 2, 2 * j : 2 * j + 2] += sign * block
    return k


def membrane(
    kind: str, angle: float, poisson: float
) -> tuple[np.ndarray, np.ndarray, plugin.Membrane]:
    """Nodes and triangles of a sheet, and its Membrane, not in the scene."""
    nodes, triangles = sheet(kind, angle)
    net = plugin.Membrane(
        material=scene.film(poisson=poisson),
        nodes=nodes.tolist(),
        triangles=triangles.tolist(),
        allowNegativeStiffness=True,
    )
    return nodes, triangles, net


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
    rng = np.random.default_rng(2)
    velocities = 1e-7 * rng.normal(size=nodes.shape) * [1, 1, 0]
    model.place(nodes, velocities)
    O.dt = 0.5 * model.forces.criticalTimeStep()
    return advance_below(model, steps, 30 * model.kinetic(), 50)


def base_stiffness(angle: float, poisson: float) -> float:
    """Stiffness [N/m] by (5) of the base of an isosceles triangle, apex angle [deg]."""
    net = plugin.Membrane(
        material=scene.film(poisson=poisson),
        nodes=[(0, 0, 0), (LENGTH, 0, 0), (0.5 * LENGTH, height(angle), 0)],
        triangles=[(0, 1, 2)],
        allowNegativeStiffness=True,
    )
    return net.stiffnesses[0]


def zero_angle(poisson: float, kind: str = "uniform") -> float:
    """Apex angle [deg] at which a base, alone or beside an equilateral one, has no stiffness."""
    beside = base_stiffness(60.0, poisson) if kind == "mixed" else 0.0

    def negative(angle):
        return base_stiffness(angle, poisson) + beside < 0

    return bisect(negative, 90.0, 179.0, rounds=30)


def run(quick: bool) -> str:
    """Scan both sheets; returns a line of text."""
    angles = np.arange(80.0, 171.0, 30.0 if quick else 7.5)
    ratios = np.linspace(-0.5, 0.5, 3 if quick else 6)
    rows = []
    for kind, angle, poisson in product(("uniform", "mixed"), angles, ratios):
        nodes, triangles, net = membrane(kind, angle, poisson)
        lowest = lowest_eigenvalue(net, nodes)
        ran = runs_stably(nodes, triangles, float(poisson))
        rows.append(
            [kind, angle, poisson, min(net.stiffnesses), lowest, int(lowest > -1e-12), int(ran)]
        )
    curves = {
        kind: [(nu, zero_angle(float(nu), kind)) for nu in np.linspace(-0.5, 0.5, 21)]
        for kind in ("uniform", "mixed")
    }
    for kind, name in (("uniform", "zero of one triangle"), ("mixed", "zero beside equilateral")):
        rows += [[name, angle, poisson, 0.0, 0.0, "", ""] for poisson, angle in curves[kind]]
    out = folder(quick)
    write_table(out / "negative_stiffness.csv", HEADER, rows)
    draw(rows, curves, out / "negative_stiffness.png")
    scanned = [row for row in rows if row[5] != ""]
    differ = sum(row[5] != row[6] for row in scanned)
    borne = sum(row[3] < 0 and row[5] for row in scanned)
    wrong = sum((row[3] >= 0) != row[5] for row in scanned)
    zeros = [zero_angle(nu, kind) for kind in ("uniform", "mixed") for nu in (0.0, 0.34)]
    return (
        f"the base of one triangle loses its stiffness at an apex of {zeros[0]:.2f} deg (nu = 0), "
        f"{zeros[1]:.2f} deg (nu = 0.34), beside an equilateral one at {zeros[2]:.2f} and "
        f"{zeros[3]:.2f} deg; of {len(scanned)} sheets {borne} are stable with a negative "
        f"side; the sign "
        f"of the least side is wrong in {wrong}; eigenvalue and run disagree in {differ}"
    )


def draw(rows: list[list], curves: dict[str, list[tuple[float, float]]], path: Path) -> None:
    """Stable and unstable sheets over apex angle and Poisson's ratio."""
    drawing, axes = figure(columns=2)
    for axis, kind in zip(axes[0], ("uniform", "mixed")):
        for stable, color in ((1, "C0"), (0, "C3")):
            points = [r for r in rows if r[0] == kind and r[5] == stable]
            label = "stable" if stable else "unstable"
            axis.plot([r[1] for r in points], [r[2] for r in points], "s", color=color, label=label)
        runs = [r for r in rows if r[0] == kind and not r[6]]
        axis.plot([r[1] for r in runs], [r[2] for r in runs], "kx", label="run grows")
        axis.plot(
            [angle for _, angle in curves[kind]],
            [poisson for poisson, _ in curves[kind]],
            "k-",
            label="predicted: stiffness of the base 0",
        )
        title = "all triangles flat" if kind == "uniform" else "between equilateral rows"
        axis.set(xlabel="apex angle [deg]", ylabel="Poisson's ratio [-]", title=title)
    axes[0, 0].legend(fontsize=7)
    save(drawing, path)
