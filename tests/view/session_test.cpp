#include "view/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "files/file_fixture.h"
#include "view/stepping_thread.h"

namespace mallow {
namespace view_session_test {

using namespace view;

Scene cube() {
  return read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/cube.toml");
}

/// A session that goes as fast as it can.
Session session_of(const Scene& scene) {
  Session session({.threads = 1});
  session.open(scene);
  session.set_speed(std::numeric_limits<double>::infinity());
  return session;
}

void go(Session& session, int steps) {
  for (int k = 0; k < steps; ++k) session.advance(0.01 * k);
}

TEST(view_session, moves_as_a_run_does_to_the_last_bit) {
  const Scene scene = cube();
  Session session = session_of(scene);
  go(session, 50);
  Simulation run = build(scene, 1);
  const double frame = frame_time(scene, run.info());
  while (run.step_count() < 50) run.step_towards((std::floor(run.time() / frame + 1e-9) + 1) * frame);
  EXPECT_EQ(session.simulation().state_hash(), run.state_hash());
}

TEST(view_session, what_follows_after_going_back_is_the_same_to_the_last_bit) {
  Session session = session_of(cube());
  go(session, 30);
  const double there = session.simulation().time();
  go(session, 40);
  const std::uint64_t end = session.simulation().state_hash();
  const std::int64_t steps = session.simulation().step_count();
  session.go_to(there);
  EXPECT_LE(session.simulation().time(), there);
  EXPECT_TRUE(session.is_paused());
  session.set_paused(false);
  for (int k = 0; k < 100 && session.simulation().step_count() < steps; ++k) session.advance(0);
  EXPECT_EQ(session.simulation().state_hash(), end);
}

TEST(view_session, goes_on_with_fewer_threads_and_with_more_to_the_same_bits) {
  Session session({.threads = 3}), alone = session_of(cube());
  session.open(cube());
  session.set_speed(std::numeric_limits<double>::infinity());
  const Vec3 above(0, 0, 30);
  for (Session* one : {&session, &alone}) {
    go(*one, 20);
    one->grab(one->simulation().positions()[0], 1);
    one->pull_to(above);
    go(*one, 20);
  }
  const auto look = [&](double free, int times) {
    for (int k = 0; k < times; ++k) session.look_at_processors(free);
    Frame frame;
    session.fill(0, frame);
    return frame.stats.threads;
  };
  EXPECT_EQ(look(0.5, 2), 1);
  for (Session* one : {&session, &alone}) go(*one, 20);
  EXPECT_EQ(look(8, 4), 3);
  for (Session* one : {&session, &alone}) go(*one, 20);
  EXPECT_EQ(session.simulation().state_hash(), alone.simulation().state_hash());
}

TEST(view_session, a_setting_that_is_refused_changes_nothing_and_is_said) {
  Session session = session_of(cube());
  go(session, 5);
  SolverConfig solver = session.scene().solver;
  solver.time_step_factor = 4;
  session.run([&](Session& one) { one.set_solver(solver); });
  Frame frame;
  session.fill(0, frame);
  EXPECT_NE(frame.message.find("time_step"), std::string::npos) << frame.message;
  EXPECT_EQ(session.scene().solver.time_step_factor, 1);
  EXPECT_FALSE(frame.failed);
  go(session, 5);
  EXPECT_EQ(session.simulation().step_count(), 10);
}

TEST(view_session, alpha_acts_while_it_runs) {
  Session session = session_of(cube());
  go(session, 5);
  SceneMaterial soft = session.scene().materials[0];
  soft.material.alpha = 0.9f;
  session.set_material(0, soft);
  go(session, 5);
  EXPECT_EQ(session.simulation().info().bodies[0].alpha, 0.9f);
}

TEST(view_session, every_place_between_realtime_and_accurate_can_be_chosen) {
  Session session = session_of(cube());
  for (int rung = 0; rung < static_cast<int>(rungs().size()); ++rung) {
    session.set_rung(rung);
    go(session, 3);
    Frame frame;
    session.fill(0, frame);
    EXPECT_EQ(frame.stats.rung, rung);
    EXPECT_EQ(frame.message, "");
  }
  session.set_rung(k_as_written);
  EXPECT_EQ(session.simulation().config().time_step_factor, session.scene().solver.time_step_factor);
}

TEST(view_session, a_grab_lifts_what_it_holds_and_lets_go) {
  Session free = session_of(cube()), held = session_of(cube());
  go(free, 40);
  go(held, 40);
  const BodyId body = held.simulation().bodies().front();
  const Aabb box = held.simulation().bounds(body);
  const Vec3 top(0.5f * (box.min.x() + box.max.x()), 0.5f * (box.min.y() + box.max.y()), box.max.z());
  held.grab(top, 1);
  const float size = (box.max - box.min).z();
  held.pull_to(top + Vec3(0, 0, 2 * size));
  go(free, 60);
  go(held, 60);
  const double lifted =
      held.simulation().motion(body).center_of_mass.z() - free.simulation().motion(body).center_of_mass.z();
  EXPECT_GT(lifted, 0.5 * static_cast<double>(size));
  held.release();
  const double high = held.simulation().motion(body).center_of_mass.z();
  go(held, 120);
  EXPECT_LT(held.simulation().motion(body).center_of_mass.z(), high) << "it falls again";
}

TEST(view_session, marks_change_nothing_of_what_moves) {
  Session plain = session_of(cube()), marked = session_of(cube());
  marked.show_marks({.pins = true, .region = true, .contacts = true});
  Frame frame;
  for (int k = 0; k < 90; ++k) {
    go(plain, 1);
    go(marked, 1);
    marked.fill(0, frame);
  }
  const VectorView a = plain.simulation().positions(), b = marked.simulation().positions();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t row = 0; row < a.size(); ++row) ASSERT_EQ(Vec3(a[row]), Vec3(b[row]));
}

TEST(view_session, what_is_pinned_is_marked_and_is_no_more_after_going_back) {
  Session session = session_of(cube());
  go(session, 10);
  const double before = session.simulation().time();
  const BodyId body = session.simulation().bodies().front();
  const Vec3 middle = session.simulation().motion(body).center_of_mass.cast<float>();
  const Ray ray{middle + Vec3(0, 0, 1000), {0, 0, -1}};
  session.show_marks({.pins = true, .region = true});
  session.pin(ray, 2.5f * session.simulation().spacing(body));
  session.choose(ray);
  go(session, 10);
  Frame frame;
  session.fill(0, frame);
  EXPECT_GT(frame.marks.pins.size(), 3u);
  ASSERT_TRUE(frame.marks.chosen);
  const float radius = session.simulation().info().bodies.front().region_radius;
  EXPECT_GT(frame.marks.region.size(), 3u);
  for (const Vec3& x : frame.marks.region) EXPECT_LT((x - *frame.marks.chosen).norm(), 1.3f * radius);
  session.go_to(before);
  session.fill(0, frame);
  EXPECT_EQ(frame.marks.pins.size(), 0u);
}

TEST(view_session, verbs_do_what_they_say) {
  Session session = session_of(cube());
  go(session, 10);
  const BodyId body = session.simulation().bodies().front();
  const Vec3 middle = session.simulation().motion(body).center_of_mass.cast<float>();
  const Ray ray{middle + Vec3(0, 0, 1000), {0, 0, -1}};
  const std::size_t before = session.simulation().particle_count();
  session.throw_ball(ray, 1);
  EXPECT_EQ(session.simulation().body_count(), 2u);
  const float reach = reach_of(session.simulation());
  const BodyId hit = hit_of(session.simulation(), ray).body;
  const Eigen::Vector3d still = session.simulation().motion(hit).momentum;
  poke(session.simulation(), ray, reach, 0.1f);
  const Eigen::Vector3d poked = session.simulation().motion(hit).momentum - still;
  EXPECT_LT(poked.z(), 0) << "along the ray, downwards";
  EXPECT_LT(poked.head<2>().norm(), 1e-3 * -poked.z());
  heat(session.simulation(), ray, reach, 10, 0.2f);
  EXPECT_FALSE(session.simulation().alphas().empty()) << "it melts where it carries no heat";
  pin(session.simulation(), ray, reach);
  Ray left = ray, right = ray;
  left.direction = Vec3(-0.02f, 0, -1).normalized();
  right.direction = Vec3(0.02f, 0, -1).normalized();
  const std::size_t with_ball = session.simulation().particle_count();
  cut(session.simulation(), left, right);
  EXPECT_LT(session.simulation().particle_count(), with_ball);
  EXPECT_GT(session.simulation().particle_count(), before / 3);
  go(session, 10);
  Frame frame;
  session.fill(0, frame);
  EXPECT_FALSE(frame.failed) << frame.message;
  EXPECT_THROW(poke(session.simulation(), {{0, 0, 1e6f}, {0, 0, 1}}, reach, 1), ConfigError);
}

TEST(view_session, a_saved_scene_goes_on_where_it_stood) {
  const TemporaryFolder temporary;
  const std::filesystem::path folder = temporary / "run";
  Session session = session_of(cube());
  go(session, 33);
  session.save_run(folder.string());
  Session other({.threads = 1});
  other.open_run(folder.string());
  EXPECT_EQ(other.simulation().state_hash(), session.simulation().state_hash());
  other.set_speed(std::numeric_limits<double>::infinity());
  go(session, 20);
  go(other, 20);
  EXPECT_EQ(other.simulation().state_hash(), session.simulation().state_hash());
}

TEST(view_session, the_thread_hands_over_frames_takes_commands_and_ends_while_it_steps) {
  std::atomic<int> woken = 0;
  SteppingThread thread({.threads = 2}, [&] { ++woken; });
  thread.open(cube());
  thread.send([](Session& session) { session.set_speed(std::numeric_limits<double>::infinity()); });
  std::uint64_t last = 0;
  const auto wait_for = [&](auto done) {
    for (int k = 0; k < 60'000; ++k) {
      if (thread.take_frame() && !thread.frame().building) {
        EXPECT_GE(thread.frame().number, last);
        last = thread.frame().number;
        if (done(thread.frame())) return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  };
  EXPECT_TRUE(wait_for([](const Frame& frame) { return frame.stats.steps > 20; }));
  EXPECT_FALSE(thread.frame().mesh.triangles.empty());
  thread.send([](Session& session) { session.show(Drawn::particles, Shown::strain); });
  EXPECT_TRUE(wait_for([](const Frame& frame) {
    return !frame.positions.empty() && frame.values.size() == frame.positions.size();
  }));
  thread.send([](Session& session) { session.show(Drawn::particles, Shown::thread); });
  EXPECT_TRUE(wait_for([](const Frame& frame) {
    return frame.shown == Shown::thread && std::ranges::count(frame.values, 0.0f) == 256 &&
           std::ranges::count(frame.values, 1.0f) == 256;
  })) << "of 512 particles and two threads";
  thread.send([](Session& session) {
    session.reset();
    session.set_paused(true);  // before it takes a step
  });
  EXPECT_TRUE(wait_for([](const Frame& frame) { return frame.paused && frame.stats.steps < 5; }));
  thread.send([](Session& session) { session.set_paused(false); });
  EXPECT_GT(woken, 0);
}

}  // namespace view_session_test
}  // namespace mallow
