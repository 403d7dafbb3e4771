#include <gtest/gtest.h>

#include "bench_fixture.h"

namespace mallow::test {
namespace materials_test {

using bench_materials = BenchTest;

double ratio_of(const nlohmann::json& document, const std::string& quantity) {
  for (const nlohmann::json& row : document.at("rows"))
    if (row.at("quantity") == quantity) return row.at("ratio");
  return 0;
}

TEST_F(bench_materials, of_rubber_find_its_stress_and_its_friction) {
  const nlohmann::json document = run_command("materials", {"--materials", "rubber", "--coarse"});
  expect_valid("materials");
  EXPECT_EQ(document.at("complete"), true);
  EXPECT_EQ(document.at("rows").size(), 6u);
  EXPECT_NEAR(ratio_of(document, "stress held [Pa]"), 1, 0.1);
  EXPECT_NEAR(ratio_of(document, "slid [m]"), 1, 0.05);
}

TEST_F(bench_materials, of_a_name_that_there_is_not_are_refused) {
  expect_refused("materials", {"--materials", "rubbber"}, {"--materials", "rubbber"});
}

}  // namespace materials_test
}  // namespace mallow::test
