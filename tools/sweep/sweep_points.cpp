#include "sweep/sweep_points.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "mallow/scene.h"
#include "program/cache.h"
#include "program/external_program.h"
#include "program/failure.h"
#include "program/fnv.h"
#include "program/interrupt.h"
#include "program/shared_frames.h"
#include "program/shell_word.h"
#include "sweep/series_measures.h"
#include "sweep/text.h"

namespace mallow::sweep {
namespace fs = std::filesystem;
namespace {

using Status = Outcome::Status;
constexpr std::array k_names{"open", "done", "refused", "failed"};
/// Points that are tried for one that runs.
constexpr std::size_t k_most_tries = 16;

std::vector<std::string> overrides(const SweepSpec& spec, const std::vector<std::string>& values) {
  std::vector<std::string> all;
  for (std::size_t k = 0; k < values.size(); ++k) {
    all.push_back(spec.vary[k].key + "=" + values[k]);
    for (const std::string& key : spec.vary[k].also) all.push_back(key + "=" + values[k]);
  }
  return all;
}

/// Throws ConfigError where a scene has no such key: no point could be run. A value that it refuses is a row.
void check_key(const SweepSpec& spec, const std::string& key, const std::string& value) try {
  read_scene(spec.scene, std::vector{key + "=" + value}, {});
} catch (const ConfigError& error) {
  const std::string text = error.what();
  if (text.find("unknown key") != std::string::npos || text.find("does not exist") != std::string::npos)
    throw;
}

/// Whether a key refuses what lies between two whole numbers: a range from 0 to 1 of a friction has more than
/// these two.
bool takes_whole_numbers_alone(const SweepSpec& spec, const Vary& vary) try {
  read_scene(spec.scene, std::vector{vary.key + "=" + number_text(vary.from + 0.5)}, {});
  return false;
} catch (const ConfigError& error) {
  return std::string(error.what()).find("a whole number") != std::string::npos;
}

/// Throws ConfigError where the frames of a run are said twice.
void check_frames(const SweepSpec& spec) {
  if (!spec.frames) return;
  for (const Vary& vary : spec.vary)
    if (vary.key == "run.frames" || std::ranges::count(vary.also, "run.frames"))
      throw ConfigError({{spec.file.string(), 0, 0, "frames",
                          "is not allowed where run.frames is varied: every run has frames of its own"}});
}

/// Keeps other processes off a point; they wait. The point's run gets it too, so that one that a killed sweep
/// left behind has the point until it ends. Null on a disk without locks.
std::unique_ptr<program::FileLock> lock_point(const fs::path& folder, bool& waited) try {
  const fs::path file = folder / k_sweep_lock;
  auto lock = program::FileLock::try_lock(file);
  waited = !lock;
  return waited ? program::FileLock::wait_for(file) : std::move(lock);
} catch (const IoError&) {
  return nullptr;  // a folder that cannot be written is told where the point's files are
}

/// The last line that a run said, without the program's name: what went wrong.
std::string last_word(const fs::path& log) {
  std::istringstream text(text_of(log));
  std::string last;
  for (std::string line; std::getline(text, line);)
    if (line.starts_with("mallow: ") && !line.starts_with("mallow: warning")) last = line.substr(8);
  return last;
}

}  // namespace

const char* name(Outcome::Status status) {
  return k_names[static_cast<std::size_t>(status)];
}

SweepFolder::SweepFolder(SweepSpec spec, fs::path folder, fs::path program)
    : spec_(std::move(spec)), folder_(std::move(folder)), program_(std::move(program)) {
  for (Vary& vary : spec_.vary) vary.whole = vary.whole && takes_whole_numbers_alone(spec_, vary);
  points_ = sample_points(spec_);
  check_frames(spec_);
  for (std::size_t k = 0; k < spec_.vary.size(); ++k) {
    check_key(spec_, spec_.vary[k].key, points_[0][k]);
    for (const std::string& key : spec_.vary[k].also) check_key(spec_, key, points_[0][k]);
  }
  program_hash_ = program::fnv(text_of(program_));
}

fs::path SweepFolder::point_folder(std::size_t point) const {
  std::string number = std::to_string(point);
  number.insert(0, std::max<std::size_t>(5, number.size()) - number.size(), '0');
  return folder_ / "points" / number;
}

fs::path SweepFolder::picture(std::size_t point) const {
  fs::path last;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(point_folder(point) / "run" / "images", none))
    last = std::max(last, entry.path());
  return last;
}

std::vector<std::size_t> SweepFolder::left_over() const {
  std::vector<std::size_t> numbers;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder_ / "points", none)) {
    const std::string name = entry.path().filename().string();
    if (name.size() > 9 || name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (const std::size_t number = std::stoul(name); number >= points_.size()) numbers.push_back(number);
  }
  std::ranges::sort(numbers);
  return numbers;
}

std::vector<std::string> SweepFolder::arguments(std::size_t point, int threads) const {
  const fs::path folder = fs::absolute(point_folder(point));  // the command is good anywhere
  std::vector<std::string> all{program_.string(),
                               "run",
                               fs::absolute(spec_.scene).string(),
                               "--threads",
                               std::to_string(threads),
                               "--series",
                               (folder / "series.csv").string(),
                               "--report",
                               (folder / "report.json").string(),
                               "--no-images",
                               "--no-surface"};
  if (spec_.frames) all.insert(all.end(), {"--frames", std::to_string(*spec_.frames)});
  if (spec_.images) all.insert(all.end(), {"--out", (folder / "run").string(), "--overwrite"});
  for (const std::string& set : overrides(spec_, points_[point])) all.insert(all.end(), {"--set", set});
  return all;
}

/// Runs the point, and takes the picture of its last frame where there is one to be. Gives the exit code of
/// what failed, or 0. log: where that says why.
int SweepFolder::execute(std::size_t point, int threads, const program::FileLock* lock, fs::path& log) const {
  const fs::path folder = fs::absolute(point_folder(point));
  log = folder / "log.txt";
  const std::optional<int> kept = lock ? std::optional(lock->descriptor()) : std::nullopt;
  int code = program::run_logged(arguments(point, threads), log, program::AtEnd::end, kept);
  if (!spec_.images) return code;
  const std::vector<std::string> last{(folder / "run").string(), "--frames=-1:", "--threads",
                                      std::to_string(threads)};
  for (std::vector<std::string> command :
       {std::vector<std::string>{"surface"}, std::vector<std::string>{"render", "--no-film"}}) {
    if (code != program::k_exit_done || program::interrupted()) break;
    log = folder / (command.front() + ".txt");
    command.insert(command.begin(), program_.string());
    command.insert(command.end(), last.begin(), last.end());
    code = program::run_logged(command, log, program::AtEnd::end, kept);
  }
  return code;
}

std::string SweepFolder::command(std::size_t point) const {
  return program::shell_line(arguments(point, 1));
}

std::string SweepFolder::worker(const std::vector<std::string>& command, std::size_t point) {
  return program::shell_line(command) + " --point " + std::to_string(point);
}

/// The scene of a point. Throws ConfigError and IoError.
Scene SweepFolder::scene(std::size_t point) const {
  return read_scene(spec_.scene, overrides(spec_, points_[point]), {});
}

/// Of all that a row depends on. Throws IoError.
std::string SweepFolder::hash(std::size_t point, Scene scene) const {
  std::uint64_t hash = program::fnv(program::Cache::scene_text(point_folder(point), scene), program_hash_);
  for (const fs::path* file : named_files(scene)) {
    const fs::path path = scene.file.parent_path() / *file;
    const std::lock_guard lock(hashing_);
    const auto [found, is_new] = file_hashes_.try_emplace(path, 0);  // many points read the same mesh
    if (is_new) found->second = program::fnv(text_of(path));
    hash = program::fnv(std::to_string(found->second), hash);
  }
  hash = program::fnv(std::to_string(spec_.frames.value_or(-1)) + (spec_.images ? " images" : ""), hash);
  std::ostringstream text;
  text << std::hex << hash;
  return text.str();
}

/// Whether that is the hash of a point as it would be run now.
bool SweepFolder::is_of_now(std::size_t point, const std::string& hash_then) const try {
  return hash(point, scene(point)) == hash_then;
} catch (const Error&) {
  return false;
}

Outcome SweepFolder::outcome(std::size_t point) const try {
  const auto json = nlohmann::json::parse(text_of(point_folder(point) / "point.json"));
  Outcome outcome;
  const auto status = std::ranges::find(k_names, json.at("status").get<std::string>());
  if (status == k_names.end()) return {};
  outcome.status = static_cast<Status>(status - k_names.begin());
  outcome.message = json.at("message").get<std::string>();
  outcome.seconds = json.at("seconds").get<double>();
  if (outcome.status == Status::refused) return outcome;
  if (!is_of_now(point, json.at("hash").get<std::string>())) return {};
  if (outcome.status == Status::done)
    outcome.measured = measure_series(spec_, point_folder(point) / "series.csv");
  return outcome;
} catch (const nlohmann::json::exception&) {
  return {};
}

Outcome SweepFolder::run(std::size_t point, int threads) const {
  const fs::path folder = point_folder(point);
  Outcome outcome;
  std::string own_hash;
  std::unique_ptr<program::FileLock> lock;
  const auto begin = std::chrono::steady_clock::now();
  try {
    fs::create_directories(folder);
    bool waited = false;
    lock = lock_point(folder, waited);
    if (waited)
      if (Outcome of_another = this->outcome(point); of_another.status == Status::done) return of_another;
    const Scene own = scene(point);
    own_hash = hash(point, own);
    write_whole(folder / "scene.toml", program::Cache::scene_text(folder, own));
    fs::remove(folder / "point.json");
    fs::path log;
    const int code = execute(point, threads, lock.get(), log);
    if (const int signal = program::interrupted())
      throw program::Interrupted("ended by a signal; the same command goes on with what is left", signal);
    outcome.status = code == program::k_exit_done        ? Status::done
                     : code == program::k_exit_bad_input ? Status::refused
                                                         : Status::failed;
    if (code != program::k_exit_done) {
      outcome.message = last_word(log);
      if (outcome.message.empty()) outcome.message = "ended with exit code " + std::to_string(code);
    }
  } catch (const ConfigError& error) {
    outcome.status = Status::refused;
    outcome.message = error.what();
  } catch (const program::Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    outcome.status = Status::failed;
    outcome.message = error.what();
  }
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const nlohmann::ordered_json json{{"point", point},
                                    {"set", overrides(spec_, points_[point])},
                                    {"command", command(point)},
                                    {"seed", spec_.seed},
                                    {"hash", own_hash},
                                    {"status", name(outcome.status)},
                                    {"message", outcome.message},
                                    {"seconds", outcome.seconds}};
  try {
    write_whole(folder / "point.json", json.dump(2) + "\n");
  } catch (const std::exception& error) {  // a full disk is this point's trouble alone
    outcome.status = Status::failed;
    outcome.message = error.what();
  }
  if (outcome.status == Status::done) outcome.measured = measure_series(spec_, folder / "series.csv");
  return outcome;
}

std::optional<double> SweepFolder::probe(std::size_t point, int threads, int frames,
                                         const fs::path& series) const {
  std::vector<std::string> all{program_.string(),       "run",      spec_.scene.string(),   "--threads",
                               std::to_string(threads), "--frames", std::to_string(frames), "--no-images",
                               "--no-surface"};
  if (!series.empty()) all.insert(all.end(), {"--series", series.string()});
  for (const std::string& set : overrides(spec_, points_[point])) all.insert(all.end(), {"--set", set});
  const auto begin = std::chrono::steady_clock::now();
  if (program::run_logged(all, "/dev/null") != program::k_exit_done) return std::nullopt;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void SweepFolder::check_measures() const {
  const fs::path series = fs::temp_directory_path() / ("mallow-sweep-" + std::to_string(::getpid()) + ".csv");
  const struct Removal {
    const fs::path& file;
    ~Removal() {
      std::error_code ignored;
      fs::remove(file, ignored);
    }
  } removal{series};
  for (std::size_t point = 0; point < std::min(points_.size(), k_most_tries); ++point) {
    if (!probe(point, 1, 0, series)) continue;
    measure_series(spec_, series);
    return;
  }
}

}  // namespace mallow::sweep
