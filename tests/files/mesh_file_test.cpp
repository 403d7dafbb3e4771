#include <clocale>
#include <cmath>
#include <cstdio>
#include <locale>
#include <numbers>

#include "files/file_fixture.h"

namespace mallow {
namespace mesh_file_test {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

void expect_same_shape(const Mesh& read, const Mesh& written) {
  EXPECT_EQ(read.vertices, written.vertices);
  EXPECT_EQ(read.triangles, written.triangles);
}

TEST(mesh_file, obj_gives_the_same_mesh_back) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  write_mesh_obj(folder / "a.obj", mesh);
  expect_same_shape(read_mesh(folder / "a.obj"), mesh);
  mesh.normals.assign(4, Vec3(0, 0, 1));
  write_mesh_obj(folder / "a.obj", mesh);
  expect_same_shape(read_mesh(folder / "a.obj"), mesh);
  EXPECT_NE(content_of(folder / "a.obj").find("f 1//1 3//3 2//2\n"), std::string::npos);
}

TEST(mesh_file, obj_says_which_axis_is_up_and_turns_to_y) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  mesh.normals = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0.6f, 0, -0.8f}};
  write_mesh_obj(folder / "z.obj", mesh);
  EXPECT_NE(content_of(folder / "z.obj").find("# z is up\n"), std::string::npos);
  write_mesh_obj(folder / "y.obj", mesh, {.up = UpAxis::y});
  const std::string text = content_of(folder / "y.obj");
  EXPECT_NE(text.find("# y is up\n"), std::string::npos);
  EXPECT_NE(text.find("\nvn 0 1 0\nvn 1 0 0\nvn 0 0 -1\n"), std::string::npos) << text;
  const Mesh read = read_mesh(folder / "y.obj");
  EXPECT_EQ(read.triangles, mesh.triangles);
  for (std::size_t v = 0; v < 4; ++v) {
    const Vec3& z_up = mesh.vertices[v];
    EXPECT_EQ(read.vertices.at(v), Vec3(z_up.x(), z_up.z(), -z_up.y()));
  }
}

TEST(mesh_file, obj_names_bodies_and_materials_that_are_in_the_mtl) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {3, 2, 1}, {1, 2, 0}};
  mesh.material_ids = {2, 0, 0, 2};  // triangles of bodies 0, 2, 0, 0
  const std::vector<MeshBody> bodies = {{{{0.5f, 0, 1}}, "left cube", "soft\tjelly#1"},
                                        {},
                                        {{{0.2f, 0.2f, 0.2f}, Finish::clay}, "left\ncube", "Ton"}};
  write_mtl(folder / "m.mtl", bodies);
  write_mesh_obj(folder / "a.obj", mesh, {.bodies = bodies, .material_library = "m.mtl"});
  const std::string text = content_of(folder / "a.obj");
  EXPECT_NE(text.find("mtllib m.mtl\n"), std::string::npos);
  EXPECT_NE(text.find("g left_cube\nusemtl soft_jelly_1\nf 1 2 3\nf 4 3 2\nf 2 3 1\n"
                      "g left_cube_1\nusemtl Ton\nf 1 2 4\n"),
            std::string::npos)
      << text;
  const Mesh read = read_mesh(folder / "a.obj");
  EXPECT_EQ(read.vertices, mesh.vertices);
  EXPECT_EQ(read.triangles, (Triangles{{0, 1, 2}, {3, 2, 1}, {1, 2, 0}, {0, 1, 3}}));
  EXPECT_EQ(
      content_of(folder / "m.mtl"),
      "# mallow materials\n# Kd is sRGB\n"
      "\nnewmtl soft_jelly_1\nKd 0.735357 0 1\nKs 0.5 0.5 0.5\nNs 250\nPr 0.5\nPm 0\nd 1\nillum 2\n"
      "\nnewmtl material_1\nKd 0.906332 0.906332 0.906332\nKs 0.5 0.5 0.5\nNs 250\nPr 0.5\nPm 0\nd 1\n"
      "illum 2\n"
      "\nnewmtl Ton\nKd 0.484529 0.484529 0.484529\nKs 0.1 0.1 0.1\nNs 10\nPr 0.9\nPm 0\nd 1\nillum 2\n");
}

TEST(mesh_file, ply_gives_the_same_mesh_back_with_normals_velocities_and_materials) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  write_mesh_ply(folder / "a.ply", mesh);
  Mesh read = read_mesh(folder / "a.ply");
  expect_same_shape(read, mesh);
  EXPECT_TRUE(read.normals.empty());
  EXPECT_TRUE(read.velocities.empty());
  EXPECT_TRUE(read.material_ids.empty());

  constexpr float s = std::numbers::inv_sqrt3_v<float>;
  mesh.normals = {{0, 0, 1}, {1, 0, 0}, {s, s, s}, {0.6f, 0, -0.8f}};
  mesh.velocities = {{0, 0, -9.8f}, {1e-3f, 0, 0}, {2, 3, 4}, {0, -1, 0}};
  mesh.material_ids = {0, 1, 254, 255};
  write_mesh_ply(folder / "a.ply", mesh);
  read = read_mesh(folder / "a.ply");
  expect_same_shape(read, mesh);
  EXPECT_EQ(read.normals, mesh.normals);
  EXPECT_EQ(read.velocities, mesh.velocities);
  EXPECT_EQ(read.material_ids, mesh.material_ids);

  write_mesh_ply(folder / "none.ply", Mesh{});
  EXPECT_TRUE(read_mesh(folder / "none.ply").triangles.empty());
}

TEST(mesh_file, columns_of_the_wrong_length_are_not_written) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  mesh.normals.resize(3);
  EXPECT_THROW(write_mesh_ply(folder / "a.ply", mesh), ConfigError);
  EXPECT_THROW(write_mesh_obj(folder / "a.obj", mesh), ConfigError);
  mesh.normals.clear();
  mesh.material_ids.resize(5);
  EXPECT_THROW(write_mesh_ply(folder / "a.ply", mesh), ConfigError);
  mesh.material_ids = {0, 0, 0, 0};
  EXPECT_THROW(write_mesh_obj(folder / "a.obj", mesh, {.material_library = "a\nv 1 2 3"}), ConfigError);
  mesh.material_ids = {1, 1, 1, 1};
  EXPECT_THROW(write_mesh_obj(folder / "a.obj", mesh, {.bodies = std::array{MeshBody{}}}), ConfigError);
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(mesh_file, obj_knows_all_forms_of_a_corner_and_splits_polygons) {
  const TemporaryFolder folder;
  const Mesh mesh =
      read_mesh(folder.file("a.OBJ",
                            "\xEF\xBB\xBF# a quad\r\nmtllib x.mtl\r\no thing\r\n"
                            "v 0 0 0\r\nv +1 0 0 1.0\r\nv 1e0 1 0 0.5 0.5 0.5\r\n\tv 0 1 .0 # last\r\n"
                            "vt 0 0\r\nvn 0 0 1\r\ng side\r\n"
                            "f 1 2/1 3//1 4/1/1\r\n"
                            "f -4 -3/-1 -2//-1 # comment\r\n"
                            "f 1 2 \\\r\n3\r\n"));
  EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 1, 2}}));
}

TEST(mesh_file, negative_obj_indices_count_from_the_last_vertex_so_far) {
  const TemporaryFolder folder;
  const Mesh mesh = read_mesh(
      folder.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -1 -2 -3\nf 1 2 5\nv 6 6 6\n"));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {3, 2, 1}, {0, 1, 4}}));
}

std::string ply_with_extras(std::endian order) {
  std::string bytes =
      std::string("ply\nformat binary_") + (order == std::endian::big ? "big" : "little") +
      "_endian 1.0\ncomment made by hand\nobj_info nothing\n"
      "element camera 2\nproperty list ushort double view\nproperty char kind\n"
      "element face 1\nproperty int flags\nproperty list int short vertex_index\n"
      "element vertex 4\nproperty double z\nproperty uchar red\nproperty float y\nproperty int x\n"
      "element edge 1\nproperty int a\nend_header\n";
  for (const std::uint16_t length : {std::uint16_t{2}, std::uint16_t{0}}) {
    append_raw(bytes, length, order);
    for (int k = 0; k < length; ++k) append_raw(bytes, 0.5 * k, order);
    append_raw(bytes, std::int8_t{-1}, order);
  }
  append_raw(bytes, std::int32_t{77}, order);
  append_raw(bytes, std::int32_t{4}, order);
  for (std::int16_t index = 0; index < 4; ++index) append_raw(bytes, index, order);
  for (int v = 0; v < 4; ++v) {
    append_raw(bytes, 0.25 * v, order);
    append_raw(bytes, std::uint8_t{200}, order);
    append_raw(bytes, 1.5f * static_cast<float>(v), order);
    append_raw(bytes, std::int32_t{-v}, order);
  }
  append_raw(bytes, std::int32_t{1}, order);
  return bytes;
}

TEST(mesh_file, ply_takes_any_scalar_type_and_passes_over_what_it_does_not_know) {
  const TemporaryFolder folder;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    const Mesh mesh = read_mesh(folder.file("a.ply", ply_with_extras(order)));
    EXPECT_EQ(mesh.vertices,
              (std::vector<Vec3>{{0, 0, 0}, {-1, 1.5f, 0.25f}, {-2, 3, 0.5f}, {-3, 4.5f, 0.75f}}));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  }
}

TEST(mesh_file, ascii_ply_with_windows_line_ends_and_loose_normals_is_read) {
  const TemporaryFolder folder;
  const Mesh mesh = read_mesh(folder.file(
      "a.ply",
      "ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float32 x\r\nproperty float64 y\r\n"
      "property float z\r\nproperty float nx\r\nproperty float ny\r\nproperty float nz\r\n"
      "element face 1\r\nproperty list uint8 int32 vertex_indices\r\nend_header\r\n"
      "0 0 0 0 0 0\r\n\r\n1 0 0.5 0 0 1\r\n0 1e-3 -2 0 0 1\r\n3 0 1 2\r\n"));
  EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0.5f}, {0, 1e-3f, -2}}));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}}));
  EXPECT_TRUE(mesh.normals.empty()) << "normals that are not unit vectors are of no use";
}

std::string binary_stl(const Mesh& mesh, std::string header) {
  header.resize(80, ' ');
  append_raw(header, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (int k = 0; k < 3; ++k) append_raw(header, 0.0f);
    for (const std::uint32_t v : triangle) {
      for (const float value : mesh.vertices[v]) append_raw(header, value);
    }
    append_raw(header, std::uint16_t{0});
  }
  return header;
}

TEST(mesh_file, stl_corners_at_the_same_place_are_one_vertex) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  const Mesh read = read_mesh(folder.file("a.stl", binary_stl(mesh, "made by hand")));
  EXPECT_EQ(read.vertices.size(), 4u);
  EXPECT_EQ(why_not_closed(read), "");
  EXPECT_EQ(read.vertices[read.triangles[3][2]], mesh.vertices[3]);

  // The next float is another place; -0 and 0 are the same.
  mesh.vertices.push_back(mesh.vertices[3]);
  mesh.vertices[4].x() = std::nextafter(mesh.vertices[4].x(), 1.0f);
  mesh.triangles[3][2] = 4;
  EXPECT_EQ(read_mesh(folder.file("b.stl", binary_stl(mesh, ""))).vertices.size(), 5u);
  mesh = tetrahedron();
  mesh.vertices.push_back({mesh.vertices[1].x(), -0.0f, mesh.vertices[1].z()});
  mesh.triangles[2][0] = 4;
  EXPECT_EQ(why_not_closed(read_mesh(folder.file("c.stl", binary_stl(mesh, "")))), "");
}

TEST(mesh_file, a_binary_stl_may_begin_with_solid) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_mesh(folder.file("a.stl", binary_stl(tetrahedron(), "solid work"))).triangles.size(), 4u);
}

TEST(mesh_file, ascii_stl_is_read_in_any_case_and_with_several_solids) {
  const TemporaryFolder folder;
  const Mesh mesh = read_mesh(folder.file(
      "a.stl",
      "solid first part\r\n facet normal 0 0 1\r\n  outer loop\r\n   vertex 0 0 0\r\n   vertex 1 0 0\r\n"
      "   vertex 0 1 0\r\n  endloop\r\n endfacet\r\nendsolid first part\r\n"
      "SOLID\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 1 0 0\nVERTEX 1 1 0\nVERTEX 0 1 "
      "-0\nENDLOOP\nENDFACET\nENDSOLID"));
  EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {1, 3, 2}}));
}

TEST(mesh_file, off_is_read_in_its_variants) {
  const TemporaryFolder folder;
  const Triangles quad = {{0, 1, 2}, {0, 2, 3}};
  for (const char* text : {
           "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n",
           "OFF 4 1\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3",
           "# first\n\nOFF # header\n# counts\n4 1 4\n\n0 0 0\n1 0 0 # second\n1 1 0\n\n0 1 0\n# faces\n4 0 "
           "1 2 3 255 0 0\n",
           "COFF\r\n4 1 0\r\n0 0 0 1 2 3 4\r\n1 0 0 1 2 3 4\r\n1 1 0 1 2 3 4\r\n0 1 0 1 2 3 4\r\n4 0 1 2 "
           "3\r\n",
           "NOFF\n4 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n4 0 1 2 3\n",
       }) {
    const Mesh mesh = read_mesh(folder.file("a.off", text));
    EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}})) << text;
    EXPECT_EQ(mesh.triangles, quad) << text;
  }
}

constexpr double k_east = 500000.25,
                 k_north = 4500000.125;  // as maps of Europe have them; floats are 0.5 apart

/// A cube of side 2 in the coordinates of a map.
std::string mapped_cube(const char* prefix, int digits) {
  std::string text;
  char line[100];
  for (unsigned corner = 0; corner < 8; ++corner) {
    std::snprintf(line, sizeof line, "%s%.*f %.*f %d\n", prefix, digits, k_east + (corner & 1u ? 2 : 0),
                  digits, k_north + (corner & 2u ? 2 : 0), corner & 4u ? 102 : 100);
    text += line;
  }
  return text;
}

TEST(mesh_file, a_mesh_far_from_0_is_read_relative_to_a_point_near_it) {
  const TemporaryFolder folder;
  const char* const faces =
      "3 0 2 3\n3 0 3 1\n3 4 5 7\n3 4 7 6\n3 0 1 5\n3 0 5 4\n3 2 6 7\n3 2 7 3\n"
      "3 0 4 6\n3 0 6 2\n3 1 3 7\n3 1 7 5\n";
  for (const auto& file :
       {folder.file("a.off", "OFF\n8 12 0\n" + mapped_cube("", 3) + faces),
        folder.file("a.ply",
                    "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\n"
                    "property double z\nelement face 12\nproperty list uchar int vertex_indices\n"
                    "end_header\n" +
                        mapped_cube("", 3) + faces),
        folder.file("a.obj", mapped_cube("v ", 3) + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\n"
                                                    "f 2 4 8 6\n")}) {
    Eigen::Vector3d origin;
    const Mesh mesh = read_mesh(file, origin);
    EXPECT_EQ(origin, Eigen::Vector3d(500000, 4500000, 0)) << file;
    EXPECT_EQ(mesh.vertices.front(), Vec3(0.25f, 0.125f, 100)) << file;
    EXPECT_EQ(mesh.vertices.back(), Vec3(2.25f, 2.125f, 102)) << file;
  }
  Eigen::Vector3d origin;
  write_mesh_obj(folder / "near.obj", tetrahedron());
  EXPECT_EQ(read_mesh(folder / "near.obj", origin).vertices, tetrahedron().vertices);
  EXPECT_EQ(origin, Eigen::Vector3d(0, 0, 0));
}

struct CommaPoint : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(mesh_file, numbers_do_not_depend_on_the_locale) {
  const TemporaryFolder folder;
  write_mesh_obj(folder / "plain.obj", tetrahedron());
  const std::string c_before = std::setlocale(LC_ALL, nullptr);
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new CommaPoint));
  // The C library's own, where one with a decimal comma is installed.
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_ALL, name)) break;
  }
  write_mesh_obj(folder / "a.obj", tetrahedron());
  const Mesh read = read_mesh(folder / "a.obj");
  std::locale::global(before);
  std::setlocale(LC_ALL, c_before.c_str());
  expect_same_shape(read, tetrahedron());
  EXPECT_EQ(content_of(folder / "a.obj"), content_of(folder / "plain.obj"));
}

}  // namespace mesh_file_test
}  // namespace mallow
