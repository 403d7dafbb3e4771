#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mallow/errors.h"
#include "mallow/mesh.h"

namespace mallow {

/// A sphere of `stacks` × 2 `stacks` patches, closed.
inline Mesh sphere_mesh(const Vec3& center, float radius, int stacks) {
  Mesh mesh;
  const int slices = 2 * stacks;
  const auto add = [&](double polar, double azimuth) {
    mesh.vertices.push_back(
        center + radius * Vec3(Eigen::Vector3d(std::sin(polar) * std::cos(azimuth),
                                               std::sin(polar) * std::sin(azimuth), std::cos(polar))
                                   .cast<float>()));
  };
  add(0, 0);
  for (int i = 1; i < stacks; ++i)
    for (int j = 0; j < slices; ++j) add(std::numbers::pi * i / stacks, std::numbers::pi * j / stacks);
  add(std::numbers::pi, 0);
  const auto ring = [&](int i, int j) { return static_cast<std::uint32_t>(1 + i * slices + j % slices); };
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (int j = 0; j < slices; ++j) {
    mesh.triangles.push_back({0, ring(0, j), ring(0, j + 1)});
    for (int i = 0; i + 2 < stacks; ++i) {
      mesh.triangles.push_back({ring(i, j), ring(i + 1, j), ring(i + 1, j + 1)});
      mesh.triangles.push_back({ring(i, j), ring(i + 1, j + 1), ring(i, j + 1)});
    }
    mesh.triangles.push_back({ring(stacks - 2, j), last, ring(stacks - 2, j + 1)});
  }
  return mesh;
}

/// A box that faces outwards.
inline Mesh box_mesh(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  for (unsigned corner = 0; corner < 8; ++corner)
    mesh.vertices.emplace_back(corner & 1u ? high.x() : low.x(), corner & 2u ? high.y() : low.y(),
                               corner & 4u ? high.z() : low.z());
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// The same surface, facing the other way.
inline Mesh turned(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

/// Adds a mesh with vertices of its own.
inline void append(Mesh& all, const Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const auto& [a, b, c] : mesh.triangles) all.triangles.push_back({first + a, first + b, first + c});
}

/// Several meshes as one.
inline Mesh together(std::initializer_list<Mesh> meshes) {
  Mesh all;
  for (const Mesh& mesh : meshes) append(all, mesh);
  return all;
}

/// Positive where triangles are counter-clockwise seen from outside.
inline double signed_volume(const Mesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k)
      corners.col(k) = (mesh.vertices[t[static_cast<std::size_t>(k)]] - mesh.vertices[0]).cast<double>();
    volume += corners.determinant() / 6;
  }
  return volume;
}

/// Parts that no triangle connects.
inline std::size_t component_count(const Mesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : mesh.triangles) {
    parent[root(t[0])] = root(t[1]);
    parent[root(t[1])] = root(t[2]);
  }
  std::set<std::uint32_t> roots;
  for (std::uint32_t v = 0; v < parent.size(); ++v) roots.insert(root(v));
  return roots.size();
}

/// What a ConfigError thrown by `act` says; empty where none was thrown.
template <class Act>
std::string config_error(const Act& act) {
  try {
    act();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

inline void expect_words(const std::string& text, std::initializer_list<const char*> words) {
  for (const char* word : words)
    EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
}

}  // namespace mallow
