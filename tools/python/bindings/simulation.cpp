#include "simulation.h"

#include <chrono>

#include "parts.h"

namespace mallow::python {
namespace {

/// Simulations are part of the collector's walk: a force callback mostly holds its simulation.
void collect_cycles(PyHeapTypeObject* heap_type) {
  PyTypeObject& type = heap_type->ht_type;
  type.tp_flags |= Py_TPFLAGS_HAVE_GC;
  type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    // One that is not made yet, or whose __init__ threw, holds nothing.
    const auto* const instance = reinterpret_cast<py::detail::instance*>(self);
    if (!instance->simple_layout || !instance->simple_holder_constructed) return 0;
    const auto& cell = py::cast<SimulationCell&>(py::handle(self));
    Py_VISIT(cell.force.ptr());
    return 0;
  };
  type.tp_clear = [](PyObject* self) {
    const auto* const instance = reinterpret_cast<py::detail::instance*>(self);
    if (!instance->simple_layout || !instance->simple_holder_constructed) return 0;
    auto& cell = py::cast<SimulationCell&>(py::handle(self));
    cell.force = py::none();
    return 0;
  };
}

/// What a force callback of Python is given, as views that keep their memory.
struct PythonForceInput {
  double time;
  py::array ids, positions, velocities;
};

void bind_force_input(py::module_& module) {
  py::class_<PythonForceInput>(module, "ForceInput", doc("ForceInput"))
      .def_readonly("time", &PythonForceInput::time, doc("ForceInput.time"))
      .def_readonly("ids", &PythonForceInput::ids, "The particle of each row.")
      .def_readonly("positions", &PythonForceInput::positions, doc("ForceInput.positions"))
      .def_readonly("velocities", &PythonForceInput::velocities, doc("ForceInput.velocities"));
}

/// Calls the function of a simulation, from within a step, which has given the GIL up.
void call_force(const SimulationCell& cell, const ForceInput& input, const VectorSpan& accelerations) {
  const py::gil_scoped_acquire acquire;
  if (cell.force.is_none()) return;
  const py::object function = cell.force;
  py::array adds = column_view(accelerations);
  const py::object result =
      function(PythonForceInput{input.time, column_view(input.ids), column_view(input.positions),
                                column_view(input.velocities)},
               adds);
  sealed(adds);
  if (!result.is_none())
    throw py::type_error(
        "a force callback returns None, and adds to the accelerations in place: accelerations += ...");
}

void set_force(SimulationCell& cell, const py::object& callback) {
  if (!callback.is_none() && !PyCallable_Check(callback.ptr()))
    throw py::type_error("a force callback is a function of (ForceInput, accelerations), or None");
  const Use use = changing(cell);
  // By address: the simulation stays where it is, and must not own what may own it.
  if (callback.is_none())
    cell.simulation.set_force({});
  else
    cell.simulation.set_force([&cell](const ForceInput& input, VectorSpan accelerations) {
      call_force(cell, input, accelerations);
    });
  cell.force = callback;
}

/// As Simulation::advance(), but that Ctrl-C ends it between two steps.
AdvanceReport advance(SimulationCell& cell, double seconds) {
  using Clock = std::chrono::steady_clock;
  const Use use = changing(cell);
  const py::gil_scoped_release release;
  Simulation& simulation = cell.simulation;
  AdvanceReport report;
  const double end = simulation.time() + seconds;
  if (!(seconds > 0) || !(end > simulation.time()) || end > std::numeric_limits<double>::max())
    return simulation.advance(seconds);  // which says what is wrong
  Clock::time_point looked = Clock::now();
  while (simulation.time() < end) {
    report.add(simulation.step_towards(end));
    if (Clock::now() - looked < std::chrono::milliseconds(100)) continue;
    looked = Clock::now();
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
  return report;
}

}  // namespace

void bind_steps(SimulationClass& simulation) {
  simulation.def("set_force", &set_force, py::arg("callback"), doc("Simulation.set_force"))
      .def("prepare", long_verb(&Simulation::prepare), doc("Simulation.prepare"))
      .def("step", long_verb(&Simulation::step), doc("Simulation.step"))
      .def("step_towards", long_verb(&Simulation::step_towards), py::arg("end"),
           doc("Simulation.step_towards"))
      .def("advance", &advance, py::arg("seconds"), doc("Simulation.advance"))
      .def("energy", long_verb(py::overload_cast<>(&Simulation::energy, py::const_)),
           doc("Simulation.energy"))
      .def("energy", long_verb(py::overload_cast<BodyId>(&Simulation::energy, py::const_)), py::arg("body"),
           doc("Simulation.energy#2"))
      .def("volume", long_verb(&Simulation::volume), py::arg("body"), doc("Simulation.volume"))
      .def("parts", long_verb(&Simulation::parts), py::arg("body"), doc("Simulation.parts"))
      .def("info", long_verb(&Simulation::info), doc("Simulation.info"))
      .def(
          "save",
          [](SimulationCell& cell) {
            const Use use = changing(cell);
            const py::gil_scoped_release release;
            return cell.simulation.save();
          },
          doc("Simulation.save"))
      .def_static(
          "restore",
          [](SavedState saved, int threads, std::shared_ptr<Executor> executor) {
            const py::gil_scoped_release release;
            return std::make_shared<SimulationCell>(Simulation::restore(saved, threads, std::move(executor)));
          },
          py::arg("saved"), py::arg("threads") = 0, py::arg("executor") = nullptr, doc("Simulation.restore"));
}

void bind_simulation(py::module_& module) {
  bind_force_input(module);
  SimulationClass simulation(module, "Simulation", doc("Simulation"), py::custom_type_setup(&collect_cycles));
  simulation.attr("Rows") = module.attr("Rows");
  py::delattr(module, "Rows");
  simulation
      .def(py::init([](const SolverConfig& config) {
             return std::make_shared<SimulationCell>(Simulation(config));
           }),
           py::arg_v("config", SolverConfig{}, "SolverConfig()"), doc("Simulation.__init__"))
      .def("__repr__", [](const SimulationCell& cell) {
        if (cell.in_use.depth > 0 && cell.in_use.by != std::this_thread::get_id())
          return std::string("Simulation(in use by another thread)");
        return "Simulation(" + std::to_string(cell.simulation.particle_count()) + " particles, " +
               std::to_string(cell.simulation.body_count()) + " bodies, step " +
               std::to_string(cell.simulation.step_count()) + ")";
      });
  bind_changes(simulation);
  bind_steps(simulation);
  bind_views(simulation);
}

}  // namespace mallow::python
