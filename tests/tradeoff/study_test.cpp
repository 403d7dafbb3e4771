#include "tradeoff/study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <set>
#include <sstream>

#include "mallow/errors.h"
#include "program/failure.h"
#include "swinging_scene.h"
#include "tradeoff/page.h"
#include "tradeoff/tables.h"

namespace mallow::study_test {

/// A fluid that splashes: its particles go their own ways.
const char* const k_splash = R"(
[solver]
gravity = [0.0, 0.0, -9.81]
[[material]]
name = "water"
alpha = 1.0
rest_density = 1000.0
[[body]]
material = "water"
box = { count = [4, 4, 6], spacing = 0.02, corner = [0.0, 0.0, 0.1] }
[[collider]]
box = { min = [0.0, 0.0, 0.0], max = [0.4, 0.25, 9.0], inside = true }
[run]
frames = 200
frame_time = 0.033
)";

/// A nozzle that lets out a strand: there is nothing but what it holds at the begin.
const char* const k_nozzle = R"(
[solver]
gravity = [0.0, 0.0, -9.81]
[[material]]
name = "paste"
alpha = 0.2
youngs_modulus = 8000.0
rest_density = 1300.0
[[emitter]]
material = "paste"
radius = 0.0045
spacing = 0.0015
translate = [0.0, 0.0, 0.03]
rotate = [180.0, 0.0, 0.0]
speed = 0.09
[[collider]]
plane = {}
[run]
frames = 8
frame_time = 0.033
)";
constexpr double k_never = std::numeric_limits<double>::infinity();

Scene scene(const char* text, std::vector<std::string> overrides = {}) {
  return parse_scene(text, "scene.toml", overrides);
}

TEST(tradeoff_study, smooth_motion_converges_at_order_one) {
  const tradeoff::Study study =
      tradeoff::study(scene(k_swinging), {.budget = k_enough, .threads = 1, .repeats = 1, .surface = false});
  ASSERT_TRUE(study.reference.order);
  EXPECT_NEAR(*study.reference.order, 1, 0.15);
  EXPECT_TRUE(study.reference.converged);
  EXPECT_FALSE(study.chaotic);
  ASSERT_TRUE(study.last_bit);
  EXPECT_LT(study.last_bit->rms, 1e-3);
  // Shorter steps are nearer, longer ones farther off.
  const auto error = [&](const char* name) {
    const auto row = std::ranges::find(study.rows, name, [](const auto& r) { return r.setting.name; });
    return row == study.rows.end() ? -1 : study.error(*row);
  };
  EXPECT_GT(error("time_step_factor x 2"), 1.5 * error("as it is"));
  EXPECT_LT(error("time_step_factor x 0.5"), 0.7 * error("as it is"));
}

TEST(tradeoff_study, chaotic_motion_is_told_and_judged_by_its_shape) {
  const tradeoff::Study study =
      tradeoff::study(scene(k_splash), {.budget = k_enough, .threads = 1, .repeats = 1, .surface = false});
  ASSERT_TRUE(study.last_bit);
  EXPECT_TRUE(study.chaotic) << tradeoff::to_text(study) << study.last_bit->rms << " h of "
                             << study.rows.front().error.rms << " h";
  EXPECT_EQ(study.error(study.rows.front()), study.rows.front().late.shape());
  EXPECT_NE(tradeoff::to_text(study).find(study.parts ? "the motion is chaotic: "
                                                      : "shorter steps lead to no one motion: "),
            std::string::npos);
}

TEST(tradeoff_study, a_limit_leads_on_to_knobs_together_that_no_list_has) {
  tradeoff::StudyOptions options{.budget = k_enough, .threads = 1, .repeats = 1, .surface = false};
  const auto run_twice = [](const tradeoff::Study& study) {
    std::set<std::string> scenes;
    for (const tradeoff::Row& row : study.rows) scenes.insert(print_scene(row.setting.scene));
    return study.rows.size() - scenes.size();
  };
  const std::size_t before = run_twice(tradeoff::study(scene(k_swinging), options));
  options.limit = tradeoff::Limit{.most = 1e3};
  const tradeoff::Study study = tradeoff::study(scene(k_swinging), options);
  EXPECT_TRUE(std::ranges::any_of(study.rows, [](const tradeoff::Row& row) {
    return row.setting.name.find(", time_step_factor x 0.8") != std::string::npos;
  })) << tradeoff::to_text(study);
  EXPECT_EQ(run_twice(study), before) << "the search runs no setting that was run";
}

TEST(tradeoff_study, every_column_is_explained) {
  const tradeoff::Study study =
      tradeoff::study(scene(k_swinging), {.budget = k_enough, .threads = 1, .repeats = 1, .surface = false});
  std::string help;
  for (const std::string& line : tradeoff::column_help()) help += line + '\n';
  const std::string csv = tradeoff::to_csv(study);
  std::istringstream header(csv.substr(0, csv.find('\n')));
  for (std::string name; std::getline(header, name, ',');)
    if (name != "setting") {
      EXPECT_NE(help.find(name), std::string::npos) << name;
    }
}

TEST(tradeoff_study, last_bit_of_what_a_nozzle_lets_out_is_moved) {
  const tradeoff::Study study =
      tradeoff::study(scene(k_nozzle), {.budget = k_enough, .threads = 1, .repeats = 1, .surface = false});
  ASSERT_TRUE(study.last_bit) << study.no_last_bit;
  EXPECT_GT(study.last_bit->rms, 0);
}

TEST(tradeoff_study, without_anything_to_be_moved_chaos_is_not_known) {
  const tradeoff::Study study =
      tradeoff::study(scene(k_nozzle, {"emitter[0].start=9.0", "run.frames=5"}),
                      {.budget = k_enough, .threads = 1, .repeats = 1, .surface = false});
  EXPECT_FALSE(study.last_bit);
  EXPECT_NE(tradeoff::to_text(study).find(
                "whether it is chaotic is not known: there was nothing to be moved by its last bit"),
            std::string::npos)
      << tradeoff::to_text(study);
}

/// 12^3 particles for so many frames.
Scene large(int frames) {
  return scene(k_swinging, {"body[0].box.count=[12, 12, 12]", "run.frames=" + std::to_string(frames)});
}

TEST(tradeoff_study, scene_longer_than_the_budget_is_judged_by_its_first_frames_and_that_is_said) {
  const tradeoff::Study study =
      tradeoff::study(large(100000), {.budget = 8, .threads = 1, .repeats = 1, .surface = false});
  EXPECT_GE(study.frames, 4);
  EXPECT_LT(study.frames, study.all_frames);
  EXPECT_GT(study.rows.size(), 1u);
  const std::string part = "the first " + std::to_string(study.frames) + " of 100000 frames";
  EXPECT_EQ(tradeoff::stretch(study), part);
  EXPECT_NE(tradeoff::to_text(study).find("judged by " + part), std::string::npos);
  EXPECT_NE(tradeoff::to_page(study).find("judged by " + part), std::string::npos);
  EXPECT_NE(tradeoff::to_csv(study).find("\"as it is\"," + std::to_string(study.frames) + ",100000,"),
            std::string::npos)
      << tradeoff::to_csv(study);
}

TEST(tradeoff_study, budget_below_a_handful_of_frames_is_refused_with_one_that_carries_them) {
  double budget = 0.002;
  // Other programs run beside this one: where the machine was faster when the budget was measured, it is
  // again.
  for (int refusals = 0; refusals < 6; ++refusals) {
    try {
      tradeoff::study(large(4000), {.budget = budget, .threads = 1, .surface = false});
      EXPECT_GE(refusals, 1);
      return;
    } catch (const program::RunFailure& failure) {
      const std::string text = failure.what();
      const std::size_t place = text.find("needs about --budget ");
      ASSERT_NE(place, std::string::npos) << text;
      budget = 3 * std::stod(text.substr(place + 21));
    }
  }
  FAIL() << "refused with three times what it said: " << budget << " s";
}

TEST(tradeoff_study, budget_is_kept_and_what_it_left_out_is_said) {
  double least = k_never;
  // Several tries: this process may have to wait at the end of one.
  for (int attempt = 0; attempt < 5 && least > 2.4; ++attempt) {
    const auto start = std::chrono::steady_clock::now();
    const tradeoff::Study study =
        tradeoff::study(large(40000), {.budget = 2, .threads = 1, .repeats = 100, .surface = false});
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    EXPECT_LT(study.frames, study.all_frames);
    EXPECT_NE(tradeoff::to_text(study).find("of 40000 frames"), std::string::npos);
  }
  EXPECT_LT(least, 2.4);
}

TEST(tradeoff_study, same_setting_again_is_off_by_the_same_bits) {
  const tradeoff::StudyOptions options{.budget = k_enough, .threads = 1, .repeats = 1, .surface = true};
  const tradeoff::Study study = tradeoff::study(scene(k_swinging), options);
  const tradeoff::Row& row = study.rows.back();
  const auto again = tradeoff::run_again(study, row.setting, options, k_never);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->error.rms, row.error.rms);
  EXPECT_FALSE(tradeoff::run_again(study, row.setting, options, 0)) << "it is too late";
}

TEST(tradeoff_study, measures_and_settings_of_users_are_told) {
  const Scene smooth = scene(k_swinging);
  Scene denser = smooth;
  denser.solver.rotation_iterations = 1;
  const tradeoff::Study study = tradeoff::study(smooth, {.budget = k_enough,
                                                         .threads = 1,
                                                         .repeats = 1,
                                                         .extra = {{"fewer", denser}},
                                                         .measures = {"height(0)", "volume(0)"}});
  EXPECT_NE(tradeoff::to_csv(study).find("\"height(0)\""), std::string::npos);
  EXPECT_NE(tradeoff::to_csv(study).find("\"volume(0)\""), std::string::npos);
  EXPECT_NE(tradeoff::to_csv(study).find("\"fewer\""), std::string::npos);
  const std::string page = tradeoff::to_page(study);
  EXPECT_NE(page.find("<svg"), std::string::npos);
  EXPECT_EQ(page.find("src="), std::string::npos);  // it needs no other file
}

TEST(tradeoff_study, wrong_measures_are_refused_with_what_there_is) {
  for (const char* text : {"height", "length(0)", "height(nobody)"}) {
    try {
      tradeoff::study(scene(k_swinging), {.budget = 1, .measures = {text}});
      ADD_FAILURE() << text;
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.problems().front().field, "--measure");
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos);
    }
  }
}

TEST(tradeoff_study, settings_that_cannot_run_are_told_with_why) {
  Scene bad = scene(k_swinging);
  bad.solver.time_step_factor = 4;
  bad.materials.front().material.elastic_time_step = 1e-3f;
  const tradeoff::Study study = tradeoff::study(
      scene(k_swinging), {.budget = k_enough, .threads = 1, .repeats = 1, .extra = {{"bad", bad}}});
  ASSERT_EQ(study.failed.size(), 1u);
  EXPECT_TRUE(study.failed.front().starts_with("bad: "));
}

}  // namespace mallow::study_test
