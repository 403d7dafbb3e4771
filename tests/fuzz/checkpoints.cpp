#include "fuzz/checkpoints.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "mallow/files.h"
#include "mallow/mallow.h"

namespace mallow::fuzz {
namespace {

Body cube(int side, const Vec3& corner) {
  return sample(Lattice{.count = {side, side, side}, .corner = corner});
}

Simulation elastic() {
  Simulation s({.support_radius = 2.1f, .update_interval = 2, .threads = 1});
  s.add_body(cube(3, {0, 0, 1}), {.alpha = 0, .update_threshold = 0.1f});
  s.add_collider({.shape = Plane{}});
  return s;
}

Simulation fluid() {
  Simulation s({.support_radius = 2.1f, .neighbor_slack = 0.2f, .threads = 1});
  s.add_body(cube(3, {0, 0, 1}), {.alpha = 1});
  s.add_collider({.shape = Box{.min = {-1, -1, 0}, .max = {4, 4, 9}, .inside = true}});
  return s;
}

Simulation groups() {
  Simulation s({.support_radius = 2.1f, .threads = 1});
  s.add_body(cube(3, {0, 0, 1}), {.alpha = {{0, 1}, {1, 0.2f}}, .region_stride = 2}, "paste");
  s.add_body(cube(2, {5, 0, 1}), {.alpha = 0.5f, .viscosity = 1, .cohesion = 0.5f}, "jelly");
  s.add_collider(
      {.shape = Union{{Sphere{{1, 1, -2}, 2}, Box{{-3, -3, 0}, {-1, -1, 3}}}}, .velocity = {0, 0.1f, 0}});
  s.pin(Aabb{{0, 0, 1}, {3, 1, 2}}, {0, 0, 0.1f});
  return s;
}

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool equal(const SavedState& a, const SavedState& b) {
  if (a.chunks.size() != b.chunks.size()) return false;
  for (std::size_t k = 0; k < a.chunks.size(); ++k)
    if (a.chunks[k].name != b.chunks[k].name || a.chunks[k].bytes != b.chunks[k].bytes) return false;
  return true;
}

void require_finite(const std::vector<Vec3>& vectors) {
  for (const Vec3& v : vectors)
    if (!v.allFinite()) throw std::logic_error("a step left numbers that are not finite");
}

/// Chunk after chunk: its size, its bytes.
std::string plain(const SavedState& state) {
  std::string bytes;
  for (const Chunk& chunk : state.chunks) {
    const auto size = static_cast<std::uint32_t>(chunk.bytes.size());
    bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
    bytes += chunk.bytes;
  }
  return bytes;
}

SavedState from_plain(std::string_view bytes) {
  static const SavedState k_names = elastic().save();
  SavedState state;
  for (const Chunk& chunk : k_names.chunks) {
    std::uint32_t size = 0;
    if (bytes.size() < sizeof size) break;
    std::memcpy(&size, bytes.data(), sizeof size);
    bytes.remove_prefix(sizeof size);
    state.chunks.push_back({chunk.name, std::string(bytes.substr(0, size))});
    bytes.remove_prefix(state.chunks.back().bytes.size());
  }
  return state;
}

/// They differ in what they hold, before the first step and after some.
std::vector<SavedState> states() {
  std::vector<SavedState> states;
  for (const auto& build : {elastic, fluid, groups}) {
    Simulation simulation = build();
    states.push_back(simulation.save());
    for (int step = 0; step < 3; ++step) simulation.step();
    states.push_back(simulation.save());
  }
  return states;
}

}  // namespace

void read_as_checkpoint(const std::filesystem::path& file) {
  read_checkpoint(file);
}

void read_as_saved_state(const std::filesystem::path& file) {
  const SavedState state = from_plain(content_of(file));
  const std::filesystem::path checkpoint = file.parent_path() / "checkpoint";
  write_checkpoint(checkpoint, state);
  const SavedState read = read_checkpoint(checkpoint);
  if (!equal(read, state)) throw std::logic_error("a checkpoint reads as another one");
  Simulation simulation = Simulation::restore(read, 1);
  for (int step = 0; step < 3; ++step) simulation.step();
  require_finite(simulation.positions_by_id());
  require_finite(simulation.velocities_by_id());
}

void write_checkpoint_seeds(const std::filesystem::path& folder) {
  int k = 0;
  for (const char* format : {"checkpoint", "saved_state"})
    std::filesystem::create_directories(folder / format);
  for (const SavedState& state : states()) {
    const std::string name = std::to_string(k++);
    write_checkpoint(folder / "checkpoint" / name, state);
    std::ofstream(folder / "saved_state" / name, std::ios::binary) << plain(state);
  }
}

}  // namespace mallow::fuzz
