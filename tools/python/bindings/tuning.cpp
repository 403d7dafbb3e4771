#include "mallow/tuning.h"

#include <pybind11/functional.h>

#include <chrono>

#include "parts.h"
#include "simulation.h"
#include "structs.h"

/// What settings cost and how far off they are.
namespace mallow::python {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A MotionPlan whose functions are of Python.
struct Plan {
  int frames = MotionPlan{}.frames;
  double frame_time = MotionPlan{}.frame_time;
  int moments = MotionPlan{}.moments;
  py::list measures = py::list();
  py::object draw = py::none(), stop = py::none();
};

/// Runs a simulation that Python has: nobody else may use it meanwhile, but the plan's functions may, all of
/// it.
class Recorder {
 public:
  Recorder(std::shared_ptr<SimulationCell> cell, const Plan& plan)
      : cell_(std::move(cell)), self_(py::cast(cell_)), plan_(plan) {
    for (const py::handle measure : plan.measures)
      measures_.push_back(py::reinterpret_borrow<py::object>(measure));
    lock();
  }

 private:
  void lock() { use_.emplace(cell_->in_use, "the simulation", false); }
  /// Calls a function of Python, which may use the simulation as its own.
  template <class Call>
  auto ask(const Call& call) {
    const py::gil_scoped_acquire acquire;
    use_.reset();
    struct Again {
      Recorder& recorder;
      ~Again() noexcept(false) {
        if (std::uncaught_exceptions() == 0) recorder.lock();
      }
    } const again{*this};
    return call();
  }

 public:
  Motion record() {
    MotionPlan plan{.frames = plan_.frames, .frame_time = plan_.frame_time, .moments = plan_.moments};
    for (std::size_t m = 0; m < measures_.size(); ++m)
      plan.measures.emplace_back([this, m](Simulation&) {
        return ask(
            [&] { return convert<double>(measures_[m](self_), "what a measure returns", "a number"); });
      });
    if (!plan_.draw.is_none()) plan.draw = [this](const Simulation&) { ask([&] { plan_.draw(self_); }); };
    plan.stop = [this] { return must_stop(); };
    const py::gil_scoped_release release;
    return record_motion(cell_->simulation, plan);
  }

 private:
  bool must_stop() {
    if (!plan_.stop.is_none())
      return ask([&] { return convert<bool>(plan_.stop(), "what stop returns", "True or False"); });
    if (seconds_since(looked_) < 0.1) return false;
    looked_ = Clock::now();
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    return false;
  }

  std::shared_ptr<SimulationCell> cell_;
  py::object self_;
  Plan plan_;
  std::vector<py::object> measures_;
  std::optional<Use> use_;
  Clock::time_point looked_ = Clock::now();
};

Motion record_built(const py::function& build, const Plan& plan) {
  const Clock::time_point begin = Clock::now();
  std::shared_ptr<SimulationCell> cell;
  try {
    cell = convert<std::shared_ptr<SimulationCell>>(build(), "what build returns", "a Simulation");
    if (!cell) throw py::type_error("what build returns must be a Simulation, not None");
  } catch (const py::error_already_set& error) {
    if (!error.matches(py::module_::import("mallow").attr("Error"))) throw;
    return {.moments = {},
            .other_seconds = seconds_since(begin),
            .failure = py::str(error.value()).cast<std::string>()};
  }
  const double building = seconds_since(begin);
  Motion motion = Recorder(std::move(cell), plan).record();
  motion.other_seconds += building;
  return motion;
}

/// A function that tells where a point is seen, as two numbers or None.
PixelOf pixel_of(const py::object& function) {
  if (function.is_none()) return {};
  return [function](const Vec3& point) -> std::optional<Eigen::Vector2d> {
    const py::object seen = function(point);
    if (seen.is_none()) return std::nullopt;
    const auto [x, y] = convert<std::pair<double, double>>(seen, "what pixel returns", "two numbers or None");
    return Eigen::Vector2d(x, y);
  };
}

void bind_motions(py::module_& module) {
  Struct<MotionMoment>(module, "MotionMoment", Change::frozen)
      .field("particles", &MotionMoment::particles, "", "a ParticleFrame")
      .field("height", &MotionMoment::height)
      .field("spread", &MotionMoment::spread)
      .field("center", &MotionMoment::center, "", "three numbers")
      .field("volume", &MotionMoment::volume)
      .field("energy", &MotionMoment::energy)
      .field("kinetic_energy", &MotionMoment::kinetic_energy)
      .field("measures", &MotionMoment::measures, "", "a list of numbers")
      .done();
  Struct<Motion>(module, "Motion", Change::frozen)
      .field("moments", &Motion::moments, "", "a list of MotionMoment")
      .field("spacings", &Motion::spacings, "", "an array of numbers")
      .field("frame_seconds", &Motion::frame_seconds, "", "a list of numbers")
      .field("draw_seconds", &Motion::draw_seconds, "", "a list of numbers")
      .field("other_seconds", &Motion::other_seconds)
      .field("steps", &Motion::steps)
      .field("failure", &Motion::failure, "", "a text")
      .done()
      .def("seconds_per_frame", &Motion::seconds_per_frame, doc("Motion.seconds_per_frame"))
      .def("draw_seconds_per_frame", &Motion::draw_seconds_per_frame, doc("Motion.draw_seconds_per_frame"));
  Struct<Plan>(module, "MotionPlan", Change::live)
      .field("frames", &Plan::frames)
      .field("frame_time", &Plan::frame_time)
      .field("moments", &Plan::moments)
      .field("measures", &Plan::measures, "", "a list of functions of a Simulation that return a number")
      .field("draw", &Plan::draw, "", "a function of a Simulation, or None")
      .field("stop", &Plan::stop, "", "a function that returns True or False, or None")
      .done();
}

void bind_errors_of_motions(py::module_& module) {
  Struct<MotionError>(module, "MotionError", Change::frozen)
      .field("median", &MotionError::median)
      .field("rms", &MotionError::rms)
      .field("worst", &MotionError::worst)
      .field("worst_time", &MotionError::worst_time)
      .field("median_pixels", &MotionError::median_pixels)
      .field("worst_pixels", &MotionError::worst_pixels)
      .field("height", &MotionError::height)
      .field("spread", &MotionError::spread)
      .field("center", &MotionError::center)
      .field("volume", &MotionError::volume)
      .field("energy", &MotionError::energy)
      .field("measures", &MotionError::measures, "", "a list of numbers")
      .field("unmatched", &MotionError::unmatched)
      .done()
      .def("shape", &MotionError::shape, doc("MotionError.shape"));
  module.def(
      "record_motion",
      [](std::shared_ptr<SimulationCell> simulation, const Plan& plan) {
        return Recorder(std::move(simulation), plan).record();
      },
      py::arg("simulation").none(false), py::arg("plan"), doc("record_motion#2"));
  module.def("record_motion", &record_built, py::arg("build"), py::arg("plan"), doc("record_motion"));
  module.def(
      "motion_error",
      [](const Motion& motion, const Motion& reference, double from, const py::object& pixel) {
        return motion_error(motion, reference, from, pixel_of(pixel));
      },
      py::arg("motion"), py::arg("reference"), py::arg("from_") = 0.0, py::arg("pixel") = py::none(),
      doc("motion_error"));
}

void bind_picks(py::module_& module) {
  Struct<Trade>(module, "Trade", Change::frozen)
      .field("cost", &Trade::cost)
      .field("error", &Trade::error)
      .done();
  Struct<Pick>(module, "Pick", Change::frozen)
      .field("index", &Pick::index)
      .field("holds", &Pick::holds)
      .done();
  using Trades = std::vector<Trade>;
  module.def(
      "pareto_front", [](const Trades& trades) { return pareto_front(trades); }, py::arg("trades"),
      doc("pareto_front"));
  module.def(
      "pick_by_error", [](const Trades& trades, double error) { return pick_by_error(trades, error); },
      py::arg("trades"), py::arg("error"), doc("pick_by_error"));
  module.def(
      "pick_by_cost", [](const Trades& trades, double cost) { return pick_by_cost(trades, cost); },
      py::arg("trades"), py::arg("cost"), doc("pick_by_cost"));
  module.def(
      "convergence_order",
      [](const std::vector<double>& differences) { return convergence_order(differences); },
      py::arg("differences"), doc("convergence_order"));
}

}  // namespace

void bind_tuning(py::module_& module) {
  bind_motions(module);
  bind_errors_of_motions(module);
  bind_picks(module);
}

}  // namespace mallow::python
