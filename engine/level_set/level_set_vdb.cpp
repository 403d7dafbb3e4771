#include "level_set/level_set_vdb.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>
#include <sstream>
#include <string>

#include "level_set/arena.h"

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

std::string level_set_vdb(std::span<const SurfaceField> fields, const Threads& threads) {
  return run_with_threads(threads, [&] {
    openvdb::initialize();
    openvdb::GridPtrVec grids;
    for (std::size_t f = 0; f < fields.size(); ++f)
      grids.push_back(to_grid(fields[f], fields.size() == 1 ? "surface" : "surface_" + std::to_string(f)));
    std::ostringstream bytes(std::ios::binary);
    openvdb::io::Stream(bytes).write(grids);
    return std::move(bytes).str();
  });
}

}  // namespace mallow
