#include <algorithm>

#include "bench_fixture.h"

namespace mallow::test {
namespace tradeoff_test {

using bench_tradeoff = BenchTest;

TEST_F(bench_tradeoff, rows_follow_the_schema_and_no_row_beats_one_on_the_front) {
  const nlohmann::json document = run_command(
      "tradeoff", {"--small", "--repeats", "1", "--reference-factor", "4", "--scenes", "elastic,fluid"});
  expect_valid("tradeoff");
  for (const std::string scene : {"elastic", "fluid"}) {
    std::vector<nlohmann::json> rows;
    for (const nlohmann::json& row : document.at("rows"))
      if (row.at("scene") == scene && row.at("part") == "motion") rows.push_back(row);
    ASSERT_GT(rows.size(), 4u);
    EXPECT_EQ(rows[0].at("setting"), "as written");
    const auto on_front =
        std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row.at("on_front") == true; });
    EXPECT_GE(on_front, 1);
    for (const nlohmann::json& front : rows) {
      if (front.at("on_front") == false) continue;
      for (const nlohmann::json& row : rows) {
        EXPECT_FALSE(row.at("ms_per_second_min") < front.at("ms_per_second_min") &&
                     row.at("errors").at("position_h") < front.at("errors").at("position_h"))
            << row << " beats " << front;
      }
    }
  }
}

TEST_F(bench_tradeoff, a_quarter_of_the_time_step_has_at_most_a_third_of_the_error_and_keeps_momentum) {
  const nlohmann::json document = run_command("tradeoff", {"--small", "--repeats", "1", "--reference-factor",
                                                           "8", "--scenes", "jelly", "--knobs", "time_step"});
  const auto& convergence = document.at("references").at("jelly");
  ASSERT_EQ(convergence.size(), 3u);
  const auto error = [&](std::size_t k) {
    return convergence[k].at("errors").at("position_h").get<double>();
  };
  EXPECT_LT(error(1), error(0));
  EXPECT_LT(error(2), error(0) / 3);
  for (const nlohmann::json& row : document.at("rows"))
    if (row.at("part") == "motion") {
      EXPECT_LT(row.at("momentum_drift"), 1e-5) << row;
    }
}

TEST_F(bench_tradeoff, knobs_that_a_scene_has_no_use_for_are_not_turned) {
  const nlohmann::json document =
      run_command("tradeoff", {"--small", "--repeats", "1", "--reference-factor", "2", "--scenes",
                               "elastic,fluid", "--knobs", "region_stride,neighbor_slack"});
  for (const nlohmann::json& row : document.at("rows")) {
    EXPECT_FALSE(row.at("scene") == "fluid" && row.at("knobs") == "region_stride");
    EXPECT_FALSE(row.at("scene") == "elastic" && row.at("knobs") == "neighbor_slack");
  }
}

TEST_F(bench_tradeoff, unknown_scenes_and_knobs_list_the_known_ones) {
  expect_refused("tradeoff", {"--scenes", "clay"}, {"--scenes", "\"clay\"", "elastic, jelly, paste, fluid"});
  expect_refused("tradeoff", {"--knobs", "colour"}, {"--knobs", "\"colour\"", "time_step", "region_stride"});
}

}  // namespace tradeoff_test
}  // namespace mallow::test
