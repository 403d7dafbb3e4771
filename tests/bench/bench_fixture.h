#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/program.h"

namespace mallow::test {

/// Runs of mallow-bench with their output in a folder of each test's own.
class BenchTest : public CliTest {
 protected:
  /// A command with --out; checks that it ends well.
  nlohmann::json run_command(const std::string& command, std::vector<std::string> arguments) const;
  /// A command that is to be refused: nothing is printed, and the message has all of these words.
  void expect_refused(const std::string& command, std::vector<std::string> arguments,
                      const std::vector<std::string>& words) const;
  /// The command's JSON file against tests/bench/<command>.schema.json, with the program jsonschema.
  void expect_valid(const std::string& command) const;
};

}  // namespace mallow::test
