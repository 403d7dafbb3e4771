#pragma once

#include <memory>
#include <vector>

#include "mallow/simulation.h"

namespace mallow::view {

/// The mouse's hold on a patch of matter: a spring from the patch's middle to where it is pulled, whose
/// acceleration all of the patch gets, most in its middle and none at its rim, so that it is pulled and not
/// turned. The spring is damped critically and as stiff as steps carry; the pull is bounded, lest a jerk of
/// the mouse throws particles through each other.
class Grab {
 public:
  /// Takes hold of what is within `radius` [m] of `at`, which must hold a particle, and sets the simulation's
  /// force. strength: on the pull, 1 by default.
  Grab(Simulation& simulation, const Vec3& at, float radius, float strength);

  /// Pulls it there from now on [m].
  void pull_to(const Vec3& target) { hold_->target = target; }
  const Vec3& target() const { return hold_->target; }
  /// Where the middle of the patch is now [m].
  Vec3 middle(const Simulation& simulation) const;
  /// The force acts in this simulation: after a state was restored, which holds no force.
  void act_on(Simulation& simulation) const;
  /// Lets go.
  static void release(Simulation& simulation) { simulation.set_force({}); }

 private:
  /// Shared with the callback.
  struct Hold {
    std::vector<ParticleId> ids;  ///< ascending
    std::vector<float> weights;   ///< of each, in (0, 1]
    Vec3 target;
    float stiffness;  ///< ω² [1/s²]
    float most;       ///< acceleration [m/s²]
  };
  static void pull(const Hold& hold, const Simulation& simulation, const ForceInput& input,
                   VectorSpan accelerations);
  std::shared_ptr<Hold> hold_;
};

}  // namespace mallow::view
