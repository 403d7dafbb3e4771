#include "mallow/files.h"
#include "mallow/level_set.h"
#include "mallow/skin.h"
#include "mallow/surface.h"
#include "meshes.h"
#include "parts.h"

namespace mallow::python {

/// Of SurfaceParticles, with a name of its own.
struct DrawnBody {
  float spacing = 1;
  std::uint32_t body = 0;
  std::optional<Simulation::Rows> rows = {};
  std::string name = {};
  MaterialId material = {};
};
/// Particles to draw a surface around, with columns of their own.
struct DrawnParticles {
  std::vector<Vec3> positions = {};
  std::vector<Vec3> velocities = {};
  std::vector<DrawnBody> bodies = {};
  std::vector<ParticleId> ids = {};

  DrawnParticles() = default;
  explicit DrawnParticles(const SurfaceParticles& particles)
      : positions(copy(particles.positions)),
        velocities(copy(particles.velocities)),
        ids(particles.ids.begin(), particles.ids.end()) {
    for (const SurfaceBody& body : particles.bodies)
      bodies.push_back({body.spacing, body.body, body.rows, std::string(body.name), body.material});
  }
  SurfaceParticles seen() const {
    SurfaceParticles particles{.positions = positions, .velocities = velocities, .bodies = {}, .ids = ids};
    for (const DrawnBody& body : bodies)
      particles.bodies.push_back({body.spacing, body.body, body.rows, body.name, body.material});
    return particles;
  }

 private:
  static std::vector<Vec3> copy(const StridedVectors& vectors) {
    std::vector<Vec3> copies(vectors.size());
    for (std::size_t row = 0; row < copies.size(); ++row) copies[row] = vectors[row];
    return copies;
  }
};

namespace {

struct SurfacerCell : std::enable_shared_from_this<SurfacerCell> {
  SurfacerCell(const SurfaceConfig& config, int threads, std::shared_ptr<Executor> executor)
      : surfacer(config, threads, std::move(executor)) {}

  Surfacer surfacer;
  InUse in_use;
  DrawnMesh drawn;

  Use use(bool nested = false) { return {in_use, "the surfacer", nested}; }
  /// find(): the particles, which stay what they are until it has drawn.
  template <class Find>
  MeshObject draw(const Find& find) {
    const Use mine = use();
    drawn.free();
    const Mesh* mesh = nullptr;
    {
      const py::gil_scoped_release release;
      mesh = &surfacer.draw(find());
    }
    return drawn.show(*mesh, shared_from_this());
  }
};

void bind_particles(py::module_& module) {
  Struct<DrawnBody>(module, "SurfaceBody", Change::frozen)
      .field("spacing", &DrawnBody::spacing)
      .field("body", &DrawnBody::body)
      .field("rows", &DrawnBody::rows)
      .field("name", &DrawnBody::name)
      .field("material", &DrawnBody::material)
      .done();
  Struct<DrawnParticles>(module, "SurfaceParticles", Change::live)
      .field("positions", &DrawnParticles::positions)
      .field("velocities", &DrawnParticles::velocities)
      .field("bodies", &DrawnParticles::bodies, "", "a list of SurfaceBody")
      .field("ids", &DrawnParticles::ids)
      .done();
  Struct<SurfacePart>(module, "SurfacePart", Change::frozen)
      .field("body", &SurfacePart::body)
      .field("name", &SurfacePart::name)
      .field("material", &SurfacePart::material)
      .field("first_vertex", &SurfacePart::first_vertex)
      .field("vertices", &SurfacePart::vertices)
      .field("first_triangle", &SurfacePart::first_triangle)
      .field("triangles", &SurfacePart::triangles)
      .done();
  module.def(
      "surface_particles",
      [](SimulationCell& cell) {
        const Use use = reading(cell);
        return DrawnParticles(surface_particles(cell.simulation));
      },
      py::arg("simulation"),
      "The particles of a simulation as they are now, as copies; Surfacer.draw(simulation) takes none.");
}

void bind_surfacer(py::module_& module) {
  py::class_<SurfacerCell, std::shared_ptr<SurfacerCell>>(module, "Surfacer", doc("Surfacer"))
      .def(py::init<const SurfaceConfig&, int, std::shared_ptr<Executor>>(),
           py::arg_v("config", SurfaceConfig{}, "SurfaceConfig()"), py::arg("threads") = 0,
           py::arg("executor") = nullptr, doc("Surfacer.__init__"))
      .def(
          "draw",
          [](SurfacerCell& self, SimulationCell& cell) {
            const Use use = reading(cell);
            return self.draw([&] { return surface_particles(cell.simulation); });
          },
          py::arg("simulation"), doc("Surfacer.draw"))
      .def(
          "draw",
          [](SurfacerCell& self, const DrawnParticles particles) {  // a copy that nobody changes
            const SurfaceParticles seen = particles.seen();
            return self.draw([&] { return seen; });
          },
          py::arg("particles"), doc("Surfacer.draw"))
      .def(
          "parts",
          [](SurfacerCell& self) {
            const Use use = self.use(true);
            const std::span<const SurfacePart> parts = self.surfacer.parts();
            return Tuple<SurfacePart>{{parts.begin(), parts.end()}};
          },
          doc("Surfacer.parts"))
      .def(
          "surface_count",
          [](SurfacerCell& self) {
            const Use use = self.use(true);
            return self.surfacer.surface_count();
          },
          doc("Surfacer.surface_count"))
      .def(
          "level_set_vdb",
          [](SurfacerCell& self, const std::vector<std::string>& materials) {
            const Use use = self.use(true);
            return py::bytes(level_set_vdb(self.surfacer, materials));
          },
          py::arg("materials") = std::vector<std::string>{}, doc("level_set_vdb"))
      .def(
          "bytes",
          [](SurfacerCell& self) {
            const Use use = self.use(true);
            return self.surfacer.bytes();
          },
          doc("Surfacer.bytes"));
  module.def(
      "level_set_vdb",
      [](const py::object& surfacer, const std::vector<std::string>& materials) {
        return surfacer.attr("level_set_vdb")(materials);
      },
      py::arg("surfacer"), py::arg("materials") = std::vector<std::string>{}, doc("level_set_vdb"));
  module.def(
      "surface",
      [](const std::vector<Vec3> positions, float spacing, const SurfaceConfig config, int threads) {
        const py::gil_scoped_release release;
        return MeshObject(surface(positions, spacing, config, threads));
      },
      py::arg("positions"), py::arg("spacing"), py::arg_v("config", SurfaceConfig{}, "SurfaceConfig()"),
      py::arg("threads") = 0, doc("surface"));
}

struct SkinCell : std::enable_shared_from_this<SkinCell> {
  explicit SkinCell(Skin&& made) : skin(std::move(made)) {}

  Skin skin;
  InUse in_use;
  DrawnMesh drawn;

  Use use() { return {in_use, "the skin", true}; }
  MeshObject follow(SimulationCell& cell, const Mesh& (Skin::*move)(const Simulation&)) {
    const Use of_simulation = reading(cell), mine = use();
    drawn.free();
    const Mesh* mesh = nullptr;
    {
      const py::gil_scoped_release release;
      mesh = &(skin.*move)(cell.simulation);
    }
    return drawn.show(*mesh, shared_from_this());
  }
};

void bind_skin(py::module_& module) {
  py::class_<SkinCell, std::shared_ptr<SkinCell>>(module, "Skin", doc("Skin"))
      .def(py::init([](SimulationCell& cell, BodyId body, const MeshObject& mesh, int threads,
                       std::shared_ptr<Executor> executor) {
             const Use use = changing(cell);
             return std::make_shared<SkinCell>(
                 Skin(cell.simulation, body, mesh.checked(), threads, std::move(executor)));
           }),
           py::arg("simulation"), py::arg("body"), py::arg("mesh"), py::arg("threads") = 0,
           py::arg("executor") = nullptr, doc("Skin.__init__"))
      .def(
          "update", [](SkinCell& self, SimulationCell& cell) { return self.follow(cell, &Skin::update); },
          py::arg("simulation"), doc("Skin.update"))
      .def(
          "find_velocities",
          [](SkinCell& self, SimulationCell& cell) { return self.follow(cell, &Skin::find_velocities); },
          py::arg("simulation"), doc("Skin.find_velocities"))
      .def(
          "mesh",
          [](SkinCell& self) {
            const Use use = self.use();
            return self.drawn.show(self.skin.mesh(), self.shared_from_this());
          },
          doc("Skin.mesh"))
      .def(
          "body",
          [](SkinCell& self) {
            const Use use = self.use();
            return self.skin.body();
          },
          doc("Skin.body"))
      .def(
          "stretch",
          [](SkinCell& self) {
            const Use use = self.use();
            const std::span<const float> stretch = self.skin.stretch();
            return std::vector<float>(stretch.begin(), stretch.end());
          },
          doc("Skin.stretch"))
      .def(
          "save",
          [](SkinCell& self) {
            const Use use = self.use();
            return py::bytes(self.skin.save());
          },
          doc("Skin.save"))
      .def_static(
          "restore",
          [](const py::bytes& saved, int threads, std::shared_ptr<Executor> executor) {
            return std::make_shared<SkinCell>(Skin::restore(saved, threads, std::move(executor)));
          },
          py::arg("saved"), py::arg("threads") = 0, py::arg("executor") = nullptr, doc("Skin.restore"))
      .def(
          "bytes",
          [](SkinCell& self) {
            const Use use = self.use();
            return self.skin.bytes();
          },
          doc("Skin.bytes"));
}

}  // namespace

py::object skin_to_python(Skin&& skin) {
  return py::cast(std::make_shared<SkinCell>(std::move(skin)));
}
py::object surface_particles_of(const ParticleFrame& frame, std::span<const float> spacings) {
  return py::cast(DrawnParticles(surface_particles(frame, spacings)));
}

void bind_surfaces(py::module_& module) {
  bind_particles(module);
  bind_surfacer(module);
  bind_skin(module);
}

}  // namespace mallow::python
