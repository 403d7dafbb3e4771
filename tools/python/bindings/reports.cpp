#include "live.h"
#include "mallow/ids.h"
#include "mallow/report.h"
#include "mallow/saved_state.h"
#include "mallow/simulation.h"
#include "parts.h"

namespace mallow::python {
namespace {

/// A name of a thing of one kind: a number, but of no use where another kind is meant.
template <class Id>
void id(py::module_& module, const char* name, const char* text) {
  using Number = std::underlying_type_t<Id>;
  const auto number = [](Id of) { return static_cast<Number>(of); };
  py::class_<Id> bound(module, name, text);
  bound.def(py::init([](Number value) { return Id{value}; }), py::arg("value"))
      .def("__int__", number)
      .def("__hash__", number)
      .def("__eq__", [](Id a, Id b) { return a == b; })
      .def("__eq__", [](Id, const py::object&) { return false; })
      .def("__lt__", [](Id a, Id b) { return a < b; })
      .def("__le__", [](Id a, Id b) { return a <= b; })
      .def("__repr__", [name = std::string(name)](Id of) {
        return name + "(" + std::to_string(static_cast<Number>(of)) + ")";
      });
  module.def(
      "slot_of", [](Id of) { return slot_of(of); }, py::arg("id"), doc("slot_of"));
  module.def(
      "generation_of", [](Id of) { return generation_of(of); }, py::arg("id"), doc("generation_of"));
}

void bind_ids(py::module_& module) {
  id<BodyId>(module, "BodyId", "The name of a body: a slot and its generation.");
  id<ColliderId>(module, "ColliderId", "The name of a collider.");
  id<PinId>(module, "PinId", "The name of a pin.");
  id<EmitterId>(module, "EmitterId", "The name of an emitter.");
  id<SinkId>(module, "SinkId", "The name of a sink.");
  id<MaterialId>(module, "MaterialId", doc("MaterialId"));
  module.def("slot_of", &slot_of<ParticleId>, py::arg("id"), doc("slot_of"));
  module.def("generation_of", &generation_of<ParticleId>, py::arg("id"), doc("generation_of"));
}

void bind_phases(py::module_& module) {
  choice<Phase>(module, "Phase",
                {{"reference_update", Phase::reference_update},
                 {"neighbors", Phase::neighbors},
                 {"density", Phase::density},
                 {"accelerations", Phase::accelerations},
                 {"time_step", Phase::time_step},
                 {"region_sums", Phase::region_sums},
                 {"rotations", Phase::rotations},
                 {"goals", Phase::goals},
                 {"volume", Phase::volume},
                 {"body_contact", Phase::body_contact},
                 {"motion", Phase::motion}});
  module.def(
      "name", [](Phase phase) { return name(phase); }, py::arg("value"), doc("name#3"));
}

void bind_steps(py::module_& module) {
  Struct<StepReport>(module, "StepReport", Change::frozen)
      .field("time_step", &StepReport::time_step)
      .field("max_velocity", &StepReport::max_velocity)
      .field("limited", &StepReport::limited)
      .field("neighbors_found", &StepReport::neighbors_found)
      .field("updated_references", &StepReport::updated_references)
      .field("awake_bodies", &StepReport::awake_bodies)
      .field("drained", &StepReport::drained)
      .field("volume_iterations", &StepReport::volume_iterations)
      .field("mean_compression", &StepReport::mean_compression)
      .field("largest_compression", &StepReport::largest_compression)
      .field("seconds", &StepReport::seconds, "Wall time per phase [s], in the order of Phase.")
      .done();
  Struct<AdvanceReport>(module, "AdvanceReport", Change::frozen)
      .field("steps", &AdvanceReport::steps)
      .field("smallest_step", &AdvanceReport::smallest_step)
      .field("largest_step", &AdvanceReport::largest_step)
      .field("max_velocity", &AdvanceReport::max_velocity)
      .field("limited_steps", &AdvanceReport::limited_steps)
      .field("updated_references", &AdvanceReport::updated_references)
      .field("drained", &AdvanceReport::drained)
      .field("volume_iterations", &AdvanceReport::volume_iterations)
      .field("largest_compression", &AdvanceReport::largest_compression)
      .field("seconds", &AdvanceReport::seconds, "Wall time per phase [s], in the order of Phase.")
      .done()
      .def("add", &AdvanceReport::add, py::arg("step"), doc("AdvanceReport.add"));
  Struct<Energy>(module, "Energy", Change::frozen)
      .field("kinetic", &Energy::kinetic)
      .field("gravity", &Energy::gravity)
      .field("elastic", &Energy::elastic)
      .field("conserved", &Energy::conserved)
      .done();
}

void bind_events(py::module_& module) {
  Struct<BodyEvent> event(module, "BodyEvent", Change::frozen);
  using Kind = BodyEvent::Kind;
  choice<Kind>(event.made(), "Kind",
               {{"slept", Kind::slept},
                {"woke", Kind::woke},
                {"yielded", Kind::yielded},
                {"torn", Kind::torn},
                {"merged", Kind::merged},
                {"split", Kind::split},
                {"touched", Kind::touched},
                {"hit", Kind::hit},
                {"parted", Kind::parted}},
               "BodyEvent.");
  event.field("kind", &BodyEvent::kind)
      .field("body", &BodyEvent::body)
      .field("parts", &BodyEvent::parts)
      .field("crumbs", &BodyEvent::crumbs)
      .field("other", &BodyEvent::other)
      .field("collider", &BodyEvent::collider)
      .field("position", &BodyEvent::position)
      .field("normal", &BodyEvent::normal)
      .field("impulse", &BodyEvent::impulse)
      .field("torque", &BodyEvent::torque)
      .field("other_torque", &BodyEvent::other_torque)
      .field("speed", &BodyEvent::speed)
      .done();
}

void bind_infos(py::module_& module) {
  Struct<BodyInfo>(module, "BodyInfo", Change::frozen)
      .field("name", &BodyInfo::name)
      .field("material", &BodyInfo::material)
      .field("particles", &BodyInfo::particles)
      .field("spacing", &BodyInfo::spacing)
      .field("particle_mass", &BodyInfo::particle_mass)
      .field("rest_density", &BodyInfo::rest_density)
      .field("region_radius", &BodyInfo::region_radius)
      .field("alpha", &BodyInfo::alpha)
      .field("update_threshold", &BodyInfo::update_threshold)
      .field("pressure_coefficient", &BodyInfo::pressure_coefficient)
      .field("viscosity", &BodyInfo::viscosity)
      .field("elastic_time_step", &BodyInfo::elastic_time_step)
      .field("youngs_modulus", &BodyInfo::youngs_modulus)
      .field("most_youngs_modulus", &BodyInfo::most_youngs_modulus)
      .field("average_neighbors", &BodyInfo::average_neighbors)
      .field("regions", &BodyInfo::regions)
      .field("shape_matching", &BodyInfo::shape_matching)
      .field("sleep_speed", &BodyInfo::sleep_speed)
      .field("sleep_time", &BodyInfo::sleep_time)
      .done();
  Struct<SimulationInfo>(module, "SimulationInfo", Change::frozen)
      .field("particles", &SimulationInfo::particles)
      .field("bodies", &SimulationInfo::bodies)
      .field("sph", &SimulationInfo::sph)
      .field("viscosity", &SimulationInfo::viscosity)
      .field("cross_group", &SimulationInfo::cross_group)
      .field("instruction_level", &SimulationInfo::instruction_level)
      .field("bytes", &SimulationInfo::bytes)
      .field("support_radius", &SimulationInfo::support_radius)
      .field("time_step", &SimulationInfo::time_step)
      .field("time_step_source", &SimulationInfo::time_step_source)
      .field("longest_step", &SimulationInfo::longest_step)
      .field("update_period", &SimulationInfo::update_period)
      .field("unlimited_step", &SimulationInfo::unlimited_step)
      .field("volume_iterations", &SimulationInfo::volume_iterations)
      .field("warnings", &SimulationInfo::warnings)
      .done();
}

void bind_queries(py::module_& module) {
  Struct<BodyHit>(module, "BodyHit", Change::frozen)
      .field("distance", &BodyHit::distance)
      .field("position", &BodyHit::position)
      .field("normal", &BodyHit::normal)
      .field("body", &BodyHit::body)
      .field("particle", &BodyHit::particle)
      .done();
  Struct<ColliderHit>(module, "ColliderHit", Change::frozen)
      .field("distance", &ColliderHit::distance)
      .field("position", &ColliderHit::position)
      .field("normal", &ColliderHit::normal)
      .field("collider", &ColliderHit::collider)
      .done();
  Struct<NearestParticle>(module, "NearestParticle", Change::frozen)
      .field("distance", &NearestParticle::distance)
      .field("particle", &NearestParticle::particle)
      .field("body", &NearestParticle::body)
      .done();
  Struct<BodyParts>(module, "BodyParts", Change::frozen)
      .field("parts", &BodyParts::parts)
      .field("crumbs", &BodyParts::crumbs)
      .done();
  Struct<BodyMotion>(module, "BodyMotion", Change::frozen)
      .field("mass", &BodyMotion::mass)
      .field("center_of_mass", &BodyMotion::center_of_mass)
      .field("velocity", &BodyMotion::velocity)
      .field("angular_velocity", &BodyMotion::angular_velocity)
      .field("momentum", &BodyMotion::momentum)
      .field("kinetic_energy", &BodyMotion::kinetic_energy)
      .done();
  Struct<Simulation::Rows>(module, "Rows", Change::frozen, "Simulation.")
      .field("begin", &Simulation::Rows::begin)
      .field("end", &Simulation::Rows::end)
      .done()
      .def(
          "slice",
          [](const Simulation::Rows& rows) {
            return py::slice(static_cast<py::ssize_t>(rows.begin), static_cast<py::ssize_t>(rows.end), 1);
          },
          "For arrays: simulation.positions[simulation.rows(body).slice()].");
}

/// Bytes, not words: what they hold is the business of whoever wrote them.
void bind_saved_state(py::module_& module) {
  py::class_<Chunk>(module, "Chunk", doc("Chunk"))
      .def(py::init([](std::string name, const py::bytes& bytes) {
             return Chunk{std::move(name), bytes};
           }),
           py::arg("name"), py::arg("bytes"))
      .def_readonly("name", &Chunk::name, "Of the chunk.")
      .def_property_readonly(
          "bytes", [](const Chunk& chunk) { return py::bytes(chunk.bytes); }, "What it holds.");
  py::class_<SavedState>(module, "SavedState", doc("SavedState"))
      .def(py::init([](std::vector<Chunk> chunks) { return SavedState{std::move(chunks)}; }),
           py::arg("chunks") = std::vector<Chunk>{})
      .def_property(
          "chunks", [](const SavedState& state) { return Tuple<Chunk>{state.chunks}; },
          [](SavedState& state, std::vector<Chunk> chunks) { state.chunks = std::move(chunks); },
          "All of them, by name: a tuple; give a list of Chunk.")
      .def(
          "find",
          [](const SavedState& state, const std::string& name) -> std::optional<py::bytes> {
            const std::string* const bytes = state.find(name);
            return bytes ? std::optional(py::bytes(*bytes)) : std::nullopt;
          },
          py::arg("name"), doc("SavedState.find"))
      .def(py::pickle(
          [](const SavedState& state) {
            py::list chunks;
            for (const Chunk& chunk : state.chunks)
              chunks.append(py::make_tuple(chunk.name, py::bytes(chunk.bytes)));
            return py::tuple(chunks);
          },
          [](const py::tuple& chunks) {
            SavedState state;
            for (const py::handle chunk : chunks) {
              const auto [name, bytes] = chunk.cast<std::pair<std::string, py::bytes>>();
              state.chunks.push_back({name, bytes});
            }
            return state;
          }));
}

}  // namespace

void bind_reports(py::module_& module) {
  bind_ids(module);
  bind_phases(module);
  bind_steps(module);
  bind_events(module);
  bind_infos(module);
  bind_queries(module);
  bind_saved_state(module);
}

}  // namespace mallow::python
