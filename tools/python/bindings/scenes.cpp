#include "mallow/scene.h"

#include "mallow/materials.h"
#include "parts.h"
#include "simulation.h"

namespace mallow::python {

py::object skin_to_python(Skin&& skin);

namespace {

/// A scene as Python holds it: its lists are lists of Python, whose elements may be changed where they are.
struct SceneObject {
  explicit SceneObject(Scene scene)
      : materials(taken(scene.materials)),
        bodies(taken(scene.bodies)),
        colliders(taken(scene.colliders)),
        pins(taken(scene.pins)),
        emitters(taken(scene.emitters)),
        sinks(taken(scene.sinks)),
        rest(std::move(scene)) {}

  py::list materials, bodies, colliders, pins, emitters, sinks;
  Scene rest;  // all else

  Scene scene() const {
    Scene scene = rest;
    put("materials", materials, scene.materials);
    put("bodies", bodies, scene.bodies);
    put("colliders", colliders, scene.colliders);
    put("pins", pins, scene.pins);
    put("emitters", emitters, scene.emitters);
    put("sinks", sinks, scene.sinks);
    return scene;
  }

 private:
  template <class T>
  static py::list taken(std::vector<T>& items) {
    py::list list;
    for (T& item : items) list.append(py::cast(std::move(item)));
    items.clear();
    return list;
  }
  template <class T>
  static void put(const char* name, const py::list& list, std::vector<T>& items) {
    for (std::size_t i = 0; i < list.size(); ++i)
      items.push_back(convert<T>(list[i], std::string("Scene.") + name + "[" + std::to_string(i) + "]",
                                 "a " + py::type::of<T>().attr("__name__").template cast<std::string>()));
  }
};

void bind_sources(py::module_& module) {
  Struct<SphereSource>(module, "SphereSource", Change::frozen)
      .field("center", &SphereSource::center)
      .field("radius", &SphereSource::radius)
      .field("sampling", &SphereSource::sampling, "", "a Sampling")
      .done();
  Struct<MeshSource>(module, "MeshSource", Change::frozen)
      .field("file", &MeshSource::file, "", "a path")
      .field("sampling", &MeshSource::sampling, "", "a Sampling")
      .field("placement", &MeshSource::placement, "", "a Placement")
      .done();
  Struct<PointsSource>(module, "PointsSource", Change::frozen)
      .field("file", &PointsSource::file, "", "a path")
      .field("spacing", &PointsSource::spacing)
      .done();
  Struct<ImplicitSource>(module, "ImplicitSource", Change::frozen)
      .field("shape", &ImplicitSource::shape, "", "a name")
      .field("sampling", &ImplicitSource::sampling, "", "a Sampling")
      .field("placement", &ImplicitSource::placement, "", "a Placement")
      .done();
  Struct<HullSource>(module, "HullSource", Change::frozen)
      .field("file", &HullSource::file, "", "a path")
      .field("points", &HullSource::points, "", "an array of n x 3 numbers")
      .field("inside", &HullSource::inside)
      .done();
  Struct<MeshColliderSource>(module, "MeshColliderSource", Change::frozen)
      .field("file", &MeshColliderSource::file, "", "a path")
      .field("voxels", &MeshColliderSource::voxels)
      .field("size", &MeshColliderSource::size)
      .field("center", &MeshColliderSource::center)
      .field("inside", &MeshColliderSource::inside)
      .done();
  Struct<SceneKeyframe>(module, "SceneKeyframe", Change::frozen)
      .field("time", &SceneKeyframe::time)
      .field("translate", &SceneKeyframe::translate)
      .field("rotate", &SceneKeyframe::rotate)
      .done();
}

/// The fields of a collider of a scene: `base` has the first of them.
template <class T>
void collider_fields(Struct<T>& bound) {
  bound.derived("Collider")
      .field("shape", &Collider::shape, "", "a shape: Plane, Sphere, Box and the like")
      .field("pose", &Collider::pose, "", "a Pose")
      .field("velocity", &Collider::velocity)
      .field("angular_velocity", &Collider::angular_velocity)
      .field("surface_velocity", &Collider::surface_velocity)
      .field("restitution", &Collider::restitution)
      .field("friction", &Collider::friction)
      .field("measure_load", &Collider::measure_load)
      .field("keyframes", &Collider::keyframes, "", "a list of PoseKeyframe")
      .field("temperature", &Collider::temperature)
      .field("heat_transfer", &Collider::heat_transfer)
      .derived("SceneCollider")
      .field("translate", &SceneCollider::translate)
      .field("rotate", &SceneCollider::rotate)
      .field("visible", &SceneCollider::visible)
      .field("sources", &SceneCollider::sources, "", "a list of HullSource, MeshColliderSource or None")
      .field("scene_keyframes", &SceneCollider::scene_keyframes, "", "a list of SceneKeyframe");
}

void bind_elements(py::module_& module) {
  Struct<SceneMaterial>(module, "SceneMaterial", Change::live)
      .field("name", &SceneMaterial::name, "", "a name")
      .field("material", &SceneMaterial::material, "", "a Material")
      .field("color", &SceneMaterial::color)
      .field("finish", &SceneMaterial::finish)
      .done();
  Struct<SceneCollider> collider(module, "SceneCollider", Change::live);
  collider_fields(collider);
  collider.done();
  Struct<ScenePaint> paint(module, "ScenePaint", Change::frozen);
  collider_fields(paint);
  paint.field("alpha", &ScenePaint::alpha)
      .field("stiffness", &ScenePaint::stiffness)
      .field("plastic_yield", &ScenePaint::plastic_yield)
      .field("paint_temperature", &ScenePaint::paint_temperature)
      .done();
  Struct<SceneBody>(module, "SceneBody", Change::live)
      .field("material", &SceneBody::material, "", "a name")
      .field("group", &SceneBody::group, "", "a name")
      .field("merges", &SceneBody::merges)
      .field("splits", &SceneBody::splits)
      .field("source", &SceneBody::source, "",
             "a Lattice, SphereSource, MeshSource, PointsSource or ImplicitSource")
      .field("velocity", &SceneBody::velocity)
      .field("paint", &SceneBody::paint, "", "a list of ScenePaint")
      .field("skin", &SceneBody::skin, "", "a path")
      .field("line", &SceneBody::line)
      .done();
  Struct<SceneSink>(module, "SceneSink", Change::live)
      .field("box", &SceneSink::box, "", "an Aabb")
      .field("outside", &SceneSink::outside)
      .field("line", &SceneSink::line)
      .done();
  Struct<ScenePin>(module, "ScenePin", Change::live)
      .field("box", &ScenePin::box, "", "an Aabb")
      .field("velocity", &ScenePin::velocity)
      .field("line", &ScenePin::line)
      .done();
}

void bind_emitter(py::module_& module) {
  Struct<SceneEmitter>(module, "SceneEmitter", Change::live)
      .derived("Emitter")
      .field("radius", &Emitter::radius)
      .field("width", &Emitter::width)
      .field("height", &Emitter::height)
      .field("points", &Emitter::points)
      .field("spacing", &Emitter::spacing)
      .field("pose", &Emitter::pose)
      .field("velocity", &Emitter::velocity)
      .field("keyframes", &Emitter::keyframes)
      .field("speed", &Emitter::speed)
      .field("start", &Emitter::start)
      .field("stop", &Emitter::stop)
      .field("jitter", &Emitter::jitter)
      .field("most_particles", &Emitter::most_particles)
      .field("merges", &Emitter::merges)
      .field("material", &SceneEmitter::material)
      .field("translate", &SceneEmitter::translate)
      .field("rotate", &SceneEmitter::rotate)
      .field("scene_keyframes", &SceneEmitter::scene_keyframes)
      .field("line", &SceneEmitter::line)
      .done();
}

void bind_scene(py::module_& module) {
  py::class_<SceneObject> scene(module, "Scene", doc("Scene"));
  const auto part = [&](const char* name, auto member) {
    scene.def_property(
        name, [member](SceneObject & self) -> auto& { return self.rest.*member; },
        [member](SceneObject& self, const std::decay_t<decltype(self.rest.*member)>& value) {
          self.rest.*member = value;
        },
        "See its class.");
  };
  const auto list = [&](const char* name, py::list SceneObject::*member, const char* of) {
    scene.def_property(
        name, [member](const SceneObject& self) { return self.*member; },
        [member](SceneObject& self, const py::list& value) { self.*member = value; },
        (std::string("A list of ") + of + ", which may be changed.").c_str());
  };
  scene
      .def(py::init([](const py::kwargs& parts) {
        auto made = std::make_unique<SceneObject>(Scene{});
        const py::object seen = py::cast(made.get(), py::return_value_policy::reference);
        for (const auto& [name, value] : parts) {
          if (!py::hasattr(seen, name))
            throw py::type_error("Scene has no field " + name.cast<std::string>());
          seen.attr(name) = value;
        }
        return made;
      }))
      .def_property(
          "file", [](const SceneObject& self) { return self.rest.file; },
          [](SceneObject& self, std::filesystem::path file) { self.rest.file = std::move(file); },
          "What messages name, and what paths are relative to.");
  part("solver", &Scene::solver);
  list("materials", &SceneObject::materials, "SceneMaterial");
  list("bodies", &SceneObject::bodies, "SceneBody");
  list("colliders", &SceneObject::colliders, "SceneCollider");
  list("pins", &SceneObject::pins, "ScenePin");
  list("emitters", &SceneObject::emitters, "SceneEmitter");
  list("sinks", &SceneObject::sinks, "SceneSink");
  part("surface", &Scene::surface);
  part("run", &Scene::run);
  part("render", &Scene::render);
  scene.attr("_fields") = py::make_tuple("file", "solver", "materials", "bodies", "colliders", "pins", "emitters",
                                         "sinks", "surface", "run", "render");
}

void bind_reading(py::module_& module) {
  module.def(
      "read_scene",
      [](const std::filesystem::path& file, const std::vector<std::string>& overrides,
         bool allow_outside_paths) {
        return SceneObject(read_scene(file, overrides, {.allow_outside_paths = allow_outside_paths}));
      },
      py::arg("file"), py::arg("overrides") = std::vector<std::string>{},
      py::arg("allow_outside_paths") = false, doc("read_scene"));
  module.def(
      "parse_scene",
      [](const std::string& text, const std::filesystem::path& file,
         const std::vector<std::string>& overrides, bool allow_outside_paths) {
        return SceneObject(parse_scene(text, file, overrides, {.allow_outside_paths = allow_outside_paths}));
      },
      py::arg("text"), py::arg("file") = "scene.toml", py::arg("overrides") = std::vector<std::string>{},
      py::arg("allow_outside_paths") = false, doc("parse_scene"));
  module.def(
      "print_scene", [](const SceneObject& scene) { return print_scene(scene.scene()); }, py::arg("scene"),
      doc("print_scene"));
  module.def("describe_scene_keys", &describe_scene_keys, doc("describe_scene_keys"));
  module.def("describe_material", &describe_material, py::arg("preset"), doc("describe_material"));
  module.def(
      "named_files",
      [](const SceneObject& object) {
        Scene scene = object.scene();
        std::vector<std::filesystem::path> files;
        for (const std::filesystem::path* file : named_files(scene)) files.push_back(*file);
        return files;
      },
      py::arg("scene"), doc("named_files"));
  module.def(
      "at_time_step",
      [](const SceneObject& scene, float factor) { return SceneObject(at_time_step(scene.scene(), factor)); },
      py::arg("scene"), py::arg("factor"), doc("at_time_step#2"));
  module.def(
      "with_quality",
      [](const SceneObject& scene, Quality quality) {
        return SceneObject(with_quality(scene.scene(), quality));
      },
      py::arg("scene"), py::arg("quality"), doc("with_quality#4"));
}

void bind_building(py::module_& module) {
  Struct<SceneIds>(module, "SceneIds", Change::live)
      .field("bodies", &SceneIds::bodies, "", "a list of ids")
      .field("colliders", &SceneIds::colliders, "", "a list of ids")
      .field("pins", &SceneIds::pins, "", "a list of ids")
      .field("emitters", &SceneIds::emitters, "", "a list of ids")
      .field("sinks", &SceneIds::sinks, "", "a list of ids")
      .done();
  module.def(
      "sample",
      [](const SceneBody body, const std::filesystem::path& scene_file, int threads) {
        const py::gil_scoped_release release;
        return sample(body, scene_file, threads);
      },
      py::arg("body"), py::arg("scene_file") = "", py::arg("threads") = 0, doc("sample#3"));
  module.def(
      "paint",
      [](const SceneBody& body, const Material& material, Body& points) { paint(body, material, points); },
      py::arg("body"), py::arg("material"), py::arg("points"), doc("paint"));
  module.def(
      "build",
      [](const SceneObject& object, int threads, std::optional<py::list> notes, SceneIds* ids) {
        const Scene scene = object.scene();
        std::vector<std::string> told;
        SceneIds named;
        std::shared_ptr<SimulationCell> cell;
        {
          const py::gil_scoped_release release;
          cell = std::make_shared<SimulationCell>(build(scene, threads, &told, &named));
        }
        if (notes)
          for (const std::string& note : told) notes->append(note);
        if (ids) *ids = std::move(named);
        return cell;
      },
      py::arg("scene"), py::arg("threads") = 0, py::arg("notes") = std::nullopt, py::arg("ids") = nullptr,
      doc("build"));
  module.def(
      "skins",
      [](const SceneObject& scene, SimulationCell& cell, int threads) {
        const Use use = changing(cell);
        py::list objects;
        for (Skin& skin : skins(scene.scene(), cell.simulation, threads))
          objects.append(skin_to_python(std::move(skin)));
        return objects;
      },
      py::arg("scene"), py::arg("simulation"), py::arg("threads") = 0, doc("skins"));
  module.def(
      "skinned_bodies", [](const SceneObject& scene) { return skinned_bodies(scene.scene()); },
      py::arg("scene"), doc("skinned_bodies"));
  module.def(
      "frame_time",
      [](const SceneObject& scene, const SimulationInfo& info) { return frame_time(scene.scene(), info); },
      py::arg("scene"), py::arg("info"), doc("frame_time"));
  module.def(
      "warnings",
      [](const SceneObject& scene, const SimulationInfo& info) { return warnings(scene.scene(), info); },
      py::arg("scene"), py::arg("info"), doc("warnings"));
  module.def(
      "body_materials",
      [](const SceneObject& scene) {
        py::list numbers;
        for (const std::size_t number : body_materials(scene.scene())) numbers.append(number);
        return numbers;
      },
      py::arg("scene"), doc("body_materials"));
}

}  // namespace

Scene scene_of(const py::handle& object) {
  return object.cast<const SceneObject&>().scene();
}

void bind_scenes(py::module_& module) {
  bind_sources(module);
  bind_elements(module);
  bind_emitter(module);
  bind_scene(module);
  bind_reading(module);
  bind_building(module);
}

}  // namespace mallow::python
