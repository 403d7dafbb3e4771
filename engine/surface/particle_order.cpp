#include "surface/particle_order.h"

#include <algorithm>
#include <string>

#include "mallow/errors.h"

namespace mallow {
namespace {

constexpr std::uint32_t k_most_slots = 1u << 28;
constexpr std::uint32_t k_no_row = UINT32_MAX;

}  // namespace

void ParticleOrder::sort(const SurfaceParticles& particles, bool joined) {
  const std::size_t n = particles.positions.size();
  const auto for_each_row = [&](const auto& visit) {
    for (const SurfaceBody& body : particles.bodies) {
      const Simulation::Rows rows = rows_of(body, n);
      for (std::size_t row = rows.begin; row < rows.end; ++row) visit(joined ? 0 : body.body, row);
    }
  };
  std::size_t surfaces = 1;
  if (!joined)
    for (const SurfaceBody& body : particles.bodies)
      surfaces = std::max(surfaces, std::size_t{body.body} + 1);
  start_.assign(surfaces + 1, 0);
  for (const SurfaceBody& body : particles.bodies) {
    const Simulation::Rows rows = rows_of(body, n);
    start_[joined ? 1 : std::size_t{body.body} + 1] += rows.end - rows.begin;
  }
  for (std::size_t s = 0; s < surfaces; ++s) start_[s + 1] += start_[s];
  next_.assign(start_.begin(), start_.end() - 1);
  rows_.resize(start_.back());
  if (particles.ids.empty()) {
    for_each_row(
        [&](std::size_t surface, std::size_t row) { add(surface, static_cast<std::uint32_t>(row)); });
    return;
  }

  std::uint32_t largest = 0;
  for (const ParticleId id : particles.ids) largest = std::max(largest, slot_of(id));
  if (largest >= k_most_slots)
    throw ConfigError("ids",
                      std::to_string(largest) + " is not allowed: below " + std::to_string(k_most_slots));
  row_of_slot_.assign(largest + 1, k_no_row);
  surface_of_row_.resize(n);
  for_each_row([&](std::size_t surface, std::size_t row) {
    row_of_slot_[slot_of(particles.ids[row])] = static_cast<std::uint32_t>(row);
    surface_of_row_[row] = static_cast<std::uint32_t>(surface);
  });
  std::size_t found = 0;
  for (const std::uint32_t row : row_of_slot_) {
    if (row == k_no_row) continue;
    add(surface_of_row_[row], row);
    ++found;
  }
  if (found < rows_.size()) throw ConfigError("ids", "are not distinct");
}

std::size_t ParticleOrder::bytes() const {
  return (start_.capacity() + next_.capacity()) * sizeof(std::size_t) +
         (rows_.capacity() + row_of_slot_.capacity() + surface_of_row_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace mallow
