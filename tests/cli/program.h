#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace mallow::test {

/// What a run of the program `mallow` left behind.
struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// The built program while it runs.
class Running {
 public:
  explicit Running(const std::vector<std::string>& arguments);
  ~Running();  ///< kills it where nobody waited for its end
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  void send(int signal) const;
  /// Whether it is still there.
  bool alive();
  Outcome wait();
  pid_t process() const { return child_; }

 private:
  std::filesystem::path folder_;
  pid_t child_ = 0;
  int status_ = 0;
  bool ended_ = false;
};

/// Runs the built program as a user would.
Outcome run_mallow(const std::vector<std::string>& arguments);

std::string read_text(const std::filesystem::path& file);
nlohmann::json read_json(const std::filesystem::path& file);
/// Names of the files in a folder, sorted; empty where there is no folder.
std::vector<std::string> names_in(const std::filesystem::path& folder);

/// A folder of its own for each test, with a scene in it.
class CliTest : public testing::Test {
 protected:
  CliTest();
  ~CliTest() override;

  std::filesystem::path write(const std::string& name, const std::string& content) const;
  /// The path of a file in the folder, as an argument.
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  /// `mallow run` of the scene, without pictures where not asked for.
  Outcome run(std::vector<std::string> arguments, bool images = false) const;

  std::filesystem::path folder_;
  std::string scene_;  ///< a small cube that falls on a floor
};

}  // namespace mallow::test
