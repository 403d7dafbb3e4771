#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "mallow/mesh.h"

namespace mallow {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Distance of a point from the plane of the nearest vertex.
inline float height_above(const Mesh& mesh, const Vec3& x) {
  float nearest = 1e9f, height = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3 d = x - mesh.vertices[v];
    if (d.squaredNorm() >= nearest) continue;
    nearest = d.squaredNorm();
    height = d.dot(mesh.normals[v]);
  }
  return std::abs(height);
}

inline void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_TRUE(same_bits(a.vertices, b.vertices));
  EXPECT_TRUE(same_bits(a.normals, b.normals));
  EXPECT_TRUE(same_bits(a.velocities, b.velocities));
  EXPECT_TRUE(same_bits(a.material_ids, b.material_ids));
  EXPECT_TRUE(same_bits(a.triangles, b.triangles));
}

}  // namespace mallow
