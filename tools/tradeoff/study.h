#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mallow/tuning.h"
#include "tradeoff/knobs.h"
#include "tradeoff/measures.h"

namespace mallow::tradeoff {

/// Share of the moments that late errors pass over: they are of the last quarter.
constexpr double k_late = 0.75;
constexpr double k_reference_share = 0.5;  ///< of the budget, that the search for a reference may take
constexpr double k_reference_part = 0.5;   ///< of the error that is allowed, that the reference may have

/// What a setting has to hold.
struct Limit {
  bool is_time = false;
  double most = 0;  ///< of a frame [s], or of the error [h]

  /// The cheapest that is accurate enough, or the most accurate that is cheap enough.
  std::optional<Pick> pick(std::span<const Trade> trades) const {
    return is_time ? pick_by_cost(trades, most) : pick_by_error(trades, most);
  }
};

/// What is to be found out.
struct StudyOptions {
  double budget = 60;  ///< wall time of all [s], > 0
  double kept = 0;     ///< share of it, in [0, 1), that is left to what follows the study
  int threads = 0;     ///< as in SolverConfig
  int repeats = 9;     ///< timed runs of a setting, at most, >= 1
  bool surface = true;
  std::vector<Setting> extra = {};         ///< of the user's knobs; they come first
  std::vector<std::string> measures = {};  ///< for parse_measure()
  std::optional<Limit> limit = {};         ///< knobs are turned on from what picks best by it
  std::function<void(const std::string& what)> progress = {};
  std::function<bool()> stop = {};  ///< asked before every step: true ends all, with Stopped
};
/// Thrown where StudyOptions::stop says so.
struct Stopped {};

/// A setting that was run.
struct Row {
  Setting setting;
  Motion motion;                       ///< the first run
  std::vector<double> seconds = {};    ///< of a frame's steps in the mean, for each run [s]
  std::vector<double> drawing = {};    ///< of its surface [s]
  MotionError error = {};              ///< of all moments
  MotionError late = {};               ///< of the last quarter
  std::optional<double> surface = {};  ///< how far its surface is from a fine one of the same particles [h]
  bool on_front = false;

  double median_seconds() const;  ///< steps [s]
  double median_drawing() const;  ///< [s]
  double frame_seconds() const { return median_seconds() + median_drawing(); }
  double least_frame_seconds() const;
  double most_frame_seconds() const;
};

/// The reference and how it was found.
struct Reference {
  double factor = 1;                ///< of the scene's own step
  std::vector<double> factors;      ///< that were tried
  std::vector<double> differences;  ///< RMS between successive ones [h]
  std::optional<double> order;
  double error = 0;          ///< what it may be off itself, by its order [h]
  double seconds = 0;        ///< wall time of the run in the shortest steps [s]
  double late_shape = 0;     ///< by how much the last halving moved shapes in the last quarter [h]
  bool converged = false;    ///< false: the budget's half ended it, or
  bool parts_again = false;  ///< the last halving moved particles farther than the one before
  Motion motion;
};

struct Study {
  std::string scene;
  SurfaceConfig fine_surface;  ///< what surfaces are compared with
  /// Those that settings are judged by, and those that the scene has: the budget may carry no more than the
  /// first of them.
  int frames = 0, all_frames = 0;
  double frame_time = 0;  ///< [s]
  int threads = 1;
  double spent = 0;  ///< [s]
  Reference reference;
  std::vector<Row> rows;  ///< the scene as it is first
  /// One position moved by its last bit moves particles by as much as settings do, or halving the step
  /// brings them to no place.
  bool chaotic = false;
  bool parts = false;                        ///< the former of the two
  std::optional<MotionError> last_bit;       ///< what moving one position by its last bit does
  std::string no_last_bit;                   ///< why that is not known
  std::optional<MotionError> last_bit_late;  ///< the same in the last quarter
  std::vector<std::string> left_out;         ///< settings that the budget did not reach
  std::vector<std::string> failed;           ///< settings, each with why
  std::vector<std::string> measures;         ///< names

  /// What settings are judged by [h]: the RMS of positions or, where the motion is chaotic, that of shape in
  /// the last quarter; or that of the surface, where that is larger.
  double error(const Row& row) const { return std::max(error_of_motion(row), row.surface.value_or(0)); }
  double error_of_motion(const Row& row) const { return chaotic ? row.late.shape() : row.error.rms; }
  /// What the reference's motion is off itself, by the same measure [h].
  double reference_error() const { return chaotic ? reference.late_shape : reference.error; }
  /// Cost: of a frame, the median of its runs [s].
  std::vector<Trade> trades() const;
};

/// Runs a scene at settings around its own. Where the budget does not carry all its frames, the first of
/// them are all. Throws what building the scene as it is throws, and RunFailure where it cannot be run, or
/// the budget carries less than a handful of frames.
Study study(const Scene& scene, const StudyOptions& options);
/// One more run of a setting, as those of the study were; error and time of it. deadline: wall_clock() at
/// which there is nothing.
std::optional<Row> run_again(const Study& study, const Setting& setting, const StudyOptions& options,
                             double deadline);
/// Says of each row whether it is on the front.
void mark_front(Study& study);
double median(std::vector<double> values);  ///< 0 of none
/// "the first 39 of 150 frames", or nothing where settings were judged by all.
std::string stretch(const Study& study);

}  // namespace mallow::tradeoff
