#include <numbers>

#include "files/file_fixture.h"
#include "files/other_reader.h"

namespace mallow {
namespace vtk_file_test {

using Rows = std::vector<std::vector<double>>;

Rows rows(const std::vector<Vec3>& vectors) {
  Rows rows;
  for (const Vec3& v : vectors) rows.push_back({v.x(), v.y(), v.z()});
  return rows;
}

template <class T>
Rows column(const std::vector<T>& values) {
  Rows rows;
  for (const T value : values) rows.push_back({static_cast<double>(value)});
  return rows;
}

/// What VTK found, as floats: some of its readers give coordinates in double from version 9.2 on.
Rows as_floats(const nlohmann::json& found) {
  Rows rows = found.get<Rows>();
  for (auto& row : rows)
    for (double& value : row) value = double{static_cast<float>(value)};
  return rows;
}

Mesh full_tetrahedron() {
  constexpr float s = std::numbers::inv_sqrt3_v<float>;
  Mesh mesh = tetrahedron();
  mesh.normals = {{0, 0, 1}, {1, 0, 0}, {s, s, s}, {0.6f, 0, -0.8f}};
  mesh.velocities = {{0, 0, -9.8f}, {1e-3f, 0, 0}, {2, 3, 4}, {0, -1, 0}};
  mesh.material_ids = {0, 1, 254, 255};
  return mesh;
}

TEST(vtk_file, vtk_reads_the_mesh_that_was_written_as_vtp) {
  const TemporaryFolder folder;
  const Mesh mesh = full_tetrahedron();
  write_mesh_vtp(folder / "a.vtp", mesh);
  READ_WITH_VTK(read, folder / "a.vtp");
  EXPECT_EQ(as_floats(read.at("points")), rows(mesh.vertices));
  EXPECT_EQ(read.at("cells"), nlohmann::json(mesh.triangles));
  EXPECT_EQ(as_floats(read.at("arrays").at("Normals")), rows(mesh.normals));
  EXPECT_EQ(as_floats(read.at("arrays").at("Velocity")), rows(mesh.velocities));
  EXPECT_EQ(read.at("arrays").at("Material"), column(mesh.material_ids));
}

TEST(vtk_file, vtk_reads_the_particles_that_were_written_as_vtp) {
  const TemporaryFolder folder;
  const ParticleFrame frame = three_particles();
  write_particles_vtp(folder / "a.vtp", frame);
  READ_WITH_VTK(read, folder / "a.vtp");
  EXPECT_EQ(as_floats(read.at("points")), rows(frame.positions));
  EXPECT_EQ(read.at("cells"), (nlohmann::json{{0}, {1}, {2}}));
  EXPECT_EQ(as_floats(read.at("arrays").at("Velocity")), rows(frame.velocities));
  EXPECT_EQ(read.at("arrays").at("Group"), column(frame.bodies));
  EXPECT_EQ(read.at("arrays").at("Id"), (Rows{{0}, {1}, {2}}));
}

TEST(vtk_file, vtk_reads_what_bodies_and_their_materials_are_called) {
  const TemporaryFolder folder;
  const std::vector<MeshBody> bodies = {
      {{}, "a \"cube\" & <more>", "clay"}, {{}, "", ""}, {{}, "k\u00e4se", "clay"}};
  const nlohmann::json names = {"a \"cube\" & <more>", "group 1", "k\u00e4se"};
  const nlohmann::json materials = {"clay", "material 1", "clay"};
  Mesh mesh = full_tetrahedron();
  mesh.material_ids = {0, 1, 2, 0};
  write_mesh_vtp(folder / "a.vtp", mesh, bodies);
  ParticleFrame frame = three_particles();
  frame.bodies = {2, 0, 1};
  write_particles_vtp(folder / "p.vtp", frame, bodies);
  for (const char* name : {"a.vtp", "p.vtp"}) {
    READ_WITH_VTK(read, folder / name);
    EXPECT_EQ(read.at("fields").at("BodyNames"), names);
    EXPECT_EQ(read.at("fields").at("MaterialNames"), materials);
    const bool is_mesh = name[0] == 'a';
    EXPECT_EQ(as_floats(read.at("points")), rows(is_mesh ? mesh.vertices : frame.positions));
    EXPECT_EQ(read.at("arrays").at(is_mesh ? "Material" : "Group"),
              column(is_mesh ? mesh.material_ids : frame.bodies));
  }
}

/// The names stand behind the XML, in the order of bodies and each with a zero, also where no VTK is there to
/// read them.
TEST(vtk_file, names_of_bodies_are_text_in_the_file_and_none_may_be_missing) {
  const TemporaryFolder folder;
  Mesh mesh = full_tetrahedron();
  mesh.material_ids = {0, 1, 1, 0};
  const std::vector<MeshBody> bodies = {{{}, "cube", "clay"}, {{}, "ball", "jelly"}};
  write_mesh_vtp(folder / "a.vtp", mesh, bodies);
  const std::string content = content_of(folder / "a.vtp");
  using namespace std::string_literals;
  for (const std::string& text :
       {"<FieldData>\n<Array type=\"String\" Name=\"BodyNames\" NumberOfTuples=\"2\" format=\"appended\" "
        "offset=\"0\"/>\n"s,
        "\n_\x0A\0\0\0\0\0\0\0cube\0ball\0"s, "\x0B\0\0\0\0\0\0\0clay\0jelly\0"s})
    EXPECT_NE(content.find(text), std::string::npos) << text;
  write_mesh_vtp(folder / "none.vtp", mesh);
  EXPECT_EQ(content_of(folder / "none.vtp").find("FieldData"), std::string::npos);
  mesh.material_ids[2] = 2;
  EXPECT_THROW(write_mesh_vtp(folder / "b.vtp", mesh, bodies), ConfigError);
  EXPECT_EQ(folder.entries(), 2u);
}

TEST(vtk_file, vtk_reads_vtp_files_of_nothing_and_of_bare_triangles) {
  const TemporaryFolder folder;
  write_mesh_vtp(folder / "bare.vtp", tetrahedron());
  READ_WITH_VTK(bare, folder / "bare.vtp");
  EXPECT_EQ(bare.at("cells").size(), 4u);
  EXPECT_TRUE(bare.at("arrays").empty());
  write_mesh_vtp(folder / "no_mesh.vtp", Mesh{});
  READ_WITH_VTK(no_mesh, folder / "no_mesh.vtp");
  EXPECT_TRUE(no_mesh.at("points").empty());
  EXPECT_TRUE(no_mesh.at("cells").empty());
  write_particles_vtp(folder / "no_particles.vtp", ParticleFrame{});
  READ_WITH_VTK(no_particles, folder / "no_particles.vtp");
  EXPECT_TRUE(no_particles.at("points").empty());
}

TEST(vtk_file, vtk_reads_an_obj_with_its_normals) {
  const TemporaryFolder folder;
  const Mesh mesh = full_tetrahedron();
  write_mesh_obj(folder / "a.obj", mesh);
  READ_WITH_VTK(read, folder / "a.obj");
  EXPECT_EQ(as_floats(read.at("points")), rows(mesh.vertices));
  EXPECT_EQ(read.at("cells"), nlohmann::json(mesh.triangles));
  EXPECT_EQ(as_floats(read.at("arrays").at("Normals")), rows(mesh.normals));
}

TEST(vtk_file, vtk_reads_an_obj_with_y_up_and_named_bodies) {
  const TemporaryFolder folder;
  Mesh mesh = full_tetrahedron();
  mesh.material_ids = {1, 1, 0, 0};  // two triangles of body 1, then two of body 0
  const std::array bodies = {MeshBody{{{1, 0, 0}}, "a cube", "clay"}, MeshBody{{{0, 1, 0}}, "b", "jelly"}};
  write_mtl(folder / "a.mtl", bodies);
  write_mesh_obj(folder / "a.obj", mesh, {.up = UpAxis::y, .bodies = bodies, .material_library = "a.mtl"});
  READ_WITH_VTK(read, folder / "a.obj");
  Rows turned;
  for (const Vec3& v : mesh.vertices) turned.push_back({v.x(), v.z(), -v.y()});
  EXPECT_EQ(as_floats(read.at("points")), turned);
  const std::vector<std::array<std::uint32_t, 3>> by_body = {mesh.triangles[2], mesh.triangles[3],
                                                             mesh.triangles[0], mesh.triangles[1]};
  EXPECT_EQ(read.at("cells"), nlohmann::json(by_body));
}

TEST(vtk_file, vtk_reads_a_glb_and_turns_its_z_up) {
  const TemporaryFolder folder;
  Mesh mesh = full_tetrahedron();
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.material_ids.clear();
  write_mesh_glb(folder / "a.glb", mesh, std::array{MeshBody{{{1, 0.5f, 0}}}});
  READ_WITH_VTK(read, folder / "a.glb");
  EXPECT_EQ(read.at("cells"), nlohmann::json(mesh.triangles));
  ASSERT_EQ(read.at("points").size(), 4u);
  for (std::size_t v = 0; v < 4; ++v) {
    const Vec3& x = mesh.vertices[v];
    const Vec3 turned(x.x(), x.z(), -x.y());
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(read.at("points").at(v).at(static_cast<std::size_t>(k)).get<double>(), double{turned[k]},
                  1e-6);
  }
}

TEST(vtk_file, columns_of_the_wrong_length_are_not_written) {
  const TemporaryFolder folder;
  Mesh mesh = tetrahedron();
  mesh.velocities.resize(3);
  EXPECT_THROW(write_mesh_vtp(folder / "a.vtp", mesh), ConfigError);
  mesh = tetrahedron();
  mesh.triangles[2][1] = 4;
  EXPECT_THROW(write_mesh_vtp(folder / "a.vtp", mesh), ConfigError);
  ParticleFrame frame = three_particles();
  frame.bodies.clear();
  EXPECT_THROW(write_particles_vtp(folder / "a.vtp", frame), ConfigError);
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(vtk_file, pvd_names_every_file_with_its_time) {
  const TemporaryFolder folder;
  write_pvd(folder / "a.pvd", std::vector<TimedFile>{{"s/frame_000000.vtp", 0}, {"a&\"b<\n.vtp", 0.1 + 0.2}});
  EXPECT_EQ(content_of(folder / "a.pvd"),
            "<?xml version=\"1.0\"?>\n"
            "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n"
            "<DataSet timestep=\"0\" part=\"0\" file=\"s/frame_000000.vtp\"/>\n"
            "<DataSet timestep=\"0.30000000000000004\" part=\"0\" file=\"a&amp;&quot;b&lt;&#10;.vtp\"/>\n"
            "</Collection>\n</VTKFile>\n");
}

}  // namespace vtk_file_test
}  // namespace mallow
