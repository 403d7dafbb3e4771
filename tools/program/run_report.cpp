#include "program/run_report.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <system_error>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "mallow/version.h"
#include "program/loads.h"
#include "program/machine.h"

namespace mallow::program {
namespace {

nlohmann::ordered_json groups_json(const RunReport& report) {
  nlohmann::ordered_json groups = nlohmann::ordered_json::array();
  for (const BodyInfo& body : report.info.bodies)
    groups.push_back({{"name", body.name},
                      {"material", body.material},
                      {"particles", body.particles},
                      {"spacing", body.spacing},
                      {"particle_mass", body.particle_mass},
                      {"rest_density", body.rest_density},
                      {"region_radius", body.region_radius},
                      {"update_threshold", body.update_threshold},
                      {"pressure_coefficient", body.pressure_coefficient},
                      {"viscosity", body.viscosity},
                      {"average_neighbors", body.average_neighbors},
                      {"regions", body.regions},
                      {"shape_matching", body.shape_matching}});
  for (std::size_t b = 0; b < std::min(groups.size(), report.appearances.size()); ++b) {
    const Vec3& color = report.appearances[b].color;
    groups[b]["color"] = {color.x(), color.y(), color.z()};
  }
  return groups;
}

const char* source_name(TimeStepSource source) {
  switch (source) {
    case TimeStepSource::given:
      return "given";
    case TimeStepSource::gravity:
      return "gravity";
    case TimeStepSource::speed:
      return "speed";
    case TimeStepSource::modulus:
      return "modulus";
  }
  return "";
}

nlohmann::ordered_json updates_json(const RunReport& report) {
  nlohmann::ordered_json updates = nlohmann::ordered_json::array();
  for (const auto& update : report.reference_updates)
    updates.push_back({{"step", update.step}, {"groups", update.groups}});
  return updates;
}

nlohmann::ordered_json events_json(const RunReport& report) {
  return {{"yielded", report.events.yielded},
          {"torn", report.events.torn},
          {"merged", report.events.merged},
          {"merged_bodies", report.events.merged_bodies},
          {"split", report.events.split}};
}

nlohmann::ordered_json sinks_json(const RunReport& report) {
  nlohmann::ordered_json sinks = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < report.sink_drained.size(); ++k)
    sinks.push_back({{"name", sink_name(k)}, {"drained", report.sink_drained[k]}});
  return sinks;
}

nlohmann::ordered_json past_bodies_json(const RunReport& report) {
  nlohmann::ordered_json past = nlohmann::ordered_json::array();
  for (const PastBody& body : report.past_bodies)
    past.push_back({{"slot", body.slot},
                    {"until", body.until},
                    {"name", body.body.name},
                    {"material", body.body.material},
                    {"spacing", body.body.spacing}});
  return past;
}

/// As a checkpoint keeps them.
nlohmann::ordered_json kept_bodies(const std::vector<BodyInfo>& bodies) {
  nlohmann::ordered_json kept = nlohmann::ordered_json::array();
  for (const BodyInfo& body : bodies)
    kept.push_back({{"name", body.name}, {"material", body.material}, {"spacing", body.spacing}});
  return kept;
}

SlotBody slot_body_from(const nlohmann::ordered_json& body) {
  return {.name = body.at("name").get<std::string>(),
          .material = body.at("material").get<std::string>(),
          .spacing = body.at("spacing").get<float>()};
}

std::vector<PastBody> past_bodies_from(const nlohmann::ordered_json& all) {
  std::vector<PastBody> past;
  for (const auto& body : all)
    past.push_back({.slot = body.at("slot").get<std::size_t>(),
                    .until = body.at("until").get<int>(),
                    .body = slot_body_from(body)});
  return past;
}

nlohmann::ordered_json compression_json(const RunReport& report) {
  return {{"mean", report.compression.mean}, {"largest", report.compression.largest}};
}

nlohmann::ordered_json loads_json(const RunReport& report) {
  nlohmann::ordered_json loads = nlohmann::ordered_json::array();
  const double seconds = report.simulated_time;
  const auto mean = [&](const Eigen::Vector3d& sum) {
    return to_json(seconds > 0 ? Eigen::Vector3d(sum / seconds) : Eigen::Vector3d(0, 0, 0));
  };
  for (const RunReport::Load& load : report.loads)
    loads.push_back({{"collider", load.collider},
                     {"mean_force", mean(load.sum.impulse)},
                     {"mean_torque", mean(load.sum.torque)},
                     {"largest_force", load.largest_force},
                     {"largest_torque", load.largest_torque}});
  return loads;
}

/// As a checkpoint keeps them.
nlohmann::ordered_json kept_loads(const std::vector<RunReport::Load>& loads) {
  nlohmann::ordered_json kept = nlohmann::ordered_json::array();
  for (const RunReport::Load& load : loads)
    kept.push_back({{"collider", load.collider},
                    {"sum", to_json(load.sum)},
                    {"largest_force", load.largest_force},
                    {"largest_torque", load.largest_torque}});
  return kept;
}

std::vector<RunReport::Load> loads_from(const nlohmann::ordered_json& kept) {
  std::vector<RunReport::Load> loads;
  for (const auto& load : kept)
    loads.push_back({.collider = load.at("collider").get<std::size_t>(),
                     .sum = load_from_json(load.at("sum")),
                     .largest_force = load.at("largest_force").get<double>(),
                     .largest_torque = load.at("largest_torque").get<double>()});
  return loads;
}

nlohmann::ordered_json phases_json(const RunReport& report) {
  nlohmann::ordered_json phases = nlohmann::ordered_json::array();
  const double steps = static_cast<double>(std::max<std::int64_t>(report.steps, 1));
  for (std::size_t i = 0; i < k_phase_count; ++i) {
    phases.push_back({{"name", name(static_cast<Phase>(i))},
                      {"seconds", report.phase_seconds[i]},
                      {"ms_per_step", 1000 * report.phase_seconds[i] / steps}});
  }
  return phases;
}

nlohmann::ordered_json stages_json(const RunReport& report) {
  nlohmann::ordered_json stages;
  for (std::size_t i = 0; i < k_stage_count; ++i)
    stages[name(static_cast<Stage>(i))] = report.stage_seconds[i];
  return stages;
}

}  // namespace

std::string sink_name(std::size_t number) {
  return "sink[" + std::to_string(number) + ']';
}

const char* name(Stage stage) {
  static constexpr std::array<const char*, k_stage_count> k_names = {"build",   "motion",   "particles",
                                                                     "surface", "pictures", "film"};
  return k_names[static_cast<std::size_t>(stage)];
}

void RunReport::add_loads(double time_step, const Simulation& simulation) {
  const std::vector<ColliderId> ids = simulation.collider_ids();
  std::size_t count = 0;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    if (!simulation.collider(ids[k]).measure_load) continue;
    if (count == loads.size()) loads.push_back({.collider = k});
    Load& of = loads[count++];
    const ColliderLoad load = simulation.load(ids[k]);
    program::add(load, of.sum);
    of.largest_force = std::max(of.largest_force, load.impulse.norm() / time_step);
    of.largest_torque = std::max(of.largest_torque, load.torque.norm() / time_step);
  }
}

void RunReport::add(const StepReport& step, const Simulation& simulation) {
  ++steps;
  smallest_step = steps == 1 ? step.time_step : std::min(smallest_step, step.time_step);
  largest_step = std::max(largest_step, step.time_step);
  if (step.limited) ++limited_steps;
  if (step.updated_references > 0) reference_updates.push_back({steps, step.updated_references});
  for (std::size_t i = 0; i < k_phase_count; ++i) phase_seconds[i] += step.seconds[i];
  add_loads(step.time_step, simulation);
  for (const BodyEvent& event : simulation.events()) {
    if (event.kind == BodyEvent::Kind::yielded) ++events.yielded;
    if (event.kind == BodyEvent::Kind::torn) ++events.torn;
    if (event.kind == BodyEvent::Kind::merged) ++events.merged;
    if (event.kind == BodyEvent::Kind::merged && event.other) ++events.merged_bodies;
    if (event.kind == BodyEvent::Kind::split) ++events.split;
  }
  compression.mean = std::max(compression.mean, step.mean_compression);
  compression.largest = std::max(compression.largest, step.largest_compression);
}

std::int64_t RunReport::drained() const {
  return std::accumulate(sink_drained.begin(), sink_drained.end(), std::int64_t{0});
}

nlohmann::ordered_json RunReport::progress() const {
  return {{"scene", scene},
          {"overrides", overrides},
          {"quality", quality},
          {"frames", frames},
          {"steps", steps},
          {"smallest_step", smallest_step},
          {"largest_step", largest_step},
          {"limited_steps", limited_steps},
          {"reference_updates", updates_json(*this)},
          {"events", events_json(*this)},
          {"bodies", kept_bodies(info.bodies)},
          {"past_bodies", past_bodies_json(*this)},
          {"compression", compression_json(*this)},
          {"loads", kept_loads(loads)},
          {"resumed_after", resumed_after},
          {"phase_seconds", phase_seconds},
          {"stage_seconds", stage_seconds}};
}

void RunReport::set_progress(const nlohmann::ordered_json& progress) {
  progress.at("scene").get_to(scene);
  progress.at("overrides").get_to(overrides);
  progress.at("quality").get_to(quality);
  progress.at("frames").get_to(frames);
  progress.at("steps").get_to(steps);
  progress.at("smallest_step").get_to(smallest_step);
  progress.at("largest_step").get_to(largest_step);
  progress.at("limited_steps").get_to(limited_steps);
  reference_updates.clear();
  for (const auto& update : progress.at("reference_updates"))
    reference_updates.push_back({update.at("step").get<std::int64_t>(), update.at("groups").get<int>()});
  // Checkpoints of earlier versions lack some of these.
  if (const auto counts = progress.find("events"); counts != progress.end()) {
    counts->at("yielded").get_to(events.yielded);
    counts->at("torn").get_to(events.torn);
    counts->at("merged").get_to(events.merged);
    events.merged_bodies = counts->value("merged_bodies", std::int64_t{0});
    events.split = counts->value("split", std::int64_t{0});
  }
  if (const auto found = progress.find("bodies"); found != progress.end())
    for (const auto& body : *found) {
      const SlotBody kept = slot_body_from(body);
      info.bodies.push_back({.name = kept.name, .material = kept.material, .spacing = kept.spacing});
    }
  if (const auto found = progress.find("past_bodies"); found != progress.end())
    past_bodies = past_bodies_from(*found);
  if (const auto found = progress.find("compression"); found != progress.end()) {
    found->at("mean").get_to(compression.mean);
    found->at("largest").get_to(compression.largest);
  }
  if (const auto found = progress.find("loads"); found != progress.end()) loads = loads_from(*found);
  progress.at("resumed_after").get_to(resumed_after);
  progress.at("phase_seconds").get_to(phase_seconds);
  progress.at("stage_seconds").get_to(stage_seconds);
}

nlohmann::ordered_json to_json(const RunReport& report) {
  const double mean_step = report.steps > 0 ? report.simulated_time / static_cast<double>(report.steps) : 0;
  return {{"version", version()},
          {"scene", report.scene},
          {"overrides", report.overrides},
          {"quality", report.quality},
          {"complete", report.complete},
          {"error", report.error},
          {"machine", machine_json()},
          {"threads", report.threads},
          {"particles", report.info.particles},
          {"groups", groups_json(report)},
          {"settings",
           {{"time_step", report.info.time_step},
            {"time_step_source", source_name(report.info.time_step_source)},
            {"longest_step", report.info.longest_step},
            {"update_period", report.info.update_period},
            {"volume_iterations", report.info.volume_iterations}}},
          {"warnings", report.info.warnings},
          {"sph", report.info.sph},
          {"viscosity", report.info.viscosity},
          {"cross_group", report.info.cross_group},
          {"instruction_level", name(report.info.instruction_level)},
          {"bytes", report.info.bytes},
          {"frames", report.frames},
          {"frame_time", report.frame_time},
          {"steps", report.steps},
          {"simulated_time", report.simulated_time},
          {"time_step",
           {{"smallest", report.smallest_step},
            {"mean", mean_step},
            {"largest", report.largest_step},
            {"limited_steps", report.limited_steps}}},
          {"reference_updates", updates_json(report)},
          {"events", events_json(report)},
          {"drained", report.drained()},
          {"sinks", sinks_json(report)},
          {"past_bodies", past_bodies_json(report)},
          {"compression", compression_json(report)},
          {"loads", loads_json(report)},
          {"resumed_after", report.resumed_after},
          {"phases", phases_json(report)},
          {"stage_seconds", stages_json(report)},
          {"state_hash", hash_text(report.state_hash)}};
}

std::string hash_text(std::uint64_t hash) {
  char text[24];
  std::snprintf(text, sizeof text, "0x%016llx", static_cast<unsigned long long>(hash));
  return text;
}

nlohmann::ordered_json read_report(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw IoError({file.string(), 0, 0, "", "cannot be read"});
  // A report has 4 levels, and as a rule some kilobytes; it is written again by recursion.
  constexpr int k_most_levels = 16;
  constexpr std::uintmax_t k_most_bytes = std::uintmax_t{256} << 20;
  std::error_code unknown_size;
  if (std::filesystem::file_size(file, unknown_size) > k_most_bytes && !unknown_size)
    throw IoError({file.string(), 0, 0, "", "is too large for a report: at most 256 MiB are allowed"});
  const auto limit = [&](int depth, nlohmann::ordered_json::parse_event_t, nlohmann::ordered_json&) {
    if (depth > k_most_levels)
      throw IoError({file.string(), 0, 0, "", "is nested too deeply: at most 16 levels are allowed"});
    return true;
  };
  try {
    return nlohmann::ordered_json::parse(stream, limit);
  } catch (const nlohmann::ordered_json::exception& error) {
    throw IoError({file.string(), 0, 0, "", error.what()});
  }
}

void write_report(const std::filesystem::path& file, const nlohmann::ordered_json& report) {
  write_whole(file, report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

bool is_report(std::string_view beginning) {
  const std::size_t second = beginning.find(",\n");
  return beginning.starts_with("{\n  \"version\": ") && second != beginning.npos &&
         beginning.substr(second).starts_with(",\n  \"scene\": ");
}

std::vector<SlotBody> slot_bodies(const nlohmann::ordered_json& report, const std::filesystem::path& file) {
  std::vector<SlotBody> bodies;
  try {
    for (const auto& group : report.at("groups")) bodies.push_back(slot_body_from(group));
  } catch (const nlohmann::ordered_json::exception& error) {
    throw IoError({file.string(), 0, 0, "groups", error.what()});
  }
  return bodies;
}

std::vector<PastBody> past_bodies(const nlohmann::ordered_json& report, const std::filesystem::path& file) {
  const auto found = report.find("past_bodies");
  if (found == report.end()) return {};
  try {
    return past_bodies_from(*found);
  } catch (const nlohmann::ordered_json::exception& error) {
    throw IoError({file.string(), 0, 0, "past_bodies", error.what()});
  }
}

}  // namespace mallow::program
