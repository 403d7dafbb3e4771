#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "mallow/scene.h"
#include "program/shared_frames.h"
#include "sweep/sweep_spec.h"

namespace mallow::sweep {

/// The file by which a process has a sweep's folder, or a point's, to itself; the system frees it when that
/// process ends, however that comes.
inline constexpr const char* k_sweep_lock = ".lock";

/// What became of a point.
struct Outcome {
  enum class Status { open, done, refused, failed };
  Status status = Status::open;
  std::string message;                     ///< why it was refused, or failed
  std::map<std::string, double> measured;  ///< by name of the measure; none of those that have no number
  double seconds = 0;                      ///< wall time of the run
};
const char* name(Outcome::Status status);

/// A sweep and its folder: points/00007 has scene.toml, series.csv, report.json and point.json of point 7.
class SweepFolder {
 public:
  /// Samples the points. program: the mallow that runs them. Throws IoError and ConfigError.
  SweepFolder(SweepSpec spec, std::filesystem::path folder, std::filesystem::path program);

  const SweepSpec& spec() const { return spec_; }
  const std::filesystem::path& folder() const { return folder_; }
  const std::vector<std::vector<std::string>>& points() const { return points_; }
  std::filesystem::path point_folder(std::size_t point) const;
  /// The picture of a point's last frame; empty where there is none.
  std::filesystem::path picture(std::size_t point) const;
  /// Numbers of points whose folders are there, and which the spec does not name: of an earlier, longer
  /// sweep.
  std::vector<std::size_t> left_over() const;
  /// Nothing but `open` where the point was not run, or was with another scene, input or program.
  Outcome outcome(std::size_t point) const;
  /// The command that runs one point by itself, without this folder.
  std::string command(std::size_t point) const;
  /// The command of a worker, which keeps what becomes of a point, as a line for a shell.
  static std::string worker(const std::vector<std::string>& command, std::size_t point);

  /// Runs one point, on so many threads, and keeps what became of it. Whoever runs it, and however often: the
  /// same but for its wall time. Where another process is at it, this waits, and takes what that one has
  /// done. Throws Interrupted; all else that fails is an outcome.
  Outcome run(std::size_t point, int threads) const;
  /// The first `frames` frames of a point, for an estimate; gives the wall time [s], nothing where it fails.
  /// series: where its series goes; may be empty.
  std::optional<double> probe(std::size_t point, int threads, int frames,
                              const std::filesystem::path& series = {}) const;
  /// Throws ConfigError where the first point that runs has no such column as the spec measures: before all
  /// of them are run.
  void check_measures() const;

 private:
  std::vector<std::string> arguments(std::size_t point, int threads) const;
  Scene scene(std::size_t point) const;
  std::string hash(std::size_t point, Scene scene) const;
  int execute(std::size_t point, int threads, const program::FileLock* lock,
              std::filesystem::path& log) const;
  bool is_of_now(std::size_t point, const std::string& hash_then) const;

  SweepSpec spec_;
  std::filesystem::path folder_, program_;
  std::vector<std::vector<std::string>> points_;
  std::uint64_t program_hash_ = 0;
  mutable std::mutex hashing_;
  mutable std::map<std::filesystem::path, std::uint64_t>
      file_hashes_;  ///< of meshes and points of the scenes
};

}  // namespace mallow::sweep
