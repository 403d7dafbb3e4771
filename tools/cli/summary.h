#pragma once

#include <nlohmann/json_fwd.hpp>

#include "mallow/scene.h"
#include "program/cache.h"

namespace mallow::cli {

/// Writes summary.html: one page with what ran, the time of every phase, the final numbers, film and
/// pictures. report: the content of report.json. Throws IoError where the report lacks something.
void write_summary(const program::Cache& cache, const Scene& scene, const nlohmann::ordered_json& report);

}  // namespace mallow::cli
