#include <cstring>
#include <limits>

#include "files/file_fixture.h"
#include "mallow/simulation.h"
#include "mallow/surface.h"

namespace mallow {
namespace particle_file_test {

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

TEST(particle_file, gives_the_same_frame_back_to_the_bit) {
  const TemporaryFolder folder;
  const ParticleFrame frame = three_particles();
  write_particles(folder / "a.ply", frame);
  const ParticleFrame read = read_particles(folder / "a.ply");
  EXPECT_TRUE(same_bits(read.positions, frame.positions));
  EXPECT_TRUE(same_bits(read.velocities, frame.velocities));
  EXPECT_EQ(read.bodies, frame.bodies);
  EXPECT_EQ(read.time, frame.time);
  EXPECT_EQ(read.step, frame.step);
  write_particles(folder / "none.ply", ParticleFrame{});
  EXPECT_TRUE(read_particles(folder / "none.ply").positions.empty());
}

TEST(particle_file, says_which_particle_is_which_once_some_are_gone) {
  const TemporaryFolder folder;
  Simulation s({.time_step = 0.1f, .support_radius = 2.1f, .threads = 1});
  const BodyId first = s.add_body(sample(Lattice{.count = {2, 2, 2}}), Material{});
  s.add_body(sample(Lattice{.count = {2, 2, 2}, .corner = {9, 0, 0}}), Material{});
  EXPECT_TRUE(snapshot(s).ids.empty());
  s.remove_body(first);
  s.add_body(sample(Lattice{.count = {2, 1, 1}, .corner = {0, 0, 9}}), Material{});
  const ParticleFrame frame = snapshot(s);
  ASSERT_EQ(frame.ids.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(frame.positions[i], s.positions()[s.row(frame.ids[i])]) << i;
  write_particles(folder / "a.ply", frame);
  EXPECT_EQ(read_particles(folder / "a.ply").ids, frame.ids);
  ParticleFrame wrong = frame;
  wrong.ids.pop_back();
  EXPECT_THROW(write_particles(folder / "b.ply", wrong), ConfigError);
}

TEST(particle_frame, is_drawn_as_a_body_for_each_stretch_of_rows_and_refused_where_one_has_no_spacing) {
  ParticleFrame frame;
  frame.positions.assign(6, Vec3(1, 2, 3));
  frame.bodies = {2, 2, 0, 2, 2, 2};
  const std::vector<float> spacings{0.5f, 1, 2};
  const SurfaceParticles particles = surface_particles(frame, spacings);
  ASSERT_EQ(particles.bodies.size(), 3u);
  const std::size_t ends[] = {2, 3, 6};
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_EQ(particles.bodies[b].body, b == 1 ? 0u : 2u);
    EXPECT_EQ(particles.bodies[b].spacing, b == 1 ? 0.5f : 2.0f);
    EXPECT_EQ(particles.bodies[b].rows.value().begin, b == 0 ? 0 : ends[b - 1]);
    EXPECT_EQ(particles.bodies[b].rows.value().end, ends[b]);
  }
  EXPECT_THROW(surface_particles(frame, std::span(spacings).first(2)), ConfigError);
}

TEST(particle_file, state_csv_is_what_printf_would_write) {
  const TemporaryFolder folder;
  const ParticleFrame frame = three_particles();
  write_state_csv(folder / "a.csv", frame);
  std::string expected = "id,x,y,z,vx,vy,vz,body\n";
  for (std::size_t i = 0; i < frame.positions.size(); ++i) {
    std::array<char, 200> row{};
    const Vec3& x = frame.positions[i];
    const Vec3& v = frame.velocities[i];
    std::snprintf(row.data(), row.size(), "%zu,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%u\n", i, double{x[0]},
                  double{x[1]}, double{x[2]}, double{v[0]}, double{v[1]}, double{v[2]}, frame.bodies[i]);
    expected += row.data();
  }
  EXPECT_EQ(content_of(folder / "a.csv"), expected);
}

TEST(particle_file, state_csv_has_alphas_and_temperatures_where_the_frame_has_them) {
  const TemporaryFolder folder;
  ParticleFrame frame = three_particles();
  frame.temperatures = {293.15f, 400, 1e-3f};
  write_state_csv(folder / "a.csv", frame);
  std::string text = content_of(folder / "a.csv");
  EXPECT_TRUE(text.starts_with("id,x,y,z,vx,vy,vz,body,temperature\n")) << text;
  EXPECT_NE(text.find(",293.149994\n"), std::string::npos) << text;
  frame.alphas = {0.25f, 0.5f, 1};
  write_state_csv(folder / "a.csv", frame);
  text = content_of(folder / "a.csv");
  EXPECT_TRUE(text.starts_with("id,x,y,z,vx,vy,vz,body,alpha,temperature\n")) << text;
  EXPECT_NE(text.find(",0.25,293.149994\n"), std::string::npos) << text;
  EXPECT_EQ(read_points(folder / "a.csv", 1).positions, frame.positions);
  frame.temperatures.pop_back();
  EXPECT_THROW(write_state_csv(folder / "a.csv", frame), ConfigError);
}

TEST(particle_file, columns_of_the_wrong_length_are_not_written) {
  const TemporaryFolder folder;
  ParticleFrame frame = three_particles();
  frame.velocities.pop_back();
  EXPECT_THROW(write_particles(folder / "a.ply", frame), ConfigError);
  EXPECT_THROW(write_state_csv(folder / "a.csv", frame), ConfigError);
  frame = three_particles();
  frame.bodies.clear();
  EXPECT_THROW(write_particles(folder / "a.ply", frame), ConfigError);
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(particle_file, every_truncation_is_refused) {
  const TemporaryFolder folder;
  write_particles(folder / "a.ply", three_particles());
  const std::string whole = content_of(folder / "a.ply");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto cut = folder.file("cut.ply", std::string_view(whole).substr(0, length));
    EXPECT_THROW(read_particles(cut), IoError) << length << " bytes of " << whole.size();
  }
}

TEST(particle_file, a_frame_that_is_none_is_refused) {
  const TemporaryFolder folder;
  write_mesh_ply(folder / "mesh.ply", tetrahedron());
  EXPECT_NE(io_problem([&] { read_particles(folder / "mesh.ply"); }).message.find("comment mallow time"),
            std::string::npos);
  write_particles(folder / "a.ply", three_particles());
  const std::string whole = content_of(folder / "a.ply");
  const auto problem = [&](const std::string& what, const std::string& with) {
    std::string changed = whole;
    changed.replace(changed.find(what), what.size(), with);
    return to_string(io_problem([&] { read_particles(folder.file("b.ply", changed)); }));
  };
  EXPECT_NE(problem("0.30000000000000004", "nan").find("time 'nan'"), std::string::npos);
  EXPECT_NE(problem("123456789012", "1.5").find("step '1.5'"), std::string::npos);
  EXPECT_NE(problem("123456789012", "-1").find("step '-1'"), std::string::npos);
  EXPECT_NE(problem("uchar group", "uchar grump").find("lacks 'group'"), std::string::npos);
  EXPECT_NE(problem("float vy", "float wy").find("lacks 'vy'"), std::string::npos);
  EXPECT_NE(problem("float x", "list uchar float x").find("'x' must not be a list"), std::string::npos);

  ParticleFrame frame = three_particles();
  frame.velocities[1].z() = std::numeric_limits<float>::quiet_NaN();
  write_particles(folder / "c.ply", frame);
  EXPECT_EQ(io_problem([&] { read_particles(folder / "c.ply"); }).field, "vertex 1, vz");
}

}  // namespace particle_file_test
}  // namespace mallow
