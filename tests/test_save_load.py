# SPDX-License-Identifier: GPL-2.0-or-later
"""A run continued from a saved state is, bit for bit, the run that never stopped.

While something touches the spool this takes YADE's `loopOnSortedInteractions`: contacts that are
about to begin are not saved, so that after loading a mass on the edge between two facets may sum
their forces in another order. Without it the difference is of the last digit.
"""

import unittest

import membrane
import numpy as np
from membrane import scene
from support import (
    O,
    contacts,
    engines_by_class,
    force_engine,
    node_states,
    release_sail,
    released_sail,
    scratch,
    wind_a_tether,
)

FORMATS = (".xml", ".xml.bz2", ".yade", ":memory:")
# None at its class's default, so that one that is not saved is missed.
UNUSUAL = {
    "alpha": 90.0,
    "alpha_crease": 900.0,
    "beta": 20.0,
    "gamma": 80.0,
    "theta0": 0.01,
    "crease_law": "conservative",
    "zeta": 0.03,
    "air_density": 2e-3,
    "gravity": 3.0,
    "tether_stiffness": 150.0,
    "tether_density": 3e-4,
    "young": 3e9,
    "poisson": 0.3,
    "thickness": 8e-6,
}
AHEAD, STEPS = 300, 500
FUSED = ({}, {"exchange_period": 7, "threads": 2})


def bits(net, ledger):
    """All numbers of the state: nodes, and the ledger's own."""
    numbers = [value for value in ledger.dict().values() if isinstance(value, (bool, float))]
    derived = [ledger.crease, ledger.total, ledger.balance]
    hub = engines_by_class().get("FreeHub")
    derived += [hub.spin, hub.angle, hub.torque] if hub else []
    return node_states(net), np.array([*numbers, *derived, O.time, O.dt, O.iter], dtype=float)


def place_to_save(form, name):
    """What to give to O.save and O.load."""
    return f":memory:{name}" if form == ":memory:" else str(scratch() / f"{name}{form}")


@unittest.skipUnless(O.numThreads == 1, "sums are in a fixed order with one thread only")
class TestContinuation(unittest.TestCase):
    def continued(self, name):
        """From the present scene: states that never stopped, and loaded ones by format."""
        for form in FORMATS:
            O.save(place_to_save(form, name), quiet=True)
        net = force_engine().membrane
        start = node_states(net)
        scene.advance(STEPS)
        never_stopped = bits(net, engines_by_class()["MembraneLedger"])
        self.assertGreater(np.abs(never_stopped[0] - start).max(), 1e-6, "nothing moved")
        loaded = {}
        for form in FORMATS:
            O.reset()
            O.load(place_to_save(form, name), quiet=True)
            net = force_engine().membrane
            np.testing.assert_array_equal(node_states(net), start, form)
            scene.advance(STEPS)
            loaded[form] = bits(net, engines_by_class()["MembraneLedger"])
        return never_stopped, loaded

    def check(self, name):
        never_stopped, loaded = self.continued(name)
        for form, found in loaded.items():
            for expected, value in zip(never_stopped, found):
                np.testing.assert_array_equal(value, expected, form)

    def sort_interactions(self):
        """Let YADE's loop go through the interactions in the order of their ids."""
        engines_by_class()["InteractionLoop"].loopOnSortedInteractions = True

    def sail(self, **options):
        release_sail(**UNUSUAL, **options)
        scene.advance(AHEAD)
        ledger = engines_by_class()["MembraneLedger"]
        self.assertTrue(ledger.started)
        self.assertNotEqual(ledger.creaseWork, 0)
        self.check("sail")

    def test_deploying_sail_of_interactions(self):
        self.sail(path="law2")

    def test_deploying_sail_of_one_engine(self):
        for options in FUSED:
            with self.subTest(**options):
                self.sail(path="fused", **options)

    def test_deploying_sail_on_a_free_hub(self):
        for path in scene.PATHS:
            with self.subTest(path):
                release_sail(**UNUSUAL, path=path, hub_inertia=1e-5)
                scene.advance(AHEAD)
                self.assertNotEqual(engines_by_class()["FreeHub"].torque, 0)
                self.check("hub")

    def test_tether_wound_onto_the_turning_spool(self):
        for path in scene.PATHS:
            with self.subTest(path):
                wind_a_tether(path)
                self.assertGreater(contacts(), 2)
                self.sort_interactions()
                self.check("tether")

    def test_wound_tether_in_any_order_is_the_same_but_for_rounding(self):
        wind_a_tether()
        self.assertGreater(contacts(), 2)
        never_stopped, loaded = self.continued("unsorted")
        for (places, velocities), _ in loaded.values():
            places_before, velocities_before = never_stopped[0]
            np.testing.assert_allclose(places, places_before, rtol=0, atol=1e-14)
            np.testing.assert_allclose(velocities, velocities_before, rtol=0, atol=1e-9)


class TestSharing(unittest.TestCase):
    def test_shared_objects_stay_shared(self):
        for path in scene.PATHS:
            with self.subTest(path):
                self.check_sharing(path)

    def check_sharing(self, path):
        O.reset()
        O.load(str(released_sail(path)), quiet=True)
        for form in FORMATS:
            O.save(place_to_save(form, "shared"), quiet=True)
            O.reset()
            O.load(place_to_save(form, "shared"), quiet=True)
            engines = engines_by_class()
            forces = force_engine()
            functors = [
                f
                for f in engines["InteractionLoop"].physDispatcher.functors
                if hasattr(f, "membrane")
            ]
            self.assertEqual(len(functors), path == "law2")
            holders = [forces, *functors, engines["CentrifugalField"]]
            holders = [holder.membrane for holder in holders]
            node = O.bodies[forces.membrane.bodyIds[0]]
            materials = [holder.material for holder in holders]
            materials += [node.material, O.materials[node.material.id]]
            for written in materials:
                written.frictionAngle += 0.01
                angles = {material.frictionAngle for material in materials}
                self.assertEqual(angles, {written.frictionAngle}, form)
            forces.beta = 7.0
            self.assertEqual(engines["MembraneLedger"].forces.beta, 7.0, form)

    def test_every_attribute_and_the_rest_state_are_kept(self):
        for path in scene.PATHS:
            with self.subTest(path):
                self.check_contents(path)

    def check_contents(self, path):
        fused = path == "fused"
        release_sail(path=path, **UNUSUAL, **(FUSED[-1] if fused else {}))
        scene.advance(5)
        O.save(":memory:before", quiet=True)  # some attributes are fetched by a save
        expected = contents()
        self.assertEqual(len(expected["links"]), 0 if fused else 1316)
        made = membrane.MembraneIntegrator if fused else membrane.MembraneForceEngine
        for kind, defaults in (("membrane", membrane.Membrane()), ("forces", made())):
            for name, value in plain(defaults).items():
                if name not in ALIKE:
                    self.assertNotEqual(expected[kind][name], value, name)
        for form in FORMATS:
            O.save(place_to_save(form, "all"), quiet=True)
            O.reset()
            O.load(place_to_save(form, "all"), quiet=True)
            found = contents()
            for kind, values in expected.items():
                self.assertEqual(found[kind], values, (form, kind))


# Attributes that the scene leaves at their defaults.
ALIKE = {
    # Those in SI exclude the numbers that it has; test_film saves and loads a scene with them.
    *("film", "bucklingLength", "creaseBucklingLength", "creaseLength", "dampingTime"),
    "dead",
    "label",
    "ompThreads",
    "forceTimeStep",
    "timeStepCheckPeriod",
    "allowNegativeStiffness",
    "damping",
    "nodeMask",
    "moveNodes",
}
# Not saved; YADE computes its geometry's in the first step.
UNSAVED = {"unusedFriction", "penetrationDepth"}


def plain(thing):
    """Attributes of an object that are numbers, texts, vectors or lists of them."""
    found = {}
    for name, value in thing.dict().items():
        if not hasattr(value, "dict") and value is not None and name not in UNSAVED:
            found[name] = value
    return found


def contents():
    """All that the membrane, its springs and its engines hold, and what follows from it."""
    engines = engines_by_class()
    net = force_engine().membrane
    derived = ("sides", "sideKinds", "restLengths", "stiffnesses", "criticalLengths", "masses")
    return {
        "membrane": {**plain(net), **{name: getattr(net, name) for name in derived}},
        "material": plain(net.material),
        "links": {(i.id1, i.id2): (plain(i.phys), plain(i.geom)) for i in O.interactions},
        "forces": plain(force_engine()),
        **{name: plain(engines[name]) for name in ("CentrifugalField", "MembraneLedger")},
    }


if __name__ == "__main__":
    unittest.main()
