#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "sweep/sweep_spec.h"

namespace mallow::sweep {

/// What a spec measures of a series, by name of the measure; none of those that have no number. Throws
/// ConfigError where a series has no such column.
std::map<std::string, double> measure_series(const SweepSpec& spec, const std::filesystem::path& file);

}  // namespace mallow::sweep
