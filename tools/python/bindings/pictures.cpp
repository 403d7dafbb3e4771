#include "mallow/scene.h"
#include "meshes.h"
#include "parts.h"
#include "program/body_appearances.h"
#include "program/film_bounds.h"
#include "render/renderer.h"

namespace mallow::python {

Scene scene_of(const py::handle& object);

namespace {

/// Height × width × 3 bytes, without a copy.
py::array picture(render::Image&& image) {
  const auto width = static_cast<py::ssize_t>(image.width), height = static_cast<py::ssize_t>(image.height);
  auto held = std::make_shared<const std::vector<std::uint8_t>>(std::move(image.rgb));
  return view_of(held->data(), {height, width, 3}, {3 * width, 3, 1}, held);
}
render::Image image_of(const py::array& array) {
  if (array.dtype().kind() != 'u' || array.itemsize() != 1) refuse_type(array, "bytes");
  if (array.ndim() != 3 || array.shape(2) != 3) refuse_shape(array, "height x width x 3");
  const auto plain = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>::ensure(array);
  return {static_cast<int>(plain.shape(1)),
          static_cast<int>(plain.shape(0)),
          {plain.data(), plain.data() + plain.size()}};
}

struct RendererCell {
  RendererCell(const RenderConfig& config, int threads) : renderer(config, threads) {}

  render::Renderer renderer;
  InUse in_use;

  /// Draws without the GIL what draw() draws.
  template <class Draw>
  py::array draw(const Draw& draw) {
    const Use use(in_use, "the renderer", false);
    render::Image image;
    {
      const py::gil_scoped_release release;
      image = draw(renderer);
    }
    return picture(std::move(image));
  }
};

void bind_renderer(py::module_& module) {
  using Palette = std::vector<Appearance>;
  using Colliders = std::vector<Collider>;
  py::class_<RendererCell>(module, "Renderer", doc("render.Renderer"))
      .def(py::init<const RenderConfig&, int>(), py::arg_v("config", RenderConfig{}, "RenderConfig()"),
           py::arg("threads") = 0, doc("render.Renderer.__init__"))
      .def(
          "set_exposure",
          [](RendererCell& self, float seconds) {
            const Use use(self.in_use, "the renderer", false);
            self.renderer.set_exposure(seconds);
          },
          py::arg("seconds"), doc("render.Renderer.set_exposure"))
      .def(
          "render",
          [](RendererCell& self, const MeshObject& mesh, const Palette palette, const Colliders colliders,
             const render::Camera camera) {
            const Mesh copy = mesh.checked();
            return self.draw([&](render::Renderer& renderer) {
              return renderer.render(copy, palette, colliders, camera);
            });
          },
          py::arg("mesh"), py::arg("palette"), py::arg("colliders"), py::arg("camera"),
          doc("render.Renderer.render"))
      .def(
          "render_points",
          [](RendererCell& self, const std::vector<Vec3> positions, float radius,
             const std::vector<std::uint32_t> bodies, const Palette palette, const Colliders colliders,
             const render::Camera camera) {
            if (!bodies.empty() && bodies.size() != positions.size())
              throw ConfigError("bodies", std::to_string(bodies.size()) +
                                              " are not allowed: none, or one for each of " +
                                              std::to_string(positions.size()) + " positions");
            if (!(radius > 0)) throw ConfigError("radius", "must be a number > 0");
            return self.draw([&](render::Renderer& renderer) {
              return renderer.render_points(positions, radius, bodies, palette, colliders, camera);
            });
          },
          py::arg("positions"), py::arg("radius"), py::arg("bodies"), py::arg("palette"),
          py::arg("colliders"), py::arg("camera"), doc("render.Renderer.render_points"));
}

}  // namespace

void bind_pictures(py::module_& module) {
  Struct<render::Camera>(module, "Camera", Change::frozen, "render.")
      .field("eye", &render::Camera::eye)
      .field("target", &render::Camera::target)
      .field("up", &render::Camera::up)
      .field("field_of_view", &render::Camera::field_of_view)
      .done();
  module.def(
      "frame_camera",
      [](const Aabb& box, const RenderConfig& config, const std::vector<Collider>& colliders) {
        return render::frame_camera(box, config, colliders);
      },
      py::arg("scene_bounds"), py::arg_v("config", RenderConfig{}, "RenderConfig()"),
      py::arg("colliders") = std::vector<Collider>{}, doc("render.frame_camera"));
  bind_renderer(module);
  module.def(
      "write_png",
      [](const std::filesystem::path& file, const py::array& image) {
        render::write_png(file, image_of(image));
      },
      py::arg("file"), py::arg("image"), doc("render.write_png"));
  module.def(
      "body_appearances",
      [](const py::object& scene, SimulationCell* cell) {
        std::vector<BodyInfo> bodies;
        if (cell) {
          const Use use = reading(*cell);
          program::follow_bodies(cell->simulation, bodies);
        }
        return program::body_appearances(scene_of(scene), program::material_names(bodies));
      },
      py::arg("scene"), py::arg("simulation") = py::none(),
      "The appearance of each body of a scene: that of its material, with a colour of a palette where that "
      "names none. simulation: of all that are in it now, parts that were torn off among them.");
  module.def(
      "visible_colliders",
      [](const py::object& scene) { return program::visible_colliders(scene_of(scene)); }, py::arg("scene"),
      "The colliders of a scene that are seen.");
  module.def(
      "bounds_now",
      [](const py::object& scene, SimulationCell& cell) {
        const Use use = reading(cell);
        return program::bounds_now(scene_of(scene), cell.simulation);
      },
      py::arg("scene"), py::arg("simulation"),
      "What a picture of a simulation as it is now has to have in view.");
}

}  // namespace mallow::python
