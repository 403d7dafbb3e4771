// What a session does that a scene cannot: throws, pins, settings that are refused, other scenes.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "files/file_fixture.h"
#include "mallow/files.h"
#include "mallow/materials.h"
#include "program/body_appearances.h"
#include "program/checkpoint.h"
#include "program/run_loop.h"
#include "program/stills.h"
#include "view/session.h"
#include "view/settings_model.h"

namespace mallow {
namespace view_played_scene_test {

using namespace view;

/// A cube of jelly that falls by centimetres, with its material by name.
Scene jelly() {
  return parse_scene(
      "[solver]\ngravity = [0, 0, -9.81]\n[[body]]\nmaterial = 'jelly'\n"
      "box = { count = [5, 5, 5], spacing = 0.01, corner = [-0.025, -0.025, 0.05] }\n"
      "[[collider]]\nplane = {}\n[run]\nframes = 60\nframe_time = 0.02\n",
      "jelly.toml");
}

Session session_of(const Scene& scene) {
  Session session({.threads = 1});
  session.open(scene);
  session.set_speed(std::numeric_limits<double>::infinity());
  return session;
}

void go(Session& session, int steps) {
  for (int k = 0; k < steps; ++k) session.advance(0.01 * k);
}

Frame frame_of(Session& session) {
  Frame frame;
  session.fill(0, frame);
  return frame;
}

/// From above through the middle of the first body.
Ray from_above(Session& session) {
  const BodyId body = session.simulation().bodies().front();
  return {session.simulation().motion(body).center_of_mass.cast<float>() + Vec3(0, 0, 1), {0, 0, -1}};
}

TEST(view_played_scene, one_that_is_refused_leaves_the_one_that_runs_as_it_stood) {
  Session session = session_of(jelly());
  go(session, 20);
  const std::uint64_t before = session.simulation().state_hash();
  const int number = frame_of(session).scene;
  Scene refused = jelly();
  refused.solver.time_step = 30;
  session.run([&](Session& one) { one.open(refused); });
  ASSERT_TRUE(session.has_scene());
  EXPECT_EQ(session.simulation().state_hash(), before);
  const Frame frame = frame_of(session);
  EXPECT_EQ(frame.scene, number);
  EXPECT_TRUE(frame.has_scene);
  EXPECT_NE(frame.message.find("time_step"), std::string::npos) << frame.message;
  EXPECT_FALSE(frame.mesh.triangles.empty());
  go(session, 10);
  EXPECT_EQ(session.simulation().step_count(), 30);
  session.reset();
  EXPECT_EQ(session.simulation().step_count(), 0);
}

TEST(view_played_scene, what_waits_for_a_new_scene_waits_until_there_is_one) {
  SettingsModel settings(jelly());
  for (const SettingsSection& section : settings.sections())
    for (const scene_file::BoundField& field : section.fields)
      if (section.path + "." + field.name == "solver.support_radius") settings.command(section, field);
  EXPECT_TRUE(settings.waits_for_rebuild());
  settings.to_rebuild();
  EXPECT_TRUE(settings.waits_for_rebuild()) << "it may be refused";
  settings.was_rebuilt();
  EXPECT_FALSE(settings.waits_for_rebuild());
}

TEST(view_played_scene, without_a_scene_a_frame_tells_nothing_of_the_one_before) {
  Session session = session_of(jelly());
  go(session, 20);
  Frame frame = frame_of(session);
  session.close();
  session.fill(0, frame);
  EXPECT_FALSE(frame.has_scene);
  EXPECT_EQ(frame.stats.steps, 0);
  EXPECT_TRUE(frame.mesh.triangles.empty());
  EXPECT_TRUE(frame.samples.empty());
}

TEST(view_played_scene, balls_can_be_thrown_again_after_going_back) {
  Session session = session_of(jelly());
  go(session, 5);
  session.throw_ball(from_above(session), 1);
  go(session, 5);
  const double with_ball = session.simulation().time();
  go(session, 20);
  session.go_to(with_ball);
  const std::size_t bodies = session.simulation().body_count();
  session.throw_ball(from_above(session), 1);
  EXPECT_EQ(session.simulation().body_count(), bodies + 1);
  session.reset();
  EXPECT_EQ(session.simulation().body_count(), 1u);
  session.throw_ball(from_above(session), 1);
  EXPECT_EQ(session.simulation().body_count(), 2u);
  session.set_paused(false);
  go(session, 20);
  EXPECT_FALSE(session.has_failed());
}

TEST(view_played_scene, saved_with_a_ball_goes_on_with_pictures) {
  const TemporaryFolder temporary;
  const std::filesystem::path folder = temporary / "run";
  Session session = session_of(jelly());
  go(session, 5);
  session.throw_ball(from_above(session), 1);
  go(session, 5);
  session.save_run(folder.string());
  const program::CheckpointedRun saved =
      program::load_newest_checkpoint(program::Cache::open_to_resume(folder), 1);
  const ParticleFrame frame = snapshot(saved.simulation);
  const float spacings[] = {0.01f, 0.01f};
  program::Stills stills(saved.scene, frame, spacings, 1);
  EXPECT_NO_THROW(stills.take(frame, {}));
  std::vector<BodyInfo> bodies;
  program::follow_bodies(saved.simulation, bodies);
  EXPECT_EQ(program::body_appearances(saved.scene, program::material_names(bodies)).size(), 2u);
  Session other({.threads = 1});
  other.open_run(folder.string());
  Ray beside = from_above(other);
  beside.origin.x() += 0.2f;
  other.throw_ball(beside, 1);
  EXPECT_EQ(other.simulation().body_count(), 3u);
}

TEST(view_played_scene, saved_beyond_its_end_says_how_it_goes_on) {
  const TemporaryFolder temporary;
  const std::filesystem::path folder = temporary / "run";
  Scene scene = jelly();
  scene.run.frames = 1;
  Session session = session_of(scene);
  session.save_run(folder.string());
  EXPECT_EQ(frame_of(session).message.find("--frames"), std::string::npos);
  for (int k = 0; k < 2000 && frame_of(session).stats.frame < 2; ++k) session.advance(0);
  std::filesystem::remove_all(folder);
  session.save_run(folder.string());
  EXPECT_NE(frame_of(session).message.find("--frames 3"), std::string::npos) << frame_of(session).message;
  program::CheckpointedRun saved = program::load_newest_checkpoint(program::Cache::open_to_resume(folder), 1);
  saved.plan.frames = saved.scene.run.frames;
  EXPECT_NE(program::nothing_left(saved.plan, saved.report).find("--frames 3"), std::string::npos);
  saved.plan.frames = 3;
  EXPECT_EQ(program::nothing_left(saved.plan, saved.report), "");
}

TEST(view_played_scene, counts_frames_as_they_are_now_after_going_back) {
  Session session = session_of(jelly());
  go(session, 60);
  const double there = 0.5 * session.simulation().time();
  RunConfig run = session.scene().run;
  run.frame_time = *run.frame_time / 4;
  session.set_run(run);
  session.go_to(there);
  const Frame frame = frame_of(session);
  EXPECT_EQ(frame.stats.frame, static_cast<int>(frame.stats.time / *run.frame_time + 1e-6));
  session.set_paused(false);
  for (int k = 0; k < 1000 && frame_of(session).stats.frame == frame.stats.frame; ++k) session.advance(0);
  EXPECT_NEAR(session.simulation().time(), (frame.stats.frame + 1) * *run.frame_time, 1e-9);
}

TEST(view_played_scene, another_one_begins_as_it_says_and_the_same_anew_as_it_was_set) {
  Session session = session_of(jelly());
  session.set_rung(8);
  session.open(jelly());
  EXPECT_EQ(frame_of(session).stats.rung, 8);
  session.close();
  session.open(jelly());
  EXPECT_EQ(frame_of(session).stats.rung, k_as_written);
  EXPECT_EQ(frame_of(session).stats.given_up, "");
}

/// Keeps a rate that no machine reaches, then is let go of.
TEST(view_played_scene, shows_the_place_that_a_kept_rate_has_left) {
  Session session = session_of(jelly());
  session.set_target(1e9);
  go(session, 400);
  session.set_target(std::nullopt);
  const Frame frame = frame_of(session);
  EXPECT_EQ(frame.stats.rung, static_cast<int>(rungs().size()) - 1);
  EXPECT_NE(frame.stats.given_up, "");
}

TEST(view_played_scene, every_material_by_name_is_taken_at_once_or_by_the_scene_built_anew) {
  int waited = 0;
  for (const MaterialPreset& preset : material_presets()) {
    SettingsModel settings(jelly());
    Session session = session_of(settings.scene());
    settings.take(frame_of(session));
    session.run(settings.take_preset(0, preset.name));
    Frame frame = frame_of(session);
    settings.take(frame);
    EXPECT_EQ(settings.scene().materials[0].material.rest_density, preset.material.rest_density)
        << preset.name << ": the wish is kept";
    if (!frame.waits) continue;
    ++waited;
    EXPECT_TRUE(settings.waits_for_rebuild()) << preset.name;
    EXPECT_NE(frame.message.find("anew"), std::string::npos) << frame.message;
    session.run([&](Session& one) { one.open(settings.to_rebuild()); });
    frame = frame_of(session);
    EXPECT_FALSE(frame.waits) << preset.name << ": " << frame.message;
    EXPECT_EQ(session.scene().materials[0].material.youngs_modulus, preset.material.youngs_modulus);
  }
  EXPECT_GT(waited, 0) << "stiff ones need shorter steps than jelly has";
}

TEST(view_played_scene, pins_of_the_mouse_are_let_go_of_and_those_of_the_scene_stay) {
  Scene scene = jelly();
  scene.pins.push_back({.box = {{-1, -1, 0.085f}, {1, 1, 1}}});
  Session session = session_of(scene);
  session.show_marks({.pins = true});
  const std::size_t of_scene = frame_of(session).marks.pins.size();
  ASSERT_GT(of_scene, 0u);
  const BodyId body = session.simulation().bodies().front();
  const Vec3 middle = session.simulation().motion(body).center_of_mass.cast<float>();
  session.pin({middle - Vec3(0, 0, 1), {0, 0, 1}}, 0.025f);
  EXPECT_GT(frame_of(session).marks.pins.size(), of_scene);
  session.release_pins();
  EXPECT_EQ(frame_of(session).marks.pins.size(), of_scene);
  const double held = session.simulation().bounds(body).min.z();
  go(session, 40);
  EXPECT_LT(session.simulation().bounds(body).min.z(), held - 1e-4) << "it hangs and is stretched";
}

TEST(view_played_scene, a_step_that_fails_is_said_with_advice_and_the_scene_stands_before_it) {
  Session session = session_of(jelly());
  go(session, 10);
  const std::uint64_t before = session.simulation().state_hash();
  session.simulation().set_force(
      [](const ForceInput&, VectorSpan accelerations) { accelerations.z()[0] = std::nanf(""); });
  go(session, 1);
  Frame frame = frame_of(session);
  EXPECT_TRUE(frame.failed);
  EXPECT_TRUE(frame.paused);
  EXPECT_NE(frame.message.find("Go back (Backspace) or start again (R)"), std::string::npos) << frame.message;
  EXPECT_EQ(session.simulation().state_hash(), before);
  EXPECT_FALSE(session.advance(1)) << "it stands";
  session.simulation().set_force({});
  session.set_paused(false);
  go(session, 5);
  EXPECT_EQ(session.simulation().step_count(), 15);
}

TEST(view_played_scene, a_film_waits_for_the_picture_of_every_frame_and_for_no_other) {
  Session session = session_of(jelly());
  while (frame_of(session).stats.frame < 1) session.advance(0);
  for (int frames = 0; frames < 1; frames = frame_of(session).stats.frame - 1) session.advance(0);
  session.set_recording(true);
  EXPECT_FALSE(frame_of(session).finished) << "it ended before the film began";
  for (int k = 0; k < 1000 && !session.waits_for_film(); ++k) session.advance(0);
  EXPECT_FALSE(session.advance(0));
  EXPECT_TRUE(frame_of(session).finished);
  EXPECT_FALSE(frame_of(session).finished) << "only once";
  EXPECT_TRUE(session.advance(0));
}

TEST(view_played_scene, is_looked_at_as_its_settings_say) {
  Session session = session_of(jelly());
  const Frame before = frame_of(session);
  RenderConfig render = session.scene().render;
  render.field_of_view = 60;
  session.set_render(render);
  EXPECT_EQ(frame_of(session).camera.field_of_view, 60);
  EXPECT_EQ(frame_of(session).camera_number, before.camera_number) << "the eye stays where the hand has it";
  render.eye = Vec3(1, 2, 3);
  session.set_render(render);
  EXPECT_EQ(frame_of(session).camera.eye, Vec3(1, 2, 3));
  EXPECT_NE(frame_of(session).camera_number, before.camera_number);
  render.target = render.eye;
  EXPECT_THROW(session.set_render(render), ConfigError);
}

TEST(view_played_scene, a_message_is_new_though_it_says_the_same) {
  Session session = session_of(jelly());
  session.say("poked");
  const int first = frame_of(session).message_number;
  session.say("poked");
  EXPECT_NE(frame_of(session).message_number, first);
}

}  // namespace view_played_scene_test
}  // namespace mallow
