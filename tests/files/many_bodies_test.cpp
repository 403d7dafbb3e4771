#include "files/file_fixture.h"
#include "mallow/simulation.h"
#include "mallow/surface.h"

namespace mallow {
namespace many_bodies_test {

constexpr std::uint32_t k_side = 10, k_count = k_side * k_side * k_side;
constexpr float k_spacing = 0.5f;

/// Where body b starts, which is 4 from the others.
Vec3 corner_of(std::uint32_t b) {
  return 4.0f * Vec3(static_cast<float>(b % k_side), static_cast<float>(b / k_side % k_side),
                     static_cast<float>(b / (k_side * k_side)));
}

/// 1,000 bodies of eight particles, some steps on.
Simulation thousand_bodies() {
  Simulation simulation({.support_radius = 1.2f, .gravity = {0, 0, -0.1f}});
  for (std::uint32_t b = 0; b < k_count; ++b)
    simulation.add_body(sample(Lattice{.count = {2, 2, 2}, .spacing = k_spacing, .corner = corner_of(b)}),
                        Material{.alpha = 0.5f});
  for (int step = 0; step < 3; ++step) simulation.step();
  return simulation;
}

Mesh drawn(const SurfaceParticles& particles, bool joined) {
  return Surfacer({.voxels_per_spacing = 2, .joined = joined}).draw(particles);
}

/// The simulation's surfaces, drawn once for all tests.
const Mesh& thousand_surfaces() {
  static const Mesh mesh = drawn(surface_particles(thousand_bodies()), false);
  return mesh;
}

/// The body whose place is nearest.
std::uint32_t body_at(const Vec3& point) {
  const auto number = [](float x) { return static_cast<std::uint32_t>(std::lround((x - 0.25f) / 4)); };
  return number(point.x()) + k_side * (number(point.y()) + k_side * number(point.z()));
}

void expect_materials_of_places(const Mesh& mesh) {
  ASSERT_EQ(mesh.material_ids.size(), mesh.vertices.size());
  std::vector<bool> seen(k_count);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    ASSERT_EQ(mesh.material_ids[v], body_at(mesh.vertices[v])) << mesh.vertices[v].transpose();
    seen[mesh.material_ids[v]] = true;
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), k_count);
}

std::vector<MeshBody> thousand_names() {
  std::vector<MeshBody> bodies;
  for (std::uint32_t b = 0; b < k_count; ++b) {
    const Vec3 color = corner_of(b) / 40;
    bodies.push_back({{color}, "body" + std::to_string(b), "m" + std::to_string(b % 7)});
  }
  return bodies;
}

std::size_t count_of(const std::string& text, std::string_view part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(many_bodies, go_through_a_frame_and_its_file_to_surfaces_of_their_own) {
  const TemporaryFolder folder;
  const Simulation simulation = thousand_bodies();
  const ParticleFrame frame = snapshot(simulation);
  ASSERT_EQ(frame.bodies.size(), 8 * k_count);
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) ASSERT_EQ(frame.bodies[i], i / 8);
  write_particles(folder / "a.ply", frame);
  const ParticleFrame read = read_particles(folder / "a.ply");
  EXPECT_EQ(read.bodies, frame.bodies);
  EXPECT_EQ(read.positions, frame.positions);
  EXPECT_EQ(read.velocities, frame.velocities);

  const std::vector<float> spacings(k_count, k_spacing);
  const Mesh mesh = drawn(surface_particles(read, spacings), false);
  expect_materials_of_places(mesh);
  EXPECT_EQ(mesh.vertices, thousand_surfaces().vertices);
  EXPECT_EQ(mesh.material_ids, thousand_surfaces().material_ids);
  EXPECT_THROW(surface_particles(read, std::span(spacings).first(k_count - 1)), ConfigError);
}

TEST(many_bodies, that_share_a_surface_keep_their_materials) {
  expect_materials_of_places(drawn(surface_particles(thousand_bodies()), true));
}

TEST(many_bodies, go_to_mesh_files_and_back) {
  const TemporaryFolder folder;
  const Mesh& mesh = thousand_surfaces();
  write_mesh_ply(folder / "a.ply", mesh);
  EXPECT_EQ(read_mesh(folder / "a.ply").material_ids, mesh.material_ids);
  write_mesh_vtp(folder / "a.vtp", mesh);
  EXPECT_EQ(count_of(content_of(folder / "a.vtp"), "type=\"UInt32\" Name=\"Material\""), 1u);
}

TEST(many_bodies, have_names_of_their_own_in_files_and_share_materials) {
  const TemporaryFolder folder;
  const Mesh& mesh = thousand_surfaces();
  std::vector<MeshBody> bodies = thousand_names();
  write_mesh_obj(folder / "a.obj", mesh, {.bodies = bodies, .material_library = "a.mtl"});
  const std::string obj = content_of(folder / "a.obj");
  EXPECT_EQ(count_of(obj, "\ng body"), k_count);
  EXPECT_EQ(count_of(obj, "\ng body256\nusemtl m4"), 1u);
  EXPECT_EQ(count_of(obj, "\ng body999\nusemtl m5"), 1u);
  write_mesh_glb(folder / "a.glb", mesh, bodies);
  EXPECT_EQ(count_of(content_of(folder / "a.glb"), "\"name\":\"body999\""), 2u);  // node and mesh
  write_mesh_usda(folder / "a.usda", mesh, bodies);
  EXPECT_EQ(count_of(content_of(folder / "a.usda"), "def GeomSubset \"body"), k_count);
  EXPECT_THROW(write_mesh_glb(folder / "a.glb", mesh, std::span(bodies).first(k_count - 1)), ConfigError);

  // Names are told apart by numbers, materials by their looks.
  for (MeshBody& body : bodies) body = {{Vec3(0.5f, 0.5f, 0.5f)}, "ball", "jelly"};
  write_mesh_obj(folder / "a.obj", mesh, {.bodies = bodies, .material_library = "a.mtl"});
  EXPECT_EQ(count_of(content_of(folder / "a.obj"), "\ng ball_999\nusemtl jelly\n"), 1u);
  write_mtl(folder / "a.mtl", bodies);
  EXPECT_EQ(count_of(content_of(folder / "a.mtl"), "newmtl"), 1u);
}

/// Three particles and a mesh of three vertices, of which one is of `last`.
struct Columns {
  ParticleFrame frame = three_particles();
  Mesh mesh = tetrahedron();
  explicit Columns(std::uint32_t last) {
    frame.bodies = {0, last, 3};
    mesh.material_ids = {0, last, 3, 3};
  }
};

TEST(body_column, has_a_byte_for_each_body_below_256_and_four_bytes_above) {
  const TemporaryFolder folder;
  for (const std::uint32_t last : {255u, 256u, 0x80000000u, 0xffffffffu}) {
    const bool narrow = last < 256;
    const Columns columns(last);
    write_particles(folder / "p.ply", columns.frame);
    write_mesh_ply(folder / "m.ply", columns.mesh);
    EXPECT_EQ(read_particles(folder / "p.ply").bodies, columns.frame.bodies);
    EXPECT_EQ(read_mesh(folder / "m.ply").material_ids, columns.mesh.material_ids);
    const auto expect = [&](const char* file, const std::string& property, std::size_t bytes) {
      const std::string content = content_of(folder / file);
      EXPECT_EQ(count_of(content, (narrow ? "property uchar " : "property uint ") + property), 1u);
      const std::string_view end = "end_header\n";
      EXPECT_EQ(content.size() - content.find(end) - end.size(), bytes);
    };
    const std::size_t width = narrow ? 1 : 4;
    expect("p.ply", "group\n", 3 * (24 + width));
    expect("m.ply", "material_id\n", 4 * (12 + width) + 4 * 13);
    write_particles_vtp(folder / "p.vtp", columns.frame);
    EXPECT_EQ(count_of(content_of(folder / "p.vtp"),
                       std::string("type=\"") + (narrow ? "UInt8" : "UInt32") + "\" Name=\"Group\""),
              1u);
  }
}

TEST(body_column, of_any_type_is_read_and_what_is_no_body_refused) {
  const TemporaryFolder folder;
  const auto file = [&](const std::string& type, const std::string& value) {
    std::string text =
        "ply\nformat ascii 1.0\ncomment mallow time 0\ncomment mallow step 0\nelement vertex 1\n";
    for (const char* name : {"x", "y", "z", "vx", "vy", "vz"})
      text += std::string("property float ") + name + '\n';
    return folder.file("a.ply",
                       text + "property " + type + " group\nend_header\n0 0 0 0 0 0 " + value + '\n');
  };
  for (const char* type : {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"})
    EXPECT_EQ(read_particles(file(type, "100")).bodies, std::vector<std::uint32_t>{100}) << type;
  EXPECT_EQ(read_particles(file("double", "4294967295")).bodies, std::vector<std::uint32_t>{0xffffffffu});
  for (const char* value : {"4294967296", "-1", "0.5", "nan"})
    EXPECT_EQ(io_problem([&] { read_particles(file("double", value)); }).field, "vertex 0, group") << value;
}

}  // namespace many_bodies_test
}  // namespace mallow
