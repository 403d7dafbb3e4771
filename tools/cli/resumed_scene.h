#pragma once

#include "cli/scene_options.h"
#include "mallow/scene.h"
#include "program/cache.h"
#include "program/checkpoint.h"

namespace mallow::cli {

/// Takes over into the scene of a run that goes on what counts of its scene.toml, or of the scene that the
/// command line names, and of --set: how frames look, and how many there are. What moves the particles is in
/// the checkpoint: where a file differs there, that is said on stderr; options that ask for it are refused.
/// Returns the scene that was read. Throws ConfigError and IoError.
Scene take_scene(const program::Cache& cache, const SceneOptions& options, program::CheckpointedRun& saved);

}  // namespace mallow::cli
