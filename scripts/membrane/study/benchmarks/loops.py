# SPDX-License-Identifier: GPL-2.0-or-later
"""Path law2: the plugin's functors and its engine beside YADE's own sphere contacts."""

from functools import partial

from membrane.mesh import sail_mesh

from . import AT_MOST, Entry, Settings
from .turns import entry, ratio_entry, take_turns
from .workers import workers

MOST_LOOP, MOST_ENGINE = 0.6, 0.3
STEPS = 2000


def measure(settings: Settings) -> list[Entry]:
    """Entries for the sail as the paper has it and with a finer mesh."""
    found = []
    for refine in (1,) if settings.quick else (1, 2):
        found += measure_sail(refine, settings)
    return found


def measure_sail(refine: int, settings: Settings) -> list[Entry]:
    """Entries for the sail in one fineness."""
    nodes = len(sail_mesh(refine=refine).nodes)
    settings.tell(f"functors on the sail of {nodes} nodes")
    steps = round(settings.work(STEPS) / refine**2)
    plans = {
        name: {"situation": name, "refine": refine} for name in ("springs", "contacts", "folded")
    }
    with workers(plans) as started:
        asked = {name: partial(one.measure, steps) for name, one in started.items()}
        answers = take_turns(asked, settings.rounds, settings.quiet)
    springs, contacts = ([a["seconds"] for a in answers[n]] for n in ("springs", "contacts"))
    engine, loop = ([a[n] for a in answers["folded"]] for n in ("engine", "loop"))
    times = {
        "InteractionLoop, membrane's functors, flat sail": springs,
        "InteractionLoop, YADE's sphere contact, same pairs": contacts,
        "InteractionLoop, membrane's functors, folded sail": loop,
        "MembraneForceEngine, all forces, folded sail": engine,
    }
    entries = [entry(n, [1e9 * t for t in times[n]], "ns a side and step", nodes) for n in times]
    over = "over YADE's sphere contact"
    for name, taken, most in (
        ("membrane's functors", springs, MOST_LOOP),
        ("MembraneForceEngine", engine, MOST_ENGINE),
    ):
        wanted: dict = {"target": most, "bound": AT_MOST}
        entries.append(ratio_entry(f"{name} {over}", taken, contacts, nodes, **wanted))
    name = "MembraneForceEngine over membrane's own functors"
    return settings.quiet.mark([*entries, ratio_entry(name, engine, loop, nodes)])
