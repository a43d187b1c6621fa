# SPDX-License-Identifier: GPL-2.0-or-later
"""Meshes of gmsh (.msh, versions 2 to 2.2, 4.0 and 4.1, text or binary), read by gmsh itself.

gmsh is silent about what it leaves out of a damaged file, so what it gives is held against the
file's sections. In version 2 it would give a group that some elements of a curve or surface are in
to all of them: there the elements are taken from the file, as they are.

Physical groups of curves named M or mountain, V or valley become creases; all named groups are
kept by name, so that a group of points "tips" can bear masses and a group "hub" be driven.
"""

import os
import re
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .files import BadFile, read_bytes, shown
from .geometry import MOUNTAIN, VALLEY, area_vectors, cut_quadrangles, nearness
from .geometry import pieces, twins, unique_sides
from .gmsh_process import GmshError, in_gmsh
from .orientation import faces_to_turn, laid_down, plane_normal
from .pattern_mesh import SheetMesh

CREASES = {"m": MOUNTAIN, "mountain": MOUNTAIN, "v": VALLEY, "valley": VALLEY}
FARTHEST = 1e12  # of coordinates, in any unit
SECTIONS = ("MeshFormat", "PhysicalNames", "Entities", "PartitionedEntities")
SECTIONS += ("Nodes", "ParametricNodes", "Elements")
NAME = re.compile(r'^ *([0-3]) +(-?\d{1,9}) +"([^"]{1,200})" *\r?$', re.MULTILINE)
BEGINS = re.compile(r"^Info: \d+ (entities|nodes|elements)$")
READ = "versions 2 to 2.2, 4.0 and 4.1 are read"


def read_msh(path, unit=1.0):
    """Read a triangulated sheet.

    Quadrangles are cut in two, of elements of higher order the corners are taken; nodes that no
    triangle has are left out. A flat sheet is turned into a plane z = const if it lies in another
    one, and all its triangles counter-clockwise seen from +z.

    Parameters
    ----------
    path : path
    unit : float
        Length of the file's unit [m].

    Returns
    -------
    SheetMesh

    Raises
    ------
    BadFile
        Whatever is wrong, in one sentence.
    OSError
        If the file cannot be opened.
    """
    if not (np.isfinite(unit) and unit > 0):
        raise ValueError(f"unit = {unit} m: must be finite and > 0")
    content = read_bytes(path).lstrip()
    try:
        sections = _sections(content)
        version, binary = _format(sections["MeshFormat"])
        names = _names(sections.get("PhysicalNames"))
        points, blocks = in_gmsh(_read, content, version, binary)
        return _sheet(unit * points, blocks, names, version)
    except GmshError as error:
        raise BadFile(path, "", f"gmsh cannot read it: {error}") from None
    except ValueError as error:
        raise BadFile(path, "", str(error)) from None


# ------------------------------------------------------------------------- the file as it is


def _sections(content):
    """Contents (bytes) of the SECTIONS that there are, by name."""
    # Whatever begins otherwise gmsh would run as a script.
    if not content.startswith((b"$MeshFormat", b"$Comments")):
        raise ValueError("does not begin with $MeshFormat: it is no mesh of gmsh")
    found = {}
    for name in SECTIONS:
        begin = list(re.finditer(rb"(?m)^\$%s[ \t\r]*\n" % name.encode(), content))
        if len(begin) > 1:
            raise ValueError(f"${name}: is there twice")
        if begin:
            end = content.find(b"$End" + name.encode(), begin[0].end())
            if end < 0:
                raise ValueError(f"${name}: is cut off: there is no $End{name}")
            found[name] = content[begin[0].end() : end]
    for name in ("MeshFormat", "Nodes", "Elements"):
        if not {name, f"Parametric{name}"} & set(found):
            raise ValueError(f"${name}: is missing")
    return found


def _format(section):
    """Version as a number, and whether the file is binary."""
    line, _, rest = section.partition(b"\n")
    words = line.split() or [b""]
    try:
        version = float(words[0])
    except ValueError:
        version = np.nan
    if not (2 <= version <= 2.2 or version in (4.0, 4.1)):
        told = shown(words[0].decode("ascii", "replace"))
        raise ValueError(f"$MeshFormat: is of version {told}; {READ}")
    if words[1:] not in ([b"0", b"8"], [b"1", b"8"]):
        raise ValueError("$MeshFormat: must be text or binary (0 or 1), of size 8")
    binary = words[1] == b"1"
    if binary and not rest.startswith(np.array([1], "<i4").tobytes()):
        raise ValueError("$MeshFormat: has the bytes of its numbers reversed")
    return version, binary


def _names(section):
    """Names of physical groups: list of (name, dimension, tag)."""
    if section is None:
        return []
    text = section.decode("utf-8", "replace")
    names = [(name, int(dim), int(tag)) for dim, tag, name in NAME.findall(text)]
    if text.split()[:1] != [str(len(names))] or len(text.strip().splitlines()) != 1 + len(names):
        raise ValueError("$PhysicalNames: does not hold the names that its count says")
    return names


# -------------------------------------------------------------------- in a process of its own


class _Kind(NamedTuple):
    """Of elements; `nodes`: how many each has, the first `corners` of them at its corners."""

    dimension: int
    order: int
    nodes: int
    corners: int


def _read(gmsh, content, version, binary):
    """Points (N, 3) and blocks of elements of a file's content.

    A block is the _Kind of its elements, their corners (n, k) as rows of the points, and the tags
    of the groups that they are in.
    """
    sections = _sections(content)

    @lru_cache(None)
    def kind_of(number):
        return _kind_of(gmsh, number)

    if version < 4:
        _check_nodes_of_version_2(sections, binary)
        found = _elements_of_version_2(sections["Elements"], binary, kind_of)
    _load(gmsh, content)
    if version >= 4:
        found = _elements_of_version_4(gmsh, sections["Elements"], version, binary, kind_of)
    tags, points, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    tags, points = tags[order].astype(int), points.reshape(-1, 3)[order]
    if not np.all(np.abs(points) <= FARTHEST):
        row = int(np.argmax(~np.all(np.abs(points) <= FARTHEST, axis=1)))
        raise ValueError(f"$Nodes: node {tags[row]} lies at {points[row].tolist()}")
    blocks = []
    for kind, nodes, groups in found:
        corners = nodes[:, : kind.corners]
        rows = np.searchsorted(tags, corners).clip(max=len(tags) - 1)
        if np.any(tags[rows] != corners):
            raise ValueError("$Elements: names a node that is not in $Nodes")
        blocks.append((kind, rows, groups))
    return points, blocks


def _load(gmsh, content):
    """Let gmsh read a file's content."""
    file = os.memfd_create("mesh")
    with os.fdopen(os.dup(file), "wb") as stream:
        stream.write(content)
    gmsh.logger.start()
    raised = None
    try:
        gmsh.merge(f"/proc/self/fd/{file}")
    except Exception as error:  # gmsh raises Exception itself
        raised = str(error)
    lines = gmsh.logger.get()
    told = [line for line in lines if line.startswith("Error") or "duplicate" in line]
    if raised is None and not told:
        return
    if lost := re.search(r"node index (\d+)", raised or ""):
        raise ValueError(f"$Elements: names node {lost[1]}, which is not in $Nodes")
    # It says how many there are when it begins to read them.
    begun = [found[1] for line in lines if (found := BEGINS.search(line))]
    place = f"${begun[-1].capitalize()}: " if begun else ""
    reason = raised if raised is not None else told[0].partition(": ")[2]
    plain = not reason or "/proc/" in reason
    raise ValueError(f"{place}gmsh cannot read it: {'it is damaged' if plain else reason}")


def _kind_of(gmsh, number):
    """The _Kind that a number stands for."""
    try:
        about = gmsh.model.mesh.getElementProperties(number)
    except Exception:
        raise ValueError(f"$Elements: has elements of kind {number}, which is unknown") from None
    name, dimension, order, nodes, _, corners = about
    if dimension == 3 or not dimension < corners <= 4:
        raise ValueError(
            f"$Elements: has elements of kind {number} ({name}); a sheet has points, lines, "
            "triangles and quadrangles"
        )
    return _Kind(dimension, order, nodes, corners)


def _elements_of_version_4(gmsh, section, version, binary, kind_of):
    """Blocks of elements as gmsh has read them: _Kind, nodes by tag (n, k), groups."""
    found = []
    for entity in gmsh.model.getEntities():
        groups = gmsh.model.getPhysicalGroupsForEntity(*entity).tolist()
        kinds, _, nodes = gmsh.model.mesh.getElements(*entity)
        for kind, tags in zip(map(kind_of, kinds.tolist()), nodes):
            found.append((kind, tags.astype(int).reshape(-1, kind.nodes), groups))
    entries = sum(len(nodes) * (1 + kind.nodes) for kind, nodes, _ in found)
    head, word = (4, 8) if version == 4.1 else (2, 4)  # numbers before all, bytes of a tag
    if binary:
        expected = 8 * head + 20 * int.from_bytes(section[:8], "little") + word * entries
        there = len(section) - len("\r\n")
    else:
        words = section.split()
        expected, there = head + 4 * int(words[0]) + entries, len(words)
    if there > expected:
        raise ValueError("$Elements: holds more than its counts say")
    return found


def _check_nodes_of_version_2(sections, binary):
    """Refuse another number of nodes than the count, by which gmsh crashes."""
    if "Nodes" not in sections:
        return
    first, _, rest = sections["Nodes"].partition(b"\n")
    size, left = (28, rest) if binary else (4, rest.split())
    if not (first.strip().isdigit() and int(first) == len(left) // size):
        raise ValueError("$Nodes: does not hold as many numbers as its count says")


def _elements_of_version_2(section, binary, kind_of):
    """Blocks of elements as the file has them: _Kind, nodes by tag (n, k), groups."""
    first, _, rest = section.partition(b"\n")
    try:
        left = int(first)
        words = np.frombuffer(rest, "<i4", len(rest) // 4) if binary else map(int, rest.split())
        numbers = np.array(list(words), dtype=int)
    except (ValueError, OverflowError):
        raise ValueError("$Elements: has something else where a whole number must be") from None
    found, at = {}, 0
    while left > 0 and at + 3 <= len(numbers):
        # In binary elements of a kind share a head, and each begins with its own number.
        one, two, marks = numbers[at : at + 3].tolist()
        (number, size), own = ((one, two), 1) if binary else ((two, 1), 0)
        kind = kind_of(number)
        width = own + marks + kind.nodes
        rows = numbers[at + 3 : at + 3 + size * width]
        if not (0 <= marks <= 100 and 1 <= size <= left and len(rows) == size * width):
            break
        rows = rows.reshape(size, width)
        groups = np.abs(rows[:, own]) if marks else np.zeros(size, dtype=int)
        for group in np.unique(groups):
            chosen = rows[groups == group, -kind.nodes :]
            found.setdefault((kind, int(group)), []).append(chosen)
        at, left = at + 3 + size * width, left - size
    if left or at != len(numbers):
        raise ValueError("$Elements: does not hold as many numbers as its counts say")
    return [(kind, np.concatenate(rows), [group]) for (kind, group), rows in found.items()]


# ---------------------------------------------------------------------------------- the sheet


def _sheet(points, blocks, names, version):
    """The SheetMesh of points (N, 3) [m] and what `_read` gives."""
    _check_repeats(points, blocks)
    groups, notes = _groups(blocks, names), []
    triangles = _triangles(points, blocks)
    used = np.unique(triangles)
    row = np.full(len(points), -1)
    row[used] = np.arange(len(used))
    creases, signs = _creases(points, triangles, groups)
    order = max(kind.order for kind, *_ in blocks)
    if order > 1:
        notes.append(f"the elements are of order {order}: their corners are taken")
    if not names and any(max(tags, default=0) for *_, tags in blocks):
        notes.append("the physical groups have no names: none is used")
    lost = [name for name, *_ in names if not any(name == other for other, _ in groups)]
    if lost:
        saved = "; version 2 with Mesh.SaveAll loses them: save version 4.1" if version < 4 else ""
        notes.append(f"no elements are in the groups {', '.join(lost)}{saved}")
    points, triangles = _right_way_up(points[used], row[triangles], notes)
    _check_surface(points, triangles, notes)
    nodes = {}
    for (name, _), rows in groups.items():
        nodes.setdefault(name, []).append(row[np.unique(rows)])
    return SheetMesh(
        nodes=points,
        triangles=triangles,
        creases=row[creases],
        crease_signs=signs,
        groups={name: _there(rows) for name, rows in nodes.items()},
        others=tuple(name for name, dim in groups if dim < 2 and not _is_crease(name, dim)),
        notes=tuple(notes),
    )


def _there(rows):
    """Of lists of rows those that are there (>= 0), each once, (n,)."""
    found = np.unique(np.concatenate(rows))
    return found[found >= 0]


def _where(corners):
    """The middle of some corners (n, 3) in words."""
    return f"at ({', '.join(f'{x:.4g}' for x in np.mean(corners, axis=0) + 0.0)}) m"


def _check_repeats(points, blocks):
    """Refuse an element with a node twice, and one that a group has twice: another may be lost."""
    for kind, rows, _ in blocks:
        ordered = np.sort(rows, axis=1)
        same = np.any(np.diff(ordered, axis=1) == 0, axis=1)
        if np.any(same):
            raise ValueError(f"$Elements: one {_where(points[rows[same][0]])} has a node twice")
        _, first = np.unique(ordered, axis=0, return_index=True)
        if kind.dimension and len(first) < len(rows):
            again = rows[np.setdiff1d(np.arange(len(rows)), first)[0]]
            raise ValueError(f"$Elements: one {_where(points[again])} is there twice")


def _groups(blocks, names):
    """Nodes of the elements of each named group, row by row, (n, k) by (name, dimension)."""
    name_of, found = {(dim, tag): name for name, dim, tag in names}, {}
    for kind, rows, tags in blocks:
        for tag in tags:
            name = name_of.get((kind.dimension, abs(tag)))
            if name is not None:
                found.setdefault((name, kind.dimension), []).append(rows.ravel())
    return {about: np.concatenate(rows) for about, rows in found.items()}


def _is_crease(name, dimension):
    return dimension == 1 and name.lower() in CREASES


def _creases(points, triangles, groups):
    """Sides on creases (C, 2), each once, and their signs (C,)."""
    found = {}
    for (name, dimension), rows in groups.items():
        if _is_crease(name, dimension):
            sign = CREASES[name.lower()]
            for pair in np.sort(rows.reshape(-1, 2), axis=1).tolist():
                if found.setdefault(tuple(pair), sign) != sign:
                    place = _where(points[pair])
                    raise ValueError(f"$Elements: the line {place} is both mountain and valley")
    creases = np.array(list(found), dtype=int).reshape(-1, 2)
    sides, _, shares = unique_sides(triangles)
    inner = set(map(tuple, sides[shares > 1].tolist()))
    for pair in map(tuple, creases.tolist()):
        if pair not in inner:
            raise ValueError(
                f"$Elements: the line {_where(points[list(pair)])}, mountain or valley, is no side "
                "between two triangles"
            )
    return creases, np.array(list(found.values()), dtype=int)


def _triangles(points, blocks):
    """Triangles (T, 3), each once: what is in several groups may be written several times."""
    found = []
    for kind, rows, _ in blocks:
        if kind.dimension == 2:
            found.append(rows if kind.corners == 3 else cut_quadrangles(points, rows))
    if not found:
        raise ValueError(
            "$Elements: has no triangles; gmsh writes none of surfaces that are in no physical "
            "group, where there are groups at all"
        )
    triangles = np.concatenate(found)
    flat = np.linalg.norm(area_vectors(points, triangles), axis=1) <= 0
    if np.any(flat):
        place = _where(points[triangles[flat][0]])
        raise ValueError(f"$Elements: the triangle {place} has no area")
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    return triangles[np.sort(first)]


def _right_way_up(points, triangles, notes):
    """Points and triangles, a flat sheet in a plane z = const and counter-clockwise from +z."""
    normal = plane_normal(points)
    if normal is None:
        under = np.zeros(len(triangles), dtype=bool)
        if len(_same_way(triangles)):
            under = faces_to_turn(triangles)
            notes.append(f"{under.sum()} of {len(under)} triangles ran the other way round")
    else:
        if normal[2] < 1:
            points = laid_down(points, normal)
            notes.append("the sheet is turned into the plane across the axis")
        under = area_vectors(points, triangles)[:, 2] < 0
    return points, np.where(under[:, None], triangles[:, ::-1], triangles)


def _same_way(triangles):
    """Sides (n, 2) along which two triangles or more run in the same direction."""
    directed = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    ends, counts = np.unique(directed, axis=0, return_counts=True)
    return ends[counts > 1]


def _check_surface(points, triangles, notes):
    """Refuse what is no sheet of one piece with an edge; note nodes that lie on one another."""
    sides, _, shares = unique_sides(triangles)
    if shares.max() > 2:
        place = _where(points[sides[shares > 2][0]])
        raise ValueError(f"$Elements: more than two triangles share the side {place}")
    if shares.min() > 1:
        raise ValueError("$Elements: is a closed surface; a sheet has an edge")
    clash = _same_way(triangles)
    if len(clash):
        place = _where(points[clash[0]])
        raise ValueError(f"$Elements: the two triangles at the side {place} overlap")
    pairs = twins(points, nearness(points))
    if len(pairs):
        notes.append(
            f"{len(pairs)} pairs of nodes lie on one another, as {_where(points[pairs[0]])}: the "
            "sheet is open there (removeDuplicateNodes of gmsh joins them)"
        )
    piece = pieces(len(points), sides)
    if piece.max() > 0:
        told = f"; {notes[-1]}" if len(pairs) else ""
        raise ValueError(f"$Elements: the sheet is of {piece.max() + 1} pieces{told}")
