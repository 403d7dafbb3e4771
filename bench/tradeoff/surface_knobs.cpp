#include "tradeoff/surface_knobs.h"

#include <array>

#include "harness/statistics.h"
#include "mallow/quality.h"
#include "mallow/surface.h"
#include "mallow/tuning.h"
#include "tradeoff/mesh_distance.h"

namespace mallow::bench {
namespace {

/// Voxels along the longest side of the surface that the others are held against.
constexpr int k_reference_voxels = 320, k_small_reference_voxels = 96;

struct SurfaceSetting {
  std::string knob, label;
  SurfaceConfig config;
};

std::vector<SurfaceSetting> make_settings(const SurfaceConfig& written, bool small) {
  std::vector<SurfaceSetting> settings = {{"as written", "as written", written}};
  const auto add = [&](const std::string& knob, const std::string& label, auto change) {
    SurfaceSetting setting{knob, label, written};
    change(setting.config);
    settings.push_back(setting);
  };
  for (const int voxels : small ? std::vector{24, 48} : std::vector{24, 32, 48, 64, 128, 160, 192})
    add("voxels", "voxels " + std::to_string(voxels), [&](SurfaceConfig& c) { c.voxels = voxels; });
  for (const Quality quality : qualities())
    add("quality", name(quality), [&](SurfaceConfig& c) { c = with_quality(c, quality); });
  if (small) return settings;
  for (const float radius : {1.5f, 1.75f, 2.5f, 3.0f})
    add("kernel_radius", "kernel " + std::to_string(radius).substr(0, 4) + " h",
        [&](SurfaceConfig& c) { c.kernel_radius = radius; });
  return settings;
}

std::vector<Vec3> particles(const Moment& moment) {
  std::vector<Vec3> positions;
  for (Eigen::Index i = 0; i < moment.x.rows(); ++i)
    positions.push_back(moment.x.row(i).transpose().cast<float>());
  return positions;
}

}  // namespace

std::vector<Json> measure_surfaces(const std::string& scene_name, const Scene& scene,
                                   const Trajectory& motion, int repeats, bool small, int threads) {
  const float spacing = std::get<Lattice>(scene.bodies.front().source).spacing;
  const std::array<std::vector<Vec3>, 2> frames = {particles(motion.moments[motion.moments.size() / 2]),
                                                   particles(motion.moments.back())};
  SurfaceConfig finest = scene.surface;
  finest.voxel_size.reset();
  finest.voxels = small ? k_small_reference_voxels : k_reference_voxels;
  std::array<Mesh, 2> references;
  for (std::size_t f = 0; f < 2; ++f) references[f] = surface(frames[f], spacing, finest, threads);

  std::vector<Json> rows;
  std::vector<Trade> choices;
  for (const SurfaceSetting& setting : make_settings(scene.surface, small)) {
    std::vector<double> ms;
    double mean_distance = 0, hausdorff = 0, triangles = 0;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      double both = 0;
      for (std::size_t f = 0; f < 2; ++f) {
        Mesh mesh;
        both += milliseconds([&] { mesh = surface(frames[f], spacing, setting.config, threads); });
        if (repeat > 0) continue;
        const MeshDistance distance = mesh_distance(mesh, references[f]);
        mean_distance += 0.5 * distance.mean / static_cast<double>(spacing);
        hausdorff = std::max(hausdorff, distance.hausdorff / static_cast<double>(spacing));
        triangles += 0.5 * static_cast<double>(mesh.triangles.size());
      }
      ms.push_back(0.5 * both);
    }
    rows.push_back({{"scene", scene_name},
                    {"part", "surface"},
                    {"knobs", setting.knob},
                    {"setting", setting.label},
                    {"ms", median(ms)},
                    {"ms_min", minimum(ms)},
                    {"mean_distance_h", mean_distance},
                    {"hausdorff_h", hausdorff},
                    {"triangles", triangles},
                    {"on_front", false}});
    choices.push_back({minimum(ms), mean_distance});
  }
  for (const std::size_t i : pareto_front(choices)) rows[i]["on_front"] = true;
  return rows;
}

}  // namespace mallow::bench
