#pragma once

#include <span>
#include <vector>

#include "colliders/contact.h"
#include "core/column.h"
#include "core/execution.h"
#include "core/isa.h"
#include "core/range_blocks.h"
#include "motion/rigid_motion.h"
#include "particles/particle_store.h"

namespace mallow {

/// How what a pin holds moves in one step: all alike, or as one with a frame that turns.
struct PinMotion {
  Vec3 velocity{0, 0, 0};                          ///< at the center [m/s]
  Eigen::Matrix3f spin = Eigen::Matrix3f::Zero();  ///< mean_spin() [1/s]
  Vec3 center{0, 0, 0};                            ///< relative to the origin [m]

  Vec3 at(const Vec3& x) const { return spin.isZero(0) ? velocity : Vec3(velocity + spin * (x - center)); }
};

/// What moves the particles of one body in one step. Null columns are terms that the scene does not have.
struct MotionInput {
  std::size_t begin, end;                ///< rows of the body
  float time_step;                       ///< Δt [s]
  float alpha;                           ///< α
  float elastic_factor;                  ///< (1 − α) Δt/(Δt0 Δt_SM) [1/s]
  Vec3 gravity;                          ///< [m/s²]
  const VectorColumn* sph_acceleration;  ///< by row of the store [m/s²]
  const VectorColumn* cross_group;       ///< by row of the store [m/s²]
  const VectorColumn* walls = nullptr;   ///< by row of the store [m/s²]
  const VectorColumn* user;              ///< by row of the store [m/s²]
  const VectorColumn* pull;              ///< g − x, by row of the body [m]
  std::span<const PlacedCollider> colliders;
  ContactStep contact;
  std::span<const PinMotion> pins;
  bool measure_external;       ///< sum |a_ext|
  bool measure_rigid = false;  ///< sum the rigid motion that the body has afterwards
  bool measure_speed = false;  ///< sum |v|
  bool sum_touches = false;    ///< sum up what it gets from colliders
  float damping = 0;           ///< share of what is not `rigid` that goes in this step [model 2, section 4 B]
  RigidMotion rigid = {};      ///< of the body at the start of the step
  float mass;                  ///< m [kg], by which loads are counted
};

/// What the update rule and the checks want to know of a body's motion.
struct MotionSums {
  double external = 0;  ///< Σ |a_ext| over unpinned particles, contact included [m/s²]
  std::size_t unpinned = 0;
  RigidSums rigid;                 ///< near the centre at the start of the step
  double speed = 0;                ///< Σ |v| [m/s]
  std::size_t bad_row = SIZE_MAX;  ///< first row whose new velocity or position is not finite
};

/// What of the motion a loop over blocks does, in this order. Phases that nothing stands between go in one
/// loop.
struct MotionPhases {
  bool predict = false;  ///< all accelerations but contact -> v', the velocities of pins
  bool collide = false;  ///< contact with colliders -> v', loads, touches, |a_ext|
  bool advance = false;  ///< v' -> x'
};

/// Bodies that move together, and what is known of them afterwards.
struct MovingBodies {
  std::vector<MotionInput> inputs;
  std::vector<MotionSums> sums;  ///< of each
  /// One a collider, where any measures it: what it got from all of them is added. Else empty.
  std::vector<ColliderLoad> loads;
  /// What each block got from each collider, for a mass of 1, where its input asks for it; empty where none
  /// does.
  std::vector<ContactSums> touches;

  // Scratch, by block.
  RangeBlocks blocks;
  std::vector<MotionSums> partial;
  std::vector<ColliderLoad> partial_loads;
  VectorColumn predicted;  ///< v' before contact, where one loop predicts and another collides
};

/// One more body, whose v' are there already and have still to be collided and advanced.
void join_motion(const MotionInput& input, MovingBodies& bodies);

/// v', by row of the store -> what contact with colliders would make of it. Nobody is told.
void preview_contact(const Execution& execution, const ParticleStore& store, const MovingBodies& bodies,
                     VectorColumn& velocity);
/// v' as it is counts as that before contact, where something stands between the two loops that changes it.
void remember_predicted(const Execution& execution, const ParticleStore& store, MovingBodies& bodies);

/// v' and x' into the store's next columns. Each phase is asked for once, in their order.
/// [model 4, 5; TK eq. 10, 11, 13]
void move_particles(const MotionPhases& phases, const Execution& execution, ParticleStore& store,
                    MovingBodies& bodies);

}  // namespace mallow
