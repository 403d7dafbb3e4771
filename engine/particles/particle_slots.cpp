#include "particles/particle_slots.h"

namespace mallow {

ParticleId ParticleSlots::take() {
  if (free.empty()) {
    row.resize(row.size() + 1);
    if (!generation.empty()) generation.resize(row.size());
    return row.size() - 1;
  }
  const std::uint32_t slot = free.back();
  free.pop_back();
  return ParticleId{generation[slot]} << 32 | slot;
}

void ParticleSlots::give_back(ParticleId id) {
  const std::uint32_t slot = slot_of(id);
  if (generation.empty()) generation.resize(row.size());
  ++generation[slot];
  row[slot] = k_free;
  free.push_back(slot);
}

void ParticleSlots::place(std::size_t begin, std::span<const ParticleId> ids) {
  for (std::size_t k = 0; k < ids.size(); ++k) row[slot_of(ids[k])] = static_cast<std::uint32_t>(begin + k);
}

std::optional<std::size_t> ParticleSlots::find(ParticleId id) const {
  const std::uint32_t slot = slot_of(id);
  if (slot >= row.size() || row[slot] == k_free) return std::nullopt;
  if (generation_of(id) != (generation.empty() ? 0 : generation[slot])) return std::nullopt;
  return row[slot];
}

}  // namespace mallow
