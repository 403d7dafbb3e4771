#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mallow/report.h"
#include "mallow/simulation.h"
#include "program/growing_file.h"

namespace mallow::program {

/// The time series of a run: a CSV with a row for each frame. The header names columns and units.
class Series {
 public:
  /// Begins a file, for a run whose bodies and colliders are those of `simulation`.
  Series(const std::filesystem::path& file, Simulation& simulation);
  /// Goes on with the series of a run that is resumed. state: what saved() gave. file: where it is now;
  /// empty: where it was. Throws IoError where it is not that series, and nlohmann's exceptions.
  Series(const std::string& state, const std::filesystem::path& file, Simulation& simulation);

  /// Takes in a step that has just been made. Not to be left out for any.
  void add_step(const StepReport& step, const Simulation& simulation);
  /// The row of a frame. volume: that its surface encloses [m³]; left out where none is drawn.
  void add_row(int frame, Simulation& simulation, const std::optional<double>& volume);
  /// What a checkpoint holds, once all rows so far are on the disk.
  std::string saved() const;

  const std::filesystem::path& file() const { return file_.file(); }

 private:
  /// A body that the run began with: what comes later has no columns.
  struct Body {
    BodyId id;
    std::string name;
    bool is_heated = false;
  };
  std::string header() const;
  bool has_body_columns() const;
  bool has_collider_columns() const;
  bool has_temperatures(const Body& body) const;

  GrowingFile file_;
  bool has_units_ = true;  ///< of SI, in the header
  std::vector<Body> bodies_;
  std::vector<ColliderId> colliders_;  ///< that measure loads
  // Since the last row.
  double row_time_ = 0;
  double largest_compression_ = 0;
  double mean_compression_ = 0;
  std::vector<ColliderLoad> loads_;  ///< of each of `colliders_`
};

/// What the columns mean, for a program's help.
const char* series_help();
/// Whether a file that begins so is a series.
bool is_series(std::string_view beginning);

}  // namespace mallow::program
