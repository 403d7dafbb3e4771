// What a run says of bodies that come and go while it writes frames.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "files/file_fixture.h"
#include "mallow/scene.h"
#include "program/body_appearances.h"
#include "program/cache.h"
#include "program/checkpoint.h"
#include "program/run_loop.h"

namespace mallow::program {
namespace run_loop_test {

namespace fs = std::filesystem;

const char* const k_scene = R"(
[solver]
time_step = 0.1
gravity = [0, 0, 0]
[[material]]
name = "red"
color = [0.8, 0.1, 0.1]
[[material]]
name = "blue"
color = [0.1, 0.1, 0.8]
[[body]]
material = "blue"
box = { count = [3, 3, 3], spacing = 1.0, corner = [20, 0, 0], jitter = 0 }
[[body]]
material = "red"
box = { count = [3, 3, 3], spacing = 1.0, corner = [0, 0, 0], jitter = 0 }
)";

TEST(run_loop, leaves_a_checkpoint_of_the_last_whole_step_where_one_fails) {
  const Scene scene = parse_scene(k_scene, "scene.toml");
  const RunPlan plan{
      .frames = 9, .steps = {}, .surface = false, .images = false, .threads = 1, .checkpoints = {}};
  const TemporaryFolder temporary;
  const fs::path folder = temporary / "run";
  std::uint64_t hash = 0;
  {
    Simulation simulation = build(scene, 1);
    const Cache cache = Cache::create(folder, true);
    cache.write_scene(scene);
    RunReport report;
    report.frame_time = 0.2;
    follow_bodies(simulation, report.info.bodies);
    simulation.set_force([&](const ForceInput& input, VectorSpan) {
      if (input.time > 0.45) throw ConfigError("force", "is no more");
    });
    EXPECT_THROW(run_frames(scene, simulation, {}, plan, &cache, report), ConfigError);
    EXPECT_EQ(report.frames, 2);
    hash = simulation.state_hash();
  }
  CheckpointedRun saved = load_newest_checkpoint(Cache::open_to_resume(folder), 1);
  EXPECT_EQ(saved.report.frames, 2);
  EXPECT_EQ(saved.report.steps, 5);
  EXPECT_EQ(saved.simulation.state_hash(), hash);
}

TEST(run_loop, keeps_what_a_body_looked_like_in_frames_before_another_had_its_slot) {
  const Scene scene = parse_scene(k_scene, "scene.toml");
  Simulation simulation = build(scene, 1);
  const TemporaryFolder temporary;
  const fs::path folder = temporary / "run";
  const Cache cache = Cache::create(folder, true);
  RunReport report;
  report.frame_time = 0.1;
  follow_bodies(simulation, report.info.bodies);
  const BodyId blue = simulation.bodies()[0], red = simulation.bodies()[1];
  const MaterialId blue_matter = simulation.material(blue);
  // Behind frame 2 the red one goes and a blue one comes, in its slot.
  const auto trade = [&](const RunReport& so_far) {
    if (so_far.frames != 2) return;
    simulation.remove_body(red);
    const Body body = sample(Lattice{.count = {2, 2, 2}, .spacing = 1, .corner = {0, 0, 0}});
    EXPECT_EQ(slot_of(simulation.add_body(body, blue_matter, "late")), slot_of(red));
  };
  run_frames(scene, simulation, {},
             {.frames = 4, .steps = {}, .surface = false, .images = false, .threads = 1, .checkpoints = {}},
             &cache, report, {.after_step = {}, .after_frame = trade, .stop = {}});
  count_particles(simulation, report.info.bodies);
  EXPECT_EQ(report.info.bodies[slot_of(blue)].particles, 27u);
  EXPECT_EQ(report.info.bodies[slot_of(red)].particles, 8u);
  simulation.remove_body(blue);
  count_particles(simulation, report.info.bodies);
  EXPECT_EQ(report.info.bodies[slot_of(blue)].particles, 0u);
  const std::vector<SlotBody> now = slot_bodies(report.info.bodies);
  for (const auto& past : {report.past_bodies, past_bodies(to_json(report), "report.json")})
    for (const auto& [frame, material] :
         {std::pair{0, 0u}, std::pair{2, 0u}, std::pair{3, 1u}, std::pair{4, 1u}}) {
      const std::vector<SlotBody> then = slot_bodies_at(frame, now, past);
      EXPECT_EQ(then[slot_of(red)].name, frame < 3 ? "body[1]" : "late") << frame;
      EXPECT_EQ(then[slot_of(blue)].name, "body[0]") << frame;
      const std::vector<Appearance> looks = body_appearances(scene, material_names(then));
      EXPECT_EQ(looks[slot_of(red)].color, *scene.materials[material].color) << frame;
      EXPECT_EQ(looks[slot_of(blue)].color, *scene.materials[1].color) << frame;
    }
}

}  // namespace run_loop_test
}  // namespace mallow::program
