#include "program/series.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "program/csv.h"
#include "program/loads.h"
#include "program/units.h"

namespace mallow::program {
namespace fs = std::filesystem;
namespace {

/// More would be a table that nobody reads.
constexpr std::size_t k_most_described = 32;

/// A line of a CSV.
class Line {
 public:
  void add(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", value);
    add(std::string(text));
  }
  void add(std::size_t value) { add(std::to_string(value)); }
  void add(const Eigen::Vector3d& value) {
    for (int axis = 0; axis < 3; ++axis) add(value[axis]);
  }
  /// As it is, in quotes where a comma or the like asks for them.
  void add(const std::string& cell) { add_separated(csv_cell(cell)); }
  std::string text() const { return text_ + '\n'; }
  /// The cells of another line.
  void add(const Line& other) {
    if (!other.is_empty_) add_separated(other.text_);
  }

 private:
  void add_separated(const std::string& text) {
    if (!is_empty_) text_ += ',';
    is_empty_ = false;
    text_ += text;
  }

  std::string text_;
  bool is_empty_ = true;
};

/// Particles that a nozzle holds, by row.
std::vector<bool> held_rows(const Simulation& simulation) {
  std::vector<bool> held(simulation.particle_count(), false);
  for (const EmitterId emitter : simulation.emitter_ids())
    for (const ParticleId id : simulation.held(emitter)) held[simulation.row(id)] = true;
  return held;
}

/// Of particles that no nozzle holds.
struct Free {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  std::size_t particles = 0;

  double height() const { return particles > 0 ? high.z() - low.z() : 0; }
  double top() const { return particles > 0 ? high.z() : 0; }
};

Free free_of(const Simulation& simulation, const Simulation::Rows& rows, const std::vector<bool>& held) {
  const VectorView positions = simulation.positions();
  Free free;
  for (std::size_t row = rows.begin; row < rows.end; ++row) {
    if (held[row]) continue;
    const Eigen::Vector3d x = positions[row].cast<double>();
    free.low = free.low.cwiseMin(x);
    free.high = free.high.cwiseMax(x);
    ++free.particles;
  }
  return free;
}

/// What a row says of a body.
struct BodyNow {
  Simulation::Rows rows;
  Free free;
  BodyMotion motion;
  BodyParts parts;
};

/// What a set of bodies has in sum.
struct Sums {
  Free free;
  std::size_t awake = 0, parts = 0, crumbs = 0;
  double volume = 0;
  Eigen::Vector3d momentum{0, 0, 0};

  void add(const BodyNow& body) {
    free.low = free.low.cwiseMin(body.free.low);
    free.high = free.high.cwiseMax(body.free.high);
    free.particles += body.free.particles;
    parts += body.parts.parts;
    crumbs += body.parts.crumbs;
    momentum += body.motion.momentum;
  }
  Eigen::Vector3d extent() const {
    return free.particles > 0 ? Eigen::Vector3d(free.high - free.low) : Eigen::Vector3d(0, 0, 0);
  }
};

/// Least, mean and most of some particles; empty cells where there are none.
void add_temperatures(const Simulation& simulation, const Simulation::Rows& rows, Line& line) {
  const std::span<const float> all = simulation.temperatures();
  if (rows.begin == rows.end || all.size() < rows.end) {
    for (int cell = 0; cell < 3; ++cell) line.add(std::string());
    return;
  }
  const std::span<const float> own = all.subspan(rows.begin, rows.end - rows.begin);
  line.add(static_cast<double>(std::ranges::min(own)));
  line.add(std::accumulate(own.begin(), own.end(), 0.0) / static_cast<double>(own.size()));
  line.add(static_cast<double>(std::ranges::max(own)));
}

/// The columns of a body; empty cells where it is gone.
void add_body(const BodyNow* body, Line& line) {
  if (!body) {
    for (int cell = 0; cell < 7; ++cell) line.add(std::string());
    return;
  }
  line.add(body->free.height());
  line.add(body->free.top());
  line.add(body->motion.center_of_mass);
  line.add(body->motion.kinetic_energy);
  line.add(body->parts.parts);
}

std::vector<ColliderId> measured_colliders(const Simulation& simulation) {
  std::vector<ColliderId> ids = simulation.collider_ids();
  std::erase_if(ids, [&](ColliderId id) { return !simulation.collider(id).measure_load; });
  return ids;
}

nlohmann::json saved_state(const std::string& text) {
  return nlohmann::json::parse(text);
}

fs::path file_of(const nlohmann::json& state, const fs::path& now) {
  return now.empty() ? fs::path(state.at("file").get<std::string>()) : now;
}

}  // namespace

Series::Series(const fs::path& file, Simulation& simulation)
    : file_(file),
      has_units_(!has_own_units(simulation.config())),
      colliders_(measured_colliders(simulation)) {
  for (const BodyId id : simulation.bodies())
    bodies_.push_back(
        {.id = id,
         .name = simulation.name(id),
         .is_heated = simulation.material_settings(simulation.material(id)).temperature.has_value()});
  row_time_ = simulation.time();
  loads_.resize(colliders_.size());
  file_.add(header());
}

Series::Series(const std::string& text, const fs::path& file, Simulation& simulation)
    : file_(file_of(saved_state(text), file), saved_state(text).at("bytes").get<std::uint64_t>(),
            saved_state(text).at("hash").get<std::uint64_t>()),
      colliders_(measured_colliders(simulation)) {
  const nlohmann::json state = saved_state(text);
  for (const auto& body : state.at("bodies"))
    bodies_.push_back({.id = BodyId{body.at("id").get<std::uint64_t>()},
                       .name = body.at("name").get<std::string>(),
                       .is_heated = body.at("is_heated").get<bool>()});
  state.at("row_time").get_to(row_time_);
  state.at("largest_compression").get_to(largest_compression_);
  state.at("mean_compression").get_to(mean_compression_);
  for (const auto& sum : state.at("loads")) loads_.push_back(load_from_json(nlohmann::ordered_json(sum)));
  loads_.resize(colliders_.size());
}

bool Series::has_body_columns() const {
  return bodies_.size() > 1 && bodies_.size() <= k_most_described;
}
bool Series::has_collider_columns() const {
  return colliders_.size() <= k_most_described;
}

bool Series::has_temperatures(const Body& body) const {
  return body.is_heated && bodies_.size() <= k_most_described;
}

std::string Series::header() const {
  Line line;
  const auto of_units = [&](const std::string& name) {
    return has_units_ ? name : name.substr(0, name.find(" ["));
  };
  for (const char* name : {"frame",
                           "time [s]",
                           "steps",
                           "particles",
                           "height [m]",
                           "top [m]",
                           "extent_x [m]",
                           "extent_y [m]",
                           "volume [m3]",
                           "kinetic_energy [J]",
                           "elastic_energy [J]",
                           "conserved_energy [J]",
                           "momentum_x [N s]",
                           "momentum_y [N s]",
                           "momentum_z [N s]",
                           "parts",
                           "crumbs",
                           "awake_bodies",
                           "largest_compression",
                           "mean_compression"})
    line.add(of_units(name));
  if (has_collider_columns())
    for (std::size_t k = 0; k < colliders_.size(); ++k)
      for (const auto& [what, unit] : {std::pair{".force_", " [N]"}, std::pair{".torque_", " [N m]"}})
        for (const char axis : {'x', 'y', 'z'})
          line.add("collider[" + std::to_string(k) + ']' + what + axis + of_units(unit));
  if (has_body_columns())
    for (const Body& body : bodies_)
      for (const char* name :
           {"height [m]", "top [m]", "x [m]", "y [m]", "z [m]", "kinetic_energy [J]", "parts"})
        line.add(body.name + '.' + of_units(name));
  for (const Body& body : bodies_)
    if (has_temperatures(body))
      for (const char* name : {"temperature_min [K]", "temperature_mean [K]", "temperature_max [K]"})
        line.add(body.name + '.' + of_units(name));
  return line.text();
}

void Series::add_step(const StepReport& step, const Simulation& simulation) {
  largest_compression_ = std::max(largest_compression_, step.largest_compression);
  mean_compression_ = step.mean_compression;
  for (std::size_t k = 0; k < colliders_.size(); ++k) add(simulation.load(colliders_[k]), loads_[k]);
}

void Series::add_row(int frame, Simulation& simulation, const std::optional<double>& volume_of_surface) {
  const std::vector<bool> held = held_rows(simulation);
  std::map<BodyId, BodyNow> bodies;
  Sums sums;
  for (const BodyId id : simulation.bodies()) {
    const Simulation::Rows rows = simulation.rows(id);
    const BodyNow& now =
        bodies[id] = {rows, free_of(simulation, rows, held), simulation.motion(id), simulation.parts(id)};
    sums.add(now);
    sums.awake += simulation.is_awake(id) ? 1 : 0;
    if (!volume_of_surface) sums.volume += simulation.volume(id);
  }
  Line of_bodies, of_heat;
  for (const Body& body : bodies_) {
    const auto now = bodies.find(body.id);
    const bool is_there = now != bodies.end();
    if (has_temperatures(body))
      add_temperatures(simulation, is_there ? now->second.rows : Simulation::Rows{}, of_heat);
    if (has_body_columns()) add_body(is_there ? &now->second : nullptr, of_bodies);
  }
  const Energy energy = simulation.particle_count() > 0 ? simulation.energy() : Energy{};
  Line line;
  line.add(static_cast<std::size_t>(frame));
  line.add(simulation.time());
  line.add(static_cast<std::size_t>(simulation.step_count()));
  line.add(sums.free.particles);
  line.add(sums.extent().z());
  line.add(sums.free.top());
  line.add(sums.extent().x());
  line.add(sums.extent().y());
  line.add(volume_of_surface.value_or(sums.volume));
  line.add(energy.kinetic);
  line.add(energy.elastic);
  line.add(energy.conserved);
  line.add(sums.momentum);
  line.add(sums.parts);
  line.add(sums.crumbs);
  line.add(sums.awake);
  line.add(largest_compression_);
  line.add(mean_compression_);
  const double seconds = simulation.time() - row_time_;
  if (has_collider_columns())
    for (const ColliderLoad& load : loads_)
      for (const Eigen::Vector3d& sum : {load.impulse, load.torque})
        line.add(seconds > 0 ? Eigen::Vector3d(sum / seconds) : Eigen::Vector3d(0, 0, 0));
  line.add(of_bodies);
  line.add(of_heat);
  file_.add(line.text());
  row_time_ = simulation.time();
  largest_compression_ = 0;
  std::ranges::fill(loads_, ColliderLoad{});
}

std::string Series::saved() const {
  file_.sync();
  nlohmann::json bodies = nlohmann::json::array(), loads = nlohmann::json::array();
  for (const Body& body : bodies_)
    bodies.push_back(
        {{"id", static_cast<std::uint64_t>(body.id)}, {"name", body.name}, {"is_heated", body.is_heated}});
  for (const ColliderLoad& load : loads_) loads.push_back(nlohmann::json(to_json(load)));
  const nlohmann::json state = {{"file", fs::absolute(file_.file()).string()},
                                {"bytes", file_.size()},
                                {"hash", file_.hash()},
                                {"bodies", bodies},
                                {"row_time", row_time_},
                                {"largest_compression", largest_compression_},
                                {"mean_compression", mean_compression_},
                                {"loads", loads}};
  return state.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

bool is_series(std::string_view beginning) {
  return beginning.starts_with("frame,time [s],steps,particles,height [m],top [m]") ||
         beginning.starts_with("frame,time,steps,particles,height,top,");
}

const char* series_help() {
  return "Columns of --series, a row for frame 0 and each frame after it, units in the header:\n"
         "frame, time, steps;\n"
         "particles: that no nozzle holds any more;\n"
         "height, top, extent_x, extent_y: of the box around their centres; top is its largest z;\n"
         "volume: that the surface encloses where one is drawn (--out without --no-surface), else of all\n"
         "  particles: mass over density where SPH runs, one less dense than at rest as at rest; where only\n"
         "  shapes are matched, as its regions are stretched against their rest shapes;\n"
         "kinetic_energy, elastic_energy, conserved_energy (what elastic bodies keep), without pinned "
         "particles;\n"
         "momentum_x, _y, _z: of all particles;\n"
         "parts: pieces that shape matching holds together now, of four particles or more, in all bodies "
         "that\n"
         "  are there; crumbs: smaller pieces;\n"
         "  what splits off a body counts in all sums and has no columns of its own;\n"
         "awake_bodies: that do not sleep;\n"
         "largest_compression: of a particle in any step since the row before; mean_compression: over all\n"
         "  particles in the last step; both where solver.volume_iterations run, else 0;\n"
         "collider[0].force_x, _y, _z, .torque_x, _y, _z: on each of up to 32 colliders, mean since the row\n"
         "  before; torques are about where its pose is, the origin of its shape;\n"
         "NAME.height, .top, .x, .y, .z (centre of mass), .kinetic_energy, .parts: of each body where there\n"
         "  are 2 to 32, NAME as its group or body[9]; empty once a body is gone; those above are of all "
         "matter;\n"
         "NAME.temperature_min, _mean, _max: of the particles of each body that carries heat, up to 32.\n"
         "Where gravity is no planet's in m/s2 units are the scene's own, and the header names none.";
}

}  // namespace mallow::program
