# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper's sail: a square of four petals, folded to a cross, on tethers about a spool."""

from dataclasses import asdict, replace
from typing import ClassVar, TypeVar

import numpy as np

from ...measures import SQUARE, SQUARE_OUTCOMES, in_plots
from ...mesh import mesh_of
from ...mesh.fold import fold, fold_report
from ...parameters import PHYSICAL, SailParameters
from ...view import plots
from ..kind import FinishedSail, Kind, Sail, in_si


P = TypeVar("P", bound=SailParameters)


class Square(Kind[P]):
    """See the module."""

    title = "the paper's square sail, folded to a cross"
    parameters: ClassVar = SailParameters
    measures = SQUARE
    outcomes = SQUARE_OUTCOMES
    told = "deployment_rate"

    def sail(self, p: P) -> Sail:
        """Guides hold the middles of the petals, and the spool the tethers' ends."""
        mesh = mesh_of(p)
        start = fold(mesh, p.bar_radius, p.arm_radius, p.layer_gap)
        return Sail(
            mesh,
            start,
            mesh.tips,
            p.tip_mass,
            mesh.cables,
            hub=mesh.anchors,
            touching=np.setdiff1d(mesh.tether_nodes, mesh.anchors),
            held=mesh.guide_nodes.ravel(),
            facts={"fold": asdict(fold_report(mesh, start))},
        )

    def film(self, sail: Sail, p: P) -> P:
        """One film on every mesh: alpha, alpha_c, beta and zeta are those of refine 1."""
        n = p.refine
        if p.film == "springs" and (p.as_printed or n == 1):
            return p
        if p.film == "springs":
            scaled = {"alpha": n**-2, "alpha_crease": n**-2, "beta": 1 / n, "zeta": n}
            given = {number for name, number in PHYSICAL.items() if getattr(p, name) > 0}
            numbers = {k: f * getattr(p, k) for k, f in scaled.items() if k not in given}
            return replace(p, **numbers)
        return in_si(mesh_of(replace(p, refine=1)), p)

    def about_film(self, p: P) -> list[str]:
        """Nothing: what is not given in SI follows from refine 1."""
        return []

    def draw(self, run: FinishedSail) -> None:
        """deployment.png, and shapes.png with six instants up to the fullest deployment."""
        columns = in_plots(self.measures, run.history)
        plots.plot_history(run.history, columns, run.folder / "deployment.png")
        rates = np.interp(run.times, run.history["time"], run.history["deployment_rate"])
        frames, times = run.show(run.until(int(np.argmax(rates))))
        plots.plot_shapes(frames, run.sail.mesh, run.folder / "shapes.png", times)


KIND: Kind = Square()
