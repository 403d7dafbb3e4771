#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <Eigen/Geometry>

#include "mallow/body.h"
#include "mallow/collider.h"
#include "mallow/errors.h"
#include "mallow/export.h"
#include "mallow/ids.h"
#include "mallow/material.h"
#include "mallow/report.h"
#include "mallow/saved_state.h"
#include "mallow/solver_config.h"
#include "mallow/vec3.h"

namespace mallow {

/// Three columns, one per component, seen without a copy. Row i of every view of a simulation is the same
/// particle; its id is ids()[i]. A view is valid until the next step or change of the simulation.
template <class Scalar>
class VectorColumns {
 public:
  /// As Eigen sees it: n × 3.
  using Map =
      Eigen::Map<std::conditional_t<std::is_const_v<Scalar>, const Eigen::Matrix<float, Eigen::Dynamic, 3>,
                                    Eigen::Matrix<float, Eigen::Dynamic, 3>>,
                 Eigen::Unaligned, Eigen::OuterStride<>>;

  /// data: x of row 0; y and z of it are `stride` and twice that further on.
  VectorColumns(Scalar* data, std::size_t size, std::size_t stride)
      : data_(data), size_(size), stride_(stride) {}

  /// Rows.
  std::size_t size() const { return size_; }
  /// One component of all rows.
  std::span<Scalar> x() const { return {data_, size_}; }
  /// @copydoc x()
  std::span<Scalar> y() const { return {data_ + stride_, size_}; }
  /// @copydoc x()
  std::span<Scalar> z() const { return {data_ + 2 * stride_, size_}; }
  /// The vector of a row, a copy.
  Vec3 operator[](std::size_t row) const {
    return {data_[row], data_[stride_ + row], data_[2 * stride_ + row]};
  }
  /// n × 3, a row per particle.
  Map eigen() const {
    return {data_, static_cast<Eigen::Index>(size_), 3,
            Eigen::OuterStride<>(static_cast<Eigen::Index>(stride_))};
  }

 private:
  Scalar* data_;
  std::size_t size_;
  std::size_t stride_;
};
using VectorView = VectorColumns<const float>;  ///< to read
using VectorSpan = VectorColumns<float>;        ///< to write

/// What a force callback sees.
struct ForceInput {
  double time;  ///< [s]
  std::span<const ParticleId> ids;
  VectorView positions;   ///< [m]
  VectorView velocities;  ///< [m/s]
};
/// Adds accelerations [m/s²] to what it is given; called once a step, before anything else moves. It may not
/// change or step the simulation that calls it: that throws ConfigError. What it throws ends the step, and
/// the state stays what it was before it.
using ForceCallback = std::function<void(const ForceInput&, VectorSpan accelerations)>;

/// A scene in motion: SPH and shape matching blended by alpha [TK]. Results depend on the binary and on what
/// was added, never on the number of threads. One thread may use an object at a time; different objects are
/// independent. One that was moved from may only be assigned to or destroyed.
class MALLOW_EXPORT Simulation {
 public:
  /// Throws ConfigError with every value that is out of range.
  explicit Simulation(const SolverConfig& config);
  ~Simulation();
  /// Moves, without a copy of particles.
  Simulation(Simulation&&) noexcept;
  /// @copydoc Simulation(Simulation&&)
  Simulation& operator=(Simulation&&) noexcept;

  /// A material that bodies share. Throws ConfigError with every value that is out of range.
  MaterialId add_material(const Material& material, std::string name = {});
  /// Adds a body; its particles get the next ids. Throws ConfigError, and changes nothing, also where a point
  /// is nearer than a tenth of the spacing to another one of the body or to a particle that is there, or
  /// where floats cannot tell points apart so far from 0.
  BodyId add_body(const Body& body, MaterialId material, std::string name = {});
  /// Adds a body of a material of its own.
  BodyId add_body(const Body& body, const Material& material, std::string name = {});
  /// Adds particles to a body, with its spacing: all of it is one piece, with one reference shape. One that
  /// already moved takes the present positions for that. Throws what add_body() throws.
  void extend_body(BodyId body, const Body& more);
  /// An obstacle from the next step on. Throws ConfigError with every value that is out of range.
  ColliderId add_collider(const Collider& collider);
  /// Particles that are in `region` now move with `velocity` from now on and answer to nothing else. The
  /// region may hold none: that is a ConfigError, as nobody means it.
  PinId pin(const Aabb& region, const Vec3& velocity = {0, 0, 0});
  /// The same for particles by id. Throws ConfigError where an id is not one.
  PinId pin(std::span<const ParticleId> ids, const Vec3& velocity = {0, 0, 0});
  /// An empty function takes the callback away.
  void set_force(ForceCallback callback);

  /// Of all bodies of the material.
  void set_alpha(MaterialId material, const AlphaSchedule& alpha);
  /// The velocity of a collider from now on [m/s], finite. It has no keyframes then.
  void set_velocity(ColliderId collider, const Vec3& velocity);
  /// [m/s], and [rad/s] about its pose's translation.
  void set_twist(ColliderId collider, const Vec3& velocity, const Vec3& angular_velocity);
  /// Puts a collider where it then stands still, without keyframes. seconds: 0, it is there at once and moves
  /// nothing on the way; > 0, it takes so long [s] and moves what it meets. Throws ConfigError where a number
  /// is out of range.
  void set_pose(ColliderId collider, const Pose& pose, double seconds = 0);
  /// The velocity of the particles of a pin from now on [m/s], finite.
  void set_velocity(PinId pin, const Vec3& velocity);

  /// Allocates, sorts and builds what the first step needs; step() does it where it was not done. The first
  /// call settles what a config leaves out, from the bodies that are there; later ones do not change it.
  /// Throws ConfigError where there are no particles, nothing says how long a step is, steps are too long for
  /// a material's springs, or neighbour lists would take more than memory_limit.
  void prepare();
  /// One step of algorithm 3.3 of the paper. Throws StepError and keeps the state where Δt would fall below
  /// Δt0/1000 or a number is not finite: it names the particle and the phase.
  StepReport step();
  /// One step on the way to the time `end` [s], after time(): the fewest equal steps that the limits on Δt
  /// allow share what is left, and this is the first of them. A varying Δt lets the energy of a swinging body
  /// drift, so the last step is no sliver; where one step is enough, time() is `end` after it, to the last
  /// bit. Throws ConfigError where `end` is not after time(), and what step() throws.
  StepReport step_towards(double end);
  /// As many steps as `seconds` take, in [0, ∞): time() is time() + seconds after them, to the last bit.
  /// Throws ConfigError where that is no such number, and what step() throws: then the steps before that one
  /// were taken, as time() tells.
  AdvanceReport advance(double seconds);

  /// Of all bodies.
  std::size_t particle_count() const;
  /// Bodies are numbered from 0 to one less than this.
  std::size_t body_count() const;
  double time() const;              ///< simulated time [s]
  std::int64_t step_count() const;  ///< steps taken
  /// As given; from the first prepare() on with the time_step that is in force. What else was left out,
  /// info() tells.
  const SolverConfig& config() const;
  const std::vector<Collider>& colliders() const;  ///< as given, in the poses that they have now
  const Collider& collider(ColliderId id) const;   ///< throws ConfigError where there is none
  /// What particles gave a collider in the last step; zeros before the first. Its measure_load must be set:
  /// else ConfigError. Summed in double, in an order that does not depend on the number of threads.
  ColliderLoad load(ColliderId id) const;

  /// The particle of each row; sorting moves rows, never ids.
  std::span<const ParticleId> ids() const;
  /// [m]. A scene whose first body is more than a thousand spacings from 0 is kept relative to a point near
  /// it, so that it moves as it would at 0; then this is a copy, in which digits are lost, made once a step.
  VectorView positions() const;
  VectorView velocities() const;  ///< [m/s]
  /// ρ [kg/m³] of the last step; empty where no SPH ran.
  std::span<const float> densities() const;
  /// The rows of a body in every view.
  struct Rows {
    std::size_t begin, end;
  };
  /// Where the body stands now.
  Rows rows(BodyId body) const;
  /// h of the body [m].
  float spacing(BodyId body) const;
  /// What the body is made of.
  MaterialId material(BodyId body) const;

  /// The row of a particle in every view. Throws ConfigError where there is none of this id, or no longer.
  std::size_t row(ParticleId id) const;
  /// x̄ of a particle [m], relative to the mean of its body's. Throws ConfigError as row() does, and where the
  /// body keeps no reference shape. [TK eq. 7]
  Vec3 rest_position(ParticleId id) const;
  /// R of the region that a particle owns, as the last step left it; with a region_stride above 1, of the
  /// first region that it is in. Throws as rest_position() does. [TK eq. 7]
  Eigen::Quaternionf rotation(ParticleId id) const;

  /// Copies in the order of slots, whatever that of rows is: entry i is particle i where none was removed.
  std::vector<Vec3> positions_by_id() const;
  /// @copydoc positions_by_id()
  std::vector<Vec3> velocities_by_id() const;
  std::vector<std::uint32_t> bodies_by_id() const;  ///< BodyId of each particle

  /// Energies as they are now, summed in double; slow, as every region is solved exactly. SPH pressure keeps
  /// no energy that could be summed, so a fluid's is what it moves and falls with. Calls prepare().
  Energy energy();

  /// 64 bits of positions and velocities in id order, time and step: equal states have equal hashes.
  std::uint64_t state_hash() const;
  /// All that later steps depend on; engine/STEP.md lists it. Not the force callback, which no bytes can
  /// hold.
  SavedState save() const;
  /// A simulation that goes on where a saved one stood: with the same bits as that one, by the same build of
  /// mallow, with any number of threads. Whoever had set a force sets it again before the next step.
  /// densities() are empty until then, and instruction_level is the machine's best. Throws ConfigError that
  /// names the chunk where a state is not whole, is of another version, or holds what no simulation could.
  static Simulation restore(const SavedState& saved, int threads = 0,
                            std::shared_ptr<Executor> executor = nullptr);

  /// What runs and what it holds; calls prepare().
  SimulationInfo info();

  struct State;  ///< internal

 private:
  friend struct StateAccess;  // of tests
  std::unique_ptr<State> state_;
};

}  // namespace mallow
