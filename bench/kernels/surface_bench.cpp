// Surfaces around particles: the whole, and its two stages.
#include <cmath>
#include <memory>

#include "core/parallel.h"
#include "harness/command.h"
#include "kernels/kernel_set.h"
#include "kernels/lattice.h"
#include "mallow/scene.h"
#include "mallow/surface.h"
#include "surface/dual_mesher.h"
#include "surface/particle_order.h"
#include "surface/surface_field.h"

namespace mallow::bench {
namespace {

struct SurfaceScene {
  std::vector<Vec3> positions;
  float spacing = 1;  ///< h [m]
  SurfaceConfig config;

  SurfaceParticles particles() const { return {.positions = positions, .bodies = {{.spacing = spacing}}}; }
  /// Moves a particle by a bit, and back the next time: what did not change would not be drawn again.
  void stir() {
    float& x = positions.front().x();
    x = std::nextafter(x, stirred_ ? -1e9f : 1e9f);
    stirred_ = !stirred_;
  }

 private:
  bool stirred_ = false;
};

SurfaceScene cube_scene(const LatticeScene& lattice) {
  SurfaceScene scene;
  scene.positions =
      sample(Lattice{.count = lattice.count, .spacing = lattice.spacing, .jitter = 0}).positions;
  scene.spacing = lattice.spacing;
  scene.config = {.voxels = 128, .kernel_radius = 2.0f};
  return scene;
}

SurfaceScene balls_scene() {
  const Scene scene = read_scene(data_file("scenes/table1/balls_8264.toml"));
  Simulation simulation = build(scene, 1);
  SurfaceScene drawn;
  drawn.positions = simulation.positions_by_id();
  drawn.spacing = simulation.info().bodies.front().spacing;
  drawn.config = scene.surface;
  return drawn;
}

/// What is drawn again and again, with memory that stays.
struct Drawing {
  SurfaceScene scene;
  VoxelFrame frame;
  int threads;
  ParticleOrder order;
  SurfaceField field;
  DualMesher mesher;
  Mesh mesh;

  Drawing(SurfaceScene of, int on_threads) : scene(std::move(of)), threads(on_threads) {
    const Mesh whole = surface(scene.positions, scene.spacing, scene.config, threads);
    const Aabb box = bounds(whole);
    frame.voxel_size = static_cast<double>((box.max - box.min).maxCoeff()) / scene.config.voxels.value();
    frame.origin = (box.min.cast<double>() / frame.voxel_size).array().floor() * frame.voxel_size;
    order.sort(scene.particles(), false);
    fill();
    draw();
  }
  void fill() { field.build({scene.positions, order.rows(0)}, scene.spacing, scene.config, frame, threads); }
  void draw() {
    MeshCounts counts;
    mesher.append(field, 0, threads, counts, mesh);
  }
  Json about() const {
    return {{"particles", scene.positions.size()},
            {"voxels", scene.config.voxels.value()},
            {"blocks", field.blocks().size()},
            {"triangles", mesh.triangles.size()},
            {"bytes", field.bytes() + mesher.bytes()}};
  }
};

using MakeScene = std::function<SurfaceScene()>;

void add_scene(const std::string& name, const MakeScene& make, int threads, KernelSet& set) {
  set.add({"surface", name, threads, "", "particle"}, [=] {
    const auto scene = std::make_shared<SurfaceScene>(make());
    const auto surfacer = std::make_shared<Surfacer>(scene->config, threads);
    const auto draw = [=]() -> const Mesh& {
      scene->stir();
      return surfacer->draw(scene->particles());
    };
    return Timed{.run = [=] { draw(); },
                 .items = static_cast<double>(scene->positions.size()),
                 .about = {{"particles", scene->positions.size()},
                           {"voxels", scene->config.voxels.value()},
                           {"triangles", draw().triangles.size()},
                           {"bytes", surfacer->bytes()}}};
  });
  set.add({"surface_field", name, threads, "", "particle"}, [=] {
    const auto drawing = std::make_shared<Drawing>(make(), threads);
    return Timed{.run = [=] { drawing->fill(); },
                 .items = static_cast<double>(drawing->scene.positions.size()),
                 .about = drawing->about()};
  });
  set.add({"surface_mesh", name, threads, "", "triangle"}, [=] {
    const auto drawing = std::make_shared<Drawing>(make(), threads);
    return Timed{.run = [=] { drawing->draw(); },
                 .items = static_cast<double>(drawing->mesh.triangles.size()),
                 .about = drawing->about()};
  });
}

}  // namespace

void add_surface(const KernelVariants& variants, KernelSet& set) {
  for (const int threads : variants.threads) {
    for (const LatticeScene& lattice : {k_cube_15, k_cube_22})
      add_scene(
          lattice.name, [=] { return cube_scene(lattice); }, threads, set);
    add_scene("balls_8264", balls_scene, threads, set);
  }
}

}  // namespace mallow::bench
