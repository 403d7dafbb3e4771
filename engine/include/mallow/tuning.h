#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mallow/export.h"
#include "mallow/files.h"
#include "mallow/simulation.h"

/// What a setting costs and how far off it is: one scene run at several settings, against the finest of them.
/// Target mallow::scene; a scene file is not needed.
namespace mallow {

/// What moves as a whole at one moment, and where each particle is.
struct MotionMoment {
  ParticleFrame particles;
  double height = 0;                  ///< of the box around all particles [m]
  double spread = 0;                  ///< root mean square distance from the vertical through the centre [m]
  Eigen::Vector3d center{0, 0, 0};    ///< of mass [m]
  double volume = 0;                  ///< by density; where that is below that at rest, as at rest [m³]
  double energy = 0;                  ///< kinetic, of gravity and elastic [J]
  double kinetic_energy = 0;          ///< [J]
  std::vector<double> measures = {};  ///< of MotionPlan::measures
};

/// A run as it was recorded.
struct Motion {
  std::vector<MotionMoment> moments;       ///< the first at the begin
  std::vector<float> spacings = {};        ///< h of each body, by slot [m]
  std::vector<double> frame_seconds = {};  ///< wall time of the steps of each frame [s]
  std::vector<double> draw_seconds = {};   ///< that MotionPlan::draw took at each moment after the first [s]
  double other_seconds = 0;                ///< wall time of building, measuring and the like [s]
  std::int64_t steps = 0;                  ///< taken
  std::string failure = {};                ///< why a step could not be taken, or the simulation not be built

  /// Wall time of the steps of a frame in the mean [s]; NaN where there is none.
  double seconds_per_frame() const;
  /// The same of drawing; 0 where nothing was drawn.
  double draw_seconds_per_frame() const;
};

/// How a run is recorded.
struct MotionPlan {
  int frames = 0;         ///< >= 0
  double frame_time = 0;  ///< [s], > 0
  int moments = 24;       ///< recorded, >= 1: frames as even as they come, the last one too
  /// Own numbers, taken at every moment.
  std::vector<std::function<double(Simulation&)>> measures = {};
  /// Called at every moment after the first and timed, such as a surface that is drawn; may be empty.
  std::function<void(const Simulation&)> draw = {};
  /// Asked before every step: true ends the run as it is. May be empty.
  std::function<bool()> stop = {};
};
/// Builds a simulation and runs it. What building or a step throws (Error) is in `failure`, with the moments
/// up to it. Throws ConfigError where the plan is out of range.
MALLOW_EXPORT Motion record_motion(const std::function<Simulation()>& build, const MotionPlan& plan);
/// Runs a simulation that is there, from where it stands; frames are counted from there. Else the same.
MALLOW_EXPORT Motion record_motion(Simulation& simulation, const MotionPlan& plan);

/// How far a motion is from a reference. Distances are between particles of the same id at the same moment,
/// in spacings h of their body.
struct MotionError {
  double median = 0, rms = 0, worst = 0;              ///< over all particles and moments [h]
  double worst_time = 0;                              ///< [s]
  std::optional<double> median_pixels, worst_pixels;  ///< where `pixel` was given
  double height = 0, spread = 0, center = 0;          ///< root mean square over moments [h]
  double volume = 0;                                  ///< likewise, as a share of that of the reference
  double energy = 0;                                  ///< of the largest kinetic energy of the reference
  std::vector<double> measures = {};                  ///< likewise, in their own units
  std::size_t unmatched = 0;  ///< particles, over all moments, that only one of the two has

  /// The worst of height, spread and centre [h]: what stays to be compared where particles go their own ways.
  double shape() const;
};
/// Where a point is seen in a picture [pixels]; nothing where it is not.
using PixelOf = std::function<std::optional<Eigen::Vector2d>(const Vec3& point)>;

/// Compares the moments that both have. from: share of them, in [0, 1), that is passed over at the beginning.
/// Where the motions have different numbers of particles at the begin, a particle is compared with what the
/// reference's particles nearest to it at the begin have moved.
MALLOW_EXPORT MotionError motion_error(const Motion& motion, const Motion& reference, double from = 0,
                                       const PixelOf& pixel = {});

/// What a setting costs and how wrong it is, both to be small.
struct Trade {
  double cost = 0;
  double error = 0;
};
/// Indices of the trades that no other beats, cheapest first: whatever costs no more than one of them is
/// worse. Choices that are not finite are on no front.
MALLOW_EXPORT std::vector<std::size_t> pareto_front(std::span<const Trade> trades);

/// What was picked of some trades.
struct Pick {
  std::size_t index = 0;
  bool holds = false;  ///< false: nothing does, and this is the nearest
};
/// The cheapest whose error is at most `error`, or else the one with the least. Nothing where no trade is
/// finite.
MALLOW_EXPORT std::optional<Pick> pick_by_error(std::span<const Trade> trades, double error);
/// The most accurate that costs at most `cost`, or else the cheapest.
MALLOW_EXPORT std::optional<Pick> pick_by_cost(std::span<const Trade> trades, double cost);

/// Order p at which results of halved steps converge, by the differences d between successive ones:
/// log2(d[n-2]/d[n-1]). Nothing where there are fewer than two, or they do not shrink to anything.
MALLOW_EXPORT std::optional<double> convergence_order(std::span<const double> differences);

}  // namespace mallow
