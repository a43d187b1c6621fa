# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper's forces a second time, in NumPy, to hold the plugin against.

Written from the paper's equations (4)...(10) and the readings in model.md, not from the plugin's
sources. Nothing here imports YADE or the plugin, and nothing of the plugin imports this.

Two bounds are not in the paper but among the README's assumptions: levers of creases stop
growing where a triangle has collapsed (`collapsed`), and damping never makes a taut cable push
(`may_push`). Both are on by default; collapsed=0 and may_push=True give the equations as they are.

Shapes: N nodes, T triangles, M sides, C creases. SI units, angles in radians. Forces are those on
the nodes, (N, 3), in N. Functions do not change their arguments.
"""

import numpy as np

COLLAPSED = 0.05  # of its rest value: where a length or height of a crease stops shrinking [-]


def dot(a, b):
    """Row-wise scalar product of a (n, 3) and b (n, 3): (n,)."""
    return np.einsum("ij,ij->i", a, b)


def norm(a):
    """Row-wise length of a (n, 3): (n,)."""
    return np.sqrt(dot(a, a))


def add_up(count, nodes, values):
    """Sum of values (n, 3) or (n,) at the nodes (n,) they belong to: (count, 3) or (count,)."""
    total = np.zeros((count,) + values.shape[1:])
    np.add.at(total, nodes, values)
    return total


def triangle_normals(positions, triangles):
    """Unit normals (T, 3) and areas (T,) [m2] of triangles (T, 3) over positions (N, 3) [m]."""
    a, b, c = (positions[triangles[:, corner]] for corner in range(3))
    twice = np.cross(b - a, c - a)
    length = norm(twice)
    return twice / length[:, None], 0.5 * length


# --- mass (4) ---


def node_masses(nodes, triangles, density, thickness):
    """Mass (N,) [kg] of the film at its nodes, (4): a third of rho h S to each corner.

    nodes (N, 3) [m] at rest; density [kg/m3]; thickness [m].
    """
    _, areas = triangle_normals(nodes, triangles)
    third = density * thickness * areas / 3.0
    return add_up(len(nodes), triangles.ravel(), np.repeat(third, 3))


def cable_masses(nodes, cables, density):
    """Mass (N,) [kg] at the nodes of cables (K, 2) of a density [kg/m]: half at each end."""
    half = 0.5 * density * norm(nodes[cables[:, 1]] - nodes[cables[:, 0]])
    return add_up(len(nodes), cables.ravel(), np.repeat(half, 2))


# --- stiffness (5) ---


def side_lengths_of_triangles(positions, triangles):
    """Lengths (T, 3) [m] of a triangle's sides; column i is the side opposite corner i."""
    ends = [(1, 2), (2, 0), (0, 1)]
    return np.stack(
        [norm(positions[triangles[:, q]] - positions[triangles[:, p]]) for p, q in ends], 1
    )


def triangle_stiffness(lengths, young, poisson, thickness):
    """Stiffness (T, 3) [N/m] that a triangle gives to its three sides, (5).

    lengths (T, 3) [m] at rest; young [Pa]; poisson [-]; thickness [m]. Column i belongs to
    lengths[:, i].
    """
    semi = 0.5 * lengths.sum(axis=1)
    # Kahan's order keeps Heron's formula accurate for needles
    low, mid, high = np.sort(lengths, axis=1).T
    area = 0.25 * np.sqrt(
        (high + (mid + low)) * (low - (high - mid)) * (low + (high - mid)) * (high + (mid - low))
    )
    assert np.all(semi > high), "no triangle has such sides"
    squares = lengths**2
    off_diagonal = 1.0 - np.eye(3)
    sine_squared = 4.0 * area[:, None, None] ** 2 / (squares[:, :, None] * squares[:, None, :])
    p = 1.0 - (1.0 + poisson) * sine_squared * off_diagonal
    b = p**2 * squares[:, None, :] / (young * thickness * area)[:, None, None]
    return np.linalg.solve(b, np.ones((len(lengths), 3, 1)))[:, :, 0]


def side_stiffness(nodes, triangles, young, poisson, thickness):
    """Stiffness of every side, (5): {(i, j) with i < j: k [N/m]}; triangles at a side add up."""
    shares = triangle_stiffness(
        side_lengths_of_triangles(nodes, triangles), young, poisson, thickness
    )
    total = {}
    for corners, share in zip(triangles.tolist(), shares.tolist()):
        for opposite in range(3):
            side = tuple(sorted((corners[opposite - 2], corners[opposite - 1])))
            total[side] = total.get(side, 0.0) + share[opposite]
    return total


# --- side tension (3), (6) ---


def critical_length(rest_length, alpha, thickness):
    """Length l_cr (M,) [m] under which a side's force stays constant, (6).

    rest_length (M,) [m]; alpha (M,) [-], 0 for cables; thickness [m].
    """
    return rest_length - alpha * np.pi**2 * thickness**2 / (12.0 * rest_length)


def side_tension(length, rest_length, critical, stiffness):
    """Tension (M,) [N], positive when stretched, (3) with (6); arguments (M,) in [m] and [N/m]."""
    return stiffness * (np.maximum(length, critical) - rest_length)


def side_energy(length, rest_length, critical, stiffness):
    """Energy (M,) [J] of the sides: the integral of the tension from the rest length on."""
    bounded = np.maximum(length, critical) - rest_length
    return 0.5 * stiffness * bounded**2 + stiffness * bounded * np.minimum(length - critical, 0.0)


def side_geometry(positions, sides):
    """Unit vectors (M, 3) from the first to the second end and lengths (M,) [m] of sides (M, 2)."""
    along = positions[sides[:, 1]] - positions[sides[:, 0]]
    length = norm(along)
    return along / length[:, None], length


def pull_together(count, sides, direction, tension):
    """Forces (count, 3) of tensions (M,) in sides (M, 2) with unit vectors direction (M, 3)."""
    force = tension[:, None] * direction
    return add_up(count, sides[:, 0], force) - add_up(count, sides[:, 1], force)


def side_forces(positions, sides, rest_length, critical, stiffness):
    """Elastic forces (N, 3) [N] of the sides (M, 2) at positions (N, 3), (3) with (6)."""
    direction, length = side_geometry(positions, sides)
    tension = side_tension(length, rest_length, critical, stiffness)
    return pull_together(len(positions), sides, direction, tension)


# --- creases (7), (8) ---


def crease_nodes(triangles, creases):
    """Nodes A, B, C, D (C, 4) of creases A, B (C, 2) between triangles ABC and BAD.

    The corners of triangles (T, 3) run the same way round on both sides of a crease.
    """
    apex = {}
    for a, b, c in triangles.tolist():
        apex.update({(a, b): c, (b, c): a, (c, a): b})
    return np.array([(a, b, apex[a, b], apex[b, a]) for a, b in creases.tolist()])


def crease_frame(positions, creases):
    """Geometry of creases (C, 4), columns A, B, C, D: common side AB, tips C and D.

    Returns a dict: length (C,) of AB; height_c, height_d (C,) over AB [m]; foot_c, foot_d (C,)
    where the feet E, F lie on AB, 0 at A and 1 at B, beyond that outside; axis (C, 3) along AB;
    up_c, up_d (C, 3) unit vectors from the feet to C and D; normal_c, normal_d = axis x up.
    """
    a, b, c, d = (positions[creases[:, column]] for column in range(4))
    length = norm(b - a)
    axis = (b - a) / length[:, None]
    frame = {"length": length, "axis": axis}
    for name, tip in (("c", c), ("d", d)):
        along = dot(tip - a, axis)
        over = tip - a - along[:, None] * axis
        height = norm(over)
        frame["foot_" + name] = along / length
        frame["height_" + name] = height
        frame["up_" + name] = over / height[:, None]
        frame["normal_" + name] = np.cross(axis, frame["up_" + name])
    return frame


def crease_angle(positions, creases, inside):
    """Angle theta (C,) between the triangles of creases (C, 4), in (-pi/2, 3 pi/2].

    0: face to face, pi: flat, negative: passed through each other. inside (C,) is +1 where the two
    faces close on the side that (B - A) x (C - A) points to, -1 where on the other.
    """
    return angle_of(crease_frame(positions, creases), inside)


def angle_of(frame, inside):
    """Angle theta (C,) of a crease_frame; see crease_angle."""
    sine = dot(frame["axis"], np.cross(frame["up_c"], frame["up_d"]))
    cosine = dot(frame["up_c"], frame["up_d"])
    theta = inside * np.arctan2(sine, cosine)
    return np.where(theta <= -0.5 * np.pi, theta + 2.0 * np.pi, theta)


def bending_stiffness(young, thickness):
    """E J [N m] of the paper, J = h^3/12 (no factor 1 - nu^2)."""
    return young * thickness**3 / 12.0


def bounded(now, before, name, collapsed):
    """Length or height (C,) [m] to divide by: that of `now`, at least a share of that `before`.

    now, before: crease_frame in the present and in the rest state; name: of a length in them;
    collapsed: that share [-], 0 for no bound.
    """
    return np.maximum(now[name], collapsed * before[name])


def crease_balance(positions, creases, now, before, force_c, force_d, collapsed):
    """Forces (N, 3) of all creases from those on C and D, (C, 3) each, with (8) on A and B.

    now, before: crease_frame in the present and in the rest state; collapsed: see `bounded`.
    The lengths on AB are signed and present ones: the four forces add up to zero, and so do their
    moments but for those about AB, which cancel only where F_C l_CE = F_D l_DF. Where AB is
    bounded, B's share is l_AE over the bounded length and A has the rest: the forces still add up
    to zero, their moments do not, and the shares depend on which end is A.
    """
    shrink = now["length"] / bounded(now, before, "length", collapsed)
    foot_c, foot_d = (shrink * now["foot_c"])[:, None], (shrink * now["foot_d"])[:, None]
    force_a = -(1.0 - foot_c) * force_c - (1.0 - foot_d) * force_d
    force_b = -foot_c * force_c - foot_d * force_d
    forces = (force_a, force_b, force_c, force_d)
    return sum(add_up(len(positions), creases[:, i], f) for i, f in enumerate(forces))


def crease_forces_paper(
    positions,
    rest,
    creases,
    inside,
    young,
    thickness,
    beta,
    gamma,
    theta0,
    collapsed=COLLAPSED,
):
    """Forces (N, 3) [N] of creases by (7) and (8) as printed, with the rest lengths in (7).

    positions, rest (N, 3) [m]; creases (C, 4); inside (C,), see crease_angle; young [Pa]; thickness
    [m]; beta, gamma [-]; theta0 [rad]; collapsed [-]: share of its rest length below which l_AB in
    (8) counts as that share, the README's assumption; 0: (8) as printed.
    """
    now, before = crease_frame(positions, creases), crease_frame(rest, creases)
    theta = angle_of(now, inside)
    penalty = np.where(theta >= 0.0, 1.0, gamma)
    moment = (
        beta * penalty * bending_stiffness(young, thickness) * before["length"] * (theta - theta0)
    )
    # theta is the turn from the face of C to that of D, times inside: forward for C closes it
    force_c = (inside * moment / before["height_c"] ** 2)[:, None] * now["normal_c"]
    force_d = -(inside * moment / before["height_d"] ** 2)[:, None] * now["normal_d"]
    return crease_balance(positions, creases, now, before, force_c, force_d, collapsed)


def crease_modulus(rest, creases, young, thickness, beta):
    """K (C,) [N m] of the conservative law: beta E J l_AB over the mean of the rest heights."""
    before = crease_frame(rest, creases)
    mean_height = 0.5 * (before["height_c"] + before["height_d"])
    return beta * bending_stiffness(young, thickness) * before["length"] / mean_height


def crease_energy(positions, rest, creases, inside, young, thickness, beta, gamma, theta0):
    """Energy (C,) [J] of the conservative law.

    K [(theta - theta0)^2 + (gamma - 1) min(theta, 0)^2] / 2; arguments as in crease_forces_paper.
    """
    modulus = crease_modulus(rest, creases, young, thickness, beta)
    theta = crease_angle(positions, creases, inside)
    through = np.minimum(theta, 0.0)
    return 0.5 * modulus * ((theta - theta0) ** 2 + (gamma - 1.0) * through**2)


def crease_forces_conservative(
    positions,
    rest,
    creases,
    inside,
    young,
    thickness,
    beta,
    gamma,
    theta0,
    collapsed=COLLAPSED,
):
    """Forces (N, 3) [N] of creases by the conservative law: minus the gradient of crease_energy.

    The angle changes by one over the present height with a tip that moves along its face's normal;
    A and B follow from (8), since rigid motion changes no angle. Arguments as in
    crease_forces_paper; heights are bounded as l_AB is, and where either is, this is no gradient.
    """
    modulus = crease_modulus(rest, creases, young, thickness, beta)
    now, before = crease_frame(positions, creases), crease_frame(rest, creases)
    theta = angle_of(now, inside)
    moment = modulus * ((theta - theta0) + (gamma - 1.0) * np.minimum(theta, 0.0))
    height_c = bounded(now, before, "height_c", collapsed)
    height_d = bounded(now, before, "height_d", collapsed)
    force_c = (inside * moment / height_c)[:, None] * now["normal_c"]
    force_d = -(inside * moment / height_d)[:, None] * now["normal_d"]
    return crease_balance(positions, creases, now, before, force_c, force_d, collapsed)


# --- damping (9) ---


def damping_coefficient(stiffness, masses, sides, zeta):
    """Coefficient c (M,) [N s/m] = 2 zeta sqrt(k m), (9); m the mean mass of the two ends [kg]."""
    mean_mass = 0.5 * (masses[sides[:, 0]] + masses[sides[:, 1]])
    return 2.0 * zeta * np.sqrt(stiffness * mean_mass)


def damping_forces(
    positions,
    velocities,
    sides,
    rest_length,
    stiffness,
    masses,
    zeta,
    cable,
    may_push=False,
):
    """Damping forces (N, 3) [N] along the sides, (9): against the rate of each side's length.

    velocities (N, 3) [m/s]; stiffness (M,) not negative; cable (M,) bool: a cable shorter than its
    rest length is not damped, a side of the film always is. may_push: whether damping may exceed
    the elastic tension of a taut cable that shortens, so that it pushes its ends apart; False, the
    README's assumption: it takes away no more than that tension.
    """
    direction, length = side_geometry(positions, sides)
    rate = dot(velocities[sides[:, 1]] - velocities[sides[:, 0]], direction)
    slack = cable & (length < rest_length)
    coefficient = np.where(slack, 0.0, damping_coefficient(stiffness, masses, sides, zeta))
    tension = coefficient * rate
    if not may_push:
        elastic = stiffness * (length - rest_length)  # of a taut cable: (3), as its alpha is 0
        tension = np.where(cable & ~slack, np.maximum(tension, -elastic), tension)
    return pull_together(len(positions), sides, direction, tension)


# --- air drag (10) ---


def drag_forces(positions, velocities, triangles, air_density):
    """Air drag (N, 3) [N], (10): on each corner rho S_n V^2 / 6 against that corner's velocity V.

    S_n = S |n . V| / |V| is the triangle's present area seen along V; air_density [kg/m3].
    """
    normals, areas = triangle_normals(positions, triangles)
    total = np.zeros_like(positions)
    for corner in range(3):
        nodes = triangles[:, corner]
        velocity = velocities[nodes]
        flow = np.abs(dot(normals, velocity)) * areas  # S_n |V|
        total += add_up(len(positions), nodes, -(air_density / 6.0 * flow)[:, None] * velocity)
    return total


# --- film of plane stress that wrinkles (model.md, "One film on any mesh") ---


def film_strain(positions, rest, triangles):
    """Deformation gradients (T, 3, 2), Green strains (T, 2, 2) and shape gradients (T, 3, 2) [1/m].

    positions, rest (N, 3) [m]; in axes of each triangle's own, x along the side from its second
    corner to its third.
    """
    at_rest = rest[triangles]
    along = at_rest[:, 2] - at_rest[:, 1]
    along /= norm(along)[:, None]
    normal, _ = triangle_normals(rest, triangles)
    axes = np.stack([along, np.cross(normal, along)], axis=2)
    flat = np.einsum("tck,tki->tci", at_rest - at_rest[:, :1], axes)
    edges = flat[:, 1:] - flat[:, :1]
    inverse = np.linalg.inv(edges)
    shapes = np.concatenate([-inverse.sum(axis=2)[:, None], inverse.transpose(0, 2, 1)], axis=1)
    gradient = np.einsum("tck,tci->tki", positions[triangles], shapes)
    strain = 0.5 * (np.einsum("tki,tkj->tij", gradient, gradient) - np.eye(2))
    return gradient, strain, shapes


def film_stress(strain, young, poisson, buckling):
    """Stress (T, 2, 2) [Pa], energy density (T,) [J/m3] and state (T,) of Green strains (T, 2, 2).

    The state is 0 taut, 1 wrinkled, 2 slack; `buckling` is the stress [Pa] that the film bears in
    compression at most. By eigenvectors.
    """
    values, vectors = np.linalg.eigh(strain)
    second, first = values.T
    limit = buckling / young
    taut = second >= -poisson * first - (1 - poisson**2) * limit
    slack = ~taut & (first < -(1 - poisson) * limit)
    plane = young / (1 - poisson**2)
    major = np.where(taut, plane * (first + poisson * second), young * first - poisson * buckling)
    minor = np.where(taut, plane * (second + poisson * first), -buckling)
    major = np.where(slack, -buckling, major)
    across = np.where(taut, second, -poisson * first - (1 - poisson**2) * limit)
    along = np.where(slack, -(1 - poisson) * limit, first)
    across = np.where(slack, -(1 - poisson) * limit, across)
    # Elastic energy of what wrinkles leave, and the work of the buckling stress in them.
    energy = 0.5 * plane * (along**2 + across**2 + 2 * poisson * along * across)
    energy += buckling * (along - first + across - second)
    principal = np.stack([minor, major], axis=1)
    stress = np.einsum("tip,tp,tjp->tij", vectors, principal, vectors)
    return stress, energy, np.where(taut, 0, np.where(slack, 2, 1))


def film_forces(positions, rest, triangles, young, poisson, thickness, buckling):
    """Forces (N, 3) [N] and energy [J] of the film; arguments as of film_stress."""
    gradient, strain, shapes = film_strain(positions, rest, triangles)
    stress, energy, _ = film_stress(strain, young, poisson, buckling)
    _, areas = triangle_normals(rest, triangles)
    volumes = thickness * areas
    return film_nodal(len(rest), triangles, gradient, stress, shapes, volumes), energy @ volumes


def film_damping(positions, velocities, rest, triangles, young, poisson, thickness, buckling, time):
    """Forces (N, 3) [N] of a damping time [s]: stress of the strain that far ahead, less stress."""
    gradient, strain, shapes = film_strain(positions, rest, triangles)
    turning = np.einsum("tck,tci->tki", velocities[triangles], shapes)
    rate = np.einsum("tki,tkj->tij", gradient, turning)
    ahead = strain + 0.5 * time * (rate + rate.transpose(0, 2, 1))
    stress, _, _ = film_stress(ahead, young, poisson, buckling)
    now, _, _ = film_stress(strain, young, poisson, buckling)
    _, areas = triangle_normals(rest, triangles)
    return film_nodal(len(rest), triangles, gradient, stress - now, shapes, thickness * areas)


def film_nodal(count, triangles, gradient, stress, shapes, volumes):
    """Forces (count, 3) [N] of second Piola-Kirchhoff stresses (T, 2, 2) [Pa]."""
    first_kind = np.einsum("tki,tij->tkj", gradient, stress)
    corners = -volumes[:, None, None] * np.einsum("tkj,tcj->tck", first_kind, shapes)
    return add_up(count, triangles.ravel(), corners.reshape(-1, 3))
