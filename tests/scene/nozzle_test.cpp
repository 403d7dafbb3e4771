// The scene data/scenes/nozzle.toml: an elastic strand that is laid down by a nozzle that moves.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow {
namespace nozzle_test {

/// In how many parts the particles of a body are, where those nearer than `reach` [m] are together.
std::size_t count_parts(const Simulation& s, BodyId body, float reach) {
  const Simulation::Rows rows = s.rows(body);
  const std::size_t count = rows.end - rows.begin;
  const VectorView x = s.positions();
  std::size_t parts = 0;
  std::vector<std::size_t> next;
  std::vector<bool> seen(count, false);
  for (std::size_t start = 0; start < count; ++start) {
    if (seen[start]) continue;
    ++parts;
    seen[start] = true;
    next.push_back(start);
    while (!next.empty()) {
      const Vec3 at = x[rows.begin + next.back()];
      next.pop_back();
      for (std::size_t i = 0; i < count; ++i)
        if (!seen[i] && (x[rows.begin + i] - at).norm() < reach) {
          seen[i] = true;
          next.push_back(i);
        }
    }
  }
  return parts;
}

/// Least and most distance from the middle of a layer to that of the next, all of `each` particles [m].
std::pair<float, float> layer_distances(const Simulation& s, std::size_t each) {
  const std::vector<Vec3> x = s.positions_by_id();
  std::vector<Vec3> middles;
  for (std::size_t i = 0; i + each <= x.size(); i += each)
    middles.push_back(std::accumulate(x.begin() + static_cast<std::ptrdiff_t>(i),
                                      x.begin() + static_cast<std::ptrdiff_t>(i + each), Vec3(0, 0, 0)) /
                      static_cast<float>(each));
  std::pair<float, float> distances(1e9f, 0.0f);
  for (std::size_t k = 1; k < middles.size(); ++k) {
    distances.first = std::min(distances.first, (middles[k] - middles[k - 1]).norm());
    distances.second = std::max(distances.second, (middles[k] - middles[k - 1]).norm());
  }
  return distances;
}

TEST(nozzle, lays_down_one_strand_that_stays_in_one_part_with_its_layers_a_spacing_apart) {
  const Scene scene = read_scene(std::filesystem::path(MALLOW_DATA_DIR) / "scenes/nozzle.toml");
  SceneIds ids;
  Simulation s = build(scene, 2, nullptr, &ids);
  const BodyId strand = s.body(ids.emitters.at(0));
  const float spacing = scene.emitters[0].spacing;
  const std::size_t each = s.particle_count() / 15;  // it begins with 15 layers
  ASSERT_EQ(s.particle_count(), 15 * each);
  for (int frame = 1; frame <= scene.run.frames; ++frame) {
    const double end = frame * *scene.run.frame_time;
    while (s.time() < end) {
      s.step_towards(end);
      for (const BodyEvent& event : s.events())
        ASSERT_NE(event.kind, BodyEvent::Kind::torn) << "into " << event.parts << " parts at " << s.time();
    }
    if (frame % 10 == 0) {
      EXPECT_EQ(count_parts(s, strand, *scene.solver.support_radius), 1u) << "frame " << frame;
      const auto [least, most] = layer_distances(s, each);
      EXPECT_GT(least, 0.65f * spacing) << "frame " << frame;
      EXPECT_LT(most, 1.25f * spacing) << "frame " << frame;
    }
  }
  EXPECT_EQ(s.body_count(), 1u);
  EXPECT_GT(s.time(), *scene.emitters[0].stop) << "it ended";
  // π r² v t of strand, what was held behind the nozzle taken away.
  EXPECT_NEAR(static_cast<double>(s.particle_count()), 3.14159 * 16 * 60, 0.1 * 3.14159 * 16 * 60);
  const Aabb box = s.bounds(strand);
  EXPECT_GT(box.max.x() - box.min.x(), 0.08f) << "it lies along the way of the nozzle";
}

}  // namespace nozzle_test
}  // namespace mallow
