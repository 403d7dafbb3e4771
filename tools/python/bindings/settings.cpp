#include "config/field_tables.h"
#include "config/run_field_tables.h"
#include "live.h"
#include "mallow/defaults.h"
#include "mallow/errors.h"
#include "mallow/executor.h"
#include "mallow/materials.h"
#include "mallow/quality.h"
#include "parts.h"

namespace mallow::python {
namespace {

void bind_choices(py::module_& module) {
  choice<Formulation>(module, "Formulation",
                      {{"conservative", Formulation::conservative}, {"printed", Formulation::printed}});
  choice<BodyContact>(module, "BodyContact",
                      {{"constraint", BodyContact::constraint}, {"pressure", BodyContact::pressure}});
  choice<Arithmetic>(module, "Arithmetic", {{"exact", Arithmetic::exact}, {"native", Arithmetic::native}});
  choice<InstructionLevel>(
      module, "InstructionLevel",
      {{"baseline", InstructionLevel::baseline}, {"v3", InstructionLevel::v3}, {"v4", InstructionLevel::v4}});
  choice<Finish>(module, "Finish",
                 {{"jelly", Finish::jelly},
                  {"clay", Finish::clay},
                  {"cream", Finish::cream},
                  {"gloss", Finish::gloss},
                  {"syrup", Finish::syrup}});
  choice<SurfaceKind>(module, "SurfaceKind",
                      {{"blended", SurfaceKind::blended},
                       {"anisotropic", SurfaceKind::anisotropic},
                       {"spheres", SurfaceKind::spheres}});
  choice<Quality>(
      module, "Quality",
      {{"realtime", Quality::realtime}, {"balanced", Quality::balanced}, {"accurate", Quality::accurate}});
  choice<TimeStepSource>(module, "TimeStepSource",
                         {{"given", TimeStepSource::given},
                          {"gravity", TimeStepSource::gravity},
                          {"speed", TimeStepSource::speed},
                          {"modulus", TimeStepSource::modulus}});
  module.def("best_instruction_level", &best_instruction_level, doc("best_instruction_level"));
  module.def(
      "qualities", [] { return std::vector<Quality>(qualities().begin(), qualities().end()); },
      doc("qualities"));
  module.def(
      "name", [](InstructionLevel level) { return name(level); }, py::arg("value"), doc("name"));
  module.def(
      "name", [](Quality quality) { return name(quality); }, py::arg("value"), doc("name#2"));
}

/// Keys as pairs; an empty list would be no schedule.
Schedule schedule_of(const std::vector<std::pair<float, float>>& pairs) {
  if (pairs.empty()) throw ConfigError("schedule", "has no keys: one at least is needed");
  std::vector<ScheduleKey> keys;
  keys.reserve(pairs.size());
  for (const auto& [time, value] : pairs) keys.push_back({time, value});
  return Schedule(std::move(keys));
}

void bind_schedule(py::module_& module) {
  Struct<ScheduleKey>(module, "ScheduleKey", Change::frozen)
      .field("time", &ScheduleKey::time)
      .field("value", &ScheduleKey::value)
      .done()
      .def("__iter__", [](const ScheduleKey& key) { return py::iter(py::make_tuple(key.time, key.value)); });
  py::class_<Schedule> schedule(module, "Schedule", doc("Schedule"));
  schedule.def(py::init<float>(), py::arg("value") = 0.0f, doc("Schedule.__init__"))
      .def(py::init(&schedule_of), py::arg("keys"), doc("Schedule.__init__#2"))
      .def("at", &Schedule::at, py::arg("time"), doc("Schedule.at"))
      .def("lowest", &Schedule::lowest, doc("Schedule.lowest"))
      .def("highest", &Schedule::highest, doc("Schedule.highest"))
      .def(
          "keys", [](const Schedule& self) { return Tuple<ScheduleKey>{self.keys()}; }, doc("Schedule.keys"))
      .def("__float__",
           [](const Schedule& self) {
             if (self.keys().size() > 1) throw py::type_error("a schedule of several keys is not one number");
             return self.keys().front().value;
           })
      .def("__repr__", [](const Schedule& self) {
        std::string text;
        for (const ScheduleKey& key : self.keys())
          text += (text.empty() ? "(" : ", (") + py::repr(py::float_(key.time)).cast<std::string>() + ", " +
                  py::repr(py::float_(key.value)).cast<std::string>() + ")";
        if (self.keys().size() == 1)
          return "Schedule(" + py::repr(py::float_(self.keys().front().value)).cast<std::string>() + ")";
        return "Schedule([" + text + "])";
      });
  py::implicitly_convertible<py::float_, Schedule>();
  py::implicitly_convertible<py::int_, Schedule>();
  py::implicitly_convertible<py::sequence, Schedule>();
}

void bind_configs(py::module_& module) {
  Struct<SolverConfig>(module, "SolverConfig", Change::live)
      .table()
      .field("executor", &SolverConfig::executor)
      .done();
  Struct<Material>(module, "Material", Change::live).table().done();
  Struct<SurfaceConfig>(module, "SurfaceConfig", Change::live).table().done();
  Struct<RunConfig>(module, "RunConfig", Change::live).table().done();
  Struct<RenderConfig>(module, "RenderConfig", Change::live)
      .table()
      .field("environment", &RenderConfig::environment)
      .done();
  Struct<Appearance>(module, "Appearance", Change::frozen)
      .field("color", &Appearance::color)
      .field("finish", &Appearance::finish)
      .done();

  module.def("at_time_step", py::overload_cast<const SolverConfig&, float>(&at_time_step), py::arg("config"),
             py::arg("factor"), doc("at_time_step"));
  module.def("at_voxels", &at_voxels, py::arg("config"), py::arg("factor"), doc("at_voxels"));
  module.def("with_quality", py::overload_cast<const SolverConfig&, Quality>(&with_quality),
             py::arg("config"), py::arg("quality"), doc("with_quality"));
  module.def("with_quality", py::overload_cast<const Material&, const SolverConfig&, Quality>(&with_quality),
             py::arg("material"), py::arg("config"), py::arg("quality"), doc("with_quality#2"));
  module.def("with_quality", py::overload_cast<const SurfaceConfig&, Quality>(&with_quality),
             py::arg("config"), py::arg("quality"), doc("with_quality#3"));
}

void bind_presets(py::module_& module) {
  py::class_<MaterialPreset>(module, "MaterialPreset", doc("MaterialPreset"))
      .def_property_readonly(
          "name", [](const MaterialPreset& preset) { return preset.name; }, doc("MaterialPreset.name"))
      .def_property_readonly(
          "about", [](const MaterialPreset& preset) { return preset.about; }, doc("MaterialPreset.about"))
      .def_property_readonly(
          "source", [](const MaterialPreset& preset) { return preset.source; }, doc("MaterialPreset.source"))
      .def_property_readonly(
          "material", [](const MaterialPreset& preset) { return Material(preset.material); },
          doc("MaterialPreset.material"))
      .def_property_readonly(
          "appearance", [](const MaterialPreset& preset) { return Appearance(preset.appearance); },
          doc("MaterialPreset.appearance"))
      .def("__repr__", [](const MaterialPreset& preset) {
        return std::string("MaterialPreset(") + preset.name + ": " + preset.about + ")";
      });
  py::module_ materials =
      module.def_submodule("materials", "A material of every preset by its name, as in materials.jelly().");
  py::list presets;
  for (const MaterialPreset& preset : material_presets()) {
    presets.append(py::cast(&preset, py::return_value_policy::reference));
    materials.def(
        preset.name, [material = &preset.material] { return Material(*material); }, preset.about);
  }
  module.def(
      "material_presets", [all = py::tuple(presets)] { return all; }, doc("material_presets"));
  module.def("find_preset", &find_preset, py::arg("name"), py::return_value_policy::reference,
             doc("find_preset"));
}

void bind_defaults(py::module_& module) {
  Struct<SceneScale>(module, "SceneScale", Change::frozen)
      .field("spacing", &SceneScale::spacing)
      .field("gravity", &SceneScale::gravity)
      .field("speed", &SceneScale::speed)
      .done();
  const auto def = [&](const char* name, auto function, auto... arguments) {
    module.def(name, function, py::arg(arguments)..., doc(name));
  };
  def("default_time_step", &default_time_step, "scale");
  def("default_support_radius", &default_support_radius, "spacing");
  def("region_moment", &region_moment, "radius", "spacing");
  def("default_update_threshold", &default_update_threshold, "scale", "time_step");
  def("default_update_period", &default_update_period, "time_step");
  def("default_pressure_coefficient", &default_pressure_coefficient, "support_radius", "alpha", "pull",
      "time_step");
  def("default_kinematic_viscosity", &default_kinematic_viscosity, "scale", "time_step");
  def("default_volume_iterations", &default_volume_iterations, "flows");
  def("full_neighbors", &full_neighbors, "radius", "spacing");
}

}  // namespace

void bind_settings(py::module_& module) {
  py::class_<Executor, std::shared_ptr<Executor>>(module, "Executor", doc("Executor"))
      .def("concurrency", &Executor::concurrency, doc("Executor.concurrency"));
  module.def("team_executor", &team_executor, doc("team_executor"));
  module.def("openmp_executor", &openmp_executor, doc("openmp_executor"));
  bind_choices(module);
  bind_schedule(module);
  bind_configs(module);
  bind_presets(module);
  bind_defaults(module);
}

}  // namespace mallow::python
