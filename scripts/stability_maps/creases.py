# SPDX-License-Identifier: GPL-2.0-or-later
"""Creases: which lengths stand in (7), both laws over the angle, and the angular momentum they
pump.

- `lengths`: the plugin takes rest lengths in (7). What current ones would do is shown by a small
  leapfrog in NumPy, outside the plugin: one triangle of a pair at a right angle, the other held,
  has its height collapsed, and its apex is let go; no sides. By hand: with current lengths the
  work of (7) on the way to theta = 0 is beta E J l pi²/8 divided by the height, without bound;
  with rest lengths it vanishes with the height.
- `law`: force of the plugin over the angle, for both laws and two natural angles.
- `swing`: a free pair of equal triangles that swings through theta = 0; energy at three
  steps.
- `momentum`: a free pair of unequal triangles: angular momentum about its centre, which nothing
  outside changes.
"""

import numpy as np
from membrane import scene

from .common import TWO_TRIANGLES, Model, O, figure, folder, save, two_triangles, write_table

YOUNG, THICKNESS, DENSITY = 3.2e9, 7.5e-6, 1420.0
GAMMA, LENGTH = 100.0, 0.02
HEADER = ("part", "case", "x", "x means", "value", "value means")
CORNER = DENSITY * THICKNESS * LENGTH**2 * np.sqrt(0.75) / 6  # kg, of an apex
HEIGHTS = np.logspace(-5.5, -2, 8)  # m


def collapse(lengths, beta, heights, step=5e-6, steps=400):
    """Largest speed (H,) [m/s] of an apex let go at theta = pi/2 at `heights` (H,) [m], in NumPy.

    Equilateral triangles of 20 mm, (7) with `rest` or `current` lengths, three nodes held.
    """
    height = LENGTH * np.sqrt(0.75)
    bending = beta * YOUNG * THICKNESS**3 / 12
    x = np.array([two_triangles(0.5 * np.pi, (h, height), LENGTH) for h in heights])
    v, largest = np.zeros((len(heights), 3)), np.zeros(len(heights))
    for _ in range(steps):
        f = np.zeros_like(x)
        fold(f, x, bending, lengths == "current", height)
        v += step / CORNER * f[:, 2]
        x[:, 2] += step * v
        largest = np.maximum(largest, np.linalg.norm(v, axis=1))
    return largest


def collapse_by_hand(lengths, beta, heights):
    """Speed (H,) [m/s] from the work of (7) along the arc from theta = pi/2 to 0."""
    work = beta * YOUNG * THICKNESS**3 / 12 * LENGTH * np.pi**2 / 8
    reach = heights if lengths == "current" else 0.75 * LENGTH**2 / heights
    return np.sqrt(2 * work / reach / CORNER)


def fold(f, x, bending, current, height):
    """Add the forces of (7) and (8) on a mountain crease AB of each pair to f (P, 4, 3) [N]."""
    a, b, c, d = (x[:, i] for i in range(4))
    axis = b - a
    long = np.linalg.norm(axis, axis=1) + 1e-30
    axis = axis / long[:, None]
    arms, feet, heights = [], [], []
    for apex in (c, d):
        along = np.sum((apex - a) * axis, axis=1)
        arm = (apex - a) - along[:, None] * axis
        arms.append(arm)
        feet.append(along / np.maximum(long, 0.05 * LENGTH))
        heights.append(np.linalg.norm(arm, axis=1) + 1e-30)
    sine = -np.sum(axis * np.cross(arms[0], arms[1]), axis=1)
    theta = np.arctan2(sine, np.sum(arms[0] * arms[1], axis=1))
    theta = np.where(theta <= -0.5 * np.pi, theta + 2 * np.pi, theta)
    gamma = np.where(theta >= 0, 1.0, GAMMA)
    for k, (sign, node) in enumerate(((1, 2), (-1, 3))):
        open_ = sign * np.cross(axis, arms[k]) / heights[k][:, None]
        reach, base = (heights[k], long) if current else (height, LENGTH)
        push = (-bending * gamma * base * theta / reach**2)[:, None] * open_
        f[:, node] += push
        f[:, 0] -= (1 - feet[k])[:, None] * push
        f[:, 1] -= feet[k][:, None] * push


def law_curve(law, theta0, angles):
    """Force [N] of the plugin on C along its opening direction, at angles (S,) [rad]."""
    rest = two_triangles(np.pi)
    model = pair(rest, beta=30.0, theta0=theta0, crease_law=law)
    forces = []
    for theta in angles:
        model.balance(two_triangles(theta))
        held = [np.array(O.forces.permF(i)) for i in model.net.bodyIds]
        x = two_triangles(theta)
        arm = x[2] - [0.5 * LENGTH, 0, 0]
        opening = np.cross([1.0, 0, 0], arm) / np.linalg.norm(arm)
        # Sides are at rest: all of the force is the crease's.
        forces.append(-float(held[2] @ opening))
    return np.array(forces)


def pair(rest, **engine):
    """A Model of two triangles on a crease."""
    return Model(
        rest, TWO_TRIANGLES, creases=[(0, 1)], crease_signs=[1], alphaCrease=100.0, engine=engine
    )


def swing(share, law, seconds=0.05):
    """Largest relative error of the energy, and angles (S,) [rad], of a pair that swings freely."""
    rest = two_triangles(np.pi)
    model = pair(rest, beta=300.0, crease_law=law)
    start = two_triangles(2.0)
    arm = (start[2] - [0.5 * LENGTH, 0, 0]) / LENGTH
    opening = np.cross([1.0, 0, 0], arm)
    velocities = np.zeros((4, 3))
    velocities[2] = 3.0 * opening
    velocities[3] = 3.0 * opening * [1, -1, 1]
    velocities -= np.average(velocities, axis=0, weights=model.masses)
    model.place(start, velocities)
    O.dt = share * model.forces.criticalTimeStep()
    ledger = model.start_ledger()
    totals, angles = [], []
    for _ in range(int(seconds / O.dt)):
        scene.advance(1)
        totals.append(ledger.total + ledger.crease)
        angles.append(model.forces.creaseAngles(model.forces.lastPositions())[0])
    totals = np.array(totals)
    return float(np.abs(totals / totals[0] - 1).max()), np.array(angles)


def momentum(law, ratio, zeta, seconds, samples=100):
    """Angular momentum of a free pair with heights 1 : ratio, over time; NaN once it has blown up.

    Divided by the moment of inertia times 1/s, it is a spin rate [rad/s].
    """
    heights = (0.02, 0.02 * ratio)
    rest = two_triangles(np.pi, heights)
    model = pair(rest, beta=300.0, crease_law=law, zeta=zeta)
    start = two_triangles(1.5, heights)
    model.place(start)
    O.dt = 0.5 * model.forces.criticalTimeStep()
    stride = max(1, int(seconds / O.dt / samples))
    middle = np.average(start, axis=0, weights=model.masses)
    inertia = np.sum(model.masses * np.sum((start - middle) ** 2, axis=1))
    times, spins = [0.0], [0.0]
    for k in range(samples):
        try:
            scene.advance(stride)
        except RuntimeError:
            break
        v, x = model.velocities(), model.positions() - 0.5 * O.dt * model.velocities()
        spin = np.sum(model.masses[:, None] * np.cross(x, v), axis=0) / inertia
        times.append((k + 1) * stride * O.dt)
        spins.append(float(np.linalg.norm(spin)))
    return np.array(times), np.array(spins)


def run(quick):
    """Measure all parts; returns a line of text."""
    rows = []
    speeds = {}
    for lengths in ("rest", "current"):
        for beta in (30.0,) if quick else (3.0, 30.0, 300.0):
            name = f"{lengths}, beta = {beta:g}"
            speeds[lengths, beta] = collapse(lengths, beta, HEIGHTS)
            hand = collapse_by_hand(lengths, beta, HEIGHTS)
            for height, speed, expected in zip(HEIGHTS, speeds[lengths, beta], hand):
                where = ["lengths", name, height, "height [m]"]
                rows.append([*where, speed, "largest speed of the apex (NumPy) [m/s]"])
                rows.append([*where, expected, "by hand, from pi/2 to 0 [m/s]"])
    angles = np.sort(
        np.append(np.linspace(-0.499, 1.499, 25 if quick else 81) * np.pi, [-1e-6, 1e-6])
    )
    curves = {}
    for law in ("paper", "conservative"):
        for theta0 in (0.0, 0.5 * np.pi):
            curves[law, theta0] = law_curve(law, theta0, angles)
            name = f"{law}, theta0 = {theta0:.4g}"
            for theta, force in zip(angles, curves[law, theta0]):
                rows.append(["law", name, theta, "theta [rad]", force, "force on C [N]"])
    errors = {}
    for law in ("paper", "conservative"):
        for share in (0.5,) if quick else (0.8, 0.4, 0.2, 0.1):
            errors[law, share], seen = swing(share, law, 0.005 if quick else 0.05)
            text = f"energy error, angles {seen.min():.3g} ... {seen.max():.3g} rad [-]"
            rows.append(["swing", law, share, "step / estimate [-]", errors[law, share], text])
    spins = {}
    for law in ("paper", "conservative"):
        for ratio in (1.0, 2.0) if quick else (1.0, 1.25, 1.5, 2.0, 3.0):
            for zeta in (0.0, 0.1):
                times, spin = momentum(law, ratio, zeta, 0.01 if quick else 0.1)
                spins[law, ratio, zeta] = times, spin
                text = "largest spin rate that came from nothing [rad/s]"
                name = f"{law}, zeta = {zeta:g}"
                rows.append(["momentum", name, ratio, "ratio of heights [-]", spin.max(), text])
    out = folder(quick)
    write_table(out / "creases.csv", HEADER, rows)
    draw(rows, speeds, angles, curves, spins, out / "creases.png")
    at = int(np.searchsorted(angles, 0.0))
    jump = curves["paper", 0.5 * np.pi][at - 1] / curves["paper", 0.5 * np.pi][at]
    smooth = curves["conservative", 0.5 * np.pi][at - 1] / curves["conservative", 0.5 * np.pi][at]
    worst = {
        law: max(s.max() for (name, r, z), (_, s) in spins.items() if name == law and r > 1)
        for law in ("paper", "conservative")
    }
    largest = {lengths: speeds[lengths, 30.0].max() for lengths in ("rest", "current")}
    fine = min(share for _, share in errors)
    return (
        f"(7) at beta = 30 throws the apex of a triangle collapsed to {1e6 * HEIGHTS[0]:.2g} "
        f"um out at "
        f"{speeds['current', 30.0][0]:.3g} m/s with current lengths, at "
        f"{speeds['rest', 30.0][0]:.2g} m/s with rest "
        f"lengths (NumPy; {largest['current']:.3g} and {largest['rest']:.2g} m/s at most over all "
        "heights up to 10 mm); at theta = 0 with theta0 = "
        f"pi/2 the force jumps {jump:.3g}-fold in `paper`, {smooth:.3g}-fold in "
        f"`conservative`; swinging "
        f"through, the energy errs by {errors['conservative', fine]:.1e} at {fine:g} of the "
        f"estimate; unequal "
        f"heights spin a body up to {worst['paper']:.3g} rad/s with `paper`, "
        f"{worst['conservative']:.1e} with "
        "`conservative`: take `paper` for meshes with equal heights and theta0 = 0, as the "
        "paper's own, and "
        "`conservative` for any other"
    )


def draw(rows, speeds, angles, curves, spins, path):
    """Four panels: lengths, law, energy error of the swing, angular momentum."""
    drawing, axes = figure(columns=2, rows=2)
    (first, second), (third, fourth) = axes
    for (lengths, beta), speed in speeds.items():
        color = "C0" if lengths == "rest" else "C3"
        marker = {3.0: "v", 30.0: "o", 300.0: "^"}[beta]
        name = f"{lengths} lengths, beta = {beta:g}"
        first.loglog(HEIGHTS, speed, marker, color=color, markersize=4, label=name)
        first.loglog(HEIGHTS, collapse_by_hand(lengths, beta, HEIGHTS), color=color, linewidth=0.6)
    first.set(xlabel="height at the start [m]", ylabel="largest speed of the apex [m/s] (NumPy)")
    first.set_title("lines: by hand", fontsize=8)
    first.legend(fontsize=6)
    for (law, theta0), force in curves.items():
        style = "-" if law == "paper" else "--"
        second.plot(angles / np.pi, force, style, label=f"{law}, theta0 = {theta0 / np.pi:g} pi")
    second.set(xlabel="theta / pi [-]", ylabel="force on C, opening [N]", yscale="symlog")
    second.set_yscale("symlog", linthresh=1e-5)
    for at in (-0.5, 0, 1, 1.5):
        second.axvline(at, color="k", linewidth=0.5)
    second.legend(fontsize=7)
    for law in ("paper", "conservative"):
        mine = [r for r in rows if r[0] == "swing" and r[1] == law]
        third.loglog([r[2] for r in mine], [r[4] for r in mine], "o-", label=law)
    third.axvline(1.0, color="C3", label="estimate")
    third.set(xlabel="step / estimate [-]", ylabel="error of the energy through 0 [-]")
    third.legend(fontsize=7)
    for (law, ratio, zeta), (times, spin) in spins.items():
        if zeta == 0.1:
            style = "-" if law == "paper" else "--"
            fourth.plot(times[1:], spin[1:] + 1e-16, style, label=f"{law}, 1 : {ratio:g}")
    fourth.set(xlabel="time [s]", ylabel="angular momentum / inertia [rad/s]", yscale="log")
    fourth.legend(fontsize=6)
    save(drawing, path)
