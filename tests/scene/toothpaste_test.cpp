// The scene data/scenes/toothpaste.toml: an emitter, plastic yield and the volume constraint together; and
// materials by their names, poured.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mallow/materials.h"
#include "mallow/scene.h"
#include "mallow/simulation.h"
#include "mallow/surface.h"
#include "meshes.h"

namespace mallow {
namespace toothpaste_test {

constexpr double k_pi = std::numbers::pi;
constexpr std::size_t k_layer = 29;  // particles of the strand beside each other

/// How the strand lies. Its layers are one behind the other in the order of identities, the first of which
/// came out first.
struct Path {
  std::string sides;       ///< to which it turns: "rl" has turned half round to the right, then to the left
  double coiled = 0;       ///< turns to the last of these sides, seen from above
  double lying_speed = 0;  ///< mean of what lies on the table [m/s]
};

/// Goes along the strand, and notes where it has turned to the other side by more than a third of a turn, so
/// that what wobbles notes nothing, and a coil one side.
class Turning {
 public:
  void turn(double by) {
    angle_ += by;
    if (sides_.empty()) {
      least_ = std::min(least_, angle_), most_ = std::max(most_, angle_);
      if (most_ - angle_ > k_half)
        begin('r', most_);
      else if (angle_ - least_ > k_half)
        begin('l', least_);
    } else if (const double on = sides_.back() == 'l' ? angle_ - end_ : end_ - angle_; on > 0) {
      end_ = angle_;
    } else if (-on > k_half) {
      begin(sides_.back() == 'l' ? 'r' : 'l', end_);
    }
  }
  const std::string& sides() const { return sides_; }
  /// Turns since it turned to the last side.
  double last() const { return sides_.empty() ? 0 : std::abs(end_ - from_); }

 private:
  static constexpr double k_half = 0.35;
  void begin(char side, double from) {
    sides_ += side;
    from_ = from;
    end_ = angle_;
  }
  double angle_ = 0, least_ = 0, most_ = 0, from_ = 0, end_ = 0;
  std::string sides_;
};

Path path_of(const Simulation& s, std::size_t layer, double spacing) {
  constexpr std::size_t k_chord = 4;  // layers over which a direction is taken
  const std::vector<Vec3> x = s.positions_by_id(), v = s.velocities_by_id();
  std::vector<Eigen::Vector3d> middle;
  Path path;
  std::size_t lying = 0;
  for (std::size_t i = 0; i + layer <= x.size(); i += layer) {
    Eigen::Vector3d at(0, 0, 0), speed(0, 0, 0);
    for (std::size_t k = i; k < i + layer; ++k) {
      at += x[k].cast<double>() / static_cast<double>(layer);
      speed += v[k].cast<double>() / static_cast<double>(layer);
    }
    middle.push_back(at);
    if (at.z() > 5.5 * spacing) continue;  // its diameter is 6
    path.lying_speed += speed.head<2>().norm();
    ++lying;
  }
  path.lying_speed /= static_cast<double>(lying);
  Turning turning;
  double before = 0;
  bool any = false;
  for (std::size_t i = 0; i + k_chord < middle.size(); i += k_chord) {
    const Eigen::Vector3d along = middle[i + k_chord] - middle[i];
    if (along.head<2>().norm() < spacing) continue;  // what hangs
    const double angle = std::atan2(along.y(), along.x());
    const double turn = std::remainder(angle - before, 2 * k_pi) / (2 * k_pi);
    if (any) turning.turn(turn);
    before = angle;
    any = true;
  }
  path.sides = turning.sides();
  path.coiled = turning.last();
  return path;
}

// Two seconds and a half of it: by then the strand has folded twice and begins to coil. That it
// becomes one where it lies on itself no event tells, as it is one piece all the while, but the regions of
// shape matching do: they reach across what has merged, so that they hold more particles.
TEST(toothpaste, is_one_strand_that_folds_coils_merges_with_itself_and_keeps_its_volume) {
  Scene scene = read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/toothpaste.toml");
  scene.surface.particle_radius = 0.5f;
  Simulation s = build(scene, 2);
  const double h = static_cast<double>(scene.emitters[0].spacing);
  Surfacer surfacer(scene.surface, 2);
  const double neighbors = s.info().bodies[0].average_neighbors;
  double next = 0.5;
  while (s.time() < 2.5) {
    s.step();
    for (const BodyEvent& event : s.events())
      ASSERT_NE(event.kind, BodyEvent::Kind::torn) << "into " << event.parts << " parts at " << s.time();
    if (s.time() < next) continue;
    next += 0.5;
    const double volume = h * h * h * static_cast<double>(s.particle_count());
    ASSERT_NEAR(signed_volume(surfacer.draw(surface_particles(s))) / volume, 1, 0.05) << s.time();
  }
  ASSERT_EQ(s.particle_count() % k_layer, 0u);
  const Path path = path_of(s, k_layer, h);
  // A nozzle that stands lets it wind to one side all the while: "l".
  EXPECT_EQ(path.sides, "rlr") << "it folds back to the right and forth to the left";
  EXPECT_GT(path.coiled, 0.5) << "and begins to wind";
  // Without yield it winds as it slides: 0.25 of the speed at which it comes out.
  EXPECT_LT(path.lying_speed, 0.05 * static_cast<double>(scene.emitters[0].speed.at(0)))
      << "it stays where it lies";
  EXPECT_GT(s.info().bodies[0].average_neighbors, 1.08 * neighbors) << "it merges with itself";
}

TEST(poured, toothpaste_by_its_name_is_one_strand_that_coils_piles_up_and_stays) {
  Scene scene = read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/toothpaste.toml");
  scene.materials[0].material = materials::toothpaste();
  Simulation s = build(scene, 2);
  const double h = static_cast<double>(scene.emitters[0].spacing);
  while (s.time() < 2.5) {
    s.step();
    for (const BodyEvent& event : s.events()) ASSERT_NE(event.kind, BodyEvent::Kind::torn) << s.time();
  }
  const Path path = path_of(s, k_layer, h);
  const std::vector<Vec3> x = s.positions_by_id(), v = s.velocities_by_id();
  float pile = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (v[i].norm() < 0.1f * scene.emitters[0].speed.at(0)) pile = std::max(pile, x[i].z());
  EXPECT_EQ(path.sides, "r") << "it coils to one side";
  EXPECT_GT(path.coiled, 2);
  EXPECT_GT(pile, 3 * *scene.emitters[0].radius) << "on itself";
  EXPECT_LT(path.lying_speed, 0.05 * static_cast<double>(scene.emitters[0].speed.at(0)));
}

TEST(poured, honey_by_its_name_heaps_up_and_levels) {
  const Scene scene = parse_scene(
      "[solver]\ngravity = [0, 0, -9.81]\n[[emitter]]\nmaterial = \"honey\"\nradius = 0.009\nspacing = "
      "0.003\n"
      "speed = 0.3\nstop = 0.4\n"
      "keyframes = [{ time = 0, translate = [0, 0, 0.1], rotate = [180, 0, 0] }]\n"
      "[[collider]]\nplane = { normal = [0, 0, 1], offset = 0 }\n",
      "honey.toml");
  Simulation s = build(scene, 2);
  const auto top = [&] {
    float most = 0;
    for (const Vec3& x : s.positions_by_id()) most = std::max(most, x.z());
    return most;
  };
  s.advance(0.5);
  const float heap = top();
  EXPECT_GT(heap, 0.02f) << "which the last of it has just come to";
  s.advance(0.2);
  EXPECT_LT(top(), 0.65f * heap);
  s.advance(0.5);
  EXPECT_LT(top(), 0.4f * heap);
  EXPECT_GT(top(), 0.2f * heap) << "the slower the flatter it is";
}

}  // namespace toothpaste_test
}  // namespace mallow
