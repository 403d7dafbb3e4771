#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mallow/files.h"
#include "mallow/mesh.h"
#include "mallow/scene.h"
#include "program/cache.h"

namespace mallow::program {

/// What can be compared: the folder of a run with its frames, or a single state, which is a checkpoint or a
/// frame of particles (PLY).
class ComparedStates {
 public:
  /// Throws IoError where it is neither.
  explicit ComparedStates(const std::filesystem::path& path);

  bool is_run() const { return cache_.has_value(); }
  const std::filesystem::path& path() const { return path_; }
  /// Of a run; {0} of a single state.
  const std::vector<int>& frames() const { return frames_; }
  ParticleFrame particles(int frame) const;
  /// Where the frame has one.
  std::optional<Mesh> surface(int frame) const;

  /// Of a run; all at its defaults, without colliders, of a single state. Throws IoError and ConfigError.
  Scene scene() const;

  /// All that is read.
  std::vector<std::filesystem::path> files() const;

  /// h of each body [m], by slot; empty where the file does not tell.
  std::span<const float> spacings() const { return spacings_; }
  void set_spacings(std::vector<float> spacings) { spacings_ = std::move(spacings); }
  /// Of a particle of each body [kg], by slot; empty where the file does not tell.
  std::span<const double> masses() const { return masses_; }
  /// Of a body, or its number.
  std::string body_name(std::uint32_t body) const;

 private:
  void read_groups(const std::filesystem::path& report);
  void read_checkpoint_state();

  std::filesystem::path path_;
  std::optional<Cache> cache_;
  std::vector<int> frames_;
  ParticleFrame state_;  ///< the single one
  std::vector<float> spacings_;
  std::vector<double> masses_;
  std::vector<std::string> names_;
};

}  // namespace mallow::program
