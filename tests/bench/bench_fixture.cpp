#include "bench_fixture.h"

#include <cstdlib>

namespace mallow::test {

nlohmann::json BenchTest::run_command(const std::string& command, std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), {command, "--out", at("out")});
  const Outcome outcome = run_mallow(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out, "");
  nlohmann::json document = read_json(at("out/" + command + ".json"));
  EXPECT_EQ(document.at("complete"), true);
  EXPECT_NE(read_text(at("out/" + command + ".csv")), "");
  return document;
}

void BenchTest::expect_refused(const std::string& command, std::vector<std::string> arguments,
                               const std::vector<std::string>& words) const {
  arguments.insert(arguments.begin(), {command, "--out", at("refused")});
  const Outcome outcome = run_mallow(arguments);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  for (const std::string& word : words) {
    EXPECT_NE(outcome.err.find(word), std::string::npos) << "'" << word << "' is not in: " << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(at("refused"))) << "nothing ran";
}

void BenchTest::expect_valid(const std::string& command) const {
  const std::string program = MALLOW_JSONSCHEMA;
  if (program.empty()) GTEST_SKIP() << "the program jsonschema is not installed";
  const std::string line = program + " -i " + at("out/" + command + ".json") + " " MALLOW_SCHEMA_DIR "/" +
                           command + ".schema.json";
  EXPECT_EQ(std::system(line.c_str()), 0) << line;
}

}  // namespace mallow::test
