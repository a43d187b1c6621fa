# SPDX-License-Identifier: GPL-2.0-or-later
"""IKAROS, the flight sail: the second stage of its deployment, on a hub that turns freely.

From a cross of four folded arms, held at the body, to the flat square of 14 m. Nobody drives the
hub: the spin follows from angular momentum.

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

from dataclasses import dataclass
from math import cos, radians, sin
from typing import Any, ClassVar

from matplotlib.figure import Figure

from ...measures import RPM, spin_by_momentum
from ...parameters import ASSUMED, SPIN, SailParameters, changed, parameter, with_defaults
from ...view import plots
from ..kind import FinishedSail, Sail
from .square import Square

THICKNESS = 7.5e-6  # m, of the polyimide film
AREAL_MASS = 0.081  # kg/m2, with solar cells and liquid-crystal devices
HUB_INERTIA = 67.0  # kg m2, of the body, fitted to the spin from 25 to 2.5 rpm in stage 1
SUNLIGHT = {"specular": 0.83, "diffuse": 0.05}  # shares of an aluminised film, McInnes 1999, 2.6
FLIGHT_SPIN = 2.5  # rpm, with the arms out, and again after stage 2
FLIGHT_CROSS = 779.0  # kg m2, of body and arms of 10 m, by the same fit; the flat sail's is 780
SHOWN = (0.0, 1.0, 2.0, 4.0, 12.0)  # s, and the end


@dataclass(frozen=True)
class Flight:
    """What the flight sail has besides the paper's."""

    spin: float = parameter(
        0.0, "rpm", SPIN, "spin before stage 2; 0: what gives the flight's angular momentum"
    )
    sun: float = parameter(
        -1.0,
        "deg",
        ASSUMED,
        "angle of sunlight on the film from the spin axis; -1: no light",
        least=-1,
        most=180,
    )


@dataclass(frozen=True)
@with_defaults(
    omega=changed(FLIGHT_SPIN / RPM.factor, text="spin in which the folded sail comes to rest"),
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
    dt=0.0,
)
class IkarosParameters(SailParameters, Flight, sail="ikaros"):
    """Parameters of the flight sail; with a spin of its own, omega follows from it."""

    def __post_init__(self) -> None:
        if self.spin:
            object.__setattr__(self, "omega", self.spin / RPM.factor)
        super().__post_init__()


class Ikaros(Square[IkarosParameters]):
    """See the module."""

    title = "the flight sail IKAROS, stage 2, on a hub that turns freely"
    parameters: ClassVar = IkarosParameters
    told = "hub_spin"

    def equip(self, sail: Sail, built: Any, p: IkarosParameters) -> None:
        """Let the sun shine, from above, if it does."""
        from yade.wrapper import Omega

        from ... import SolarPressure

        if p.sun >= 0:
            direction = (sin(radians(p.sun)), 0, -cos(radians(p.sun)))
            light = SolarPressure(membrane=built.membrane, direction=direction, **SUNLIGHT)
            Omega().engines = [light, *Omega().engines]

    def release_rate(self, built: Any, p: IkarosParameters) -> float:
        """The spin asked for, or that with the flight's angular momentum."""
        from ...scene.hub import inertia

        if p.spin:
            return p.omega
        return p.omega * FLIGHT_CROSS / inertia(built, built.positions())

    def draw(self, run: FinishedSail) -> None:
        """ikaros.png: six shapes, and the spin of the hub and what momentum makes of it."""
        figure = Figure(figsize=(10.5, 7.6))
        frames, times = run.show((*SHOWN, run.times[-1]))
        width = 0.72 * run.sail.mesh.outer_width
        for place, (shape, time) in enumerate(zip(frames, times)):
            left, bottom = place % 3 / 3, 0.68 - 0.29 * (place // 3)
            axes = figure.add_axes((left, bottom, 1 / 3, 0.3), projection="3d")
            plots.draw_sail(axes, run.sail.mesh, shape, width)
            if place == 0:
                plots.draw_scale_bar(axes, width)
            figure.text(left + 1 / 6, bottom + 0.28, f"{time:.0f} s", ha="center", fontsize=11)
        axes = figure.add_axes((0.07, 0.075, 0.9, 0.3))
        self._draw_spin(axes, run.history)
        plots.save(figure, run.folder / "ikaros.png")

    def _draw_spin(self, axes, history):
        time = history["time"]
        axes.plot(time, RPM.factor * history["hub_spin"], label="hub")
        label = "angular momentum / moment of inertia"
        axes.plot(time, RPM.factor * spin_by_momentum(history), color="0.4", label=label)
        label = "IKAROS in flight, before and after stage 2"
        axes.axhline(FLIGHT_SPIN, color="C3", linestyle="--", label=label)
        axes.set(xlabel="time [s]", ylabel="spin [rpm]", xlim=(0, time[-1]), ylim=(0, None))
        axes.grid(alpha=0.3)
        axes.legend(frameon=False)

    def leave(self, run: FinishedSail) -> dict:
        """The work of sunlight, if any."""
        if run.parameters.sun < 0:
            return {}
        return {"sunlight_work": run.built.ledger.workOf("sunlight")}


KIND = Ikaros()
