// Density and accelerations of SPH, per pair within σ (both ways and the particle itself, as lists hold
// them).
#include <memory>
#include <numeric>

#include "kernels/kernel_set.h"
#include "kernels/lattice.h"
#include "sph/sph.h"

namespace mallow::bench {
namespace {

/// About 30 neighbours, and too large for the caches that one core has for itself.
const LatticeScene k_cube_46{"cube_46", {46, 46, 46}, 1.0f, 2.1f};

enum class Pairs { pressure, viscous, grouped };

struct SphScene {
  VectorColumn x, velocity;
  Sph sph;
  double pairs = 0;  ///< within σ, both ways and each particle itself

  SphScene(const LatticeScene& scene, Pairs kind, int threads, InstructionLevel level)
      : x(bent(lattice_points(scene))), velocity(x.size()) {
    const std::size_t n = x.size();
    for (std::size_t i = 0; i < n; ++i) velocity.set(i, 0.01f * x.get(n - 1 - i));
    const auto radius = static_cast<double>(scene.radius);
    const double density = lattice_density(radius, static_cast<double>(scene.spacing));
    const SphGroup group{.mass = 1,
                         .rest_density = static_cast<float>(density),
                         .rest_volume = static_cast<float>(1 / density),
                         .kernel_volume = static_cast<float>(1 / density),
                         .pressure_coefficient = 16,
                         .contact_share = 1,
                         .viscosity = kind == Pairs::pressure ? 0.0f : 0.5f,
                         .cohesion = 0};
    sph.support_radius = scene.radius;
    sph.factors = kernel_factors(radius);
    sph.viscous = kind != Pairs::pressure;
    sph.groups = {group};
    sph.bodies = {{n, 0}};
    if (kind == Pairs::grouped) {
      sph.groups.push_back(group);
      sph.bodies = {{n / 2, 0}, {n, 1}};
    }
    sph.grid.spacing = scene.spacing;
    find_neighbors(x, {threads, level}, sph);
    compute_density({threads, level}, sph);
    NeighborLists exact;
    build_neighbor_lists(sph.grid, scene.radius, {threads, level}, exact);
    pairs = static_cast<double>(exact.total);
  }
  Json about() const {
    const auto n = static_cast<double>(x.size());
    const double near = std::accumulate(sph.lists.count.begin(), sph.lists.count.end(), 0.0);
    return {{"particles", x.size()},
            {"average_neighbors", pairs / n},
            {"lanes_used", pairs / (k_cluster * near)},
            {"list_entries", near / n}};
  }
};

void add_scene(const LatticeScene& scene, int threads, InstructionLevel level, KernelSet& set) {
  const auto timed = [=](Pairs pairs, auto run) {
    return [=] {
      const auto data = std::make_shared<SphScene>(scene, pairs, threads, level);
      return Timed{.run = [=] { run(*data); }, .items = data->pairs, .about = data->about()};
    };
  };
  const auto density = [=](SphScene& s) { compute_density({threads, level}, s.sph); };
  const auto accelerations = [=](SphScene& s) {
    compute_accelerations(s.velocity, {{}, {}}, {threads, level}, s.sph);
  };
  const auto about = [&](const char* kernel) {
    return KernelCase{kernel, scene.name, threads, name(level), "pair"};
  };
  set.add(about("density"), timed(Pairs::viscous, density));
  set.add(about("density_two_groups"), timed(Pairs::grouped, density));
  set.add(about("accelerations_inviscid"), timed(Pairs::pressure, accelerations));
  set.add(about("accelerations"), timed(Pairs::viscous, accelerations));
  set.add(about("accelerations_two_groups"), timed(Pairs::grouped, accelerations));
}

}  // namespace

void add_sph(const KernelVariants& variants, KernelSet& set) {
  for (const LatticeScene& scene : {k_cube_15, k_cube_22, k_cube_46})
    for (const int threads : variants.threads)
      for (const InstructionLevel level : variants.levels) add_scene(scene, threads, level, set);
}

}  // namespace mallow::bench
