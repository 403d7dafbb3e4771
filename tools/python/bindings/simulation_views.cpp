#include "simulation.h"

/// What a simulation tells of itself.
namespace mallow::python {
namespace {

/// A whole number of Python or NumPy. The id of a body is one of a body, and no number here.
ParticleId particle_id(const py::object& number) {
  if (PyIndex_Check(number.ptr()) == 0)
    throw py::type_error("particle: the id of a particle is needed, a whole number of ids");
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(number.ptr()));
  const ParticleId id = index ? PyLong_AsUnsignedLongLong(index.ptr()) : 0;
  if (PyErr_Occurred() != nullptr) throw py::error_already_set();
  return id;
}

/// Quaternions as x, y, z, w.
std::array<float, 4> numbers(const Eigen::Quaternionf& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

/// A property that shows a column: see column_view().
template <auto member>
py::array column(SimulationCell& cell) {
  const Use use = reading(cell);
  return column_view((cell.simulation.*member)());
}

void bind_columns(SimulationClass& simulation) {
  const auto property = [&](const char* name, py::array (*get)(SimulationCell&)) {
    simulation.def_property_readonly(name, get, doc(std::string("Simulation.") + name));
  };
  property("ids", &column<&Simulation::ids>);
  property("positions", &column<&Simulation::positions>);
  property("velocities", &column<&Simulation::velocities>);
  property("densities", &column<&Simulation::densities>);
  property("alphas", &column<&Simulation::alphas>);
  property("stiffnesses", &column<&Simulation::stiffnesses>);
  property("temperatures", &column<&Simulation::temperatures>);
  const auto number = [&](const char* name, const auto& get) {
    simulation.def_property_readonly(name, get, doc(std::string("Simulation.") + name));
  };
  number("particle_count", query(&Simulation::particle_count));
  number("body_count", query(&Simulation::body_count));
  number("time", query(&Simulation::time));
  number("step_count", query(&Simulation::step_count));
}

void bind_of_particles(SimulationClass& simulation) {
  const auto def = [&](const char* name, const auto& get, auto... arguments) {
    simulation.def(name, get, py::arg(arguments)..., doc(std::string("Simulation.") + name));
  };
  const auto def_of_particle = [&](const char* name, const auto& get) {
    simulation.def(
        name,
        [get](SimulationCell& cell, const py::object& particle) {
          const ParticleId id = particle_id(particle);
          const Use use = reading(cell);
          return get(cell.simulation, id);
        },
        py::arg("particle"), doc(std::string("Simulation.") + name));
  };
  def_of_particle("row", [](const Simulation& s, ParticleId id) { return s.row(id); });
  def_of_particle("alpha", [](const Simulation& s, ParticleId id) { return s.alpha(id); });
  def_of_particle("rest_position", [](const Simulation& s, ParticleId id) { return s.rest_position(id); });
  def_of_particle("rotation", [](const Simulation& s, ParticleId id) {
    return Eigen::Vector4d(s.rotation(id).coeffs().cast<double>());
  });
  def("positions_by_id", query(&Simulation::positions_by_id));
  def("velocities_by_id", query(&Simulation::velocities_by_id));
  def("bodies_by_id", query(&Simulation::bodies_by_id));
  simulation
      .def(
          "rest_positions",
          [](SimulationCell& cell, BodyId body) {
            const Use use = reading(cell);
            return column_view(cell.simulation.rest_positions(body));
          },
          py::arg("body"), doc("Simulation.rest_positions"))
      .def(
          "rotations",
          [](SimulationCell& cell, BodyId body) {
            const Use use = reading(cell);
            const RotationView rotations = cell.simulation.rotations(body);
            std::vector<std::array<float, 4>> result(rotations.size());
            for (std::size_t i = 0; i < result.size(); ++i) result[i] = numbers(rotations[i]);
            return result;
          },
          py::arg("body"), doc("Simulation.rotations"))
      .def("nearest_particle", query(&Simulation::nearest_particle), py::arg("point"),
           doc("Simulation.nearest_particle"))
      .def("particles_in", query(py::overload_cast<const Aabb&>(&Simulation::particles_in, py::const_)),
           py::arg("box"), doc("Simulation.particles_in"))
      .def("particles_in",
           query(py::overload_cast<const Vec3&, float>(&Simulation::particles_in, py::const_)),
           py::arg("center"), py::arg("radius"), doc("Simulation.particles_in#2"));
}

void bind_of_bodies(SimulationClass& simulation) {
  const auto def = [&](const char* name, const auto& get, auto... arguments) {
    simulation.def(name, get, py::arg(arguments)..., doc(std::string("Simulation.") + name));
  };
  def("bodies", query(&Simulation::bodies));
  def("find_body", query(&Simulation::find_body), "name");
  def("name", query(&Simulation::name), "body");
  def("body", query(&Simulation::body), "emitter");
  def("rows", query(&Simulation::rows), "body");
  def("spacing", query(&Simulation::spacing), "body");
  def("material", query(&Simulation::material), "body");
  def("heat", query(&Simulation::heat), "body");
  def("bounds", query(&Simulation::bounds), "body");
  def("motion", query(&Simulation::motion), "body");
  def("is_enabled", query(&Simulation::is_enabled), "body");
  def("is_awake", query(&Simulation::is_awake), "body");
  def("user_data", query(&Simulation::user_data), "body");
  simulation.def(
      "events",
      [](SimulationCell& cell) {
        const Use use = reading(cell);
        const std::span<const BodyEvent> events = cell.simulation.events();
        return Tuple<BodyEvent>{{events.begin(), events.end()}};
      },
      doc("Simulation.events"));
}

void bind_of_scene(SimulationClass& simulation) {
  const auto def = [&](const char* name, const auto& get, auto... arguments) {
    simulation.def(name, get, py::arg(arguments)..., doc(std::string("Simulation.") + name));
  };
  def("config", query(&Simulation::config));
  def("material_settings", query(&Simulation::material_settings), "material");
  def("emitter", query(&Simulation::emitter), "emitter");
  def("emitter_ids", query(&Simulation::emitter_ids));
  def("held", query(&Simulation::held), "emitter");
  def("sink_ids", query(&Simulation::sink_ids));
  def("drained", query(&Simulation::drained), "sink");
  def("colliders", query(&Simulation::colliders));
  def("collider_ids", query(&Simulation::collider_ids));
  def("collider", query(&Simulation::collider), "collider");
  def("load", query(&Simulation::load), "collider");
  def("state_hash", query(&Simulation::state_hash));
  constexpr double k_far = std::numeric_limits<double>::infinity();
  simulation
      .def("raycast", query(&Simulation::raycast), py::arg("origin"), py::arg("direction"),
           py::arg("farthest") = k_far, doc("Simulation.raycast"))
      .def("raycast_colliders", query(&Simulation::raycast_colliders), py::arg("origin"),
           py::arg("direction"), py::arg("farthest") = k_far, doc("Simulation.raycast_colliders"));
}

}  // namespace

void bind_views(SimulationClass& simulation) {
  bind_columns(simulation);
  bind_of_particles(simulation);
  bind_of_bodies(simulation);
  bind_of_scene(simulation);
}

}  // namespace mallow::python
