#define XXH_INLINE_ALL
#include <xxhash.h>

#include <map>
#include <memory>
#include <mutex>

#include "config/field_checks.h"
#include "config/field_tables.h"
#include "mallow/level_set.h"

namespace mallow {
namespace {

/// Grids that somebody still holds, by what they were made of.
class GridCache {
 public:
  using Grid = std::shared_ptr<const DistanceGrid>;
  template <class Make>
  Grid get(std::uint64_t key, const Make& make) {
    const std::lock_guard lock(mutex_);
    std::erase_if(grids_, [](const auto& entry) { return entry.second.expired(); });
    if (Grid known = grids_[key].lock()) return known;
    Grid made = make();
    grids_[key] = made;
    return made;
  }

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, std::weak_ptr<const DistanceGrid>> grids_;
};

}  // namespace

DistanceField mesh_collider(const Mesh& mesh, int voxels, bool inside, int threads) {
  Checks checks;
  check_value("voxels", voxels, k_collider_voxels, checks);
  checks.finish();
  static GridCache cache;
  std::uint64_t key = static_cast<std::uint64_t>(voxels);
  const auto add = [&](const auto& values) {
    if (!values.empty()) key = XXH3_64bits_withSeed(values.data(), values.size() * sizeof(values[0]), key);
  };
  add(mesh.vertices);
  add(mesh.triangles);
  return {cache.get(key,
                    [&] {
                      const ImplicitShape shape = mesh_shape(mesh, voxels, threads);
                      const float voxel =
                          (shape.bounds.max - shape.bounds.min).maxCoeff() / static_cast<float>(voxels);
                      // A little less than the band, as its last voxels hold the bound itself.
                      constexpr float k_band = 2.9f;
                      return distance_field(shape, voxel, false, k_band * voxel).grid;
                    }),
          inside};
}

}  // namespace mallow
