#include "mallow/saved_state.h"

#include "config/field_tables.h"
#include "simulation/phases.h"
#include "simulation/saved_chunks.h"
#include "simulation/settings.h"

namespace mallow {
namespace {

/// Counted up whenever the chunks or what they mean change.
constexpr std::uint32_t k_version = 15;
static_assert(sizeof(std::size_t) == sizeof(std::uint64_t), "sizes are saved as they are");

template <class Archive, class State>
void pass_clock(Archive& archive, State& state) {
  archive(state.step);
  archive(state.time);
  archive(state.last_time_step);
  archive(state.prepared);
  archive(state.passed_periods);
  auto source = static_cast<std::uint8_t>(state.time_step_source);
  archive(source);
  archive(state.scale.spacing);
  archive(state.scale.gravity);
  archive(state.scale.speed);
  if constexpr (!Archive::k_packs) {
    if (source > static_cast<std::uint8_t>(TimeStepSource::modulus))
      archive.fail("the time step has no such source");
    state.time_step_source = static_cast<TimeStepSource>(source);
  }
}

void unpack_clock(const SavedState& saved, Simulation::State& state) {
  unpack(saved, "clock", [&](UnpackingArchive& archive) {
    pass_clock(archive, state);
    if (state.step < 0 || !std::isfinite(state.time) || !std::isfinite(state.last_time_step) ||
        state.last_time_step < 0)
      archive.fail("step and time_step must be 0 or above, and time finite");
    const SceneScale& scale = state.scale;
    const bool settled = state.config.time_step && state.config.support_radius && scale.spacing > 0;
    if (!(std::isfinite(scale.spacing) && scale.spacing >= 0 && std::isfinite(scale.speed) &&
          scale.speed >= 0 && scale.gravity.allFinite() && std::isfinite(state.passed_periods)) ||
        (!settled && (state.prepared || scale.spacing > 0)))
      archive.fail("what settings follow from is not known");
  });
}

}  // namespace

SavedState Simulation::save() const {
  const State& s = *state_;
  SavedState saved;
  const auto add = [&](Chunk chunk) { saved.chunks.push_back(std::move(chunk)); };
  add(packed("version", [&](PackingArchive& archive) { archive(k_version); }));
  add(packed("solver", [&](PackingArchive& archive) { pass_fields(archive, s.config); }));
  add(packed("clock", [&](PackingArchive& archive) { pass_clock(archive, s); }));
  pack_lists(s, saved);
  pack_columns(s, saved);
  return saved;
}

Simulation Simulation::restore(const SavedState& saved, int threads, std::shared_ptr<Executor> executor) {
  std::uint32_t version = 0;
  unpack(saved, "version", [&](UnpackingArchive& archive) { archive(version); });
  if (version != k_version)
    throw ConfigError("saved state", "is of version " + std::to_string(version) +
                                         "; this build of mallow reads " + std::to_string(k_version));
  SolverConfig config;
  unpack(saved, "solver", [&](UnpackingArchive& archive) { pass_fields(archive, config); });
  config.threads = threads;
  config.executor = std::move(executor);
  Simulation simulation(config);
  State& state = *simulation.state_;
  unpack_clock(saved, state);
  const std::vector<ShapeSizes> sizes = unpack_lists(saved, state);
  unpack_columns(saved, sizes, state);
  if (state.scale.spacing > 0) resolve_settings(state);
  if (state.prepared) describe_bodies(state);
  if (state.prepared) prepare_heat(state);
  blend_bodies(state);
  unpack_neighbors(saved, state);
  return simulation;
}

}  // namespace mallow
