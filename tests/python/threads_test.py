"""The GIL is given up while the engine works; an object that two threads use says so and goes on."""
import gc
import threading
import time
import unittest
import weakref

import mallow
import numpy
from support import cube


class Threads(unittest.TestCase):
    def test_others_run_during_a_step(self):
        simulation = cube(30)
        simulation.prepare()
        steps = counted = 0
        ended = threading.Event()

        def run():
            nonlocal steps
            while not ended.is_set():
                simulation.step()
                steps += 1

        thread = threading.Thread(target=run)
        thread.start()
        stop, enough = time.monotonic() + 60, False
        while not enough and time.monotonic() < stop:
            counted += 1
            time.sleep(0.0005)
            enough = steps >= 20 and counted > 20 + 2 * steps
        ended.set()
        thread.join()
        self.assertTrue(enough, f"{counted} naps during {steps} steps")

    def test_a_simulation_in_two_threads_is_refused(self):
        simulation, surfacer = cube(16), mallow.Surfacer()
        inside, leave = threading.Event(), threading.Event()

        def wait(particles, accelerations):
            inside.set()
            leave.wait(60)

        simulation.set_force(wait)
        thread = threading.Thread(target=simulation.step)
        thread.start()
        inside.wait(60)
        uses = (simulation.step, lambda: simulation.positions, lambda: simulation.time, simulation.save,
                lambda: surfacer.draw(simulation), lambda: simulation.set_force(None),
                lambda: simulation.add_collider(mallow.Collider()))
        for use in uses:
            with self.assertRaisesRegex(mallow.BusyError, "another thread"):
                use()
        self.assertIn("in use", repr(simulation))
        leave.set()
        thread.join()
        self.assertEqual(simulation.step_count, 1)
        self.assertEqual(simulation.positions.shape, (4096, 3))

    def test_many_threads_never_crash_one_simulation(self):
        simulation = cube(8)
        surfacer = mallow.Surfacer()
        refused, stop = [], time.monotonic() + 2
        calls = (simulation.step, lambda: simulation.positions.sum(), lambda: surfacer.draw(simulation).vertices.sum(),
                 lambda: simulation.set_gravity([0, 0, -0.2]), simulation.save, simulation.info)

        def run(call):
            while time.monotonic() < stop:
                try:
                    call()
                except mallow.BusyError as error:
                    refused.append(error)

        threads = [threading.Thread(target=run, args=(call,)) for call in calls]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(numpy.isfinite(simulation.positions).all())


class Forces(unittest.TestCase):
    def test_exceptions_come_out_and_nothing_has_moved(self):
        simulation = cube()
        simulation.advance(1)
        before = simulation.state_hash()

        class Mine(Exception):
            pass

        def fail(particles, accelerations):
            raise Mine("stop")

        simulation.set_force(fail)
        for step in (simulation.step, lambda: simulation.advance(1)):
            with self.assertRaisesRegex(Mine, "stop"):
                step()
        self.assertEqual(simulation.state_hash(), before)
        simulation.set_force(None)
        simulation.step()

    def test_a_callback_may_read_and_change_nothing(self):
        simulation = cube()
        seen = []

        def look(particles, accelerations):
            seen.append((simulation.time, particles.time, simulation.motion(simulation.bodies()[0]).mass))
            for change in (simulation.step, simulation.prepare, simulation.info, simulation.save, simulation.energy,
                           lambda: simulation.set_gravity([0, 0, 0]), lambda: simulation.set_force(None)):
                try:
                    change()
                    seen.append(change)
                except mallow.ConfigError:
                    pass

        simulation.set_force(look)
        simulation.step()
        self.assertEqual(len(seen), 1)
        self.assertEqual(seen[0][0], seen[0][1])

    def test_what_a_callback_was_given_stays_readable_and_cannot_be_written_later(self):
        simulation = cube()
        kept = []
        simulation.set_force(lambda particles, accelerations: kept.append((particles, accelerations)))
        simulation.step()
        particles, accelerations = kept[0]
        del simulation, kept
        gc.collect()
        cube(4)
        self.assertEqual(particles.positions.shape, accelerations.shape)
        with self.assertRaises(ValueError):
            accelerations[0] = 1

    def test_a_callback_that_holds_its_simulation_is_collected(self):
        simulation = cube()
        held = weakref.ref(simulation)
        simulation.set_force(lambda particles, accelerations: accelerations.fill(simulation.time))
        simulation.step()
        del simulation
        gc.collect()
        self.assertIsNone(held())

    def test_distance_functions_of_python_raise(self):
        def fail(point):
            raise KeyError("here")
        with self.assertRaises(KeyError):
            mallow.sample(mallow.ImplicitShape(fail, mallow.Aabb([0, 0, 0], [1, 1, 1])), mallow.Sampling(0.2))
        ball = mallow.ImplicitShape(lambda x: float(numpy.linalg.norm(x)) - 1, mallow.Aabb([-1] * 3, [1] * 3))
        self.assertGreater(len(mallow.sample(ball, mallow.Sampling(0.3))), 50)


if __name__ == "__main__":
    unittest.main()
