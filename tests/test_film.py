# SPDX-License-Identifier: GPL-2.0-or-later
"""A film of plane stress and tension field, creases per length, one damping time: on any mesh.

Held against reference/forces.py, which takes deformation gradients and eigenvectors where the
plugin takes side lengths; against matrices of differences; and one path against the other.
"""

import unittest
from dataclasses import replace

import membrane
import numpy as np
from membrane import scene
from membrane.mesh import mesh_of
from membrane.mesh.fold import fold
from membrane.parameters import PHYSICAL, SailParameters, SceneParameters
from membrane.results.output import list_series, read_frame
from membrane.run import driver
from membrane.run.sails import SAILS
from membrane.scene.physical import physical_parameters
from membrane.study.sources import paper
from membrane.study.verification import film
from membrane.view.report import run_data
from support import (
    O,
    SceneTest,
    Sheet,
    film_of_the_sail,
    grid,
    node_states,
    quiet,
    rotation,
    scratch,
    set_engines,
)
from yade import utils
from yade import wrapper as yade

YOUNG, POISSON, THICKNESS = 3.2e9, 0.34, 7.5e-6
LAW = YOUNG, POISSON, THICKNESS
BUCKLING_LENGTH = 2.26e-3  # [m]
TIME = 7e-7  # of damping [s]
STATES = ("taut", "wrinkled", "slack")


def film_sheet(nodes, triangles, *, engine=None, **options):
    """A Sheet of plane stress."""
    about = {"film": "plane_stress", **options}
    return Sheet(nodes, triangles, interactions=False, engine=engine, **about)


def shapes(mesh, rest, rng):
    """The film of the sail flat, crumpled and folded, shaken a little."""
    yield "flat", rest + 1e-5 * rng.normal(size=rest.shape)
    yield "crumpled", rest + 5e-3 * rng.normal(size=rest.shape)
    yield "folded", fold(mesh)[: len(rest)] + 1e-4 * rng.normal(size=rest.shape)


class TestForces(SceneTest):
    def test_forces_and_energies_are_those_of_tensors_in_all_states(self):
        mesh, rest = film_of_the_sail()
        rng = np.random.default_rng(0)
        for length in (0.0, BUCKLING_LENGTH):
            O.reset()
            sheet = film_sheet(rest, mesh.triangles, bucklingLength=length)
            law = (*LAW, sheet.membrane.bucklingStress)
            seen = np.zeros(3)
            for name, x in shapes(mesh, rest, rng):
                v = rng.normal(size=x.shape)
                expected, energy = paper.film_forces(x, rest, mesh.triangles, *law)
                size = np.abs(expected).max()
                sheet.engine.dampingTime = 0
                found = sheet.place(x, v).engine_forces()
                np.testing.assert_allclose(found, expected, atol=1e-12 * size, err_msg=name)
                self.assertAlmostEqual(sheet.membrane.elasticEnergy() / energy, 1, delta=1e-12)
                sheet.engine.dampingTime = TIME
                found = sheet.place(x, v).engine_forces()
                expected += paper.film_damping(x, v, rest, mesh.triangles, *law, TIME)
                np.testing.assert_allclose(found, expected, atol=1e-12 * size, err_msg=name)
                _, strain, _ = paper.film_strain(x, rest, mesh.triangles)
                states = paper.film_stress(strain, YOUNG, POISSON, law[-1])[2]
                np.testing.assert_array_equal(sheet.membrane.filmStates(x), states)
                seen += np.bincount(states, minlength=3)
            self.assertGreater(seen.min(), 100, STATES)

    def test_patches_of_any_mesh_have_hookes_stress_and_poissons_ratio(self):
        rng = np.random.default_rng(1)
        nodes, triangles = grid(5, jitter=0.35, rng=rng)
        sheet = film_sheet(nodes, triangles, bucklingLength=1e-4)  # far from buckling
        for strain in ([1e-3, 0, 0], [0, 1e-3, 0], [1e-3, 1e-3, 0], [0, 0, 1e-3], [1e-3, 0, 7e-4]):
            xx, yy, xy = strain
            green = np.array([[xx, xy], [xy, yy]])
            stretch = np.linalg.cholesky(2 * green + np.eye(2)).T
            x = nodes.copy()
            x[:, :2] = nodes[:, :2] @ stretch.T
            hooke = YOUNG / (1 - POISSON**2) * ((1 - POISSON) * green)
            hooke += YOUNG / (1 - POISSON**2) * POISSON * np.trace(green) * np.eye(2)
            expected = np.sort(np.linalg.eigvalsh(hooke))[::-1]
            found = np.array(sheet.membrane.filmStresses(x))
            np.testing.assert_allclose(found, np.tile(expected, (len(triangles), 1)), atol=1e-3)
            inner = np.all((nodes[:, :2] > 0.008) & (nodes[:, :2] < 0.092), axis=1)
            forces = sheet.place(x).engine_forces()
            self.assertLess(np.abs(forces[inner]).max(), 1e-11 * np.abs(forces).max())

    def test_rigid_motion_leaves_no_force_and_forces_no_thrust(self):
        rng = np.random.default_rng(2)
        nodes, triangles = grid(4, jitter=0.2, rng=rng)
        sheet = film_sheet(nodes, triangles, engine={"dampingTime": TIME})
        turn, spin = rotation(rng), rng.normal(size=3)
        x = nodes @ turn.T + 0.3
        found = sheet.place(x, np.cross(spin, x)).engine_forces()
        self.assertLess(np.abs(found).max(), 1e-12 * YOUNG * THICKNESS * 0.02)
        x = x + 2e-3 * rng.normal(size=x.shape)
        found = sheet.place(x, rng.normal(size=x.shape)).engine_forces()
        size = np.abs(found).max()
        self.assertLess(np.abs(found.sum(axis=0)).max(), 1e-13 * size * len(x))
        self.assertLess(np.abs(np.cross(x, found).sum(axis=0)).max(), 1e-13 * size * len(x))

    def test_flat_triangles_are_taken(self):
        nodes = [(0, 0, 0), (1, 0, 0), (0.5, 0.01, 0), (0.5, -0.5, 0)]
        triangles = [(0, 1, 2), (1, 0, 3)]
        with self.assertRaises(ValueError):  # by (5) its base has a negative stiffness
            Sheet(nodes, triangles)
        O.reset()
        sheet = film_sheet(nodes, triangles)
        self.assertGreater(min(sheet.membrane.stiffnesses), 0)

    def test_collapsed_and_inverted_triangles_have_finite_forces(self):
        nodes = np.array([(0, 0, 0), (0.02, 0, 0), (0.01, 0.02, 0)])
        sheet = film_sheet(nodes, [(0, 1, 2)], engine={"dampingTime": TIME})
        for third in ((0.01, 0, 0), (0.01, -0.02, 0), (0, 0, 0)):
            x = nodes.copy()
            x[2] = third
            self.assertTrue(np.isfinite(sheet.place(x, 10 * x).engine_forces()).all())
        self.assertTrue(np.isfinite(sheet.place(np.zeros((3, 3))).engine_forces()).all())

    def test_wrinkles_run_along_the_tension(self):
        rng = np.random.default_rng(5)
        nodes, triangles = grid(3, jitter=0.2, rng=rng)
        sheet = film_sheet(nodes, triangles)
        turn, angle = rotation(rng), 0.4
        along, across = np.array([np.cos(angle), np.sin(angle)]), [-np.sin(angle), np.cos(angle)]
        stretch = 1.01 * np.outer(along, along) + 0.98 * np.outer(across, across)
        x = nodes.copy()
        x[:, :2] = nodes[:, :2] @ stretch
        found = np.array(sheet.membrane.wrinkleDirections(x @ turn.T))
        self.assertEqual(set(sheet.membrane.filmStates(x @ turn.T)), {1})
        expected = turn @ [*along, 0]
        np.testing.assert_allclose(np.abs(found @ expected), 1, atol=1e-12)
        np.testing.assert_array_equal(sheet.membrane.wrinkleDirections(), np.zeros(found.shape))


class TestMotion(SceneTest):
    def swinging(self, path, ledger=True):
        """A sheet with cables, creases, damping and drag that crumples."""
        O.reset()
        rng = np.random.default_rng(3)
        nodes, triangles = grid(6, jitter=0.2, rng=rng)
        creases = [(14 + j, 15 + j) for j in range(6)]
        cables = [(0, 16), (6, 30)]
        net = scene.add_membrane(
            nodes,
            triangles,
            creases,
            [1] * 6,
            cables,
            positions=nodes + 1e-4 * rng.normal(size=nodes.shape),
            interactions=path == "law2",
            film="plane_stress",
            bucklingLength=BUCKLING_LENGTH,
        )
        made = set_engines(
            net,
            path=path,
            film="plane_stress",
            damping_time=TIME,
            crease_length=8e-4,
            air_density=0.5,
            energy_tolerance=0.1,
        )
        for i in net.bodyIds:
            O.bodies[i].state.vel = rng.normal(size=3).tolist()
        O.dt = 0.3 * made.forces.criticalTimeStep()
        return made

    def test_paths_agree_over_a_thousand_steps_and_so_do_their_ledgers(self):
        found, seen = {}, set()
        for path in scene.PATHS:
            made = self.swinging(path)
            for _ in range(10):
                seen.update(made.membrane.filmStates())
                scene.advance(100)
            ledger = made.ledger
            names = ("kinetic", "elastic", "crease", "dampingWork", "dragWork", "kinkError")
            found[path] = node_states(made.membrane), [getattr(ledger, n) for n in names]
        self.assertEqual(seen, {0, 1, 2})
        (states, book), (others, other_book) = found["fused"], found["law2"]
        for one, other in zip(states, others):
            self.assertLess(np.abs(one - other).max(), 1e-10 * np.abs(other).max())
        np.testing.assert_allclose(book, other_book, atol=1e-10 * max(book))

    def test_ledger_closes_and_damping_takes(self):
        made = self.swinging("fused")
        scene.advance(2000)
        ledger = made.ledger
        self.assertLess(ledger.dampingWork, -1e-3 * ledger.initial)
        self.assertLess(abs(ledger.unexplained), 1e-3 * ledger.initial)
        # An error of the second order: half the step, a quarter of it.
        errors = []
        for share in (0.2, 0.1):
            made = self.swinging("fused")
            O.dt = share * made.forces.criticalTimeStep()
            scene.advance(round(200 / share))
            errors.append(abs(made.ledger.unexplained))
        self.assertLess(errors[1], 0.4 * errors[0])

    def test_a_saved_run_goes_on_to_the_last_bit(self):
        for path in scene.PATHS:
            made = self.swinging(path)
            scene.advance(300)
            file = str(scratch() / "film.yade.gz")
            O.save(file, quiet=True)
            scene.advance(300)
            whole = node_states(made.membrane)
            O.reset()
            O.load(file, quiet=True)
            made = scene.loaded()
            scene.advance(300)
            np.testing.assert_array_equal(node_states(made.membrane), whole)

    def test_an_interaction_on_a_side_of_the_film_is_refused(self):
        made = self.swinging("law2")
        self.assertTrue(made.membrane.hasInteractions)
        ids = made.membrane.bodyIds
        utils.createInteraction(ids[0], ids[1])
        with self.assertRaisesRegex(RuntimeError, "no side of the membrane"):
            scene.advance(3)

    def test_the_watch_names_the_triangle_that_goes_wrong(self):
        made = self.swinging("fused")
        made.forces.forceTimeStep = True
        O.dt = 1.5 * made.forces.criticalTimeStep()
        with self.assertRaisesRegex(RuntimeError, "the film and its cables gave .* at triangle"):
            scene.advance(20_000)

    def test_threads_give_the_same_motion(self):
        found = []
        for threads in (1, 3):
            made = self.swinging("fused")
            made.forces.ompThreads = threads
            scene.advance(300)
            found.append(node_states(made.membrane))
        np.testing.assert_allclose(*found, rtol=1e-9, atol=1e-12)


class TestTimeStep(SceneTest):
    def exact(self, sheet, x):
        """Step at which the leapfrog of small vibrations about x is unstable, without damping."""
        count, step = x.size, 1e-8
        stiffness = np.empty((count, count))
        for i in range(count):
            ends = []
            for sign in (1, -1):
                moved = x.ravel().copy()
                moved[i] += sign * step
                ends.append(sheet.place(moved.reshape(-1, 3)).engine_forces().ravel())
            stiffness[:, i] = (ends[1] - ends[0]) / (2 * step)
        root = np.repeat(sheet.masses**-0.5, 3)
        scaled = root[:, None] * (stiffness + stiffness.T) / 2 * root
        fastest = np.linalg.eigvalsh(scaled)[-1]
        return 2 / np.sqrt(fastest) if fastest > 0 else np.inf

    def test_prediction_is_never_above_the_exact_step_and_close_where_taut(self):
        rng = np.random.default_rng(6)
        nodes, triangles = grid(3, jitter=0.2, rng=rng)
        for name, x in (
            ("taut", 1.002 * nodes),
            ("wrinkled", nodes * [1.01, 0.97, 1]),
            ("slack", 0.97 * nodes),
            ("crumpled", nodes + 2e-3 * rng.normal(size=nodes.shape)),
        ):
            O.reset()
            sheet = film_sheet(nodes, triangles, bucklingLength=BUCKLING_LENGTH)
            predicted = sheet.place(x).engine.criticalTimeStep()
            exact = self.exact(sheet, x)
            self.assertLessEqual(predicted, exact * (1 + 1e-6), name)
            if name == "taut":
                self.assertGreater(predicted, 0.95 * exact)

    def test_a_film_that_is_shortened_counts_as_if_taut(self):
        nodes, triangles = grid(4, jitter=0.2, rng=np.random.default_rng(9))
        sheet = film_sheet(nodes, triangles, engine={"dampingTime": TIME})
        at_rest = sheet.place(nodes).engine.criticalTimeStep()
        for share in (0.7, 0.3, 1e-3, 0.0):
            found = sheet.place(share * nodes).engine.criticalTimeStep()
            self.assertLess(found, 1.05 * at_rest, share)
            self.assertGreater(found, 0.3 * at_rest, share)

    def test_damped_vibration_is_stable_below_the_predicted_step_and_not_far_above(self):
        nodes, triangles = grid(3)
        for time in (0.0, 2e-6, 2e-5):
            grown = []
            for share in (0.99, 1.05):
                O.reset()
                net = scene.add_membrane(
                    nodes, triangles, interactions=False, film="plane_stress", bucklingLength=1e-4
                )
                made = set_engines(
                    net,
                    path="fused",
                    film="plane_stress",
                    damping_time=time,
                    energy_tolerance=0,
                    force_time_step=True,
                )
                rng = np.random.default_rng(7)
                for i in net.bodyIds:
                    O.bodies[i].state.vel = [*(1e-9 * rng.normal(size=2)), 0]
                O.dt = share * made.forces.criticalTimeStep()
                try:
                    scene.advance(3000)
                    grown.append(np.abs(node_states(net)[1]).max())
                except RuntimeError as error:
                    self.assertIn("diverged", str(error))
                    grown.append(np.inf)
            self.assertLess(grown[0], 1e-7, time)
            self.assertGreater(grown[1], 1e-3, time)


class TestCreases(SceneTest):
    def hinge(self, height, **engine):
        """Forces (4, 3) [N] of a crease at a right angle, C at `height` and D at 0.02 m."""
        O.reset()
        nodes = [(0, 0, 0), (0.02, 0, 0), (0.01, height, 0), (0.01, -0.02, 0)]
        film = {"film": "plane_stress"}
        sheet = Sheet(
            nodes,
            [(0, 1, 2), (1, 0, 3)],
            creases=[(0, 1)],
            crease_signs=[1],
            interactions=False,
            engine=engine,
            **film,
        )
        x = np.array(nodes, dtype=float)
        x[3] = 0.01, 0, -0.02
        return x, sheet.place(x).engine_forces()

    def test_a_crease_per_length_is_that_of_beta_on_its_mesh(self):
        beta = 30
        length = 0.02 / (beta * (1 - POISSON**2))
        _, by_number = self.hinge(0.02, beta=beta, creaseLaw="conservative")
        _, by_length = self.hinge(0.02, creaseLength=length)
        size = np.abs(by_number).max()
        self.assertGreater(size, 0)
        np.testing.assert_allclose(by_length, by_number, atol=1e-14 * size)

    def test_moment_is_that_of_the_length_whatever_the_triangles(self):
        plate = YOUNG * THICKNESS**3 / 12 / (1 - POISSON**2)
        for height in (0.005, 0.02, 0.05):
            _, forces = self.hinge(height, creaseLength=8e-4)
            moment = plate / 8e-4 * 0.02 * np.pi / 2  # closes by theta = pi / 2 towards 0
            self.assertAlmostEqual(abs(forces[2, 2]) * height / moment, 1, places=12)
            self.assertAlmostEqual(abs(forces[3, 1]) * 0.02 / moment, 1, places=12)


class TestClosedForms(SceneTest):
    def test_wrinkled_strips_and_rings_disks_and_arms(self):
        with quiet():
            found = film.checks(full=False)
        self.assertGreater(len(found), 20)
        for check in found:
            with self.subTest(check.name, measured=check.measured, target=check.target):
                self.assertTrue(check.holds)


class TestParameters(SceneTest):
    def test_what_does_not_fit_is_refused(self):
        nodes, triangles = grid(2)
        for options, word in (
            ({"film": "shell"}, "film = shell"),
            ({"bucklingLength": -1.0}, "bucklingLength"),
            ({"creaseBucklingLength": float("nan")}, "creaseBucklingLength"),
        ):
            with self.assertRaisesRegex(ValueError, word):
                yade.Membrane(material=scene.film(), nodes=nodes, triangles=triangles, **options)
        for both, word in (
            ({"beta": 1, "creaseLength": 1e-3}, "beta = 1"),
            ({"zeta": 0.1, "dampingTime": 1e-6}, "zeta = 0.1"),
            ({"dampingTime": -1}, "dampingTime"),
        ):
            with self.assertRaisesRegex(ValueError, word):
                membrane.MembraneForceEngine(**both)
        with self.assertRaisesRegex(ValueError, "plane_stress"):
            Sheet(nodes, triangles).membrane.filmStresses()
        O.reset()
        sheet = film_sheet(nodes, triangles, engine={"zeta": 0.1})
        with self.assertRaisesRegex(ValueError, "dampingTime"):
            sheet.engine_forces()

    def test_the_same_twice_is_refused_and_its_default_is_not_twice(self):
        for name, number in PHYSICAL.items():
            with self.assertRaisesRegex(ValueError, f"{name} = .* {number} = 7"):
                SailParameters(**{name: 1e-3, number: 7.0})
            SailParameters(**{name: 1e-3})
            SailParameters(**{name: 1e-3, number: 0.0})
            self.assertEqual(getattr(SceneParameters(), name), 0)

    def test_springs_buckle_at_one_strain_where_a_length_is_given(self):
        nodes, triangles = grid(3, jitter=0.2, rng=np.random.default_rng(8))
        net = yade.Membrane(
            material=scene.film(), nodes=nodes, triangles=triangles, bucklingLength=BUCKLING_LENGTH
        )
        strain = 1 - np.array(net.criticalLengths) / net.restLengths
        expected = np.pi**2 * THICKNESS**2 / (12 * (1 - POISSON**2) * BUCKLING_LENGTH**2)
        np.testing.assert_allclose(strain, expected, rtol=1e-9)

    def test_a_finer_sail_is_of_the_same_film(self):
        kind, base = SAILS["square"], SailParameters()
        self.assertIs(kind.film(None, base), base)
        printed = replace(base, refine=3, as_printed=True)
        self.assertIs(kind.film(None, printed), printed)
        fine = kind.film(None, replace(base, refine=2))
        numbers = fine.alpha, fine.alpha_crease, fine.beta, fine.zeta
        self.assertEqual(numbers, (25.0, 250.0, 15.0, 0.04))
        given = kind.film(None, replace(base, refine=2, crease_length=1e-3))
        self.assertEqual((given.beta, given.crease_length), (base.beta, 1e-3))

    def test_the_numbers_of_finer_meshes_are_those_of_the_same_lengths(self):
        kind = SAILS["square"]
        coarse = physical_parameters(mesh_of(SailParameters()), SailParameters())
        for refine in (2, 3):
            p = SailParameters(refine=refine)
            found = physical_parameters(mesh_of(p), kind.film(None, p))
            for name in PHYSICAL:
                # A finer mesh has more rows: their mean lengths differ a little.
                self.assertAlmostEqual(found[name] / coarse[name], 1, delta=0.02)
        # by hand: rows 22 mm apart, beta = 30, nu = 0.34
        self.assertAlmostEqual(coarse["crease_length"], 0.022 / (30 * 0.8844), delta=1e-6)

    def test_a_sail_of_plane_stress_takes_the_lengths_of_the_paper_s_mesh(self):
        p = SailParameters(film="plane_stress", refine=3, damping_time=2e-6)
        given = SAILS["square"].film(None, p)
        base = physical_parameters(mesh_of(SailParameters()), SailParameters())
        for name in set(PHYSICAL) - {"damping_time"}:
            self.assertEqual(getattr(given, name), base[name])
        self.assertEqual((given.damping_time, given.zeta, given.beta), (2e-6, 0, 0))

    def test_a_run_tells_its_lengths_and_the_states_of_its_triangles(self):
        p = SailParameters(film="plane_stress", duration=4e-3, spin_up_tolerance=1e-1)
        folder = scratch() / "film_run"
        with quiet():
            summary = driver.deploy(p, folder, pictures=False, page=False)
        self.assertEqual(set(summary["film"]), set(PHYSICAL))
        self.assertAlmostEqual(summary["film"]["crease_length"], 8.29e-4, delta=1e-6)
        _, path = list_series(folder / "shapes" / "film.pvd")[-1]
        x, fields = read_frame(path)
        triangles = mesh_of(p).triangles
        _, strain, _ = paper.film_strain(x, mesh_of(p).nodes, triangles)
        buckling = np.pi**2 * YOUNG * THICKNESS**2 / 12 / (1 - POISSON**2)
        buckling /= summary["film"]["buckling_length"] ** 2
        stress, _, states = paper.film_stress(strain, YOUNG, POISSON, buckling)
        self.assertGreater(np.bincount(states, minlength=3).min(), 0)
        np.testing.assert_array_equal(fields["film_state"], states)
        principal = np.linalg.eigvalsh(stress)
        np.testing.assert_allclose(fields["first_stress"], principal[:, 1], rtol=1e-5, atol=1.0)
        np.testing.assert_allclose(fields["second_stress"], principal[:, 0], rtol=1e-5, atol=1.0)
        # A side is buckled beside a triangle that is not taut.
        self.assertEqual(np.all(states == 0), not fields["buckled"].any())
        self.assertGreaterEqual(fields["buckled"][states > 0].min(), 1)
        lengths = np.linalg.norm(fields["wrinkles"], axis=1)
        np.testing.assert_allclose(lengths, states == 1, atol=1e-6)
        page = {field["name"]: field for field in run_data(folder)["fields"]}
        self.assertEqual((page["film_state"]["low"], page["film_state"]["high"]), (0, 2))
        self.assertEqual(page["first_stress"]["unit"], "kPa")


if __name__ == "__main__":
    unittest.main()
