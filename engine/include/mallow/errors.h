#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "mallow/export.h"
#include "mallow/ids.h"
#include "mallow/report.h"

namespace mallow {

/// One thing that is wrong with an input: where it stands, and what would be right there.
struct Problem {
  std::string file = {};     ///< empty where the value came through the API
  int line = 0;              ///< from 1; 0 where there is no line
  int column = 0;            ///< from 1; 0 where there is no column
  std::string field = {};    ///< as the user types it: "solver.time_step", "body[2].box.count"
  std::string message = {};  ///< the value given and what is allowed
};

/// "file:line:column: field: message", leaving out what is empty.
MALLOW_EXPORT std::string to_string(const Problem& problem);

/// Everything the library throws on purpose.
class MALLOW_EXPORT Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A configuration, scene or argument that cannot be run; holds all of its problems at once.
class MALLOW_EXPORT ConfigError : public Error {
 public:
  /// problems: at least one.
  explicit ConfigError(std::vector<Problem> problems);
  /// One problem of a value that came through the API.
  ConfigError(std::string field, std::string message);
  /// All that is wrong, in the order in which it was found.
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

/// A file that cannot be read or written, or whose content is not what it claims to be.
class MALLOW_EXPORT IoError : public Error {
 public:
  /// problem: names the file.
  explicit IoError(Problem problem);
  /// What is wrong, with the file.
  const Problem& problem() const { return problem_; }

 private:
  Problem problem_;
};

/// A step that cannot be taken. The simulation keeps positions, velocities, time and reference shapes as they
/// were before that step.
class MALLOW_EXPORT StepError : public Error {
 public:
  /// message: what went wrong, and which setting to change.
  StepError(const std::string& message, ParticleId particle_id, Phase phase);
  /// The particle that asked for it, or whose row is the first that holds a number that is not finite.
  ParticleId particle_id() const { return particle_id_; }
  /// Phase::time_step where Δt would be too short; else the phase that writes the first column, in the order
  /// of phases, with a number that is not finite.
  Phase phase() const { return phase_; }

 private:
  ParticleId particle_id_;
  Phase phase_;
};

}  // namespace mallow
