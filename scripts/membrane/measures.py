# SPDX-License-Identifier: GPL-2.0-or-later
"""What is measured on the sail (README, "Assumptions"): plain functions of a mesh and positions.

The mesh is a SailMesh, positions are (N, 3) arrays [m] in the order of its nodes, in the frame of
the spin axis.
"""

import numpy as np

from .geometry import triangle_areas


def deployment_rate(mesh, positions):
    """Area inside the outer edge, projected on the spin plane, over its flat value [-].

    1 for the flat sail. The shoelace formula: parts of the loop run through clockwise count
    negative.
    """
    x, y = positions[mesh.outer_edge, :2].T
    twice = x[:-1] @ y[1:] + x[-1] * y[0] - y[:-1] @ x[1:] - y[-1] * x[0]
    return float(0.5 * twice / mesh.outer_width**2)


def mean_tip_radius(mesh, positions):
    """Mean distance of the four tips from the axis [m]; flat: outer_width / sqrt(2)."""
    return float(_radius(positions[mesh.tips]).mean())


def mean_edge_middle_radius(mesh, positions):
    """Mean distance of the outer edges' middles from the axis [m]; flat: outer_width / 2."""
    middles = positions[mesh.outer_edge_middles]  # between two nodes, or twice the same
    return float(_radius(0.5 * (middles[:, 0] + middles[:, 1])).mean())


def area_strain(mesh, positions, rest=None):
    """Relative growth (T,) of the triangles' areas [-]; `rest` (T,) [m2] if known already."""
    if rest is None:
        rest = triangle_areas(mesh.nodes, mesh.triangles)
    return triangle_areas(positions, mesh.triangles) / rest - 1


def tip_azimuths(mesh, positions):
    """Azimuths (4,) of the tips [rad] in (-pi, pi], counter-clockwise from +x."""
    x, y = positions[mesh.tips, :2].T
    return np.arctan2(y, x)


def nearest_turn(angle, reference):
    """`angle` [rad] shifted by whole turns to within half a turn of `reference` [rad]."""
    return angle - 2 * np.pi * np.round((angle - reference) / (2 * np.pi))


def phase_difference(azimuths, spool_angles):
    """Phase difference between each tip and the spool over time.

    Parameters
    ----------
    azimuths : (S, 4) float
        Azimuths of the tips [rad] at S times, the first one at release, in any turn.
    spool_angles : (S,) float
        Angle by which the spool has turned [rad].

    Returns
    -------
    (S, 4) float
        Azimuth minus spool angle [rad], continuous, 0 at release; positive = the tip leads.
        It must change by less than half a turn from one time to the next.
    """
    raw = np.asarray(azimuths) - np.asarray(spool_angles)[:, None]
    return np.unwrap(raw - raw[0], axis=0)


def _radius(points):
    """Distances (n,) [m] of points (n, 3) from the spin axis."""
    return np.hypot(points[:, 0], points[:, 1])


def first_time_above(time, values, level):
    """First of the times (S,) at which `values` (S,) exceed `level`; None if they never do."""
    above = np.flatnonzero(np.asarray(values) > level)
    return float(time[above[0]]) if len(above) else None


def swing(time, phase):
    """How far and how fast the tips swing against the spool.

    Parameters
    ----------
    time : (S,) float
        Times since the release [s].
    phase : (S,) float
        Mean phase difference [rad].

    Returns
    -------
    dict
        `largest_lag` [rad] and its `time_of_largest_lag` [s]; `return_time` [s] when the phase
        difference first comes back to zero after it, None if it does not.
    """
    lag = int(np.argmin(phase))
    back = np.flatnonzero(np.asarray(phase[lag:]) >= 0)
    return {
        "largest_lag": float(-phase[lag]),
        "time_of_largest_lag": float(time[lag]),
        "return_time": float(time[lag + back[0]]) if len(back) else None,
    }


def lag_and_half_period(time, phase):
    """Amplitude and half the period of the phase difference; parameters as in `swing`.

    Returns
    -------
    lag : float
        Largest lag of the mean tip [deg].
    half_period : float
        Time [s] from it to the largest lead that follows.
    """
    found = swing(time, phase)
    lagged = found["time_of_largest_lag"]
    after = time >= lagged
    lead = time[after][np.argmax(phase[after])]
    return float(np.degrees(found["largest_lag"])), float(lead - lagged)


def energy_errors(history):
    """How far the energies and works of a history (dict of (S,) [J]) are from adding up.

    Returns
    -------
    dict
        `largest_energy_imbalance` [J], and `largest_unexplained_energy` [J]: the same without what
        the integrator itself leaves where sides buckle or become taut within a step.
    """
    balance, kinks = history["energy_balance"], history["kink_error"]
    return {
        "largest_energy_imbalance": float(np.abs(balance).max()),
        "largest_unexplained_energy": float(np.abs(balance - kinks).max()),
    }
