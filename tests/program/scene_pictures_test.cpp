// Pictures of the scenes in data/scenes: nothing that they show is cut off.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "mallow/scene.h"
#include "program/film_bounds.h"
#include "render/renderer.h"
#include "render/viewport.h"

namespace mallow::program {
namespace scene_pictures_test {
namespace fs = std::filesystem;

/// Paths below data/scenes.
std::vector<std::string> scenes() {
  const fs::path folder = MALLOW_DATA_DIR "/scenes";
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".toml") names.push_back(fs::relative(entry.path(), folder).string());
  std::ranges::sort(names);
  return names;
}

/// How many balls around particles are not whole in a picture.
std::size_t cut_off(const std::vector<Vec3>& positions, float radius, const render::Viewport& view) {
  const auto is_in = [&](const Vec3& x) {
    const auto pixel = view.pixel(x);
    return pixel && (*pixel).x() >= 0 && (*pixel).x() <= view.width && (*pixel).y() >= 0 &&
           (*pixel).y() <= view.height;
  };
  return static_cast<std::size_t>(std::ranges::count_if(positions, [&](const Vec3& x) {
    for (int axis = 0; axis < 3; ++axis)
      for (const float way : {-radius, radius})
        if (!is_in(x + way * Vec3::Unit(axis))) return true;
    return false;
  }));
}

/// What is seen of a simulation: what a nozzle holds is inside of it.
std::vector<Vec3> seen(const Simulation& simulation) {
  std::set<ParticleId> hidden;
  for (const EmitterId emitter : simulation.emitter_ids())
    for (const ParticleId id : simulation.held(emitter)) hidden.insert(id);
  std::vector<Vec3> positions;
  for (std::size_t row = 0; row < simulation.particle_count(); ++row)
    if (!hidden.contains(simulation.ids()[row])) positions.push_back(simulation.positions()[row]);
  return positions;
}

class scene_pictures : public testing::TestWithParam<std::string> {};

/// At the begin, and a little later; by the scene's own camera, and by the automatic one.
TEST_P(scene_pictures, show_every_particle) {
  Scene scene;
  try {
    scene = read_scene(fs::path(MALLOW_DATA_DIR) / "scenes" / GetParam());
  } catch (const ConfigError& error) {
    GTEST_SKIP() << error.what();  // a mesh that a script fetches; scene_files holds that all else is right
  }
  Simulation simulation = build(scene, 0);
  std::vector<float> spacings;
  for (const BodyInfo& body : simulation.info().bodies) spacings.push_back(body.spacing);
  FilmBounds bounds(spacings, snapshot(simulation), scene.emitters);
  std::vector<std::vector<Vec3>> frames{seen(simulation)};
  for (int frame = 1; frame <= 3; ++frame) {
    simulation.advance(frame_time(scene, simulation.info()));
    bounds.add(snapshot(simulation));
    frames.push_back(seen(simulation));
  }
  const float radius = SurfaceConfig{}.particle_radius * std::ranges::min(spacings);
  for (const bool own : {true, false}) {
    if (!own) {
      scene.render.eye.reset();
      scene.render.target.reset();
    }
    const render::Camera camera =
        render::frame_camera(bounds.boxes(scene), scene.render, visible_colliders(scene));
    const render::Viewport view(camera, scene.render.width, scene.render.height);
    for (std::size_t frame = 0; frame < frames.size(); ++frame)
      EXPECT_EQ(cut_off(frames[frame], radius, view), 0u)
          << (own ? "own" : "automatic") << " camera, frame " << frame;
  }
}

INSTANTIATE_TEST_SUITE_P(data, scene_pictures, testing::ValuesIn(scenes()), [](const auto& scene) {
  std::string name = scene.param.substr(0, scene.param.find('.'));
  for (char& c : name)
    if (c == '/' || c == '-') c = '_';
  return name;
});

}  // namespace scene_pictures_test
}  // namespace mallow::program
