#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/program.h"
#include "mallow/scene.h"

namespace mallow::test {
namespace {

class cli_tune : public CliTest {
 protected:
  Outcome tune(std::vector<std::string> more) const {
    std::vector<std::string> all = {"tune", scene_,      "--budget", "2s",          "--repeats",
                                    "1",    "--threads", "1",        "--no-surface"};
    all.insert(all.end(), more.begin(), more.end());
    return run_mallow(all);
  }
};

TEST_F(cli_tune, writes_a_scene_at_a_pick_that_holds) {
  const Outcome outcome = tune({"--error", "5h", "--write", at("tuned.toml"), "--out", at("study")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json study = read_json(at("study/tradeoff.json"));
  EXPECT_TRUE(study.at("pick").at("holds").get<bool>());
  EXPECT_LE(study.at("pick").at("error_h").get<double>(), 5);
  EXPECT_NO_THROW(read_scene(at("tuned.toml")));
  EXPECT_EQ(names_in(at("study")), (std::vector<std::string>{"index.html", "tradeoff.csv", "tradeoff.json"}));
}

TEST_F(cli_tune, nothing_that_holds_is_a_failure_that_names_the_nearest) {
  const Outcome outcome = tune({"--frame", "0.00001ms", "--write", at("tuned.toml")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("no setting holds --frame 0.00001ms; the nearest is"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(read_text(at("tuned.toml")), "");
}

TEST_F(cli_tune, never_writes_over_an_input) {
  const std::string before = read_text(scene_);
  const Outcome outcome = tune({"--error", "5h", "--write", scene_});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("--write"), std::string::npos) << outcome.err;
  EXPECT_EQ(read_text(scene_), before);
}

TEST_F(cli_tune, bad_input_is_refused_by_name_and_with_what_is_allowed) {
  const std::vector<std::vector<std::string>> bad = {{"--error", "0h"},
                                                     {"--error", "0.1m"},
                                                     {"--frame",
                                                      "16"
                                                      "x"},
                                                     {"--error", "1h", "--budget", "soon"},
                                                     {"--error", "1h", "--knob", "solver"},
                                                     {"--error", "1h", "--measure", "length(0)"},
                                                     {}};
  for (const auto& arguments : bad) {
    const Outcome outcome = tune(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    const std::string option = arguments.empty() ? "--frame" : arguments[arguments.size() - 2];
    EXPECT_NE(outcome.err.find(option), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace mallow::test
