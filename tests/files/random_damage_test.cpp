#include <random>

#include "files/file_fixture.h"

/// Files with random damage either are read or throw IoError; under the address and undefined-behaviour
/// sanitizers this also shows that nothing is read or written outside.
namespace mallow {
namespace random_damage_test {

constexpr int k_variants_per_file = 2000;

std::string damaged(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t limit) { return random() % limit; };
  static constexpr std::string_view k_telling[] = {"-1", "0",     "nan", "4294967296", " ",
                                                   "\n", "1e999", "/",   ","};
  for (std::size_t edits = 1 + below(4); edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at = below(bytes.size());
    switch (below(5)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(random());
        break;
      case 2:
        bytes.insert(at, k_telling[below(std::size(k_telling))]);
        break;
      case 3:
        bytes.erase(at, 1 + below(8));
        break;
      default:
        if (below(4) == 0) bytes.resize(at);
        break;
    }
  }
  return bytes;
}

template <class Read>
void expect_survival(const std::string& name, const std::string& content, Read&& read) {
  const TemporaryFolder folder;
  ASSERT_NO_THROW(read(folder.file(name, content))) << "the undamaged file must be readable";
  std::mt19937 random(20240607);
  int refused = 0;
  for (int k = 0; k < k_variants_per_file; ++k) {
    const auto file = folder.file(name, damaged(content, random));
    try {
      read(file);
    } catch (const IoError& error) {
      ++refused;
      EXPECT_EQ(error.problem().file, file.string());
    }
  }
  EXPECT_GT(refused, k_variants_per_file / 10);
}

void expect_valid(const std::filesystem::path& file) {
  const Mesh mesh = read_mesh(file);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) ASSERT_LT(vertex, mesh.vertices.size());
  }
  for (const Vec3& vertex : mesh.vertices) ASSERT_TRUE(vertex.allFinite());
  ASSERT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.vertices.size());
  ASSERT_TRUE(mesh.material_ids.empty() || mesh.material_ids.size() == mesh.vertices.size());
}

std::string written(const char* name, const auto& write) {
  const TemporaryFolder folder;
  write(folder / name);
  return content_of(folder / name);
}

TEST(random_damage, obj) {
  expect_survival("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 .5\nf 1 2/1 3//1 4/1/1\nf -4 -3 \\\n-2\n",
                  expect_valid);
}

TEST(random_damage, binary_ply_mesh) {
  Mesh mesh = tetrahedron();
  mesh.normals.assign(4, Vec3(0, 0, 1));
  mesh.material_ids.assign(4, 7);
  expect_survival("a.ply", written("a.ply", [&](const auto& file) { write_mesh_ply(file, mesh); }),
                  expect_valid);
}

TEST(random_damage, ascii_ply_mesh) {
  expect_survival(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty double y\nproperty int z\n"
      "element face 2\nproperty list uchar int vertex_indices\nproperty list int char extra\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 2\n4 0 1 2 3 1 5\n3 0 1 2 0\n",
      expect_valid);
}

TEST(random_damage, big_endian_ply_mesh) {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\nproperty double y\nproperty "
      "float z\n"
      "element face 1\nproperty list ushort uint vertex_index\nend_header\n";
  for (int v = 0; v < 3; ++v) {
    append_raw(bytes, static_cast<std::int16_t>(v), std::endian::big);
    append_raw(bytes, 0.5 * v, std::endian::big);
    append_raw(bytes, 2.0f, std::endian::big);
  }
  append_raw(bytes, std::uint16_t{3}, std::endian::big);
  for (const std::uint32_t v : {0u, 1u, 2u}) append_raw(bytes, v, std::endian::big);
  expect_survival("a.ply", bytes, expect_valid);
}

TEST(random_damage, ascii_stl) {
  expect_survival(
      "a.stl",
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
      "endfacet\nendsolid a\n",
      expect_valid);
}

TEST(random_damage, binary_stl) {
  std::string bytes(80, '\0');
  append_raw(bytes, std::uint32_t{2});
  for (int t = 0; t < 2; ++t) {
    for (int k = 0; k < 12; ++k) append_raw(bytes, static_cast<float>(k % 5));
    append_raw(bytes, std::uint16_t{0});
  }
  expect_survival("a.stl", bytes, expect_valid);
}

TEST(random_damage, off) {
  expect_survival("a.off",
                  "OFF\n4 2 0\n# corners\n0 0 0\n1 0 0\n1 1 0\n0 1 2.5\n4 0 1 2 3\n3 0 1 2 255 0 0\n",
                  expect_valid);
}

TEST(random_damage, csv) {
  expect_survival("a.csv",
                  "# points\nx,y,z,vx,vy,vz,name\n1,2,3,4,5,6,a\n7,8,9,-1,-2,-3,b\n.5,1e3,0,0,0,0,c\n",
                  [](const auto& file) { read_points(file, 1.0f); });
}

TEST(random_damage, ply_points) {
  expect_survival("a.ply",
                  written("a.ply", [](const auto& file) { write_particles(file, three_particles()); }),
                  [](const auto& file) { read_points(file, 1.0f); });
}

TEST(random_damage, particle_frame) {
  expect_survival("a.ply",
                  written("a.ply", [](const auto& file) { write_particles(file, three_particles()); }),
                  [](const auto& file) { read_particles(file); });
}

}  // namespace random_damage_test
}  // namespace mallow
