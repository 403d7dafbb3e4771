// A mesh of a game's own that follows a body: the bunny's, of 37,706 vertices, on 4,000 particles.
#include <memory>

#include "harness/command.h"
#include "kernels/kernel_set.h"
#include "mallow/scene.h"
#include "mallow/skin.h"

namespace mallow::bench {
namespace {

struct SkinnedScene {
  Simulation simulation;
  Skin skin;

  Json about() const {
    return {{"particles", simulation.particle_count()},
            {"vertices", skin.mesh().vertices.size()},
            {"bytes", skin.bytes()}};
  }
  double vertices() const { return static_cast<double>(skin.mesh().vertices.size()); }
};

std::shared_ptr<SkinnedScene> bunny(int threads) {
  const Scene scene = read_scene(data_file("scenes/bunny_skin.toml"));
  Simulation simulation = build(scene, threads);
  Skin skin = std::move(skins(scene, simulation, threads).at(0));
  return std::make_shared<SkinnedScene>(SkinnedScene{std::move(simulation), std::move(skin)});
}

}  // namespace

void add_skin(const KernelVariants& variants, KernelSet& set) {
  for (const int threads : variants.threads) {
    set.add({"skin_bind", "bunny_4000", threads, "", "vertex"}, [=] {
      const auto scene = bunny(threads);
      Mesh mesh = scene->skin.mesh();
      mesh.normals.clear();  // files often have none, and binding makes them
      return Timed{.run = [=] { Skin(scene->simulation, scene->skin.body(), mesh, threads); },
                   .items = scene->vertices(),
                   .about = scene->about()};
    });
    // A step lies between two calls, as in a game: it takes the caches and moves the particles.
    set.add({"skin_follow", "bunny_4000", threads, "", "vertex"}, [=] {
      const auto scene = bunny(threads);
      return Timed{.run = [=] { scene->skin.update(scene->simulation); },
                   .items = scene->vertices(),
                   .restore = [=] { scene->simulation.step(); },
                   .about = scene->about()};
    });
  }
}

}  // namespace mallow::bench
