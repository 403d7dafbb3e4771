#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "files/byte_writer.h"
#include "mallow/files.h"

/// What files of meshes and of series in USD's text have in common.
namespace mallow {

/// An attribute whose values change between frames.
struct UsdAttribute {
  std::size_t depth;          ///< prims around it
  const char* declaration;    ///< type and name
  const char* interpolation;  ///< what its values stand for, or empty
};
inline constexpr UsdAttribute k_usd_extent = {2, "float3[] extent", ""};
inline constexpr UsdAttribute k_usd_counts = {2, "int[] faceVertexCounts", ""};
inline constexpr UsdAttribute k_usd_corners = {2, "int[] faceVertexIndices", ""};
inline constexpr UsdAttribute k_usd_points = {2, "point3f[] points", ""};
inline constexpr UsdAttribute k_usd_normals = {2, "normal3f[] normals", "vertex"};
inline constexpr UsdAttribute k_usd_velocities = {2, "vector3f[] velocities", ""};
/// Of several bodies.
inline constexpr UsdAttribute k_usd_color = {2, "color3f[] primvars:displayColor", "uniform"};
inline constexpr UsdAttribute k_usd_group = {2, "int[] primvars:group", "uniform"};
inline constexpr UsdAttribute k_usd_subset_indices = {3, "int[] indices", ""};

/// Throws ConfigError where rates are not finite and > 0.
void require_valid(const UsdOptions& options);

/// The first line and the layer's metadata, with the time codes where there are any.
std::string usd_header(const UsdOptions& options, std::optional<int> first, std::optional<int> last);
/// A name of a prim: letters of ASCII, digits and _, no digit first.
std::string usd_name(std::string name);

/// ` (interpolation = "vertex")`, over several lines
void append_interpolation(std::string& text, const UsdAttribute& attribute);
/// The right name, among the metadata of a prim, where it differs from the prim's.
void append_display_name(std::string& text, std::size_t depth, const std::string& name,
                         const std::string& title);

}  // namespace mallow
