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
  // A frame of a run knows its report.
  const fs::path report = fs::absolute(path).parent_path().parent_path() / "report.json";
  if (fs::absolute(path).parent_path().filename() == "particles" && fs::exists(report)) read_groups(report);
}

void ComparedStates::read_groups(const fs::path& file) {
  const nlohmann::ordered_json report = read_report(file);
  spacings_ = body_spacings(report, file);
  try {
    for (const auto& group : report.at("groups")) {
      names_.push_back(group.at("name").get<std::string>());
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
    const std::size_t slot = slot_of(bodies[b]), size = std::max(spacings_.size(), slot + 1);
    spacings_.resize(size, info.bodies[b].spacing);
    masses_.resize(size, 0);
    names_.resize(size);
    spacings_[slot] = info.bodies[b].spacing;
    masses_[slot] = static_cast<double>(info.bodies[b].particle_mass);
    names_[slot] = info.bodies[b].name;
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

std::string ComparedStates::body_name(std::uint32_t body) const {
  return body < names_.size() && !names_[body].empty() ? names_[body] : std::to_string(body);
}

}  // namespace mallow::program
