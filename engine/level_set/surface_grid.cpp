#include <openvdb/io/Stream.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "level_set/arena.h"
#include "mallow/errors.h"
#include "mallow/level_set.h"
#include "mallow/openvdb.h"
#include "surface/surfacer_access.h"

namespace mallow {
namespace {

using Grid = openvdb::FloatGrid;
using Leaf = Grid::TreeType::LeafNodeType;
using Leaves = openvdb::tree::LeafManager<Grid::TreeType>;
static_assert(Leaf::DIM == k_block_side);

/// Voxels on each side of the surface that hold a distance.
constexpr int k_half_band = static_cast<int>(SurfaceField::k_background);
/// Numbers of voxels that an int holds, with those of a grid added.
constexpr double k_farthest = 1 << 30;

/// The blocks as leaves, with those beside surface blocks, whose voxels are on one side; no voxel is active.
Grid::Ptr copy_blocks(const SurfaceField& field) {
  const double voxel = field.frame().voxel_size;
  // Not below three voxels, whichever way they are rounded: tools take a narrower band for a damaged one.
  const float background =
      std::nextafter(static_cast<float>(k_half_band * voxel), 2 * k_half_band * static_cast<float>(voxel));
  auto grid = Grid::create(background);
  // Voxels are numbered from the world's origin where that is a whole number of voxels away: grids of all
  // frames and bodies share a transform, and tools that sum moments see small numbers.
  const Eigen::Vector3d shift = field.frame().shift();
  const bool numbered = shift.cwiseAbs().maxCoeff() < k_farthest;
  const BlockMap::Coord first = numbered ? BlockMap::Coord(shift.cast<int>()) : BlockMap::Coord(0, 0, 0);
  const auto origin = [&](std::uint32_t b) {
    const BlockMap::Coord at = first + k_block_side * field.blocks().blocks()[b];
    return openvdb::Coord(at.x(), at.y(), at.z());
  };
  for (std::uint32_t b = 0; b < field.blocks().size(); ++b)
    if (field.kind(b) == BlockKind::inside) grid->tree().addTile(1, origin(b), -background, false);
  for (std::uint32_t b = 0; b < field.blocks().size(); ++b) {
    if (field.kind(b) != BlockKind::surface) continue;
    Leaf* const leaf = grid->tree().touchLeaf(origin(b));
    for (openvdb::Index v = 0; v < k_block_voxels; ++v)
      leaf->setValueOff(
          v, std::clamp(static_cast<float>(voxel) * field.distances(b)[v], -background, background));
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int way : {-k_block_side, k_block_side}) {
        openvdb::Coord beside = origin(b);
        beside[axis] += way;
        grid->tree().touchLeaf(beside);
      }
  }
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  const Eigen::Vector3d corner = numbered ? field.frame().base() : field.frame().origin;
  transform->postTranslate({corner.x(), corner.y(), corner.z()});
  grid->setTransform(transform);
  return grid;
}

/// Makes the voxels active that the surface passes by: between one and the next along an axis.
void activate_beside_surface(Grid& grid) {
  Leaves(grid.tree()).foreach ([&](Leaf& leaf, std::size_t) {
    const auto values = grid.getConstAccessor();
    for (openvdb::Index v = 0; v < k_block_voxels; ++v) {
      const openvdb::Coord at = leaf.offsetToGlobalCoord(v);
      const bool inside = leaf.getValue(v) < 0;
      bool beside = false;
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int way : {-1, 1}) {
          openvdb::Coord next = at;
          next[axis] += way;
          beside = beside || (values.getValue(next) < 0) != inside;
        }
      if (beside) leaf.setValueOn(v);
    }
  });
}

/// Cuts distances at those of the band's ends.
void trim(float background, Grid& grid) {
  Leaves(grid.tree()).foreach ([&](Leaf& leaf, std::size_t) {
    for (openvdb::Index v = 0; v < k_block_voxels; ++v)
      if (const float d = leaf.getValue(v); !(std::abs(d) < background) || !leaf.isValueOn(v))
        leaf.setValueOff(v, std::copysign(background, d));
  });
  openvdb::tools::changeLevelSetBackground(grid.tree(), background);
  openvdb::tools::pruneLevelSet(grid.tree());
}

/// A field's distances place its zero well and are rough away from it, and stop where a block ends; tools
/// count on a whole band of true ones. So the distances in the band are found from where the zero crosses the
/// lines between voxels.
Grid::Ptr to_grid(const SurfaceField& field) {
  Grid::Ptr grid = copy_blocks(field);
  const float background = grid->background();
  activate_beside_surface(*grid);
  if (grid->activeVoxelCount() > 0) {
    openvdb::tools::dilateActiveValues(grid->tree(), k_half_band, openvdb::tools::NN_FACE_EDGE_VERTEX);
    grid = openvdb::tools::sdfToSdf(*grid);
  }
  trim(background, *grid);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

/// The body that a surface is of; none where it is of several, joined, or of no particles.
const SurfacePart* part_of(const Surfacer& surfacer, std::size_t surface) {
  const auto parts = surfacer.parts();
  const auto part = std::ranges::find(parts, surface, &SurfacePart::body);
  return part == parts.end() ? nullptr : &*part;
}

/// Names and numbers are what programs tell grids apart by, so a name that two bodies share is none.
std::string grid_name(const Surfacer& surfacer, std::size_t surface) {
  const SurfacePart* const part = part_of(surfacer, surface);
  if (part != nullptr && !part->name.empty() &&
      std::ranges::count(surfacer.parts(), part->name, &SurfacePart::name) == 1)
    return part->name;
  return surfacer.surface_count() == 1 ? "surface" : "surface_" + std::to_string(surface);
}

void say_body(const Surfacer& surfacer, std::size_t surface, Grid& grid) {
  const SurfacePart* const part = part_of(surfacer, surface);
  if (part == nullptr) return;
  grid.insertMeta("body", openvdb::Int64Metadata(part->body));
  if (!part->name.empty()) grid.insertMeta("body_name", openvdb::StringMetadata(part->name));
  grid.insertMeta("material_id", openvdb::Int64Metadata(static_cast<std::int64_t>(part->material)));
}

}  // namespace

Grid::Ptr level_set(const Surfacer& surfacer, std::size_t surface) {
  const auto fields = SurfacerAccess::fields(surfacer);
  if (surface >= fields.size())
    throw ConfigError("surface", std::to_string(surface) + " is not allowed: the frame drawn last has " +
                                     std::to_string(fields.size()));
  return run_with_threads(SurfacerAccess::threads(surfacer), [&] {
    openvdb::initialize();
    const auto grid = to_grid(fields[surface]);
    grid->setName(grid_name(surfacer, surface));
    say_body(surfacer, surface, *grid);
    return grid;
  });
}

std::string level_set_vdb(const Surfacer& surfacer, std::span<const std::string> materials) {
  openvdb::GridPtrVec grids;
  for (std::size_t s = 0; s < surfacer.surface_count(); ++s) {
    const Grid::Ptr grid = level_set(surfacer, s);
    grids.push_back(grid);
    const SurfacePart* const part = part_of(surfacer, s);
    if (part == nullptr) continue;
    if (const auto id = static_cast<std::size_t>(part->material); id < materials.size())
      grid->insertMeta("material", openvdb::StringMetadata(materials[id]));
  }
  return run_with_threads(SurfacerAccess::threads(surfacer), [&] {
    openvdb::initialize();
    std::ostringstream bytes(std::ios::binary);
    openvdb::io::Stream(bytes).write(grids);
    return std::move(bytes).str();
  });
}

}  // namespace mallow
