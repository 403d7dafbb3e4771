#include <algorithm>
#include <iterator>
#include <random>
#include <string>

#include "mallow/simulation.h"
#include "mallow/surface.h"
#include "meshes.h"
#include "same_meshes.h"
#include "surface/surfacer_access.h"

namespace mallow {
namespace kept_surfaces_test {

using Rows = Simulation::Rows;

/// Bodies that move, rest, come and go at random, drawn frame after frame.
class Crowd {
 public:
  explicit Crowd(unsigned seed) : random_(seed) {
    for (std::uint32_t b = 0; b < 9; ++b) {
      const Vec3 corner(7.0f * static_cast<float>(b % 3), 7.0f * static_cast<float>(b / 3), 0);
      Member member;
      for (const Vec3& x : sample(sphere_shape(corner, 2), {.spacing = 1.0f, .jitter = 0.3f}).positions) {
        member.positions.push_back(x);
        member.velocities.push_back(0.1f * x);
      }
      members_.push_back(std::move(member));
    }
  }

  /// Each body does something with this chance.
  void step(double chance) {
    std::uniform_real_distribution<float> way(-0.4f, 0.4f);
    for (Member& member : members_) {
      if (!std::bernoulli_distribution(chance)(random_)) continue;
      const auto what = random_() % 8;
      if (what == 0) member.there = !member.there;
      if (what == 1) member.spacing = member.spacing == 1.0f ? 1.1f : 1.0f;
      if (what == 2) member.velocities[random_() % member.velocities.size()].x() += 1;
      if (what == 3) member.positions.back().y() = std::nextafter(member.positions.back().y(), 1e3f);
      if (what < 4) continue;
      const Vec3 by(way(random_), way(random_), way(random_));
      for (Vec3& x : member.positions) x += by;
    }
  }

  SurfaceParticles particles(bool with_velocities) {
    positions_.clear();
    velocities_.clear();
    std::vector<SurfaceBody> bodies;
    for (std::uint32_t b = 0; b < members_.size(); ++b) {
      const Member& member = members_[b];
      if (!member.there) continue;
      const std::size_t first = positions_.size();
      positions_.insert(positions_.end(), member.positions.begin(), member.positions.end());
      velocities_.insert(velocities_.end(), member.velocities.begin(), member.velocities.end());
      bodies.push_back({.spacing = member.spacing, .body = b, .rows = Rows{first, positions_.size()}});
    }
    SurfaceParticles all{.positions = positions_, .bodies = bodies};
    if (with_velocities) all.velocities = velocities_;
    return all;
  }

 private:
  struct Member {
    std::vector<Vec3> positions, velocities;
    float spacing = 1;
    bool there = true;
  };
  std::mt19937 random_;
  std::vector<Member> members_;
  std::vector<Vec3> positions_, velocities_;
};

TEST(kept_surfaces, meshes_are_those_that_a_new_surfacer_draws_whatever_moves_comes_and_goes) {
  const SurfaceConfig blended{.voxels_per_spacing = 2};
  unsigned seed = 0;
  for (const SurfaceConfig& config :
       {blended, SurfaceConfig{.voxels_per_spacing = 2, .kind = SurfaceKind::spheres},
        SurfaceConfig{.voxels_per_spacing = 2, .kind = SurfaceKind::anisotropic},
        SurfaceConfig{.voxels_per_spacing = 2, .adaptivity = 0.2f, .smoothing = 2},
        SurfaceConfig{.voxels_per_spacing = 2, .joined = true}, SurfaceConfig{.voxels = 48}}) {
    for (const int threads : {1, 2}) {
      Crowd crowd(++seed);
      Surfacer surfacer(config, threads);
      std::size_t kept = 0;
      for (int frame = 0; frame < 14; ++frame) {
        const SurfaceParticles particles = crowd.particles(frame % 7 != 3);
        const Mesh& mesh = surfacer.draw(particles);
        kept += SurfacerAccess::kept(surfacer);
        Surfacer fresh(config, threads);
        expect_same(mesh, fresh.draw(particles));
        ASSERT_FALSE(testing::Test::HasFailure()) << "frame " << frame << " of seed " << seed;
        crowd.step(frame % 5 == 0 ? 0 : frame % 5 == 1 ? 1 : 0.3);
      }
      EXPECT_GT(kept, config.joined || config.voxels ? 0u : 30u);
    }
  }
}

/// On one thread, and on two, which draw small surfaces side by side.
class unfinished_frame : public testing::TestWithParam<int> {};

TEST_P(unfinished_frame, leaves_nothing_behind) {
  Crowd crowd(5);
  Surfacer surfacer({.voxel_size = 0.5f, .memory_limit = 0.001f}, GetParam());
  const Mesh expected = surfacer.draw(crowd.particles(true));
  SurfaceParticles particles = crowd.particles(true);
  std::vector<Vec3> positions;
  for (std::size_t i = 0; i < particles.positions.size(); ++i) positions.push_back(particles.positions[i]);
  // The last body is too large for its memory; those before it have been drawn by then.
  for (std::size_t i = 0; i < positions.size(); ++i)
    positions[i] +=
        Vec3(0, 0, 0.1f) +
        (i >= particles.bodies.back().rows->begin ? Vec3(static_cast<float>(i) * 50, 0, 0) : Vec3(0, 0, 0));
  particles.positions = positions;
  EXPECT_THROW(surfacer.draw(particles), ConfigError);
  expect_same(surfacer.draw(crowd.particles(true)), expected);
}

INSTANTIATE_TEST_SUITE_P(kept_surfaces, unfinished_frame, testing::Values(1, 2));

TEST(kept_surfaces, only_bodies_of_which_a_bit_changed_are_drawn_anew) {
  Crowd crowd(3);
  Surfacer surfacer({});
  surfacer.draw(crowd.particles(true));
  EXPECT_EQ(SurfacerAccess::kept(surfacer), 0u);
  SurfaceParticles particles = crowd.particles(true);
  surfacer.draw(particles);
  EXPECT_EQ(SurfacerAccess::kept(surfacer), 9u);
  std::vector<Vec3> positions;
  for (std::size_t i = 0; i < particles.positions.size(); ++i) positions.push_back(particles.positions[i]);
  float& x = positions[particles.bodies[4].rows->begin].x();
  x = std::nextafter(x, 1e3f);
  particles.positions = positions;
  surfacer.draw(particles);
  EXPECT_EQ(SurfacerAccess::kept(surfacer), 8u);
}

TEST(kept_surfaces, are_not_drawn_again_because_something_flies_off) {
  Crowd crowd(4);
  Surfacer surfacer({});
  SurfaceParticles particles = crowd.particles(false);
  std::vector<Vec3> positions;
  for (std::size_t i = 0; i < particles.positions.size(); ++i) positions.push_back(particles.positions[i]);
  particles.positions = positions;
  surfacer.draw(particles);
  for (const Vec3& by : {Vec3(-9, 5, 2), Vec3(-90, 0, -200), Vec3(700, -20, 100)}) {
    for (std::size_t i = particles.bodies.back().rows->begin; i < positions.size(); ++i) positions[i] += by;
    expect_same(surfacer.draw(particles), Surfacer({}).draw(particles));
    EXPECT_EQ(SurfacerAccess::kept(surfacer), 8u);
  }
}

TEST(kept_surfaces, consecutive_meshes_of_bodies_at_rest_are_the_same_bits) {
  Simulation simulation({.support_radius = 2.1f, .gravity = {0, 0, -9.81f}});
  const MaterialId jelly =
      simulation.add_material({.alpha = 0.2f, .rest_density = 1000.0f, .friction = 0.5f});
  for (const float height : {0.5f, 6.0f})
    simulation.add_body(
        sample(Lattice{.count = {5, 5, 5}, .spacing = 1.0f, .corner = {height / 12, 0, height}}), jelly);
  simulation.add_collider({.shape = Plane{{0, 0, 1}, 0}, .friction = 0.5f});
  Surfacer surfacer({});
  Mesh last;
  int same = 0;
  for (int frame = 0; frame < 1500 && same < 3; ++frame) {
    simulation.advance(0.1);
    const Mesh& mesh = surfacer.draw(surface_particles(simulation));
    const bool at_rest = SurfacerAccess::kept(surfacer) == 2;
    if (at_rest) expect_same(Surfacer({}).draw(surface_particles(simulation)), last);
    same = at_rest ? same + 1 : 0;
    last = mesh;
  }
  EXPECT_EQ(same, 3) << "the cubes do not come to rest";
}

/// Two balls of one body.
struct TwoBalls {
  std::vector<Vec3> points = ball(0);
  std::size_t turning = points.size();

  TwoBalls() { std::ranges::copy(ball(20), std::back_inserter(points)); }
  static bool is_second(const Vec3& x) { return x.x() > 10; }
  /// With the first ball turned.
  Mesh draw(float angle, Surfacer& surfacer) const {
    std::vector<Vec3> now = points;
    for (std::size_t i = 0; i < turning; ++i) now[i] = Eigen::AngleAxisf(angle, Vec3::UnitZ()) * points[i];
    return surfacer.draw({now, {}, {{.spacing = 1}}});
  }

 private:
  static std::vector<Vec3> ball(float x) {
    return sample(sphere_shape({x, 0, 0}, 4), {.spacing = 1.0f, .jitter = 0.2f}).positions;
  }
};

TEST(slow_turns, move_a_surface_about_as_far_as_the_particles) {
  const TwoBalls balls;
  for (const SurfaceKind kind : {SurfaceKind::blended, SurfaceKind::anisotropic}) {
    Surfacer surfacer({.kind = kind});
    const Mesh before = balls.draw(0, surfacer);
    for (const float angle : {1e-5f, 1e-4f, 1e-3f}) {
      const Mesh mesh = balls.draw(angle, surfacer);
      for (std::size_t v = 0; v < mesh.vertices.size(); v += 7) {
        const Vec3& x = mesh.vertices[v];
        ASSERT_LT(height_above(before, x), TwoBalls::is_second(x) ? 2e-6f : 1.3f * angle * x.norm() + 2e-6f)
            << angle;
      }
    }
  }
}

TEST(slow_turns, of_a_part_of_a_body_change_no_bit_of_another) {
  const TwoBalls balls;
  for (const SurfaceKind kind : {SurfaceKind::blended, SurfaceKind::spheres}) {
    Surfacer surfacer({.kind = kind});
    std::vector<Vec3> before;
    std::ranges::copy_if(balls.draw(0, surfacer).vertices, std::back_inserter(before), TwoBalls::is_second);
    for (const float angle : {1e-5f, 1e-2f, 0.5f}) {
      std::vector<Vec3> after;
      std::ranges::copy_if(balls.draw(angle, surfacer).vertices, std::back_inserter(after),
                           TwoBalls::is_second);
      EXPECT_TRUE(same_bits(after, before)) << angle;
    }
  }
}

TEST(surface_parts, say_which_range_of_the_mesh_is_of_which_body) {
  Simulation simulation({.support_radius = 2.9f});
  const MaterialId soft = simulation.add_material({.alpha = 0.5f}),
                   firm = simulation.add_material({.alpha = 0});
  const auto cube = [](float x) {
    return sample(Lattice{.count = {3, 4, 5}, .spacing = 1, .corner = {x, 0, 0}});
  };
  simulation.add_body(cube(0), soft, "first");
  const BodyId second = simulation.add_body(cube(9), firm, "second");
  simulation.add_body(cube(18), soft, "third");
  Surfacer surfacer({});
  const auto check = [&](const Mesh& mesh, const std::vector<std::string>& names) {
    const auto parts = surfacer.parts();
    ASSERT_EQ(parts.size(), names.size());
    std::size_t vertex = 0, triangle = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const SurfacePart& part = parts[k];
      EXPECT_EQ(part.name, names[k]);
      EXPECT_EQ(part.material, names[k] == "second" ? firm : soft);
      EXPECT_EQ(part.first_vertex, vertex);
      EXPECT_EQ(part.first_triangle, triangle);
      EXPECT_GT(part.triangles, 0u);
      vertex += part.vertices;
      triangle += part.triangles;
      for (std::size_t v = part.first_vertex; v < vertex; ++v) ASSERT_EQ(mesh.material_ids[v], part.body);
      for (std::size_t t = part.first_triangle; t < triangle; ++t)
        for (const std::uint32_t v : mesh.triangles[t])
          ASSERT_TRUE(v >= part.first_vertex && v < vertex) << part.name;
    }
    EXPECT_EQ(vertex, mesh.vertices.size());
    EXPECT_EQ(triangle, mesh.triangles.size());
  };
  check(surfacer.draw(surface_particles(simulation)), {"first", "second", "third"});
  simulation.remove_body(second);
  check(surfacer.draw(surface_particles(simulation)), {"first", "third"});
  EXPECT_EQ(surfacer.parts().back().body, 2u);

  Surfacer joined({.joined = true});
  joined.draw(surface_particles(simulation));
  EXPECT_TRUE(joined.parts().empty());
}

}  // namespace kept_surfaces_test
}  // namespace mallow
