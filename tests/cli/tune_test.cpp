#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/program.h"
#include "mallow/scene.h"

namespace mallow::test {
namespace {

class cli_tune : public CliTest {
 protected:
  /// The study ends by itself long before the budget does.
  Outcome tune(std::vector<std::string> more, const std::string& budget = "60s") const {
    std::vector<std::string> all = {"tune", scene_,      "--budget", budget,         "--repeats",
                                    "1",    "--threads", "1",        "--no-surface", "--no-film"};
    all.insert(all.end(), more.begin(), more.end());
    return run_mallow(all);
  }
};

/// The error of a setting in a study [h].
double error_of(const nlohmann::json& study, const std::string& setting) {
  for (const nlohmann::json& row : study.at("settings"))
    if (row.at("setting") == setting) return row.at("error_h");
  ADD_FAILURE() << "no " << setting;
  return 0;
}

TEST_F(cli_tune, writes_a_scene_at_a_pick_that_holds_a_limit_that_others_miss) {
  ASSERT_EQ(run_mallow({"tradeoff", scene_, "--budget", "60s", "--repeats", "1", "--threads", "1",
                        "--no-surface", "--out", at("before")})
                .exit_code,
            0);
  const nlohmann::json before = read_json(at("before/tradeoff.json"));
  const double fine = error_of(before, "as it is"), coarse = error_of(before, "time_step_factor x 2");
  ASSERT_LT(1.3 * fine, coarse);
  const double limit = 0.5 * (fine + coarse);
  const Outcome outcome =
      tune({"--error", std::to_string(limit) + "h", "--write", at("tuned.toml"), "--out", at("study")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json study = read_json(at("study/tradeoff.json"));
  EXPECT_TRUE(study.at("pick").at("holds").get<bool>());
  EXPECT_EQ(study.at("pick").at("run_again"), 1);
  EXPECT_LE(study.at("pick").at("error_h").get<double>(), limit);
  EXPECT_EQ(study.at("pick").at("error_h").get<double>(), error_of(study, study.at("pick").at("setting")));
  EXPECT_NO_THROW(read_scene(at("tuned.toml")));
  EXPECT_EQ(names_in(at("study")), (std::vector<std::string>{"index.html", "tradeoff.csv", "tradeoff.json"}));
}

TEST_F(cli_tune, picks_the_most_accurate_that_is_fast_enough_by_the_median_of_its_runs) {
  const Outcome outcome = tune({"--frame", "10s", "--write", at("tuned.toml"), "--out", at("study")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json study = read_json(at("study/tradeoff.json"));
  const nlohmann::json& pick = study.at("pick");
  EXPECT_TRUE(pick.at("holds").get<bool>());
  EXPECT_EQ(pick.at("run_again"), 3);
  // All are fast enough: so it is the one that is least off.
  for (const nlohmann::json& row : study.at("settings"))
    EXPECT_LE(pick.at("error_h").get<double>(), row.at("error_h").get<double>()) << row.at("setting");
  EXPECT_TRUE(pick.at("dropped").empty());
  EXPECT_NE(outcome.out.find("ms a frame (median of "), std::string::npos) << outcome.out;
  EXPECT_NO_THROW(read_scene(at("tuned.toml")));
}

TEST_F(cli_tune, scene_longer_than_the_budget_is_tuned_by_its_first_frames_and_the_file_says_so) {
  const Outcome outcome = tune(
      {"--frame", "10s", "--write", at("tuned.toml"), "--out", at("study"), "--set", "run.frames=1000000"},
      "5s");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const int frames = read_json(at("study/tradeoff.json")).at("frames");
  const std::string part = "judged by the first " + std::to_string(frames) + " of 1000000 frames";
  EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  EXPECT_NE(read_text(at("tuned.toml")).find(part), std::string::npos);
  EXPECT_NE(read_text(at("study/index.html")).find(part), std::string::npos);
  EXPECT_EQ(read_scene(at("tuned.toml")).run.frames, 1000000);
}

TEST_F(cli_tune, page_shows_the_scene_as_it_is_beside_a_setting_in_one_film) {
  if (std::system("ffmpeg -version > /dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed";
  const auto tradeoff = [&](std::vector<std::string> more) {
    std::vector<std::string> all = {"tradeoff", scene_,      "--budget", "60s",   "--repeats",
                                    "1",        "--threads", "1",        "--out", at("study")};
    all.insert(all.end(), more.begin(), more.end());
    return run_mallow(all);
  };
  const Outcome outcome = tradeoff({});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string page = read_text(at("study/index.html"));
  EXPECT_NE(page.find("<video src=\"side_by_side.mp4\""), std::string::npos);
  EXPECT_NE(page.find("<td>as it is: "), std::string::npos);
  const std::string film = read_text(at("study/side_by_side.mp4"));
  EXPECT_NE(film.find("ftyp"), std::string::npos);
  EXPECT_GT(film.size(), 2000u);
  // Left out, and that of before is gone.
  ASSERT_EQ(tradeoff({"--no-film"}).exit_code, 0);
  EXPECT_EQ(read_text(at("study/index.html")).find("<video"), std::string::npos);
  EXPECT_EQ(names_in(at("study")), (std::vector<std::string>{"index.html", "tradeoff.csv", "tradeoff.json"}));
}

TEST_F(cli_tune, nothing_that_holds_is_a_failure_that_names_the_nearest) {
  const Outcome outcome = tune({"--frame", "0.00001ms", "--write", at("tuned.toml")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("no pick: no setting holds --frame 0.00001ms; the nearest is"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(outcome.out.find("pick"), std::string::npos) << outcome.out;
  EXPECT_EQ(read_text(at("tuned.toml")), "");
}

TEST_F(cli_tune, error_below_that_of_the_reference_has_one_verdict_that_says_what_to_do) {
  const Outcome outcome = tune({"--error", "0.0000001h", "--write", at("tuned.toml"), "--out", at("study")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("no pick: --error 0.0000001h cannot be judged, as "), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("no budget brings it near enough"), std::string::npos) << outcome.err;
  for (const char* other : {"pick", "nearest"})
    EXPECT_EQ(outcome.out.find(other), std::string::npos) << outcome.out;
  const nlohmann::json pick = read_json(at("study/tradeoff.json")).at("pick");
  EXPECT_FALSE(pick.at("holds").get<bool>());
  EXPECT_NE(pick.at("not_judged"), "");
  EXPECT_EQ(read_text(at("study/index.html")).find("class=\"picked\""), std::string::npos);
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
