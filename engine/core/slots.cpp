#include "core/slots.h"

namespace mallow {

std::uint64_t Slots::take() {
  if (free.empty()) {
    index.resize(index.size() + 1);
    if (!generation.empty()) generation.resize(index.size());
    return index.size() - 1;
  }
  const std::uint32_t slot = free.back();
  free.pop_back();
  return std::uint64_t{generation[slot]} << 32 | slot;
}

void Slots::give_back(std::uint64_t id) {
  const std::uint32_t slot = slot_of(id);
  if (generation.empty()) generation.resize(index.size());
  ++generation[slot];
  ++given_back;
  index[slot] = k_free;
  free.push_back(slot);
}

void Slots::place(std::size_t begin, std::span<const std::uint64_t> ids) {
  for (std::size_t k = 0; k < ids.size(); ++k) index[slot_of(ids[k])] = static_cast<std::uint32_t>(begin + k);
}

std::optional<std::size_t> Slots::find(std::uint64_t id) const {
  const std::uint32_t slot = slot_of(id);
  if (slot >= index.size() || index[slot] == k_free) return std::nullopt;
  if (generation_of(id) != (generation.empty() ? 0 : generation[slot])) return std::nullopt;
  return index[slot];
}

}  // namespace mallow
