#include "level_set/level_set_file.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>
#include <exception>
#include <string>

#include "level_set/arena.h"
#include "mallow/errors.h"

namespace mallow {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
static_assert(Leaf::DIM == k_block_side);

openvdb::FloatGrid::Ptr to_grid(const SurfaceField& field, const std::string& name) {
  const auto voxel = static_cast<float>(field.frame().voxel_size);
  const float background = SurfaceField::k_background * voxel;
  auto grid = openvdb::FloatGrid::create(background);
  for (std::uint32_t b = 0; b < field.blocks().size(); ++b) {
    const BlockMap::Coord& block = field.blocks().blocks()[b];
    const openvdb::Coord origin(k_block_side * block.x(), k_block_side * block.y(), k_block_side * block.z());
    if (field.kind(b) == BlockKind::inside) grid->tree().addTile(1, origin, -background, false);
    if (field.kind(b) != BlockKind::surface) continue;
    Leaf* const leaf = grid->tree().touchLeaf(origin);
    const float* const distances = field.distances(b);
    for (openvdb::Index v = 0; v < k_block_voxels; ++v) {
      if (std::abs(distances[v]) < SurfaceField::k_background)
        leaf->setValueOn(v, voxel * distances[v]);
      else
        leaf->setValueOff(v, voxel * distances[v]);
    }
  }
  openvdb::tools::signedFloodFill(grid->tree(), false);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setName(name);
  const auto transform = openvdb::math::Transform::createLinearTransform(field.frame().voxel_size);
  const Eigen::Vector3d& origin = field.frame().origin;
  transform->postTranslate({origin.x(), origin.y(), origin.z()});
  grid->setTransform(transform);
  return grid;
}

}  // namespace

void write_level_set(const std::filesystem::path& file, std::span<const SurfaceField> fields, int threads) {
  openvdb::initialize();
  try {
    run_with_threads(threads, [&] {
      openvdb::GridPtrVec grids;
      for (std::size_t f = 0; f < fields.size(); ++f)
        grids.push_back(to_grid(fields[f], fields.size() == 1 ? "surface" : "surface_" + std::to_string(f)));
      openvdb::io::File out(file.string());
      out.write(grids);
      out.close();
      return 0;
    });
  } catch (const std::exception& error) {
    throw IoError({file.string(), 0, 0, "", std::string("cannot be written: ") + error.what()});
  }
}

}  // namespace mallow
