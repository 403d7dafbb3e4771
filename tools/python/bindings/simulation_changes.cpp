#include "simulation.h"

/// The verbs of a simulation that change it between steps.
namespace mallow::python {
namespace {

const Vec3 k_zero{0, 0, 0};

void bind_bodies(SimulationClass& simulation) {
  simulation
      .def("add_material", verb(&Simulation::add_material), py::arg("material"), py::arg("name") = "",
           doc("Simulation.add_material"))
      .def("add_body", verb(py::overload_cast<const Body&, MaterialId, std::string>(&Simulation::add_body)),
           py::arg("body"), py::arg("material"), py::arg("name") = "", doc("Simulation.add_body"))
      .def("add_body",
           verb(py::overload_cast<const Body&, const Material&, std::string>(&Simulation::add_body)),
           py::arg("body"), py::arg("material"), py::arg("name") = "", doc("Simulation.add_body#2"))
      .def("extend_body", verb(&Simulation::extend_body), py::arg("body"), py::arg("more"),
           doc("Simulation.extend_body"))
      .def("remove_body", verb(&Simulation::remove_body), py::arg("body"), doc("Simulation.remove_body"))
      .def("remove_particles", verb(py::overload_cast<const Aabb&>(&Simulation::remove_particles)),
           py::arg("region"), doc("Simulation.remove_particles#2"))
      .def("remove_particles",
           verb(py::overload_cast<std::span<const ParticleId>>(&Simulation::remove_particles)),
           py::arg("ids"), doc("Simulation.remove_particles"))
      .def("split", verb(&Simulation::split), py::arg("body"), doc("Simulation.split"));
}

void bind_surroundings(SimulationClass& simulation) {
  simulation
      .def("add_collider", verb(&Simulation::add_collider), py::arg("collider"),
           doc("Simulation.add_collider"))
      .def("set_collider", verb(&Simulation::set_collider), py::arg("id"), py::arg("collider"),
           doc("Simulation.set_collider"))
      .def("remove_collider", verb(&Simulation::remove_collider), py::arg("collider"),
           doc("Simulation.remove_collider"))
      .def("add_emitter", verb(&Simulation::add_emitter), py::arg("emitter"), py::arg("material"),
           py::arg("name") = "", doc("Simulation.add_emitter"))
      .def("set_flow", verb(&Simulation::set_flow), py::arg("emitter"), py::arg("speed"),
           py::arg("velocity") = k_zero, doc("Simulation.set_flow"))
      .def("remove_emitter", verb(&Simulation::remove_emitter), py::arg("emitter"),
           doc("Simulation.remove_emitter"))
      .def("add_sink", verb(&Simulation::add_sink), py::arg("box"), py::arg("outside") = false,
           doc("Simulation.add_sink"))
      .def("remove_sink", verb(&Simulation::remove_sink), py::arg("sink"), doc("Simulation.remove_sink"))
      .def("pin", verb(py::overload_cast<const Aabb&, const Vec3&>(&Simulation::pin)), py::arg("region"),
           py::arg("velocity") = k_zero, doc("Simulation.pin"))
      .def("pin", verb(py::overload_cast<std::span<const ParticleId>, const Vec3&>(&Simulation::pin)),
           py::arg("ids"), py::arg("velocity") = k_zero, doc("Simulation.pin#2"))
      .def("unpin", verb(&Simulation::unpin), py::arg("pin"), doc("Simulation.unpin"))
      .def("move_pin", verb(&Simulation::move_pin), py::arg("pin"), py::arg("way"), py::arg("seconds"),
           doc("Simulation.move_pin"))
      .def("set_twist", verb(&Simulation::set_twist), py::arg("collider"), py::arg("velocity"),
           py::arg("angular_velocity"), doc("Simulation.set_twist"))
      .def("set_pose", verb(&Simulation::set_pose), py::arg("collider"), py::arg("pose"),
           py::arg("seconds") = 0.0, doc("Simulation.set_pose"))
      .def("set_solver", verb(&Simulation::set_solver), py::arg("config"), doc("Simulation.set_solver"))
      .def("set_gravity", verb(&Simulation::set_gravity), py::arg("gravity"), doc("Simulation.set_gravity"));
}

void bind_matter(SimulationClass& simulation) {
  simulation
      .def("set_material", verb(&Simulation::set_material), py::arg("material"), py::arg("settings"),
           doc("Simulation.set_material"))
      .def("set_alpha", verb(py::overload_cast<MaterialId, const AlphaSchedule&>(&Simulation::set_alpha)),
           py::arg("material"), py::arg("alpha"), doc("Simulation.set_alpha"))
      .def("set_alpha", verb(py::overload_cast<std::span<const ParticleId>, float>(&Simulation::set_alpha)),
           py::arg("ids"), py::arg("alpha"), doc("Simulation.set_alpha#2"))
      .def("set_stiffness", verb(&Simulation::set_stiffness), py::arg("ids"), py::arg("stiffness"),
           doc("Simulation.set_stiffness"))
      .def("set_temperature",
           verb(py::overload_cast<ColliderId, const std::optional<Schedule>&>(&Simulation::set_temperature)),
           py::arg("collider"), py::arg("temperature"), doc("Simulation.set_temperature#2"))
      .def("set_temperature",
           verb(py::overload_cast<std::span<const ParticleId>, float>(&Simulation::set_temperature)),
           py::arg("ids"), py::arg("temperature"), doc("Simulation.set_temperature"));
}

void bind_motion(SimulationClass& simulation) {
  simulation
      .def("set_velocity", verb(py::overload_cast<ColliderId, const Vec3&>(&Simulation::set_velocity)),
           py::arg("collider"), py::arg("velocity"), doc("Simulation.set_velocity"))
      .def("set_velocity", verb(py::overload_cast<PinId, const Vec3&>(&Simulation::set_velocity)),
           py::arg("pin"), py::arg("velocity"), doc("Simulation.set_velocity#2"))
      .def("set_velocity",
           verb(py::overload_cast<BodyId, const Vec3&, const Vec3&>(&Simulation::set_velocity)),
           py::arg("body"), py::arg("velocity"), py::arg("angular_velocity") = k_zero,
           doc("Simulation.set_velocity#3"))
      .def("set_velocity",
           verb(py::overload_cast<std::span<const ParticleId>, const Vec3&>(&Simulation::set_velocity)),
           py::arg("ids"), py::arg("velocity"), doc("Simulation.set_velocity#4"))
      .def("set_position", verb(&Simulation::set_position), py::arg("body"), py::arg("center_of_mass"),
           doc("Simulation.set_position"))
      .def("add_impulse", verb(py::overload_cast<BodyId, const Vec3&>(&Simulation::add_impulse)),
           py::arg("body"), py::arg("impulse"), doc("Simulation.add_impulse"))
      .def("add_impulse", verb(py::overload_cast<const Vec3&, float, const Vec3&>(&Simulation::add_impulse)),
           py::arg("center"), py::arg("radius"), py::arg("impulse"), doc("Simulation.add_impulse#2"))
      .def("enable", verb(&Simulation::enable), py::arg("body"), py::arg("enabled"), doc("Simulation.enable"))
      .def("wake", verb(&Simulation::wake), py::arg("body"), doc("Simulation.wake"))
      .def("set_user_data", verb(&Simulation::set_user_data), py::arg("body"), py::arg("data"),
           doc("Simulation.set_user_data"));
  constexpr double k_never = std::numeric_limits<double>::infinity();
  simulation
      .def("report_contacts",
           verb(py::overload_cast<BodyId, std::optional<double>>(&Simulation::report_contacts)),
           py::arg("body"), py::arg("hit_impulse") = k_never, doc("Simulation.report_contacts#2"))
      .def("report_contacts", verb(py::overload_cast<std::optional<double>>(&Simulation::report_contacts)),
           py::arg("hit_impulse") = k_never, doc("Simulation.report_contacts"));
}

}  // namespace

void bind_changes(SimulationClass& simulation) {
  bind_bodies(simulation);
  bind_surroundings(simulation);
  bind_matter(simulation);
  bind_motion(simulation);
}

}  // namespace mallow::python
