#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mallow/files.h"
#include "mallow/mesh.h"
#include "mallow/scene.h"
#include "program/body_appearances.h"
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

  /// Who has the slots in a frame; empty where the file does not tell. Of their materials nothing is read.
  std::vector<SlotBody> bodies(int frame) const { return slot_bodies_at(frame, bodies_, past_); }
  /// Takes over what another one knows.
  void take_bodies(const ComparedStates& other);
  /// So many bodies at least, all of this spacing [m].
  void set_spacing(std::size_t bodies, float spacing);
  /// Of a particle of each body [kg], by slot; 0 where the file does not tell.
  std::vector<double> masses(int frame) const;
  /// Of the body that has a slot in a frame, or its number.
  std::string body_name(std::uint32_t body, int frame) const;

 private:
  void read_groups(const std::filesystem::path& report);
  void read_checkpoint_state();

  std::filesystem::path path_;
  std::optional<Cache> cache_;
  std::vector<int> frames_;
  ParticleFrame state_;           ///< the single one
  std::vector<SlotBody> bodies_;  ///< at the end
  std::vector<PastBody> past_;    ///< those that had these slots before
  std::vector<double> masses_;    ///< of `bodies_`
};

}  // namespace mallow::program
