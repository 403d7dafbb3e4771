#include "particles/particle_store.h"

#include <algorithm>

#include "core/parallel.h"

namespace mallow {
namespace {

/// Opens a gap of `count` values at `at`.
template <class T>
void open_gap(T* values, std::size_t size, std::size_t at, std::size_t count) {
  std::copy_backward(values + at, values + size, values + size + count);
}

}  // namespace

std::size_t ParticleStore::bytes() const {
  return position.bytes() + velocity.bytes() + id.bytes() + row_of_id.bytes() + pin.bytes() +
         next_position.bytes() + next_velocity.bytes();
}

void ParticleStore::insert(std::size_t at, std::span<const Vec3> positions,
                           std::span<const Vec3> velocities) {
  const std::size_t old = size(), count = positions.size();
  for (VectorColumn* column : {&position, &velocity}) {
    column->resize(old + count);
    for (std::size_t a = 0; a < 3; ++a) open_gap(column->axis(a), old, at, count);
  }
  id.resize(old + count);
  open_gap(id.data(), old, at, count);
  if (!pin.empty()) {
    pin.resize(old + count);
    open_gap(pin.data(), old, at, count);
    std::fill_n(pin.data() + at, count, std::uint16_t{0});
  }
  for (std::size_t k = 0; k < count; ++k) {
    position.set(at + k, positions[k]);
    velocity.set(at + k, velocities[k]);
    id[at + k] = static_cast<std::uint32_t>(old + k);
  }
  next_position.resize(old + count);
  next_velocity.resize(old + count);
  row_of_id.resize(old + count);
  for (std::size_t row = 0; row < old + count; ++row) row_of_id[id[row]] = static_cast<std::uint32_t>(row);
}

void ParticleStore::permute(std::size_t begin, std::span<const std::uint32_t> order, const Threads& threads) {
  const std::size_t n = order.size();
  const auto gather = [&](auto* values, auto* scratch) {
    parallel_for(threads, n, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k) scratch[k] = values[begin + order[k]];
    });
    parallel_for(threads, n, [&](std::size_t first, std::size_t last) {
      std::copy(scratch + first, scratch + last, values + begin + first);
    });
  };
  for (VectorColumn* column : {&position, &velocity})
    for (std::size_t a = 0; a < 3; ++a) gather(column->axis(a), next_position.axis(a));
  // The scratch columns hold floats; ids travel through them as the bits they are.
  static_assert(sizeof(std::uint32_t) == sizeof(float));
  gather(id.data(), reinterpret_cast<std::uint32_t*>(next_position.x()));
  if (!pin.empty()) gather(pin.data(), reinterpret_cast<std::uint16_t*>(next_position.x()));
  parallel_for(threads, n, [&](std::size_t first, std::size_t last) {
    for (std::size_t row = begin + first; row < begin + last; ++row)
      row_of_id[id[row]] = static_cast<std::uint32_t>(row);
  });
}

}  // namespace mallow
