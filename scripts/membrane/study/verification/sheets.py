# SPDX-License-Identifier: GPL-2.0-or-later
"""Sheets of triangles: what modulus, Poisson ratio and stiffness the springs of (5) amount to.

The small-strain stiffness matrix of a sheet is assembled from the plugin's sides and stiffnesses.
Its boundary nodes take an affine displacement, the inner ones go to equilibrium, and the energy
gives the sheet's mean stiffness, of which the moduli follow. A petal of the sail, fixed at its
inner edge and pulled at its outer one, is compared with plane-stress finite elements: those of
CalculiX, and in the fast run constant-strain triangles of our own, which are held against CalculiX
in the full one.
"""

import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

import membrane
import numpy as np
from membrane import geometry, scene
from membrane.mesh import sail_mesh
from scipy import sparse
from scipy.sparse.linalg import spsolve

from ..sources import paper
from . import Check, at_most, recorded

YOUNG, POISSON, THICKNESS = 3.2e9, 0.34, 7.5e-6
POISSONS = (-0.5, 0.0, 0.2, 1 / 3, 0.34, 0.5)
CELLS = 12  # of a square sheet; the boundary is affine, so even lattices do not depend on it
LENGTH = 0.02  # of a cell [m]
REFINES, FAST_REFINES = (1, 2, 4), (1,)
LOAD = 1.0  # on the outer edge of the petal [N]
PULL = 1e-5  # displacement of the outer edge [m]

MODULI = (
    "uniaxial along x, modulus / E",
    "uniaxial along x, Poisson ratio",
    "uniaxial along y, modulus / E",
    "uniaxial along y, Poisson ratio",
    "equibiaxial, modulus / (E / (1 - nu))",
    "shear, modulus / G",
    "shear at 45 degrees, modulus / G",
)
ANSWERS = ("displacement of outer edge", "reaction to its displacement")

EXACT = 1e-9
DIGITS = 1e-5  # CalculiX prints seven digits
UNCHANGED = 1e-6
WHY = "linear, so it changes only with (5) or the mesh"


# --- sheets ---


def square_sheet(diagonals: str) -> tuple[np.ndarray, np.ndarray]:
    """Flat square sheet of CELLS x CELLS cells, cut in two: nodes (N, 3) [m], triangles (T, 3).

    diagonals: 'one', all alike, or 'alternating', every second one crosswise (union jack).
    """
    rows = CELLS + 1
    i, j = (axis.ravel() for axis in np.mgrid[:rows, :rows])
    nodes = LENGTH * np.column_stack([i, j, np.zeros(rows * rows)])
    i, j = (axis.ravel() for axis in np.mgrid[:CELLS, :CELLS])
    a = i * rows + j
    b, c, d = a + rows, a + rows + 1, a + 1
    return nodes, halves((a, b, c, d), ((i + j) % 2 == 1) & (diagonals == "alternating"))


def halves(corners: tuple[np.ndarray, ...], cross: np.ndarray) -> np.ndarray:
    """Triangles (2 n, 3) of cells with four corners (n,) in order, cut from the first to the third.

    Those that are `cross` (n,) are cut from the second to the fourth.
    """
    a, b, c, d = corners
    first = np.column_stack([a, b, np.where(cross, d, c)])
    second = np.column_stack([np.where(cross, b, a), c, d])
    return np.concatenate([first, second])


def equilateral_sheet() -> tuple[np.ndarray, np.ndarray]:
    """Parallelogram of equilateral triangles: nodes (N, 3) [m], triangles (T, 3)."""
    nodes, triangles = square_sheet("one")
    # The diagonal from (0, 0) to (1, 1) becomes as long as the sides at 120 degrees to each other.
    x, y, z = nodes.T
    return np.column_stack([x - 0.5 * y, np.sqrt(0.75) * y, z]), triangles


def petal(refine: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Petal 0 of the paper's sail: nodes (N, 3) [m], triangles (T, 3), nodes of both edges.

    The edges, inner and outer, run in order.
    """
    mesh = sail_mesh(refine=refine)
    kept = np.unique(np.concatenate([row[0] for row in mesh.rows]))
    number = np.full(len(mesh.nodes), -1)
    number[kept] = np.arange(len(kept))
    triangles = number[mesh.triangles]
    triangles = triangles[np.all(triangles >= 0, axis=1)]
    return mesh.nodes[kept], triangles, number[mesh.rows[0][0]], number[mesh.rows[-1][0]]


# --- stiffness matrices, degrees of freedom x0, y0, x1, y1, … ---


def springs(
    nodes: np.ndarray, triangles: np.ndarray, poisson: float = POISSON
) -> tuple[np.ndarray, np.ndarray, float]:
    """The plugin's sides (S, 2), their stiffnesses (S,) [N/m], and the area of the sheet [m2]."""
    net = membrane.Membrane(
        material=scene.film(YOUNG, poisson, 1420.0, THICKNESS),
        nodes=nodes.tolist(),
        triangles=triangles.tolist(),
        allowNegativeStiffness=True,
    )
    return np.array(net.sides), np.array(net.stiffnesses), net.area


def assemble(count: int, corners: np.ndarray, blocks: np.ndarray) -> sparse.csr_matrix:
    """Sparse matrix (2 count, 2 count) from blocks (E, 2 c, 2 c) on nodes corners (E, c)."""
    freedoms = (2 * corners[:, :, None] + np.arange(2)).reshape(len(corners), -1)
    places = np.broadcast_arrays(freedoms[:, :, None], freedoms[:, None, :])
    shape = (2 * count, 2 * count)
    return sparse.csr_matrix((blocks.ravel(), tuple(map(np.ravel, places))), shape=shape)


def spring_matrix(
    nodes: np.ndarray, triangles: np.ndarray, poisson: float = POISSON
) -> sparse.csr_matrix:
    """Stiffness matrix [N/m] of the springs at rest: k n n^T on both ends of each side."""
    sides, stiffness, _ = springs(nodes, triangles, poisson)
    along = (nodes[sides[:, 1]] - nodes[sides[:, 0]])[:, :2]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    stretch = np.concatenate([-along, along], axis=1)
    blocks = stiffness[:, None, None] * stretch[:, :, None] * stretch[:, None, :]
    return assemble(len(nodes), sides, blocks)


def film_matrix(
    nodes: np.ndarray, triangles: np.ndarray, poisson: float = POISSON
) -> sparse.csr_matrix:
    """Stiffness matrix [N/m] of constant-strain triangles in plane stress."""
    corners = nodes[triangles][:, :, :2]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    area = 0.5 * (opposite[:, 0, 0] * opposite[:, 1, 1] - opposite[:, 0, 1] * opposite[:, 1, 0])
    slope = np.stack([-opposite[..., 1], opposite[..., 0]], axis=2) / (2 * area)[:, None, None]
    strain = np.zeros((len(triangles), 3, 6))
    strain[:, 0, 0::2], strain[:, 1, 1::2] = slope[..., 0], slope[..., 1]
    strain[:, 2, 0::2], strain[:, 2, 1::2] = slope[..., 1], slope[..., 0]
    film = np.array([[1, poisson, 0], [poisson, 1, 0], [0, 0, 0.5 * (1 - poisson)]])
    weighted = area[:, None, None] * (YOUNG * THICKNESS / (1 - poisson**2) * film @ strain)
    return assemble(len(nodes), triangles, np.swapaxes(strain, 1, 2) @ weighted)


def equilibrium(
    matrix: sparse.csr_matrix,
    known: np.ndarray,
    values: np.ndarray | float,
    load: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Displacements (2 N,) [m] under a load (2 N,) [N], with `values` at the freedoms `known`."""
    free = np.setdiff1d(np.arange(matrix.shape[0]), known)
    moved = np.zeros(matrix.shape[0])
    moved[known] = values
    force = np.broadcast_to(load, moved.shape) - matrix @ moved
    moved[free] = spsolve(matrix[free][:, free].tocsc(), force[free])
    return moved


# --- moduli of a sheet ---


def lattice_stiffness(triangle: np.ndarray, diagonals: str, poisson: float = POISSON) -> np.ndarray:
    """Stiffness (3, 3) [N/m] of an endless sheet of copies of a triangle, in closed form.

    triangle: corners (3, 2) [m], the last two sides along those of the cell, which two triangles
    fill. diagonals: 'one', or 'alternating', where the first side leans either way. Each side
    belongs to two triangles; every node is a centre of symmetry, so nothing moves but affinely.
    """
    spans = np.roll(triangle, -2, axis=0) - np.roll(triangle, -1, axis=0)
    length = np.linalg.norm(spans, axis=1)
    area = 0.5 * abs(np.cross(spans[0], spans[1]))
    shares = paper.triangle_stiffness(length[None], YOUNG, poisson, THICKNESS)[0]
    x, y = spans.T
    stretch = np.column_stack([x * x, y * y, x * y]) / length[:, None]
    total = (stretch.T * shares) @ stretch / area
    if diagonals == "alternating":
        total[2, :2] = total[:2, 2] = 0.0
    return total


def mean_stiffness(
    nodes: np.ndarray, triangles: np.ndarray, poisson: float = POISSON
) -> np.ndarray:
    """Stiffness (3, 3) [N/m] of a sheet of springs for mean strains xx, yy and 2 xy."""
    matrix = spring_matrix(nodes, triangles, poisson)
    area = geometry.triangle_areas(nodes, triangles).sum()
    sides, _, shares = geometry.unique_sides(triangles)
    boundary = np.unique(sides[shares == 1])
    known = np.concatenate([2 * boundary, 2 * boundary + 1])
    x, y, _ = nodes.T
    strains = (x, 0 * x), (0 * x, y), (0.5 * y, 0.5 * x)
    affine = [np.column_stack(field).ravel() for field in strains]
    fields = np.array([equilibrium(matrix, known, field[known]) for field in affine])
    return fields @ (matrix @ fields.T) / area


def moduli(stiffness: np.ndarray) -> tuple[float, ...]:
    """Numbers named by MODULI of a sheet with a stiffness (3, 3) [N/m]."""
    s = YOUNG * THICKNESS * np.linalg.inv(stiffness)
    return (
        1 / s[0, 0],
        -s[1, 0] / s[0, 0],
        1 / s[1, 1],
        -s[0, 1] / s[1, 1],
        2 * (1 - POISSON) / s[:2, :2].sum(),
        2 * (1 + POISSON) / s[2, 2],
        2 * (1 + POISSON) / (s[0, 0] + s[1, 1] - 2 * s[0, 1]),
    )


# --- single triangles ---


def energy_error(corners: np.ndarray, poisson: float) -> float:
    """Largest error [-] of the energy of a triangle's springs in stress along each side."""
    sides, stiffness, area = springs(corners, np.array([[0, 1, 2]]), poisson)
    span = corners[sides[:, 1]] - corners[sides[:, 0]]
    length = np.linalg.norm(span, axis=1)
    along = span / length[:, None]
    errors = []
    for pulled in along:
        stress = YOUNG * 1e-3 * np.outer(pulled, pulled)
        strain = ((1 + poisson) * stress - poisson * np.trace(stress) * np.eye(3)) / YOUNG
        stretch = np.einsum("si,ij,sj->s", along, strain, along) * length
        film = 0.5 * np.trace(stress) ** 2 / YOUNG * THICKNESS * area
        errors.append(abs(0.5 * np.sum(stiffness * stretch**2) / film - 1))
    return max(errors)


def worst_energy_error(count: int = 50) -> float:
    """Worst energy_error over `count` random triangles for each of POISSONS."""
    rng = np.random.default_rng(11)
    errors = []
    for poisson in np.repeat(POISSONS, count).tolist():
        corners = np.zeros((3, 3))
        while geometry.triangle_angles(corners, np.array([[0, 1, 2]])).min() < 0.1:
            corners[:, :2] = rng.normal(size=(3, 2))
        errors.append(energy_error(corners, poisson))
    return max(errors)


# --- the petal under load ---


def petal_load(nodes: np.ndarray, outer: np.ndarray) -> np.ndarray:
    """Forces (N, 2) [N] of LOAD along +x, even on the outer edge (nodes in order)."""
    length = np.linalg.norm(np.diff(nodes[outer], axis=0), axis=1)
    half = 0.5 * (LOAD * length / length.sum())
    force = np.zeros((len(nodes), 2))
    force[outer, 0] = np.append(half, 0.0) + np.append(0.0, half)
    return force


def petal_answers(
    matrix: sparse.csr_matrix, nodes: np.ndarray, inner: np.ndarray, outer: np.ndarray
) -> tuple[float, float]:
    """Mean displacement [m] of the outer edge under LOAD, and reaction [N] to PULL.

    The first is the load's work over the load, so twice the energy over the load. In the second the
    whole edge moves by PULL along x and not along y; twice the energy is the reaction times PULL.
    """
    fixed = np.concatenate([2 * inner, 2 * inner + 1])
    load = petal_load(nodes, outer).ravel()
    moved = equilibrium(matrix, fixed, 0.0, load)
    held = np.concatenate([fixed, 2 * outer, 2 * outer + 1])
    values = np.repeat([0.0, PULL, 0.0], [len(fixed), len(outer), len(outer)])
    pulled = equilibrium(matrix, held, values)
    return moved @ load / LOAD, (matrix @ pulled)[2 * outer].sum()


def run_calculix(
    nodes: np.ndarray,
    elements: np.ndarray,
    inner: np.ndarray,
    edge: np.ndarray,
    poisson: float,
    act: Iterable[str],
) -> tuple[np.ndarray, np.ndarray]:
    """Displacements (len(edge), 2) [m] and total reaction (2,) [N] of plane-stress elements.

    By CalculiX, which prints them: elements (E, 3 or 6), `inner` fixed; lines `act` load them.
    """
    numbered = np.column_stack([np.arange(len(elements)), elements]) + 1
    lines = [
        "*NODE",
        *(f"{n + 1}, {x:.12g}, {y:.12g}" for n, (x, y, _) in enumerate(nodes.tolist())),
        f"*ELEMENT, TYPE=CPS{elements.shape[1]}, ELSET=FILM",
        *(", ".join(map(str, row)) for row in numbered.tolist()),
        *("*NSET, NSET=INNER", *(f"{n + 1}," for n in inner)),
        *("*NSET, NSET=EDGE", *(f"{n + 1}," for n in edge)),
        *("*MATERIAL, NAME=FILM", "*ELASTIC", f"{YOUNG!r}, {poisson!r}"),
        *("*SOLID SECTION, ELSET=FILM, MATERIAL=FILM", f"{THICKNESS!r}"),
        *("*BOUNDARY", "INNER, 1, 2", "*STEP", "*STATIC", *act),
        *("*NODE PRINT, NSET=EDGE", "U", "*NODE PRINT, NSET=INNER, TOTALS=ONLY", "RF"),
        *("*END STEP", ""),
    ]
    with tempfile.TemporaryDirectory(prefix="calculix-") as folder:
        Path(folder, "petal.inp").write_text("\n".join(lines), encoding="utf-8")
        done = subprocess.run(
            ["ccx", "petal"], cwd=folder, capture_output=True, encoding="utf-8", timeout=300
        )
        results = Path(folder, "petal.dat")
        printed = results.read_text(encoding="utf-8") if results.exists() else ""
    rows = [line.split() for line in printed.splitlines() if line and "(" not in line]
    if done.returncode or [len(row) for row in rows] != [4] * len(edge) + [3]:
        raise RuntimeError(f"CalculiX failed: {done.stdout[-1000:]}{done.stderr[-1000:]}")
    numbers = [[float(word) for word in row] for row in rows]
    return np.array(numbers[:-1])[:, 1:3], np.array(numbers[-1][:2])


def calculix_answers(
    nodes: np.ndarray,
    triangles: np.ndarray,
    inner: np.ndarray,
    outer: np.ndarray,
    order: int,
    poisson: float = POISSON,
) -> tuple[float, float]:
    """What petal_answers gives, by CalculiX with elements of first or second `order`."""
    if order == 2:
        sides, sides_of, _ = geometry.unique_sides(triangles)
        middles = 0.5 * (nodes[sides[:, 0]] + nodes[sides[:, 1]])
        number = {tuple(side): len(nodes) + n for n, side in enumerate(sides.tolist())}
        triangles = np.column_stack([triangles, len(nodes) + sides_of])
        nodes = np.concatenate([nodes, middles])

        def all_on(row: np.ndarray) -> np.ndarray:
            pairs = np.sort(np.column_stack([row[:-1], row[1:]])).tolist()
            return np.append(row, [number[a, b] for a, b in pairs])

        inner, edge = all_on(inner), all_on(outer)
        cells = len(outer) - 1
        ends = np.r_[0.5, np.ones(cells - 1), 0.5]  # even cells: Simpson's weights
        load = LOAD / cells * np.concatenate([ends / 3, np.full(cells, 2 / 3)])
    else:
        edge, load = outer, petal_load(nodes, outer)[outer, 0]
    mesh = nodes, triangles, inner, edge, poisson
    loaded = ["*CLOAD", *(f"{n + 1}, 1, {force:.12g}" for n, force in zip(edge, load))]
    moved, reaction = run_calculix(*mesh, loaded)
    if abs(reaction[0] + LOAD) > 1e-5 * LOAD:
        raise RuntimeError(f"CalculiX: reaction {reaction[0]} N to a load of {LOAD} N")
    pulled = ["*BOUNDARY", f"EDGE, 1, 1, {PULL!r}", "EDGE, 2, 2"]
    _, reaction = run_calculix(*mesh, pulled)
    return moved[:, 0] @ load / LOAD, -reaction[0]


# --- checks ---

# What `scripts/run.sh verify --only sheets` measured with version 0.1.0. They are no targets: these
# sheets are what (5) makes of their triangles. First the numbers of MODULI; petals by refinement.
LAST_MODULI = {
    "equilateral": (0.9999500, 0.3333333, 0.9999500, 0.3333333, 0.9899505, 1.0049498, 1.0049498),
    "right-angled, one diagonal": (0.8161141, 0, 0.8161141, 0, 0.5386353, 0.3663536, 1.0935930),
    "right-angled, alternating diagonals": (
        *(0.9803173, 0.2012012, 0.9803173, 0.2012012, 0.8099779, 0.5509077, 1.0935930),
    ),
    1: (0.9499319, 0.1766048, 0.9641832, 0.1792543, 0.7683227, 0.4798882, 1.0886871),
    2: (0.9449493, 0.1709602, 0.9599398, 0.1736723, 0.7594282, 0.4763972, 1.0886211),
    4: (0.9441668, 0.1700982, 0.9593266, 0.1728293, 0.7580896, 0.4758208, 1.0886137),
}
# Then ANSWERS of the petal's springs over those of finite elements, by refinement and element.
LAST_PETAL = {
    (1, "own triangles"): (1.1171363, 0.9690158),
    (1, "CPS3"): (1.1213365, 0.9663711),
    (1, "CPS6"): (1.0432919, 1.0076015),
    (2, "own triangles"): (1.1045163, 0.9673650),
    (2, "CPS3"): (1.1064062, 0.9662446),
    (2, "CPS6"): (1.0770136, 0.9838790),
    (4, "own triangles"): (1.1000586, 0.9683719),
    (4, "CPS3"): (1.1007717, 0.9679049),
    (4, "CPS6"): (1.0903744, 0.9754580),
}

CONSTANT_STRAIN = "constant-strain triangles in plane stress on the same mesh; " + WHY
CALCULIX = "CalculiX, plane stress on the same mesh; " + WHY + " or seven printed digits"

RIGHT = LENGTH * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
# Nodes and triangles, the triangle of the lattice, and its diagonals.
SHEETS: dict[str, tuple] = {
    "equilateral": (equilateral_sheet(), RIGHT @ [[1.0, 0.0], [0.5, np.sqrt(0.75)]], "one"),
    # Its diagonal runs from corner to corner of the cell: up to the right, as in square_sheet.
    "right-angled, one diagonal": (square_sheet("one"), RIGHT * [-1, 1], "one"),
    "right-angled, alternating diagonals": (square_sheet("alternating"), RIGHT, "alternating"),
}


def triangle_checks() -> list[Check]:
    """Single triangles, and sheets of equal ones against closed forms."""
    energy = "sigma2 h S / (2 E) in uniaxial stress along each side, which defines (5)"
    found = [at_most("triangles: error of energy", worst_energy_error(), 1e-12, energy)]
    for name, (sheet, *lattice) in SHEETS.items():
        exact = lattice_stiffness(*lattice)
        error = np.abs(mean_stiffness(*sheet) - exact).max() / exact.max()
        source = "lattice sum of k L2 n n n n over the area"
        found.append(at_most(f"{name}: error of mean stiffness", error, EXACT, source))
    ratios = []
    for poisson in POISSONS:
        s = YOUNG * THICKNESS * np.linalg.inv(mean_stiffness(*equilateral_sheet(), poisson))
        ratios.append(-s[1, 0] / s[0, 0])
        title = f"equilateral, nu = {poisson:.3g}: modulus / E"
        target = 1 / (1 + (1 - 3 * poisson) ** 2 / 8)
        found.append(Check(title, 1 / s[0, 0], target, EXACT, "1 / (1 + (1 - 3 nu)2 / 8)"))
    worst = max(ratios, key=lambda ratio: abs(ratio - 1 / 3))
    title = "equilateral, any nu: Poisson ratio farthest from 1/3"
    source = "Cauchy's relation of central forces: whatever nu of the film"
    return [*found, Check(title, worst, 1 / 3, EXACT, source)]


def sheet_checks(refines: Sequence[int]) -> list[Check]:
    """Moduli of sheets and petals, recorded."""
    sheets: list[tuple] = [(name, sheet, name) for name, (sheet, *_) in SHEETS.items()]
    sheets += [(f"petal, refine {n}", petal(n)[:2], n) for n in refines]
    found = []
    for name, sheet, key in sheets:
        values = moduli(mean_stiffness(*sheet))
        for title, value, last in zip(MODULI, values, LAST_MODULI[key]):
            source = f"film: {POISSON if 'Poisson' in title else 1:g}; {WHY}"
            found.append(recorded(f"{name}: {title}", value, last, UNCHANGED, source))
    return found


def petal_checks(refines: Sequence[int], calculix: bool) -> list[Check]:
    """Displacement and reaction of the petal over those by finite elements, recorded."""
    found = []
    for n in refines:
        nodes, triangles, inner, outer = petal(n)
        springs_say = petal_answers(spring_matrix(nodes, triangles), nodes, inner, outer)
        film_says = petal_answers(film_matrix(nodes, triangles), nodes, inner, outer)
        others = {"own triangles": (film_says, CONSTANT_STRAIN, UNCHANGED)}
        for order, element in ((1, "CPS3"), (2, "CPS6")) if calculix else ():
            answers = calculix_answers(nodes, triangles, inner, outer, order)
            others[element] = answers, CALCULIX, DIGITS
        for element, (answers, source, tolerance) in others.items():
            ratios = np.divide(springs_say, answers)
            for title, ratio, last in zip(ANSWERS, ratios, LAST_PETAL[n, element]):
                name = f"petal, refine {n}: {title}, springs / {element}"
                found.append(recorded(name, ratio, last, tolerance, source))
    return found


def calculix_checks() -> list[Check]:
    """CalculiX against our own triangles, where the two must agree.

    CalculiX gives plane-stress elements a thickness strain that is continuous from one to the next;
    without lateral contraction that makes no difference.
    """
    found = []
    for n in (1, 2):
        nodes, triangles, inner, outer = petal(n)
        ours = petal_answers(film_matrix(nodes, triangles, 0.0), nodes, inner, outer)
        theirs = calculix_answers(nodes, triangles, inner, outer, 1, 0.0)
        for title, a, b in zip(ANSWERS, ours, theirs):
            name = f"petal, refine {n}, nu = 0: {title}, own triangles / CPS3"
            found.append(Check(name, a / b, 1.0, DIGITS, "CalculiX"))
    return found


def checks(full: bool) -> list[Check]:
    """Checks of sheets and of the petal; `full`, finer petals too, and CalculiX where it is."""
    refines = REFINES if full else FAST_REFINES
    calculix = full and shutil.which("ccx") is not None
    if full and not calculix:
        print("verify: CalculiX (ccx) is not here: what it is to be held against is left out")
    found = triangle_checks() + sheet_checks(refines) + petal_checks(refines, calculix)
    return found + (calculix_checks() if calculix else [])
