#pragma once

#include <optional>
#include <vector>

#include "mallow/ids.h"
#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow::view {

/// What is marked over the picture where it is asked for.
struct Marks {
  bool pins = false;      ///< particles that are pinned
  bool region = false;    ///< the particles of the region of the chosen one
  bool contacts = false;  ///< what bodies get from colliders and from each other
};

/// What a body got from what it touched in the last step.
struct ContactMark {
  Vec3 position;  ///< [m]
  Vec3 force;     ///< in the mean of the step [N]
};

/// Where marks are now: empty where they are not asked for.
struct PlacedMarks {
  std::vector<Vec3> pins;      ///< [m]
  std::optional<Vec3> chosen;  ///< the particle whose region is shown [m]
  std::vector<Vec3> region;    ///< the others in it [m]
  std::vector<ContactMark> contacts;
};

/// Particles that a scene pins at its start. The simulation stands there.
std::vector<ParticleId> pinned_by(const Scene& scene, const Simulation& simulation);

/// asked.contacts: report_contacts() was asked for 0 N s. last_step: Δt [s], 0 before the first one.
PlacedMarks place(const Marks& asked, const Simulation& simulation, const std::vector<ParticleId>& pinned,
                  const std::optional<ParticleId>& chosen, double last_step);

}  // namespace mallow::view
