#include "motion/motion.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/parallel.h"
#include "motion/motion_kernels.h"

namespace mallow {
namespace {

ConstVectors raw_or_null(const VectorColumn* column) {
  return column ? raw(*column) : ConstVectors{};
}

ForcesInput forces(const MotionInput& in, const ParticleStore& store) {
  return {
      .position = raw(store.position),
      .velocity = raw(store.velocity),
      .sph_acceleration = raw_or_null(in.sph_acceleration),
      .cross_group = raw_or_null(in.cross_group),
      .user = raw_or_null(in.user),
      .pull = raw_or_null(in.pull),
      .group_begin = in.begin,
      .pin = store.pin.empty() ? nullptr : store.pin.data(),
      .gravity = {in.gravity[0], in.gravity[1], in.gravity[2]},
      .time_step = in.time_step,
      .sph_factor = in.alpha * in.time_step,
      .elastic_factor = in.elastic_factor,
  };
}

bool is_pinned(const ForcesInput& forces, std::size_t row) {
  return forces.pin && forces.pin[row] != 0;
}

/// Σ |a_ext| over the unpinned of a block, row by row.
double sum_external(const ForcesInput& forces, const MotionKernels& kernels, std::size_t begin,
                    std::size_t end, ConstVectors free, ConstVectors velocity) {
  std::array<float, k_block> external;
  kernels.external(forces, begin, end, free, velocity, external.data());
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

/// The particles [begin, end) of the store; only reads and writes their own rows.
MotionSums move_block(const MotionInput& in, const ForcesInput& forces, InstructionLevel level,
                      std::size_t begin, std::size_t end, ParticleStore& store,
                      std::span<ColliderLoad> loads) {
  const MotionKernels& kernels = MALLOW_SELECT(level, motion_kernels);
  MotionSums sums{.unpinned = end - begin};
  const BlockBounds bounds = kernels.blend(forces, begin, end, raw(store.next_velocity));
  if (forces.pin) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!is_pinned(forces, i)) continue;
      store.next_velocity.set(i, in.pin_velocities[forces.pin[i] - 1u]);
      --sums.unpinned;
    }
  }
  std::array<std::array<float, k_block>, 3> free;
  if (in.measure_external)
    for (std::size_t a = 0; a < 3; ++a)
      std::copy_n(store.next_velocity.axis(a) + begin, end - begin, free[a].data());
  if (!in.colliders.empty())
    resolve_contacts({begin, end, store.position, store.velocity, forces.pin, bounds}, in.colliders,
                     in.contact, store.next_velocity, loads);
  const ConstVectors velocity = raw(std::as_const(store.next_velocity));
  if (in.measure_external)
    sums.external =
        sum_external(forces, kernels, begin, end, {free[0].data(), free[1].data(), free[2].data()}, velocity);
  if (!kernels.advance(forces, begin, end, velocity, raw(store.next_position)))
    sums.bad_row = first_bad_row(store, begin, end);
  return sums;
}

}  // namespace

void move_particles(const Threads& threads, InstructionLevel level, ParticleStore& store,
                    MovingBodies& bodies) {
  bodies.blocks.clear();
  for (const MotionInput& in : bodies.inputs) bodies.blocks.add(in.end - in.begin);
  const std::size_t blocks = bodies.blocks.blocks.size(), colliders = bodies.loads.size();
  bodies.partial.resize(blocks);
  bodies.partial_loads.assign(blocks * colliders, {});
  parallel_for(threads, bodies.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const MotionInput& in = bodies.inputs[block.range];
    const auto loads = std::span(bodies.partial_loads).subspan(number * colliders, colliders);
    bodies.partial[number] =
        move_block(in, forces(in, store), level, in.begin + block.begin, in.begin + block.end, store, loads);
  });
  bodies.sums.assign(bodies.inputs.size(), {});
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t body = bodies.blocks.blocks[b].range;
    MotionSums& sums = bodies.sums[body];
    sums.external += bodies.partial[b].external;
    sums.unpinned += bodies.partial[b].unpinned;
    sums.bad_row = std::min(sums.bad_row, bodies.partial[b].bad_row);
    const double mass = static_cast<double>(bodies.inputs[body].mass);
    for (std::size_t c = 0; c < colliders; ++c) {
      bodies.loads[c].impulse += mass * bodies.partial_loads[b * colliders + c].impulse;
      bodies.loads[c].torque += mass * bodies.partial_loads[b * colliders + c].torque;
    }
  }
}

}  // namespace mallow
