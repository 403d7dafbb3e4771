#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "mallow/ids.h"
#include "mallow/material.h"
#include "mallow/saved_state.h"
#include "mallow/solver_config.h"

namespace mallow::view {

/// What a session is set to, beside what its simulation holds.
struct Settings {
  SolverConfig solver;              ///< as the scene has it, without the rung
  std::vector<Material> materials;  ///< of the scene, the same
  int rung = 0;                     ///< see frame_governor.h
};

/// What the mouse has pinned at one stroke.
struct HandPin {
  PinId pin{};
  std::vector<ParticleId> ids = {};
};

/// A moment to go back to.
struct Moment {
  double time = 0;        ///< [s]
  std::int64_t step = 0;  ///< steps taken
  int frame = 0;          ///< frames of the scene that were finished
  double frame_time = 0;  ///< that they are counted by [s]
  Settings settings;
  SavedState state;
  std::vector<ParticleId> pinned = {};
  std::vector<HandPin> hand_pins = {};
  std::optional<MaterialId> ball_material = {};
  bool touched = false;  ///< by the mouse
};

/// Saved states by time, the newest last. What a simulation does after one of them is restored is what it
/// did before, bit by bit. Where they take more than the budget, every second one of the older half goes, so
/// that it reaches far back and is dense near the present.
class RewindRing {
 public:
  explicit RewindRing(std::size_t budget) : budget_(budget) {}

  /// What is later than `moment` is forgotten: the simulation took another way.
  void add(Moment moment);
  /// The place of the newest moment at or before a time; the oldest one where none is. Not when empty.
  std::size_t find(double time) const;
  const Moment& operator[](std::size_t place) const { return moments_[place]; }
  std::size_t size() const { return moments_.size(); }
  bool empty() const { return moments_.empty(); }
  void clear();
  std::size_t bytes() const { return bytes_; }

 private:
  void thin_out();

  std::size_t budget_;     ///< [bytes]
  std::size_t bytes_ = 0;  ///< of all moments
  std::deque<Moment> moments_;
};

/// Memory of a state [bytes].
std::size_t bytes_of(const SavedState& state);

}  // namespace mallow::view
