"""Arrays show memory of the engine without a copy, cannot be written, and never read memory that is gone."""
import gc
import unittest

import mallow
import numpy
from support import cube


class Columns(unittest.TestCase):
    def test_are_views_that_follow_a_step(self):
        simulation = cube()
        simulation.step()
        x = simulation.positions
        self.assertEqual((x.shape, x.dtype), ((64, 3), numpy.float32))
        self.assertFalse(x.flags.owndata)
        self.assertEqual(x.__array_interface__["data"][0], simulation.positions.__array_interface__["data"][0])
        numpy.testing.assert_array_equal(simulation.positions_by_id()[simulation.ids], x)

    def test_cannot_be_written(self):
        simulation = cube()
        for view in (simulation.positions, simulation.ids, simulation.velocities):
            with self.assertRaises(ValueError):
                view[0] = 1
            with self.assertRaises(ValueError):
                view.flags.writeable = True

    def test_outlive_rows_and_simulations(self):
        simulation = cube(6)
        simulation.step()
        names = ("positions", "velocities", "ids", "densities")
        kept = []
        for round_ in range(6):
            kept += [getattr(simulation, name) for name in names]
            body = mallow.sample(mallow.Lattice(count=[4 + round_] * 3, spacing=1, corner=[20 * round_ + 20, 0, 1]))
            simulation.add_body(body, mallow.Material())
            kept += [getattr(simulation, name) for name in names]
            simulation.step()
            simulation.remove_particles(simulation.ids[::3])
            simulation.step()
        first = kept[0][:4].copy()
        del simulation
        gc.collect()
        for _ in range(20):
            cube(8).step()  # takes the memory, if any was given back
        numpy.testing.assert_array_equal(kept[0][:4], first)
        for view in kept:
            self.assertTrue(numpy.isfinite(view.astype(float)).all())

    def test_slices_and_casts_keep_memory_too(self):
        x = cube(6).positions[::2, 1]
        before = x.copy()
        gc.collect()
        cube(6)
        numpy.testing.assert_array_equal(x, before)

    def test_optional_columns_are_empty_until_they_are_there(self):
        simulation = cube()
        self.assertEqual(len(simulation.densities), 0)
        self.assertEqual(simulation.alphas.shape, (0,))
        self.assertEqual(simulation.temperatures.shape, (0,))
        simulation.set_alpha(simulation.ids, 0.25)
        simulation.step()
        self.assertEqual(set(simulation.alphas), {0.25})
        self.assertEqual(len(simulation.densities), 64)

    def test_what_particles_rest_in(self):
        simulation = cube(alpha=0.2)
        simulation.step()
        body = simulation.bodies()[0]
        rest, turns = simulation.rest_positions(body), simulation.rotations(body)
        self.assertEqual((rest.shape, turns.shape), ((64, 3), (64, 4)))
        numpy.testing.assert_allclose(turns[:, 3], 1, atol=1e-3)


class Meshes(unittest.TestCase):
    def test_drawn_ones_are_views_and_stay_as_they_were_drawn(self):
        simulation, surfacer = cube(), mallow.Surfacer()
        mesh = surfacer.draw(simulation)
        vertices, triangles = mesh.vertices, mesh.triangles
        self.assertFalse(vertices.flags.owndata or vertices.flags.writeable)
        self.assertEqual((vertices.dtype, triangles.dtype), (numpy.float32, numpy.uint32))
        before = vertices.copy(), triangles.copy()
        for _ in range(5):
            simulation.advance(1)
            later = surfacer.draw(simulation)
        self.assertFalse(numpy.array_equal(later.vertices[:10], before[0][:10]))
        del mesh, surfacer, simulation
        gc.collect()
        numpy.testing.assert_array_equal(vertices, before[0])
        numpy.testing.assert_array_equal(triangles, before[1])

    def test_the_same_meshes_come_whether_one_is_kept_or_not(self):
        simulation, surfacer, other = cube(), mallow.Surfacer(), mallow.Surfacer()
        kept = []
        for _ in range(4):
            kept.append(surfacer.draw(simulation))
            numpy.testing.assert_array_equal(kept[-1].vertices, other.draw(simulation).vertices)
            simulation.advance(0.5)

    def test_columns_are_given_whole(self):
        mesh = mallow.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        old = mesh.vertices
        mesh.vertices = old * 2
        self.assertEqual((old.max(), mesh.vertices.max()), (1, 2))
        with self.assertRaises(ValueError):
            mesh.vertices[0] = 1
        mesh.triangles = [[0, 1, 7]]
        with self.assertRaisesRegex(mallow.ConfigError, "vertex 7"):
            mallow.welded(mesh)

    def test_skins_follow(self):
        simulation = cube(alpha=0.2)
        mesh = mallow.surface(simulation.positions, 1)
        skin = mallow.Skin(simulation, simulation.bodies()[0], mesh)
        first = skin.mesh().vertices
        before = first.copy()
        simulation.advance(2)
        moved = skin.update(simulation).vertices
        numpy.testing.assert_array_equal(first, before)
        self.assertLess(moved[:, 2].mean(), before[:, 2].mean())
        again = mallow.Skin.restore(skin.save())
        numpy.testing.assert_array_equal(again.update(simulation).vertices, moved)


if __name__ == "__main__":
    unittest.main()
