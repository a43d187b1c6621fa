# SPDX-License-Identifier: GPL-2.0-or-later
"""Meshes of gmsh (.msh, versions 2 to 2.2, 4.0 and 4.1, text or binary), read by gmsh itself.

Not by meshio, which reads neither gmsh's own 4.0 nor what is partitioned, parametric or in no
group, and takes a node 0 for the last one. What gmsh is silent about is held against its counts.

Physical groups of curves named M or mountain, V or valley become creases; all named groups are
kept by name, so that a group of points "tips" can bear masses and a group "hub" be driven.
"""

import os
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..files import BadFile, is_value, read_bytes, shown
from ..geometry import MOUNTAIN, VALLEY, area_vectors, cut_quadrangles, nearness, pieces, twins
from ..geometry import unique_sides
from .gmsh_process import GmshError, in_gmsh
from .orientation import faces_to_turn, laid_down, plane_normal
from .pattern_mesh import SheetMesh

CREASES = {"m": MOUNTAIN, "mountain": MOUNTAIN, "v": VALLEY, "valley": VALLEY}
FARTHEST = 1e12  # of coordinates, in any unit
HEAD = re.compile(rb"^\$MeshFormat\s+(\S+) +(\S+) +(\S+)", re.MULTILINE)
NAME = re.compile(r'^ *([0-3]) +(-?\d{1,9}) +"([^"]{1,200})" *\r?$', re.MULTILINE)
BEGINS = re.compile(r"^Info: (\d+) (entit|node|element)")
READ = "versions 2 to 2.2, 4.0 and 4.1 are read"


def read_msh(path: str | Path, unit: float = 1.0) -> SheetMesh:
    """Read a triangulated sheet; `unit` is the length of the file's unit [m].

    Quadrangles are cut in two, of elements of higher order the corners are taken; nodes that no
    triangle has are left out. A flat sheet is turned into a plane z = const if it lies in another
    one, and all its triangles counter-clockwise seen from +z.

    BadFile, in one sentence, for whatever is wrong; OSError if the file cannot be opened.
    """
    if not (np.isfinite(unit) and unit > 0):
        raise ValueError(f"unit = {unit} m: must be finite and > 0")
    content = read_bytes(path).lstrip()
    try:
        version, is_text = _format(content)
        _check_sections(content, by_line=is_text and version < 4)
        names = _names(content)
        points, blocks = in_gmsh(_read, content, version < 4)
        return _sheet(unit * points, blocks, names, version)
    except GmshError as error:
        raise BadFile(path, "", f"gmsh cannot read it: {error}") from None
    except ValueError as error:
        raise BadFile(path, "", str(error)) from None


# ------------------------------------------------------------------------- the file as it is


def _format(content):
    """Version as a number, and whether the file is text; refused if it is no mesh of gmsh."""
    head = HEAD.search(content)
    # Whatever begins otherwise gmsh would run as a script.
    if not (head and content.startswith((b"$MeshFormat", b"$Comments"))):
        raise ValueError("does not begin with $MeshFormat: it is no mesh of gmsh")
    version, kind, size = (word.decode("ascii", "replace") for word in head.groups())
    if not (is_value(version) and (2 <= float(version) <= 2.2 or float(version) in (4.0, 4.1))):
        raise ValueError(f"$MeshFormat: is of version {shown(version)}; {READ}")
    if kind not in ("0", "1") or size != "8":
        raise ValueError("$MeshFormat: must be text or binary (0 or 1), of size 8")
    return float(version), kind == "0"


def _check_sections(content, by_line):
    """Refuse a section that is not there once, or (`by_line`) has other lines than its count says.

    In version 2 gmsh crashes where there are more nodes, and leaves out further elements.
    """
    nodes = "ParametricNodes" if b"$ParametricNodes" in content else "Nodes"
    for name in (nodes, "Elements"):
        begin, end = b"$" + name.encode(), b"$End" + name.encode()
        if content.count(begin) != 1:
            raise ValueError(f"${name}: is {'there twice' if begin in content else 'missing'}")
        lines, there, _ = content.partition(begin)[2].partition(end)
        if not there:
            raise ValueError(f"${name}: is cut off: there is no $End{name}")
        count, *lines = lines.strip().splitlines() or [b""]
        if by_line and count.strip() != b"%d" % len(lines):
            raise ValueError(f"${name}: does not hold as many lines as its count says")


def _names(content):
    """Names of physical groups: list of (name, dimension, tag)."""
    section = content.partition(b"$PhysicalNames")[2].partition(b"$End")[0]
    count, _, lines = section.decode("utf-8", "replace").strip().partition("\n")
    names = [(name, int(dim), int(tag)) for dim, tag, name in NAME.findall(lines)]
    if (count.strip() or "0") != str(len(names)):
        raise ValueError("$PhysicalNames: does not hold the names that its count says")
    return names


# -------------------------------------------------------------------- in a process of its own


class _Block(NamedTuple):
    """Elements of one kind: their corners (n, k), and the tags of the groups that they are in."""

    dimension: int
    order: int
    corners: np.ndarray
    groups: list


def _read(gmsh, content, is_old):
    """Points (N, 3) and list of _Block, whose corners are rows of the points."""
    # An element of version 2 has a group of its own: gmsh else gives it to the whole entity.
    gmsh.option.setNumber("Mesh.SwitchElementTags", is_old)
    gmsh.option.setNumber("Mesh.PartitionConvertMsh2", 0)
    count = _load(gmsh, content)
    tags, points, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    tags, points = tags[order], points.reshape(-1, 3)[order]
    wrong = ~np.all(np.abs(points) <= FARTHEST, axis=1)
    if np.any(wrong):
        row = np.argmax(wrong)
        raise ValueError(f"$Nodes: node {tags[row]} lies at {points[row].tolist()}")
    blocks = []
    for entity in gmsh.model.getEntities():
        if is_old and entity[1] < 0:  # which is to gmsh as much as all
            raise ValueError(f"$Elements: are in a group of number {entity[1]}")
        groups = [entity[1]] if is_old else gmsh.model.getPhysicalGroupsForEntity(*entity).tolist()
        for kind, _, nodes in zip(*gmsh.model.mesh.getElements(*entity)):
            blocks.append(_block(gmsh, int(kind), nodes, tags, groups))
    if sum(len(block.corners) for block in blocks) != count:
        raise ValueError("$Elements: does not hold as many elements as its counts say")
    return points, blocks


def _load(gmsh, content):
    """Let gmsh read a file's content; returns how many elements it says there are."""
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
    begun = [found.groups() for line in lines if (found := BEGINS.search(line))]
    told = [line for line in lines if line.startswith("Error") or "duplicate" in line]
    if raised is None and not told:
        return int(begun[-1][0]) if begun else 0
    if lost := re.search(r"node index (\d+)", raised or ""):
        raise ValueError(f"$Elements: names node {lost[1]}, which is not in $Nodes")
    # It says how many there are when it begins to read them.
    place = {"node": "$Nodes: ", "element": "$Elements: "}.get(begun[-1][1], "") if begun else ""
    reason = raised if raised is not None else told[0].partition(": ")[2]
    plain = not reason or "/proc/" in reason
    raise ValueError(f"{place}gmsh cannot read it: {'it is damaged' if plain else reason}")


def _block(gmsh, kind, nodes, tags, groups):
    """The _Block of elements of a kind, whose nodes (n,) are among those of `tags` (N,)."""
    name, dimension, order, size, _, corners = gmsh.model.mesh.getElementProperties(kind)
    if dimension == 3 or not dimension < corners <= 4:
        raise ValueError(
            f"$Elements: has elements of kind {kind} ({name}); a sheet has points, lines, "
            "triangles and quadrangles"
        )
    rows = np.searchsorted(tags, nodes.reshape(-1, size)[:, :corners])
    return _Block(dimension, order, rows, groups)


# ---------------------------------------------------------------------------------- the sheet


def _sheet(points, blocks, names, version):
    """The SheetMesh of points (N, 3) [m] and of blocks."""
    _check_repeats(points, blocks)
    groups, notes = _groups(blocks, names), []
    triangles = _triangles(points, blocks)
    used = np.unique(triangles)
    row = np.full(len(points), -1)
    row[used] = np.arange(len(used))
    creases, signs = _creases(points, triangles, groups)
    order = max(block.order for block in blocks)
    if order > 1:
        notes.append(f"the elements are of order {order}: their corners are taken")
    if not names and any(max(block.groups, default=0) for block in blocks):
        notes.append("the physical groups have no names: none is used")
    lost = [name for name, *_ in names if not any(name == other for other, _ in groups)]
    if lost:
        saved = "; version 2 with Mesh.SaveAll loses them: save version 4.1" if version < 4 else ""
        notes.append(f"no elements are in the groups {', '.join(lost)}{saved}")
    points, triangles = _right_way_up(points[used], row[triangles], notes)
    _check_surface(points, triangles, notes)
    nodes: dict = {}
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
    for dimension, _, rows, _ in blocks:
        ordered = np.sort(rows, axis=1)
        same = np.any(np.diff(ordered, axis=1) == 0, axis=1)
        if np.any(same):
            raise ValueError(f"$Elements: one {_where(points[rows[same][0]])} has a node twice")
        _, first = np.unique(ordered, axis=0, return_index=True)
        if dimension and len(first) < len(rows):
            again = rows[np.setdiff1d(np.arange(len(rows)), first)[0]]
            raise ValueError(f"$Elements: one {_where(points[again])} is there twice")


def _groups(blocks, names):
    """Nodes of the elements of each named group, row by row, (n, k) by (name, dimension)."""
    name_of = {(dim, tag): name for name, dim, tag in names}
    found: dict = {}
    for dimension, _, rows, tags in blocks:
        for tag in tags:
            name = name_of.get((dimension, abs(tag)))
            if name is not None:
                found.setdefault((name, dimension), []).append(rows.ravel())
    return {about: np.concatenate(rows) for about, rows in found.items()}


def _is_crease(name, dimension):
    return dimension == 1 and name.lower() in CREASES


def _creases(points, triangles, groups):
    """Sides on creases (C, 2), each once, and their signs (C,)."""
    found: dict = {}
    for (name, dimension), rows in groups.items():
        if _is_crease(name, dimension):
            sign = CREASES[name.lower()]
            for pair in np.sort(rows.reshape(-1, 2), axis=1).tolist():
                if found.setdefault(tuple(pair), sign) != sign:
                    place = _where(points[pair])
                    raise ValueError(f"$Elements: the line {place} is both mountain and valley")
    creases = np.array([*found], dtype=np.int64).reshape(-1, 2)
    sides, _, shares = unique_sides(triangles)
    inner = set(map(tuple, sides[shares > 1].tolist()))
    for pair in map(tuple, creases.tolist()):
        if pair not in inner:
            raise ValueError(
                f"$Elements: the line {_where(points[list(pair)])}, mountain or valley, is no side "
                "between two triangles"
            )
    return creases, np.array([*found.values()], dtype=np.int64)


def _triangles(points, blocks):
    """Triangles (T, 3), each once: what is in several groups may be written several times."""
    found = []
    for dimension, _, rows, _ in blocks:
        if dimension == 2:
            found.append(rows if rows.shape[1] == 3 else cut_quadrangles(points, rows))
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
