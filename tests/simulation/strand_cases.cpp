// Cases of section 6 of the second chapter.
#include "simulation/oracle_case_parts.h"

namespace mallow {
namespace {

/// Flows down, a little aslant.
const Pose k_down{.translation = {0.3, -0.2, 7.0}, .rotation = {0.96, 0.2, 0.1, 0.05}};

Material strand(Material material) {
  material.deformation_damping = 0.0f;
  return with_paper_settings(std::move(material));
}

}  // namespace

std::vector<Case> cases_of_strands() {
  const std::vector<Vec3> scattered{{0.1f, 0, 0},    {1, 0.2f, 0},   {-0.9f, 0.1f, 0},
                                    {0.2f, 1.1f, 0}, {-0.1f, -1, 0}, {0.9f, -0.8f, 0}};
  const std::vector<Vec3> disc{{0, 0, 0}, {0, -1, 0}, {-1, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Blob lump{strand(lasting(0.3f)), {0, 0, 3.2f}, {0, 0, 0}, {5, 5, 3}};
  return {
      {.name = "strand_of_dough_on_lump",
       .blobs = {lump},
       .colliders = {k_slope},
       .solver = units(),
       .nozzles = {{{.points = scattered, .pose = k_down, .speed = 1.6f, .jitter = 0},
                    strand(dough(0.1f, 0.03f)),
                    scattered}}},
      {.name = "turned_strand_from_moving_nozzle",
       .blobs = {lump},
       .colliders = {k_slope},
       .solver = units(),
       .nozzles = {{{.radius = 1.26f,
                     .pose = k_down,
                     .velocity = {0.2f, 0.1f, 0.05f},
                     .speed = Schedule{{0.0f, 0.5f}, {1.0f, 2.5f}},
                     .start = 0.4,
                     .jitter = 0},
                    strand(lasting(0.0f)),
                    disc,
                    2.4}}},
      {.name = "strand_of_fluid",
       .blobs = {lump},
       .colliders = {k_slope},
       .solver = units(),
       .nozzles = {{{.points = scattered, .pose = k_down, .speed = 1.5f, .jitter = 0},
                    strand(stuff(1.0f)),
                    scattered}}},
  };
}

}  // namespace mallow
