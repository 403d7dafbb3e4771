#pragma once

#include "colliders/shape.h"
#include "config/field_archive.h"

namespace mallow {

template <>
struct FieldTable<DistanceField> {
  static constexpr std::tuple k_fields{
      Field{"inside", &DistanceField::inside, k_any, "", "particles are kept in, not out"},
  };
};

template <>
struct MALLOW_EXPORT ShapeTraits<DistanceField> {
  static constexpr const char* k_key = "mesh";

  static std::optional<ShapeProblem> problem(const DistanceField& field);
  static bool keeps_in(const DistanceField& field) { return field.inside; }
  template <class Visit>
  static void visit_met(const DistanceField& field, const Visit& visit) {
    visit(field);
  }
  static ShapeNumbers numbers(const DistanceField& field, const Eigen::Vector3d& by);
  static const ColliderLanes& lanes(InstructionLevel level);
  /// Of all places only the first ones in front of the origin.
  static Crossings cross(const DistanceField& field, const Vec3& origin, const Vec3& direction);
  static float edge_distance(const DistanceField&, const Vec3&) {
    return std::numeric_limits<float>::infinity();
  }

  /// What FieldTable has not, in saved states.
  template <class Archive, class Field>
  static void pass_data(Archive& archive, Field& field) {
    DistanceGrid grid;
    if constexpr (Archive::k_packs) grid = *field.grid;
    archive(grid.origin);
    archive(grid.voxel_size);
    for (int& count : grid.size) archive(count);
    std::uint64_t count = grid.distances.size();
    if constexpr (Archive::k_packs)
      archive(count);
    else
      grid.distances.resize(archive.count(sizeof(float)));
    archive.array(grid.distances.data(), grid.distances.size());
    if constexpr (!Archive::k_packs) field.grid = std::make_shared<const DistanceGrid>(std::move(grid));
  }
};

}  // namespace mallow
