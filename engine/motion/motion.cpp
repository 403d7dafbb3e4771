#include "motion/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "motion/motion_lanes.h"

namespace mallow {
namespace {

ConstVectors raw_or_null(const VectorColumn* column) {
  return column ? raw(*column) : ConstVectors{};
}

ForcesInput forces(const MotionInput& in, const ParticleStore& store) {
  ForcesInput forces{
      .position = raw(store.position),
      .velocity = raw(store.velocity),
      .sph_acceleration = raw_or_null(in.sph_acceleration),
      .cross_group = raw_or_null(in.cross_group),
      .walls = raw_or_null(in.walls),
      .user = raw_or_null(in.user),
      .pull = raw_or_null(in.pull),
      .group_begin = in.begin,
      .pin = store.pin.empty() ? nullptr : store.pin.data(),
      .gravity = {in.gravity[0], in.gravity[1], in.gravity[2]},
      .time_step = in.time_step,
      .sph_factor = in.alpha * in.time_step,
      .elastic_factor = in.elastic_factor,
      .damping = in.damping,
  };
  for (int a = 0; a < 3; ++a) {
    forces.center[a] = static_cast<float>(in.rigid.center[a]);
    forces.velocity_of_center[a] = static_cast<float>(in.rigid.velocity[a]);
    forces.spin[a] = static_cast<float>(in.rigid.spin[a]);
  }
  return forces;
}

bool is_pinned(const ForcesInput& forces, std::size_t row) {
  return forces.pin && forces.pin[row] != 0;
}

/// Σ |a_ext| over the unpinned of a block, row by row.
double sum_external(const ForcesInput& forces, const MotionLanes& lanes, std::size_t begin, std::size_t end,
                    ConstVectors free, ConstVectors velocity) {
  std::array<float, k_block> external;
  lanes.external(forces, begin, end, free, velocity, external.data());
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i)
    if (!is_pinned(forces, i)) sum += static_cast<double>(external[i - begin]);
  return sum;
}

std::size_t first_bad_row(const ParticleStore& store, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i)
    if (!(store.next_velocity.get(i).allFinite() && store.next_position.get(i).allFinite())) return i;
  return SIZE_MAX;
}

/// The particles [begin, end) of the store, of one body; only reads and writes their own rows.
class MovingBlock {
 public:
  /// What it gives to colliders and gets from them, one a collider; empty where nobody asks.
  struct FromColliders {
    std::span<ColliderLoad> loads;
    std::span<ContactSums> touches;
  };

  MovingBlock(const MotionInput& in, InstructionLevel level, std::size_t begin, std::size_t end,
              ParticleStore& store)
      : in_(in),
        forces_(forces(in, store)),
        level_(level),
        lanes_(MALLOW_SELECT(level, motion_lanes)),
        begin_(begin),
        end_(end),
        store_(store) {}

  /// Returns what it says of the rows, pins left out.
  BlockBounds predict() {
    const BlockBounds bounds = lanes_.blend(forces_, begin_, end_, raw(store_.next_velocity));
    if (!forces_.pin) return bounds;
    for (std::size_t i = begin_; i < end_; ++i)
      if (is_pinned(forces_, i))
        store_.next_velocity.set(i, in_.pins[forces_.pin[i] - 1u].at(store_.position.get(i)));
    return bounds;
  }
  BlockBounds bounds() const {
    return lanes_.bounds(forces_, begin_, end_, raw(std::as_const(store_.next_velocity)));
  }
  void collide(const BlockBounds& bounds, const FromColliders& got) {
    if (in_.colliders.empty()) return;
    resolve_contacts({begin_, end_, store_.position, store_.velocity, forces_.pin, bounds}, in_.colliders,
                     in_.contact, store_.next_velocity, got.loads, got.touches);
  }
  /// predicted: v' before contact, from the block's first row on.
  void measure(ConstVectors predicted, MotionSums& sums) const {
    sums.unpinned = end_ - begin_;
    if (forces_.pin)
      for (std::size_t i = begin_; i < end_; ++i) sums.unpinned -= is_pinned(forces_, i);
    if (in_.measure_external)
      sums.external =
          sum_external(forces_, lanes_, begin_, end_, predicted, raw(std::as_const(store_.next_velocity)));
  }
  void advance(MotionSums& sums) {
    if (!lanes_.advance(forces_, begin_, end_, raw(std::as_const(store_.next_velocity)),
                        raw(store_.next_position)))
      sums.bad_row = first_bad_row(store_, begin_, end_);
    if (in_.measure_rigid)
      sums.rigid = sum_rigid(level_, raw(std::as_const(store_.next_position)),
                             raw(std::as_const(store_.next_velocity)), begin_, end_, in_.rigid.center);
    if (in_.measure_speed) sums.speed = sum_speeds();
  }

  /// The phases one after the other. predicted: where v' before contact goes in one loop and comes from in
  /// the next; not used where one loop does both.
  void move(const MotionPhases& phases, VectorColumn& predicted, const FromColliders& got, MotionSums& sums) {
    BlockBounds bounds{};
    if (phases.predict) {
      bounds = predict();
      sums = {};
    }
    std::array<std::array<float, k_block>, 3> here;
    for (std::size_t a = 0; a < 3 && phases.predict && in_.measure_external; ++a)
      std::copy_n(store_.next_velocity.axis(a) + begin_, end_ - begin_,
                  phases.collide ? here[a].data() : predicted.axis(a) + begin_);
    if (phases.collide) {
      collide(phases.predict ? bounds : this->bounds(), got);
      measure(phases.predict ? ConstVectors{here[0].data(), here[1].data(), here[2].data()}
                             : from(std::as_const(predicted), begin_),
              sums);
    }
    if (phases.advance) advance(sums);
  }

 private:
  double sum_speeds() const {
    const VectorColumn& v = store_.next_velocity;
    std::array<float, k_block> speed;
    for (std::size_t i = begin_; i < end_; ++i)
      speed[i - begin_] = std::sqrt(v.x()[i] * v.x()[i] + v.y()[i] * v.y()[i] + v.z()[i] * v.z()[i]);
    double sum = 0;
    for (std::size_t k = 0; k < end_ - begin_; ++k) sum += static_cast<double>(speed[k]);
    return sum;
  }
  static ConstVectors from(const VectorColumn& column, std::size_t row) {
    return {column.x() + row, column.y() + row, column.z() + row};
  }

  const MotionInput& in_;
  const ForcesInput forces_;
  const InstructionLevel level_;
  const MotionLanes& lanes_;
  const std::size_t begin_, end_;
  ParticleStore& store_;
};

/// Part `number` of a list of equal parts, or none where there is no list.
template <class T>
std::span<T> part_of(std::vector<T>& list, std::size_t number, std::size_t size) {
  return list.empty() ? std::span<T>{} : std::span(list).subspan(number * size, size);
}

/// What bodies and colliders got, block by block.
void add_up(MovingBodies& bodies) {
  const std::size_t colliders = bodies.loads.size();
  bodies.sums.assign(bodies.inputs.size(), {});
  for (std::size_t b = 0; b < bodies.partial.size(); ++b) {
    const std::size_t body = bodies.blocks.blocks[b].range;
    MotionSums& sums = bodies.sums[body];
    sums.external += bodies.partial[b].external;
    sums.unpinned += bodies.partial[b].unpinned;
    sums.rigid += bodies.partial[b].rigid;
    sums.speed += bodies.partial[b].speed;
    sums.bad_row = std::min(sums.bad_row, bodies.partial[b].bad_row);
    const double mass = static_cast<double>(bodies.inputs[body].mass);
    for (std::size_t c = 0; c < colliders; ++c) {
      bodies.loads[c].impulse += mass * bodies.partial_loads[b * colliders + c].impulse;
      bodies.loads[c].torque += mass * bodies.partial_loads[b * colliders + c].torque;
    }
  }
}

}  // namespace

void join_motion(const MotionInput& input, MovingBodies& bodies) {
  bodies.inputs.push_back(input);
  bodies.blocks.add(input.end - input.begin);
  bodies.partial.resize(bodies.blocks.blocks.size());
  bodies.partial_loads.resize(bodies.partial.size() * bodies.loads.size());
  if (input.sum_touches || !bodies.touches.empty())
    bodies.touches.resize(bodies.partial.size() * input.colliders.size());
}

void preview_contact(const Execution& execution, const ParticleStore& store, const MovingBodies& bodies,
                     VectorColumn& velocity) {
  const MotionLanes& lanes = MALLOW_SELECT(execution.level, motion_lanes);
  parallel_for(execution.threads, bodies.blocks, [&](const RangeBlocks::Block& block, std::size_t) {
    const MotionInput& in = bodies.inputs[block.range];
    const std::size_t begin = in.begin + block.begin, end = in.begin + block.end;
    const ForcesInput all = forces(in, store);
    const BlockBounds bounds = lanes.bounds(all, begin, end, raw(std::as_const(velocity)));
    resolve_contacts({begin, end, store.position, store.velocity, all.pin, bounds}, in.colliders, in.contact,
                     velocity, {});
  });
}

void remember_predicted(const Execution& execution, const ParticleStore& store, MovingBodies& bodies) {
  parallel_for(execution.threads, bodies.blocks, [&](const RangeBlocks::Block& block, std::size_t) {
    const MotionInput& in = bodies.inputs[block.range];
    for (std::size_t a = 0; a < 3 && in.measure_external; ++a)
      std::copy(store.next_velocity.axis(a) + in.begin + block.begin,
                store.next_velocity.axis(a) + in.begin + block.end,
                bodies.predicted.axis(a) + in.begin + block.begin);
  });
}

void move_particles(const MotionPhases& phases, const Execution& execution, ParticleStore& store,
                    MovingBodies& bodies) {
  const std::size_t colliders = bodies.loads.size();
  if (phases.predict) {
    bodies.blocks.clear();
    for (const MotionInput& in : bodies.inputs) bodies.blocks.add(in.end - in.begin);
    bodies.partial.resize(bodies.blocks.blocks.size());
    bodies.partial_loads.assign(bodies.partial.size() * colliders, {});
    const auto asks = std::ranges::find_if(bodies.inputs, &MotionInput::sum_touches);
    bodies.touches.assign(asks == bodies.inputs.end() ? 0 : bodies.partial.size() * asks->colliders.size(),
                          {});
    if (!phases.collide) bodies.predicted.resize_unset(store.size());
  }
  parallel_for(execution.threads, bodies.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const MotionInput& in = bodies.inputs[block.range];
    MovingBlock(in, execution.level, in.begin + block.begin, in.begin + block.end, store)
        .move(phases, bodies.predicted,
              {.loads = part_of(bodies.partial_loads, number, colliders),
               .touches = in.sum_touches ? part_of(bodies.touches, number, in.colliders.size())
                                         : std::span<ContactSums>{}},
              bodies.partial[number]);
  });
  if (phases.advance) add_up(bodies);
}

}  // namespace mallow
