"""What is wrong is said by exceptions with the field, the value and what is allowed; nothing changes by them."""
import pickle
import tempfile
import unittest
from pathlib import Path

import mallow
import numpy
from support import SCENE, cube


class Exceptions(unittest.TestCase):
    def test_are_of_the_library(self):
        for kind in (mallow.ConfigError, mallow.IoError, mallow.StepError, mallow.BusyError):
            self.assertTrue(issubclass(kind, mallow.Error))

    def test_config_errors_have_all_problems(self):
        with self.assertRaises(mallow.ConfigError) as caught:
            mallow.Simulation(mallow.SolverConfig(time_step=-1, rotation_iterations=99))
        error = caught.exception
        self.assertEqual(len(error.problems), 2)
        self.assertEqual(error.field, error.problems[0].field)
        self.assertIn("-1", error.problems[0].message)
        self.assertIsInstance(error, ValueError)

    def test_arguments_that_do_not_fit_are_shown_in_short(self):
        points, simulation = numpy.arange(3000000.0).reshape(-1, 3), cube()
        for wrong in (lambda: simulation.set_gravity(points, points), lambda: mallow.read_mesh(points),
                      lambda: mallow.Trade(points), lambda: mallow.Surfacer(points, points, points)):
            with self.assertRaises(TypeError) as caught:
                wrong()
            self.assertLess(len(str(caught.exception)), 400)
            self.assertNotIn("_mallow", str(caught.exception))

    def test_scene_errors_have_lines(self):
        with self.assertRaises(mallow.ConfigError) as caught:
            mallow.parse_scene(SCENE.replace("0.3", "3"), "my.toml")
        self.assertEqual((caught.exception.file, caught.exception.line), ("my.toml", 4))

    def test_files(self):
        with self.assertRaises(mallow.IoError) as caught:
            mallow.read_mesh("none.obj")
        self.assertEqual(caught.exception.file, "none.obj")

    def test_a_step_that_cannot_be_taken(self):
        simulation = cube()
        simulation.set_force(lambda particles, accelerations: accelerations.fill(numpy.nan))
        before = simulation.state_hash()
        with self.assertRaises(mallow.StepError) as caught:
            simulation.step()
        self.assertIsInstance(caught.exception.phase, mallow.Phase)
        self.assertIsInstance(caught.exception.particle_id, int)
        self.assertEqual(simulation.state_hash(), before)

    def test_a_force_callback_that_returns_what_it_should_add(self):
        simulation = cube()
        simulation.set_force(lambda particles, accelerations: accelerations + 1)
        with self.assertRaisesRegex(TypeError, "adds to the accelerations in place"):
            simulation.step()

    def test_objects_that_nobody_constructed(self):
        refused = 0
        for kind in vars(mallow).values():
            if not isinstance(kind, type) or issubclass(kind, BaseException):
                continue
            bare = kind.__new__(kind)
            for name in dir(kind):
                if name.startswith("__") and name != "__repr__":
                    continue
                try:
                    value = getattr(bare, name)
                    value() if callable(value) else value
                except (TypeError, AttributeError, mallow.Error) as error:
                    refused += "never constructed" in str(error)
        self.assertGreater(refused, 100)

    def test_ids_of_another_kind_and_dead_ones(self):
        simulation = cube()
        body = simulation.bodies()[0]
        with self.assertRaises(TypeError):
            simulation.remove_body(mallow.ColliderId(0))
        with self.assertRaises(TypeError):
            simulation.remove_body(0)
        simulation.step()
        for call in (simulation.row, simulation.alpha, simulation.rest_position, simulation.rotation):
            call(simulation.ids[0])
            call(0)
            for wrong in (body, 0.0, "0", None):
                with self.assertRaises(TypeError):
                    call(wrong)
        simulation.remove_body(body)
        for call in (simulation.rows, simulation.wake, simulation.motion, simulation.remove_body):
            with self.assertRaises(mallow.ConfigError):
                call(body)


class Arguments(unittest.TestCase):
    def test_arrays_of_the_wrong_kind(self):
        simulation = cube()
        ids = simulation.ids
        for wrong in (ids.astype(float), ids.astype(bool), numpy.array(["a"]), numpy.array([None]), "abc", 3, None):
            with self.assertRaises(TypeError):
                simulation.set_alpha(wrong, 0.5)
        for wrong in (-ids.astype(int) - 1, ids[:, None], ids.reshape(4, 16)):
            with self.assertRaises(ValueError):
                simulation.set_alpha(wrong, 0.5)
        with self.assertRaises(mallow.ConfigError):
            simulation.set_alpha(ids + 1000, 0.5)
        with self.assertRaises(ValueError):
            simulation.set_velocity(ids, numpy.zeros(4))
        with self.assertRaises(TypeError):
            simulation.set_velocity(ids, numpy.zeros(3, complex))

    def test_points_too_far_away_to_draw(self):
        with self.assertRaisesRegex(mallow.ConfigError, "farther than"):
            mallow.surface([[-1e20, 1e20, 0]], 1, threads=2)

    def test_strides_and_dtypes_do_not_matter(self):
        points = numpy.arange(60, dtype=numpy.int16).reshape(3, 20).T[::-2]
        body = mallow.Body(positions=points, spacing=1)
        numpy.testing.assert_array_equal(body.positions, points)
        body = mallow.Body(positions=points.astype(">f8"), spacing=1)
        numpy.testing.assert_array_equal(body.positions, points)

    def test_fields(self):
        with self.assertRaisesRegex(TypeError, "SolverConfig has no field gravitation"):
            mallow.SolverConfig(gravitation=1)
        with self.assertRaisesRegex(TypeError, r"Material.youngs_modulus must be a number > 0"):
            mallow.Material(youngs_modulus="stiff")
        with self.assertRaises(AttributeError):
            mallow.Sphere().radius = 2
        with self.assertRaises(AttributeError):
            mallow.Material().alhpa = 1
        with self.assertRaises((ValueError, TypeError)):
            mallow.SolverConfig(contact="touch")
        with self.assertRaises(ValueError):
            mallow.SolverConfig().gravity[2] = 1

    def test_structs(self):
        config = mallow.SolverConfig(gravity=(0, 0, -1), contact="pressure")
        other = config.replace(time_step=0.1)
        self.assertEqual((config.time_step, other.gravity[2]), (None, -1))
        self.assertEqual(config.contact, mallow.BodyContact.pressure)
        self.assertIn("time_step=0.1", repr(other))
        material = mallow.Material(alpha=[(0, 0.1), (2, 0.9)])
        self.assertAlmostEqual(material.alpha.at(1), 0.5, 6)
        union = mallow.Union([mallow.Sphere(radius=1), mallow.Box()])
        self.assertIsInstance(mallow.Collider(shape=union).shape.parts[1], mallow.Box)
        self.assertAlmostEqual(mallow.nearest(mallow.Sphere(radius=1), [3, 0, 0]).distance, 2, 6)


class Scenes(unittest.TestCase):
    def test_the_parts_of_a_scene_have_ids(self):
        ids = mallow.SceneIds()
        simulation = mallow.build(mallow.parse_scene(SCENE, "scene.toml"), ids=ids)
        self.assertEqual(ids.bodies, simulation.bodies())
        self.assertEqual(ids.colliders, simulation.collider_ids())
        self.assertEqual((ids.pins, ids.emitters, ids.sinks), ([], [], []))
        self.assertEqual(simulation.find_body("body[0]"), ids.bodies[0])

    def test_files_strings_and_objects_are_one(self):
        scene = mallow.parse_scene(SCENE)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "scene.toml"
            file.write_text(mallow.print_scene(scene))
            hashes = [self.run_scene(mallow.read_scene(file)), self.run_scene(scene)]
        made = mallow.Scene(
            materials=[mallow.SceneMaterial("paste", mallow.Material(alpha=0.3))],
            bodies=[mallow.SceneBody("paste", source=mallow.Lattice([4, 4, 4], 1, [0, 0, 1]))],
            colliders=[mallow.SceneCollider()])
        hashes.append(self.run_scene(made))
        self.assertEqual(len(set(hashes)), 1)

    def run_scene(self, scene):
        simulation = mallow.build(scene)
        simulation.advance(3)
        return simulation.state_hash()

    def test_elements_are_changed_where_they_are(self):
        scene = mallow.parse_scene(SCENE)
        scene.materials[0].material.alpha = 1
        scene.solver.gravity = [0, 0, -1]
        scene.bodies.append(mallow.SceneBody("paste", source=mallow.SphereSource([20, 0, 5], 2, mallow.Sampling(1))))
        text = mallow.print_scene(scene)
        self.assertIn("alpha = 1", text)
        self.assertIn("sphere", text)
        scene.bodies.append("not a body")
        with self.assertRaisesRegex(TypeError, r"Scene.bodies\[2\] must be a SceneBody"):
            mallow.build(scene)

    def test_states_go_through_pickle_and_files(self):
        simulation = cube()
        simulation.advance(1)
        again = mallow.Simulation.restore(pickle.loads(pickle.dumps(simulation.save())))
        self.assertEqual(again.state_hash(), simulation.state_hash())
        with self.assertRaises(mallow.ConfigError):
            mallow.Simulation.restore(mallow.SavedState([mallow.Chunk("bodies", b"x")]))


if __name__ == "__main__":
    unittest.main()
