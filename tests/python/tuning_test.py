"""What settings cost and how far off they are, asked from Python."""
import threading
import time
import unittest

import mallow

PLAN = mallow.MotionPlan(frames=4, frame_time=0.6)


def jelly(factor=1.0):
    simulation = mallow.Simulation(mallow.SolverConfig(time_step=0.15, time_step_factor=factor, threads=1))
    simulation.add_collider(mallow.Collider())
    cube = mallow.sample(mallow.Lattice([4, 4, 4], 1, [0, 0, 0.5]))
    simulation.add_body(cube, mallow.Material(alpha=0.1, elastic_time_step=0.3), "cube")
    return simulation


class Motions(unittest.TestCase):
    def test_the_same_motion_has_no_error_and_longer_steps_have_one(self):
        reference = mallow.record_motion(lambda: jelly(0.25), PLAN)
        self.assertEqual(mallow.motion_error(reference, reference).worst, 0)
        error = mallow.motion_error(mallow.record_motion(jelly, PLAN), reference)
        self.assertGreater(error.rms, 0)
        self.assertGreaterEqual(error.worst, error.rms)
        self.assertEqual(len(reference.moments), PLAN.frames + 1)
        self.assertEqual(len(reference.frame_seconds), PLAN.frames)

    def test_a_simulation_that_is_there_is_run_from_where_it_stands(self):
        simulation = jelly()
        simulation.advance(0.6)
        motion = mallow.record_motion(simulation, PLAN)
        self.assertEqual(motion.moments[0].particles.time, 0.6)
        self.assertAlmostEqual(simulation.time, 0.6 + 4 * 0.6, places=6)
        self.assertEqual(simulation.state_hash(), self.by_hand().state_hash())

    @staticmethod
    def by_hand():
        simulation = jelly()
        simulation.advance(0.6)
        for frame in range(4):
            while simulation.time < 0.6 + (frame + 1) * 0.6:
                simulation.step_towards(0.6 + (frame + 1) * 0.6)
        return simulation

    def test_measures_and_drawing_may_use_all_of_the_simulation(self):
        drawn, surfacer = [], mallow.Surfacer(threads=1)
        plan = mallow.MotionPlan(frames=2, frame_time=0.6, measures=[lambda s: s.volume(s.bodies()[0])],
                                 draw=lambda s: drawn.append(len(surfacer.draw(s).vertices)))
        motion = mallow.record_motion(jelly, plan)
        self.assertEqual([len(moment.measures) for moment in motion.moments], [1, 1, 1])
        self.assertGreater(min(drawn), 100)
        self.assertGreater(motion.draw_seconds_per_frame(), 0)

    def test_stop_ends_a_run_and_what_functions_raise_comes_out(self):
        steps = []
        stopped = mallow.record_motion(jelly, mallow.MotionPlan(
            frames=9, frame_time=0.6, stop=lambda: steps.append(0) or len(steps) > 3))
        self.assertEqual(stopped.steps, 3)

        def fail(simulation):
            raise KeyError("here")

        for plan in (mallow.MotionPlan(frames=2, frame_time=0.6, measures=[fail]),
                     mallow.MotionPlan(frames=2, frame_time=0.6, draw=fail)):
            with self.assertRaises(KeyError):
                mallow.record_motion(jelly, plan)

    def test_what_cannot_be_built_is_a_failure_and_what_is_none_is_refused(self):
        refused = mallow.record_motion(lambda: jelly(-1), PLAN)
        self.assertIn("time_step_factor", refused.failure)
        for build in (lambda: 3, lambda: None):
            with self.assertRaisesRegex(TypeError, "must be a Simulation"):
                mallow.record_motion(build, PLAN)
        with self.assertRaises(TypeError):
            mallow.record_motion(None, PLAN)
        for wrong in ({"measures": 3}, {"measures": 1.0}, {"frames": "4"}):
            with self.assertRaisesRegex(TypeError, "MotionPlan"):
                mallow.MotionPlan(**wrong)
        with self.assertRaises(mallow.ConfigError):
            mallow.record_motion(jelly, mallow.MotionPlan(frames=-1, frame_time=1))

    def test_two_threads_and_one_simulation_never_crash_and_one_is_refused(self):
        simulation, begun, end = jelly(), threading.Event(), threading.Event()
        plan = mallow.MotionPlan(frames=100000, frame_time=0.6, draw=lambda s: begun.set(), stop=end.is_set)
        refused = []

        def record():
            try:
                mallow.record_motion(simulation, plan)
            except mallow.BusyError as error:
                refused.append(error)

        thread = threading.Thread(target=record)
        thread.start()
        begun.wait(60)
        stop = time.monotonic() + 60
        while time.monotonic() < stop and not refused:
            try:
                simulation.step()
            except mallow.BusyError as error:
                refused.append(error)
        end.set()
        thread.join()
        self.assertGreater(len(refused), 0)


class Picks(unittest.TestCase):
    def test_front_and_picks(self):
        trades = [mallow.Trade(1, 3), mallow.Trade(2, 1), mallow.Trade(3, 2)]
        self.assertEqual(list(mallow.pareto_front(trades)), [0, 1])
        self.assertEqual(mallow.pick_by_error(trades, 2).index, 1)
        self.assertEqual(mallow.pick_by_cost(trades, 1.5).index, 0)
        self.assertFalse(mallow.pick_by_error(trades, 0.5).holds)
        self.assertIsNone(mallow.pick_by_error([], 1))
        self.assertEqual(mallow.convergence_order([4, 2, 1]), 1)


if __name__ == "__main__":
    unittest.main()
