# SPDX-License-Identifier: GPL-2.0-or-later
"""IKAROS, the flight sail: the second stage of its deployment, on a hub that turns freely.

From a cross of four folded arms, held at the body, to the flat square of 14 m. Nobody drives the
hub: the spin follows from angular momentum. Run it by `scripts/run.sh ikaros [options]`.

Known of the flight: size, film, masses, and the spin, 2.5 rpm with the arms out and 2.5 rpm after
the second stage. Fold lines, tethers and damping are not known here: they are those of the paper's
sail, scaled. The devices' mass is spread evenly over the film.

A cross of folded petals cannot reach the flat sail's 9.9 m: from the middle of an outer edge, which
the guide bars hold near the body, to the tip it is half an edge, 7 m. Were the tips 9.9 m out, the
edges between them would be straight and the sail flat. Estimates of the flight's cross that take
arms of 10 m find it as heavy to turn as the flat square; the scene's has less than half of that. It
starts with the angular momentum that the flat sail has at the flight's 2.5 rpm, at more than twice
that spin, and must end at 2.5 rpm; with `--spin 2.5` it ends at 1.1 rpm.
"""

import argparse
from dataclasses import fields, replace
from math import cos, pi, radians, sin

import numpy as np
from matplotlib.figure import Figure
from yade.wrapper import Omega

from .. import SolarPressure
from ..files import write_json
from ..measures import energy_errors
from ..parameters import SailParameters
from ..results.unfinished import new_results
from ..run import sail
from ..run.record import Recorder
from ..scene import hub
from ..view import plots
from ..view.report import PAGE
from .options import add_argument, add_out

RPM = 2 * pi / 60
THICKNESS = 7.5e-6  # m, of the polyimide film
AREAL_MASS = 0.081  # kg/m2, with solar cells and liquid-crystal devices
HUB_INERTIA = 67.0  # kg m2, of the body, fitted to the spin from 25 to 2.5 rpm in stage 1
SUNLIGHT = {"specular": 0.83, "diffuse": 0.05}  # shares of an aluminised film, McInnes 1999, 2.6
FLIGHT_SPIN = 2.5  # rpm, with the arms out, and again after stage 2
FLIGHT_CROSS = 779.0  # kg m2, of body and arms of 10 m, by the same fit; the flat sail's is 780
STEP = 0.5  # of the critical time step
SHOWN = (0.0, 1.0, 2.0, 4.0, 12.0)  # s, and the end
OPTIONS = ("fold_lines", "refine", "duration", "zeta")

IKAROS = SailParameters(
    outer_width=14.0,
    inner_width=3.2,
    thickness=THICKNESS,
    density=AREAL_MASS / THICKNESS,
    spool_radius=0.79,
    tip_mass=0.5,
    hub_inertia=HUB_INERTIA,
    crease_law="conservative",  # which gives and takes no angular momentum
    gravity=0.0,
    air_density=0.0,
    bar_radius=0.93,
    arm_radius=1.24,
    layer_gap=3e-3,
    tether_stiffness=2e3,
    tether_density=5e-3,
    tether_radius=5e-3,
    spool_height=1.0,
    history_interval=0.1,
    shapes_interval=0.5,
    duration=120.0,
)


def command_line():
    """Parsed sys.argv."""
    parser = argparse.ArgumentParser(
        prog="ikaros", description="Stage 2 of the deployment of IKAROS, on a free hub."
    )
    add_out(parser, "out/ikaros")
    parser.add_argument(
        "--spin",
        type=float,
        metavar="RPM",
        help="spin before stage 2, > 0 (default: that with the angular momentum of the flight)",
    )
    parser.add_argument(
        "--sun",
        type=float,
        metavar="DEG",
        help="let sunlight press on the film, at this angle from the spin axis (default: no light)",
    )
    for item in fields(SailParameters):
        if item.name in OPTIONS:
            add_argument(parser, item, getattr(IKAROS, item.name))
    return parser.parse_args()


def shine(net, angle):
    """Add sunlight to the scene's engines, `angle` [deg] from the spin axis, from above."""
    direction = (sin(radians(angle)), 0, -cos(radians(angle)))
    light = SolarPressure(membrane=net, direction=direction, **SUNLIGHT)
    Omega().engines = [light, *Omega().engines]


def draw(mesh, recorder, history, rigid, path):
    """Six shapes, and under them the spin of the hub and what momentum makes of it, `rigid`."""
    times = np.array(recorder.frame_times)
    figure = Figure(figsize=(10.5, 7.6))
    for place, wanted in enumerate((*SHOWN, times[-1])):
        i = int(np.argmin(np.abs(times - wanted)))
        left, bottom = place % 3 / 3, 0.68 - 0.29 * (place // 3)
        axes = figure.add_axes((left, bottom, 1 / 3, 0.3), projection="3d")
        plots.draw_sail(axes, mesh, recorder.frames[i], 0.72 * mesh.outer_width)
        if place == 0:
            plots.draw_scale_bar(axes, 0.72 * mesh.outer_width)
        figure.text(left + 1 / 6, bottom + 0.28, f"{times[i]:.0f} s", ha="center", fontsize=11)
    axes = figure.add_axes((0.07, 0.075, 0.9, 0.3))
    axes.plot(history["time"], history["hub_spin"] / RPM, label="hub")
    axes.plot(history["time"], rigid, color="0.4", label="angular momentum / moment of inertia")
    label = "IKAROS in flight, before and after stage 2"
    axes.axhline(FLIGHT_SPIN, color="C3", linestyle="--", label=label)
    axes.set(xlabel="time [s]", ylabel="spin [rpm]", xlim=(0, times[-1]), ylim=(0, None))
    axes.grid(alpha=0.3)
    axes.legend(frameon=False)
    figure.savefig(path, dpi=plots.DPI)


def report(p, history, rigid):
    """What the run found, `rigid` [rpm] being the spin that momentum makes of the shape."""
    momentum, late = history["angular_momentum"], history["time"] >= 0.75 * p.duration
    hub = history["hub_energy"]

    def mean(values):
        return float(np.mean(values[late]))

    return {
        "parameters": p.as_dict(),
        "versions": sail.versions(),
        "measures": {
            "spin_before": float(history["hub_spin"][0]),
            "spin_after": mean(history["hub_spin"]),
            "spin_after_by_momentum": RPM * mean(rigid),
            "final_deployment_rate": float(history["deployment_rate"][-1]),
            "largest_deployment_rate": float(history["deployment_rate"].max()),
        },
        "spin_rpm": {
            "before": float(history["hub_spin"][0] / RPM),
            "after": mean(history["hub_spin"]) / RPM,
            "after_by_momentum": mean(rigid),
            "flight_before_and_after": FLIGHT_SPIN,
        },
        "inertia_before": float(history["inertia"][0]),
        "inertia_after": mean(history["inertia"]),
        "deployment_rate_after": mean(history["deployment_rate"]),
        "angular_momentum": float(momentum[0]),
        "angular_momentum_drift": float(np.abs(momentum / momentum[0] - 1).max()),
        "kinetic_energy_before": float(history["kinetic_energy"][0]),
        "kinetic_energy_after": mean(history["kinetic_energy"]),
        "largest_change_of_hub_energy": float(np.abs(hub - hub[0]).max()),
        "work_of_damping": float(history["damping_work"][-1]),
        "work_of_contacts": float(history["contact_work"][-1]),
        **energy_errors(history),
    }


def deploy(p, spin, folder, sun=None):
    """Do it all; returns what is written to summary.json.

    Parameters
    ----------
    spin : float or None
        Before stage 2 [rpm]; None: with the angular momentum of the flight.
    sun : float or None
        Angle of sunlight from the spin axis [deg]; None: no light.
    """
    mesh, built = sail.build(p)
    if sun is not None:
        shine(built.membrane, sun)
    critical = built.forces.criticalTimeStep()
    p = replace(p, dt=STEP * critical, omega=(FLIGHT_SPIN if spin is None else spin) * RPM)
    sail.spin_up(built, p)
    if spin is None:
        cross = hub.inertia(built, built.positions())
        p = replace(p, omega=p.omega * FLIGHT_CROSS / cross)
    recorder = Recorder(folder, mesh, built, p.omega)
    try:
        sail.release(mesh, built, p)
        with sail.last_good_saved(built, folder, Omega().iter):
            sail.march(p, recorder, lambda row: f"hub {row['hub_spin'] / RPM:.2f} rpm")
    finally:
        recorder.close()
    history = recorder.columns()
    rigid = history["angular_momentum"] / history["inertia"] / RPM
    summary = {"critical_time_step": critical, **report(p, history, rigid)}
    if sun is not None:
        light = {"angle": sun, "work": built.ledger.workOf("sunlight"), **SUNLIGHT}
        summary["sunlight"] = light
    write_json(folder / "summary.json", summary)
    draw(mesh, recorder, history, rigid, folder / "ikaros.png")
    sail.write_page(folder)
    return summary


def main():
    """Deploy it and tell about the spin; sys.exit with one sentence if that cannot be."""
    arguments = command_line()
    given = {name: getattr(arguments, name) for name in OPTIONS}
    with new_results(arguments.out) as part:
        found = deploy(replace(IKAROS, **given), arguments.spin, part, arguments.sun)
    spin = found["spin_rpm"]
    print(
        f"Spin {spin['before']:.2f} rpm before, {spin['after']:.2f} rpm after, "
        f"{spin['after_by_momentum']:.2f} rpm by momentum; in flight {FLIGHT_SPIN} rpm before and "
        f"after. Inertia from {found['inertia_before']:.0f} to {found['inertia_after']:.0f} kg m2."
    )
    print("Look at:")
    for name in ("ikaros.png", PAGE, "history.csv", "summary.json", "shapes/film.pvd"):
        if (arguments.out / name).exists():
            print(f"  {arguments.out / name}")
