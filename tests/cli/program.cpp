#include "cli/program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <sstream>

namespace mallow::test {
namespace fs = std::filesystem;
namespace {

constexpr const char* k_scene = R"(
[solver]
time_step = 0.15
support_radius = 2.0
[[material]]
name = "paste"
alpha = 0.7
[[body]]
material = "paste"
group = "cube"
box = { count = [5, 5, 5], spacing = 1.0, corner = [-2.5, -2.5, 0.6] }
[[collider]]
plane = { normal = [0.0, 0.0, 1.0], offset = 0.0 }
[surface]
voxels = 16
[run]
frames = 2
frame_time = 0.45
[render]
width = 64
height = 36
samples = 1
)";

fs::path new_folder() {
  std::string name = (fs::temp_directory_path() / "mallow-cli-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  return name;
}

}  // namespace

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

nlohmann::json read_json(const fs::path& file) {
  return nlohmann::json::parse(read_text(file));
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  if (!fs::exists(folder)) return names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

Running::Running(const std::vector<std::string>& arguments) : folder_(new_folder()) {
  const std::string out = (folder_ / "out").string();
  const std::string err = (folder_ / "err").string();
  std::vector<std::string> words{MALLOW_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
  const int error = ::posix_spawn(&child_, argv[0], &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) throw std::runtime_error("cannot start " MALLOW_PROGRAM);
}

Running::~Running() {
  if (!ended_) {
    send(SIGKILL);
    ::waitpid(child_, &status_, 0);
  }
  fs::remove_all(folder_);
}

void Running::send(int signal) const {
  if (!ended_) ::kill(child_, signal);
}

bool Running::alive() {
  if (!ended_) ended_ = ::waitpid(child_, &status_, WNOHANG) == child_;
  return !ended_;
}

Outcome Running::wait() {
  if (!ended_) ::waitpid(child_, &status_, 0);
  ended_ = true;
  return {WIFEXITED(status_) ? WEXITSTATUS(status_) : -1, read_text(folder_ / "out"),
          read_text(folder_ / "err")};
}

Outcome run_mallow(const std::vector<std::string>& arguments) {
  return Running(arguments).wait();
}

CliTest::CliTest() : folder_(new_folder()), scene_(write("cube.toml", k_scene).string()) {}

CliTest::~CliTest() {
  fs::remove_all(folder_);
}

fs::path CliTest::write(const std::string& name, const std::string& content) const {
  std::ofstream(folder_ / name, std::ios::binary) << content;
  return folder_ / name;
}

Outcome CliTest::run(std::vector<std::string> arguments, bool images) const {
  arguments.insert(arguments.begin(), {"run", scene_, "--threads", "1"});
  if (!images) arguments.push_back("--no-images");
  return run_mallow(arguments);
}

}  // namespace mallow::test
