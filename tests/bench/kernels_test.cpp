#include "bench_fixture.h"

namespace mallow::test {
namespace kernels_test {

using bench_kernels = BenchTest;

const nlohmann::json* find_row(const nlohmann::json& document, const std::string& kernel,
                               const std::string& scene) {
  for (const nlohmann::json& row : document.at("rows"))
    if (row.at("kernel") == kernel && row.at("scene") == scene) return &row;
  return nullptr;
}

TEST_F(bench_kernels, rows_follow_the_schema) {
  // One of every subject, on small scenes.
  const nlohmann::json document = run_command(
      "kernels", {"--threads", "1", "--min-time", "0.001", "--repeats", "2", "--filter",
                  "cube_15/|rotations/small|svd_float/small|points_10k_in|surface_field/cube_15"});
  expect_valid("kernels");
  for (const char* kernel : {"row_additions", "write_rows", "region_sums", "region_sums_phase", "goals",
                             "density", "density_two_groups", "accelerations", "surface", "surface_field"})
    EXPECT_NE(find_row(document, kernel, "cube_15"), nullptr) << kernel;
  EXPECT_NE(find_row(document, "cell_grid", "points_10k_in_cell_order"), nullptr);
  EXPECT_NE(find_row(document, "neighbor_lists", "points_10k_in_cell_order"), nullptr);

  const nlohmann::json* sums = find_row(document, "region_sums", "cube_15");
  ASSERT_NE(sums, nullptr);
  EXPECT_NEAR(sums->at("about").at("average_neighbors"), 23.56, 0.01);
  EXPECT_GT(sums->at("times_as_long"), 0);
}

TEST_F(bench_kernels, rotations_are_right_wherever_they_are_determined) {
  const nlohmann::json document = run_command(
      "kernels",
      {"--threads", "1", "--min-time", "0.001", "--repeats", "1", "--all-levels", "--filter", "^rotations/"});
  expect_valid("kernels");
  for (const nlohmann::json& row : document.at("rows")) {
    const nlohmann::json& about = row.at("about");
    EXPECT_LT(about.at("determinant_error_max"), 1e-5) << row;
    if (row.at("scene") == "line") {
      EXPECT_EQ(about.at("determined_share"), 0);
      continue;
    }
    EXPECT_EQ(about.at("determined_share"), 1) << row;
    // Rounding of A, which is 10 at the most, and is shared by a weakest pair of directions of no less than
    // 0.1.
    EXPECT_LT(about.at("error_max"), 1e-4) << row;
  }
}

TEST_F(bench_kernels, a_skin_is_bound_and_follows_a_body) {
  const nlohmann::json document = run_command(
      "kernels", {"--threads", "1", "--min-time", "0.001", "--repeats", "3", "--filter", "^skin_"});
  expect_valid("kernels");
  ASSERT_EQ(document.at("rows").size(), 2u);
  for (const nlohmann::json& row : document["rows"]) {
    EXPECT_EQ(row.at("items"), 37706) << row;
    EXPECT_NEAR(row.at("about").at("particles"), 4000, 40);
    EXPECT_LE(row.at("ms").at("min"), row["ms"].at("median"));
    EXPECT_LE(row["ms"]["median"], row["ms"].at("max"));
  }
}

TEST_F(bench_kernels, what_makes_no_sense_is_refused) {
  expect_refused("kernels", {"--filter", "no_such_kernel"},
                 {"--filter", "no_such_kernel", "region_sums/cube_15"});
  expect_refused("kernels", {"--filter", "("}, {"--filter", "regular expression"});
  expect_refused("kernels", {"--min-time", "0"}, {"--min-time"});
}

}  // namespace kernels_test
}  // namespace mallow::test
