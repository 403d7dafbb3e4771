#include "bench_fixture.h"

namespace mallow::test {
namespace table1_test {

using bench_table1 = BenchTest;

TEST_F(bench_table1, rows_follow_the_schema_and_hold_paper_and_textbook_beside_ours) {
  const nlohmann::json document =
      run_command("table1", {"--rows", "cube_3375,bunny_1328", "--steps", "4", "--repeats", "2",
                             "--surface-every", "4", "--textbook-seconds", "0.01"});
  expect_valid("table1");
  ASSERT_EQ(document.at("rows").size(), 2u);
  const nlohmann::json& cube = document.at("rows")[0];
  EXPECT_EQ(cube.at("name"), "cube_3375");
  EXPECT_EQ(cube.at("particles"), 3375);
  EXPECT_NEAR(cube.at("avg_neighbors"), 23.56, 0.005);
  EXPECT_EQ(cube.at("paper_fps1"), 25.1);
  EXPECT_EQ(cube.at("paper_fps2"), 1.2);
  EXPECT_DOUBLE_EQ(cube.at("fps1_ratio").get<double>() * 25.1, cube.at("fps1"));
  EXPECT_GT(cube.at("fps1"), cube.at("fps2"));
  EXPECT_GT(cube.at("fps2"), cube.at("fps2_rendered"));
  EXPECT_GE(cube.at("textbook_steps"), 1);
  EXPECT_DOUBLE_EQ(cube.at("native_ratio").get<double>() * cube.at("native_ms").get<double>() * 25.1, 1000);
}

TEST_F(bench_table1, without_time_for_the_textbook_it_is_not_in_the_rows) {
  const nlohmann::json document =
      run_command("table1", {"--rows", "cube_3375", "--steps", "2", "--repeats", "1", "--surface-every", "2",
                             "--textbook-seconds", "0"});
  expect_valid("table1");
  EXPECT_FALSE(document.at("rows")[0].contains("textbook_ms"));
}

TEST_F(bench_table1, json_goes_where_it_is_wanted) {
  const Outcome outcome =
      run_mallow({"table1", "--rows", "cube_3375", "--steps", "2", "--repeats", "1", "--surface-every", "2",
                  "--textbook-seconds", "0", "--out", at("out"), "--json", at("mine.json")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read_json(at("mine.json")).at("rows").size(), 1u);
  EXPECT_FALSE(std::filesystem::exists(at("out/table1.json")));
}

TEST_F(bench_table1, an_unknown_row_lists_the_known_ones) {
  expect_refused("table1", {"--rows", "cube_3375,cube_9"},
                 {"--rows", "\"cube_9\"", "bar_sigma8", "balls_8264"});
}

TEST_F(bench_table1, what_makes_no_sense_is_refused) {
  expect_refused("table1", {"--steps", "1"}, {"--steps"});
  expect_refused("table1", {"--repeats", "0"}, {"--repeats"});
  expect_refused("table1", {"--textbook-seconds", "-1"}, {"--textbook-seconds"});
}

}  // namespace table1_test
}  // namespace mallow::test
