#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mallow/appearance.h"
#include "mallow/report.h"
#include "mallow/scene.h"
#include "mallow/simulation.h"

namespace mallow::program {

/// The parts of a run, in the order in which a frame passes them.
enum class Stage { build, motion, particles, surface, pictures, film };
inline constexpr std::size_t k_stage_count = 6;
const char* name(Stage stage);
using StageTimes = std::array<double, k_stage_count>;  ///< wall time [s]

/// Adds the time of a scope to a stage.
class StageTimer {
 public:
  StageTimer(StageTimes& times, Stage stage) : seconds_(times[static_cast<std::size_t>(stage)]) {}
  ~StageTimer() { seconds_ += std::chrono::duration<double>(Clock::now() - started_).count(); }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point started_ = Clock::now();
};

/// What frames say of a body by its slot alone.
struct SlotBody {
  std::string name = {}, material = {};
  float spacing = 0;  ///< h [m]
  bool operator==(const SlotBody&) const = default;
};
/// A body whose slot another one has by now.
struct PastBody {
  std::size_t slot = 0;
  int until = 0;  ///< the first frame in which it is the other one's
  SlotBody body = {};
};

/// What a run did: report.json.
struct RunReport {
  std::string scene;
  std::vector<std::string> overrides;
  std::string quality;  ///< empty: as the scene says
  int threads = 0;
  SimulationInfo info;
  std::vector<Appearance> appearances;  ///< of each body of `info`, for other programs; or none

  bool complete = false;
  std::string error;      ///< why the run ended early; empty where it did not
  int frames = 0;         ///< frames of the film after frame 0
  double frame_time = 0;  ///< simulated time from one to the next [s]
  std::int64_t steps = 0;
  double simulated_time = 0;  ///< [s]
  double smallest_step = 0;   ///< Δt [s]
  double largest_step = 0;
  std::int64_t limited_steps = 0;  ///< steps that a limit kept below Δt0
  struct ReferenceUpdate {
    std::int64_t step;  ///< counted from 1
    int groups;
  };
  std::vector<ReferenceUpdate> reference_updates;
  /// How often bodies did what BodyEvent tells, all together.
  struct Events {
    std::int64_t yielded = 0, torn = 0;
    std::int64_t merged = 0;         ///< parts that became one with others, of one body or of two
    std::int64_t merged_bodies = 0;  ///< of these: whole bodies, which are no more
    std::int64_t split = 0;          ///< bodies that came, as parts were split off others
  } events;
  std::vector<std::int64_t> sink_drained;  ///< particles that each sink took, as the scene lists them
  std::vector<PastBody> past_bodies;       ///< in the order of frames
  /// Of volume iterations, where there are any: StepReport::mean_compression and largest_compression.
  struct Compression {
    double mean = 0;     ///< over all particles, in the step where it was largest
    double largest = 0;  ///< of a particle, in any step
  } compression;
  /// What particles gave a collider that measures it, in all steps.
  struct Load {
    std::size_t collider = 0;  ///< its number, as in the scene
    ColliderLoad sum = {};
    double largest_force = 0;   ///< |impulse|/Δt of a step [N]
    double largest_torque = 0;  ///< likewise [N m]
  };
  std::vector<Load> loads;
  std::vector<std::int64_t> resumed_after;  ///< steps after which the run was taken up again
  PhaseTimes phase_seconds{};
  StageTimes stage_seconds{};
  std::uint64_t state_hash = 0;

  /// Particles that all sinks took.
  std::int64_t drained() const;
  /// How far the run is, and how long that took, as a checkpoint keeps it.
  nlohmann::ordered_json progress() const;
  /// The reverse; of `info` there is who had the slots, also those that are gone. Throws nlohmann's
  /// exceptions.
  void set_progress(const nlohmann::ordered_json& progress);
  /// Takes in a step that has just been made, and what happened in it.
  void add(const StepReport& step, const Simulation& simulation);

 private:
  void add_loads(double time_step, const Simulation& simulation);
};

nlohmann::ordered_json to_json(const RunReport& report);

/// What a scene's sink is called: "sink[0]".
std::string sink_name(std::size_t number);

/// 16 digits after 0x.
std::string hash_text(std::uint64_t hash);
/// The report of a cache. Throws IoError where it cannot be read.
nlohmann::ordered_json read_report(const std::filesystem::path& file);
/// Whole or not at all.
void write_report(const std::filesystem::path& file, const nlohmann::ordered_json& report);
/// The `error` of a report until its run ends, or for good where that was killed.
inline constexpr const char* k_not_ended_yet = "the run has not ended yet";
/// Whether a file that begins so is a report.
bool is_report(std::string_view beginning);
/// Who had the slots as the run ended. Throws IoError where the report does not tell.
std::vector<SlotBody> slot_bodies(const nlohmann::ordered_json& report, const std::filesystem::path& file);
/// RunReport::past_bodies; none in a report of an earlier version. Throws IoError likewise.
std::vector<PastBody> past_bodies(const nlohmann::ordered_json& report, const std::filesystem::path& file);

}  // namespace mallow::program
