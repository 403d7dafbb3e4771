#include "program/compared_states.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "mallow/errors.h"
#include "mallow/simulation.h"
#include "program/run_report.h"

namespace mallow::program {
namespace fs = std::filesystem;

ComparedStates::ComparedStates(const fs::path& path) : path_(path) {
  if (fs::is_directory(path)) {
    cache_ = Cache::open(path, Cache::Access::read);
    frames_ = cache_->particle_frames();
    read_groups(cache_->report_file());
    return;
  }
  frames_ = {0};
  if (!fs::exists(path)) throw IoError({path.string(), 0, 0, "", "is not there"});
  if (path.extension() != ".ply") {
    read_checkpoint_state();
    return;
  }
  state_ = read_particles(path);
  // A frame of a run knows its report, and shows who had the slots then.
  const fs::path report = fs::absolute(path).parent_path().parent_path() / "report.json";
  if (fs::absolute(path).parent_path().filename() == "particles" && fs::exists(report)) {
    read_groups(report);
    const int frame = std::max(frame_number(path, "ply"), 0);
    masses_ = masses(frame);
    bodies_ = bodies(frame);
    past_.clear();
  }
}

void ComparedStates::read_groups(const fs::path& file) {
  const nlohmann::ordered_json report = read_report(file);
  past_ = past_bodies(report, file);
  try {
    for (const auto& group : report.at("groups")) {
      bodies_.push_back(
          {.name = group.at("name").get<std::string>(), .spacing = group.at("spacing").get<float>()});
      // What is gone when a run goes on has none any more.
      masses_.push_back(group.value("particle_mass", 0.0));
    }
  } catch (const nlohmann::ordered_json::exception& error) {
    throw IoError({file.string(), 0, 0, "groups", error.what()});
  }
}

void ComparedStates::read_checkpoint_state() try {
  Simulation simulation = Simulation::restore(read_checkpoint(path_));
  state_ = snapshot(simulation);
  const SimulationInfo info = simulation.info();
  const std::vector<BodyId> bodies = simulation.bodies();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::size_t slot = slot_of(bodies[b]), size = std::max(bodies_.size(), slot + 1);
    bodies_.resize(size, {.spacing = info.bodies[b].spacing});
    masses_.resize(size, 0);
    bodies_[slot] = {.name = info.bodies[b].name, .spacing = info.bodies[b].spacing};
    masses_[slot] = static_cast<double>(info.bodies[b].particle_mass);
  }
} catch (const IoError& error) {
  throw IoError(
      {path_.string(), 0, 0, "",
       std::string("cannot be compared: allowed are the folder of a run, a checkpoint and a frame of "
                   "particles (.ply); as a checkpoint: ") +
           error.what()});
} catch (const ConfigError& error) {
  throw IoError({path_.string(), 0, 0, "", error.what()});
}

ParticleFrame ComparedStates::particles(int frame) const {
  return cache_ ? read_particles(cache_->particles_file(frame)) : state_;
}

std::optional<Mesh> ComparedStates::surface(int frame) const {
  if (!cache_ || !fs::exists(cache_->surface_file(frame))) return std::nullopt;
  return read_mesh(cache_->surface_file(frame));
}

Scene ComparedStates::scene() const {
  constexpr SceneReadOptions k_anywhere{.allow_outside_paths = true};
  return cache_ ? read_scene(cache_->scene_file(), {}, k_anywhere) : Scene{};
}

std::vector<fs::path> ComparedStates::files() const {
  if (!cache_) return {path_};
  std::vector<fs::path> files = {cache_->scene_file(), cache_->report_file()};
  for (const int frame : frames_) {
    files.push_back(cache_->particles_file(frame));
    files.push_back(cache_->surface_file(frame));
  }
  return files;
}

void ComparedStates::take_bodies(const ComparedStates& other) {
  bodies_ = other.bodies_;
  past_ = other.past_;
}

void ComparedStates::set_spacing(std::size_t bodies, float spacing) {
  bodies_.resize(std::max(bodies_.size(), bodies));
  for (SlotBody& body : bodies_) body.spacing = spacing;
  for (PastBody& body : past_) body.body.spacing = spacing;
}

std::vector<double> ComparedStates::masses(int frame) const {
  std::vector<double> masses = masses_;
  // Reports do not tell those of bodies that had a slot before.
  const std::vector<std::uint32_t> numbers = slot_numbers_at(frame, masses.size(), past_);
  for (std::size_t slot = 0; slot < masses.size(); ++slot)
    if (numbers[slot] != slot) masses[slot] = 0;
  return masses;
}

std::string ComparedStates::body_name(std::uint32_t body, int frame) const {
  const std::vector<SlotBody> now = bodies(frame);
  return body < now.size() && !now[body].name.empty() ? now[body].name : std::to_string(body);
}

}  // namespace mallow::program
