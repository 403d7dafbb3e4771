#include "tradeoff/confirm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "swinging_scene.h"
#include "tradeoff/tables.h"

namespace mallow::confirm_test {

constexpr double k_never = std::numeric_limits<double>::infinity();

Scene scene() {
  return parse_scene(k_swinging, "scene.toml");
}

const tradeoff::StudyOptions k_options{.budget = k_enough, .threads = 1, .repeats = 1, .surface = false};

/// A study whose settings have times that were not measured [s]: what a run more takes is far less.
tradeoff::Study timed(std::vector<std::vector<double>> seconds) {
  tradeoff::Study study = tradeoff::study(scene(), k_options);
  study.rows.resize(seconds.size(), study.rows.front());
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    study.rows[i].seconds = seconds[i];
    study.rows[i].drawing.assign(seconds[i].size(), 0);
    study.rows[i].setting.name = "row " + std::to_string(i);
    study.rows[i].error.rms = 0.1 * static_cast<double>(i + 1);
  }
  study.chaotic = false;
  return study;
}

TEST(tradeoff_confirm, time_is_the_median_of_all_runs_and_not_the_least) {
  // The first is the most accurate, and was fast enough once.
  tradeoff::Study study = timed({{9, 0.5, 8, 7, 6, 9, 8}, {0.9, 0.8, 0.7, 0.9, 0.9, 0.8, 30}});
  const auto picked = tradeoff::confirm(study, {.is_time = true, .most = 1}, k_options, k_never);
  ASSERT_TRUE(picked);
  EXPECT_EQ(picked->row, 1u);
  EXPECT_TRUE(picked->holds);
  EXPECT_EQ(picked->more, 3u);
  EXPECT_EQ(study.rows[1].seconds.size(), 10u) << "one slow run takes away no pick";
  ASSERT_EQ(picked->dropped.size(), 1u);
  EXPECT_EQ(
      picked->dropped.front(),
      "row 0: 8e+03 ms a frame in the median of 7 runs (500 ms to 9e+03 ms), where 1e+03 ms are allowed; "
      "0.1 h off");
}

TEST(tradeoff_confirm, pick_that_is_too_slow_when_run_again_is_dropped_and_that_is_said) {
  // A frame takes far longer than the first claims; and far less than the second's.
  tradeoff::Study study = timed({{1e-9}, {1e-10}});
  const auto picked = tradeoff::confirm(study, {.is_time = true, .most = 1e-8}, k_options, k_never);
  ASSERT_TRUE(picked);
  EXPECT_FALSE(picked->holds);
  ASSERT_EQ(picked->dropped.size(), 2u);
  EXPECT_TRUE(picked->dropped[0].starts_with("row 0: ")) << picked->dropped[0];
  EXPECT_NE(picked->dropped[0].find("in the median of 4 runs (1e-06 ms to "), std::string::npos)
      << picked->dropped[0];
}

TEST(tradeoff_confirm, what_the_budget_no_longer_reaches_is_picked_by_the_study_alone) {
  tradeoff::Study study = timed({{0.9, 0.8, 0.7}});
  const auto picked = tradeoff::confirm(study, {.is_time = true, .most = 1}, k_options, 0);
  ASSERT_TRUE(picked);
  EXPECT_TRUE(picked->holds);
  EXPECT_EQ(picked->more, 0u);
}

TEST(tradeoff_confirm, pick_by_error_has_the_limit_between_it_and_what_is_cheaper) {
  tradeoff::Study study = tradeoff::study(scene(), k_options);
  const auto row = [&](const std::string& name) {
    return static_cast<std::size_t>(
        std::ranges::find(study.rows, name, [](const auto& r) { return r.setting.name; }) -
        study.rows.begin());
  };
  const std::size_t plain = row("as it is"), longer = row("time_step_factor x 2");
  ASSERT_LT(longer, study.rows.size());
  // What a setting costs is no part of this: longer steps are the cheaper ones.
  for (std::size_t i = 0; i < study.rows.size(); ++i)
    study.rows[i].seconds = {i == longer ? 1.0 : i == plain ? 2.0 : 3.0};
  const double between = 0.5 * (study.error(study.rows[plain]) + study.error(study.rows[longer]));
  const auto picked = tradeoff::confirm(study, {.most = between}, k_options, k_never);
  ASSERT_TRUE(picked && picked->holds);
  EXPECT_EQ(study.rows[picked->row].setting.name, "as it is") << tradeoff::to_text(study);
  EXPECT_EQ(picked->error, study.error(study.rows[plain])) << "the same bits";
  EXPECT_LT(picked->error, between);
}

TEST(tradeoff_confirm, tells_what_to_give_where_the_reference_is_too_far_off) {
  tradeoff::Study study = timed({{1}, {2}});
  tradeoff::StudyOptions options = k_options;
  options.kept = 0.2;
  const auto why = [&] {
    return tradeoff::confirm(study, {.most = 0.1}, options, k_never).value().not_judged;
  };
  study.reference.error = 0.3;
  study.reference.order = 1;
  study.reference.seconds = 5;
  study.reference.factor = 0.5;
  study.reference.parts_again = study.reference.converged = false;
  // Two halvings more, which take 5 s (2 + 4) after 5 s (1 + 1/2 + ...), in half of what is not kept.
  EXPECT_EQ(why(),
            "the reference itself is off by about 0.3 h: ask for no less than that, or give about --budget "
            "100s");
  study.reference.seconds = 4.5;
  EXPECT_TRUE(why().ends_with("about --budget 90s")) << why();
  study.all_frames = study.frames + 1;
  EXPECT_TRUE(
      why().ends_with("or give --set run.frames=" + std::to_string(study.frames) + " and about --budget 90s"))
      << why();
  study.reference.order = 0.1;
  EXPECT_TRUE(why().ends_with(" and more by --budget")) << why();
  study.chaotic = true;
  study.reference.late_shape = 0.3;
  study.last_bit_late.emplace().height = 0.25;
  EXPECT_NE(why().find("no budget brings it nearer, as the last bit of one position moves shapes by 0.25 h"),
            std::string::npos)
      << why();
}

TEST(tradeoff_confirm, no_budget_is_named_that_would_change_nothing) {
  tradeoff::Study study = timed({{1}, {2}});
  const auto why = [&] {
    return tradeoff::confirm(study, {.most = 0.1}, k_options, k_never).value().not_judged;
  };
  study.reference.error = 0.3;
  study.reference.order = 1;
  study.reference.factor = 0.5;
  study.reference.parts_again = study.reference.converged = false;
  ASSERT_NE(why().find("or give about --budget "), std::string::npos) << why();
  study.reference.converged = true;
  EXPECT_NE(why().find("no budget brings it near enough"), std::string::npos) << why();
  study.reference.converged = false;
  study.reference.order = 0.3;  // six halvings more, where there are fewer down to the shortest steps
  EXPECT_NE(why().find("no budget brings it near enough"), std::string::npos) << why();
  EXPECT_EQ(why().find("--budget"), std::string::npos) << why();
}

TEST(tradeoff_confirm, the_reference_is_looked_for_until_it_is_near_enough) {
  tradeoff::StudyOptions options = k_options;
  const tradeoff::Study loose = tradeoff::study(scene(), options);
  ASSERT_TRUE(loose.reference.converged);
  options.limit = tradeoff::Limit{.most = loose.reference.error};
  const tradeoff::Study tight = tradeoff::study(scene(), options);
  EXPECT_LT(tight.reference.factor, loose.reference.factor);
}

}  // namespace mallow::confirm_test
