#include "particles/particle_store.h"

#include <type_traits>

#include "core/parallel.h"
#include "particles/particle_columns.h"

namespace mallow {
namespace {

/// values[begin + k] becomes what values[begin + order[k]] was; through `scratch`, of as many as the order:
/// with that of the same rows, those of other bodies keep what they have there.
template <class T, class Scratch>
void gather(const Threads& threads, std::size_t begin, std::span<const std::uint32_t> order, T* values,
            Scratch* scratch) {
  parallel_for(threads, order.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) scratch[k] = values[begin + order[k]];
  });
  parallel_for(threads, order.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) values[begin + k] = static_cast<T>(scratch[k]);
  });
}

/// The columns of a store that are there, one after the other.
template <class Visit>
void for_each_present(ParticleStore& store, const Visit& visit) {
  for_each_column(store, [&](const SavedColumn&, auto& column) {
    if (column.size() > 0) visit(column);
  });
}

}  // namespace

std::size_t ParticleStore::bytes() const {
  std::size_t sum = slots.bytes() + next_position.bytes() + next_velocity.bytes() + words.bytes();
  for_each_column(*this, [&](const SavedColumn&, const auto& column) { sum += column.bytes(); });
  return sum;
}

void ParticleStore::insert(std::size_t at, std::span<const Vec3> positions,
                           std::span<const Vec3> velocities) {
  const std::size_t count = positions.size();
  const bool first = size() == 0;
  if (first) {
    for (VectorColumn* column : {&position, &velocity}) column->resize(count);
    id.resize(count);
  } else {
    for_each_present(*this, [&](auto& column) { column.insert(at, count); });
  }
  for (std::size_t k = 0; k < count; ++k) {
    position.set(at + k, positions[k]);
    velocity.set(at + k, velocities[k]);
    id[at + k] = slots.take();
  }
  slots.place(at, id.span().subspan(at));
  next_position.resize(size());
  next_velocity.resize(size());
}

void ParticleStore::erase(std::span<const std::uint32_t> rows) {
  if (rows.empty()) return;
  for (const std::uint32_t row : rows) slots.give_back(id[row]);
  for_each_present(*this, [&](auto& column) { column.erase(rows); });
  slots.place(rows.front(), id.span().subspan(rows.front()));
  next_position.resize(size());
  next_velocity.resize(size());
}

void ParticleStore::permute(std::size_t begin, std::span<const std::uint32_t> order, const Threads& threads) {
  for_each_present(*this, [&](auto& column) {
    if constexpr (std::is_same_v<decltype(column), VectorColumn&>) {
      for (std::size_t a = 0; a < 3; ++a)
        gather(threads, begin, order, column.axis(a), next_position.axis(a) + begin);
    } else if constexpr (std::is_same_v<decltype(column), Column<float>&>) {
      gather(threads, begin, order, column.data(), next_position.axis(0) + begin);
    } else {
      words.resize(size());
      gather(threads, begin, order, column.data(), words.data() + begin);
    }
  });
  parallel_for(threads, order.size(), [&](std::size_t first, std::size_t last) {
    slots.place(begin + first, id.span().subspan(begin + first, last - first));
  });
}

}  // namespace mallow
