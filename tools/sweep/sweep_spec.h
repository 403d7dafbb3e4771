#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mallow::sweep {

/// Where something stands in the spec file, from 1; 0: nowhere, as it is left out there.
struct Place {
  int line = 0, column = 0;
};

/// One key of the scene that a sweep turns, by a list or by a range.
struct Vary {
  std::string key;                  ///< as `mallow run --set` has it: "material[0].alpha"
  std::vector<std::string> also;    ///< keys that get the same value
  std::vector<std::string> values;  ///< as TOML writes them; empty where it is a range
  double from = 0, to = 0;          ///< of a range, from < to
  std::optional<int> count;         ///< of a range in a grid, ends included
  bool logarithmic = false;
  bool whole = false;  ///< from and to are written as whole numbers, and so is what lies between
};

enum class Method { grid, random, latin_hypercube, sobol };

/// A column of the series of a run, and what of it goes into the table.
struct Measure {
  enum class Of { last, least, most, mean };
  std::string column;  ///< without its unit: "height"
  Of of = Of::last;
  std::string name;  ///< "height.last"
  Place place = {};
};

/// A picture of the table: columns of it.
struct Plot {
  struct Column {
    std::string name;
    Place place = {};
  };
  Column x, y, color;  ///< color: its name may be empty
};

/// What a spec file says.
struct SweepSpec {
  std::filesystem::path file;
  std::filesystem::path scene;
  Method method = Method::grid;
  int points = 0;  ///< of all methods but grid
  std::uint64_t seed = 1;
  std::optional<int> frames;  ///< in place of the scene's
  bool images = false;        ///< of the last frame of each point, and a sheet of them
  std::vector<Vary> vary;
  std::filesystem::path points_file;  ///< points from a CSV, in place of a method
  std::vector<Measure> measures;
  std::vector<Plot> plots;
};

/// Throws IoError, and ConfigError with all that is wrong, by line.
SweepSpec read_spec(const std::filesystem::path& file);

/// The values of each point, in the order of spec.vary, as TOML writes them. Depends on the spec alone.
/// points_file: its header becomes spec.vary. Throws IoError and ConfigError.
std::vector<std::vector<std::string>> sample_points(SweepSpec& spec);

}  // namespace mallow::sweep
