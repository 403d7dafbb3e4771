#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "mallow/mesh.h"

namespace mallow {

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

inline void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_TRUE(same_bits(a.vertices, b.vertices));
  EXPECT_TRUE(same_bits(a.normals, b.normals));
  EXPECT_TRUE(same_bits(a.velocities, b.velocities));
  EXPECT_TRUE(same_bits(a.material_ids, b.material_ids));
  EXPECT_TRUE(same_bits(a.triangles, b.triangles));
}

}  // namespace mallow
