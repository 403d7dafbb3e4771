#include <gtest/gtest.h>

#include "bench_fixture.h"

namespace mallow::test {
namespace drift_test {

using bench_drift = BenchTest;

TEST_F(bench_drift, of_300_steps_stays_below_what_single_precision_explains) {
  const nlohmann::json document = run_command("drift", {"--steps", "300"});
  expect_valid("drift");
  EXPECT_EQ(document.at("complete"), true);
  EXPECT_EQ(document.at("rows").size(), 7u);
  for (const nlohmann::json& row : document.at("rows")) {
    // Positions at 1e5 are seen through columns that have no more digits.
    const bool is_far = row.at("scene").get<std::string>().find("1e5") != std::string::npos;
    EXPECT_LT(row.at("apart").at("10"), 2e-6) << row;
    EXPECT_LT(row.at("apart").at("300"), is_far ? 5e-3 : 1e-4) << row;
    EXPECT_LT(row.at("energy"), 1e-4) << row;
    if (!row.contains("single")) continue;
    EXPECT_LT(row.at("single").at("momentum"), 1e-6) << row;
    EXPECT_LT(row.at("double").at("momentum"), 1e-11) << row;
    EXPECT_NEAR(row.at("single").at("spin").get<double>(), row.at("double").at("spin").get<double>(), 1e-5)
        << row;
  }
}

}  // namespace drift_test
}  // namespace mallow::test
