#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mallow/files.h"
#include "mallow/scene.h"
#include "program/run_report.h"

namespace mallow::program {

/// Share of some particles that are nearer than 0.3 spacings to another one of them. At rest they are about
/// one apart, a lattice that is displaced at random 0.7 at least.
double crushed_share(std::span<const Vec3> positions, float spacing);

/// What only the end of a run shows, a sentence each: bodies that were crushed, as they flow at once or
/// yield to more than the default bears, one sentence a material. info: of the
/// run's simulation. last: its particles at the end.
std::vector<std::string> end_warnings(const Scene& scene, const SimulationInfo& info,
                                      const ParticleFrame& last);
/// Likewise, where something closed on matter and left it less room than it fills; else nothing.
std::optional<std::string> pressed_warning(const RunReport::Compression& compression);

}  // namespace mallow::program
