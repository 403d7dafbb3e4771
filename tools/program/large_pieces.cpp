#include "program/large_pieces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>

namespace mallow::program {
namespace {

constexpr float k_cell = 1.5f;         ///< side of a cell, in spacings
constexpr std::size_t k_large = 20;    ///< a piece is large that is at least one in so many of its body
constexpr float k_farthest = 1 << 30;  ///< cells from the origin that a number holds, with those beside

/// A cell that holds particles of a body; those that touch are one piece.
struct Cell {
  std::uint32_t body;
  std::int32_t x, y, z;
  auto operator<=>(const Cell&) const = default;
};

Cell cell_of(const Vec3& position, std::uint32_t body, std::span<const float> spacings) {
  if (body >= spacings.size()) return {body, 0, 0, 0};
  const auto number = [&](float along) {
    return static_cast<std::int32_t>(
        std::floor(std::clamp(along / (k_cell * spacings[body]), -k_farthest, k_farthest)));
  };
  return {body, number(position.x()), number(position.y()), number(position.z())};
}

/// Sets of cells, each with one of them as its root.
class Sets {
 public:
  explicit Sets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }
  std::size_t root(std::size_t at) {
    while (parents_[at] != at) at = parents_[at] = parents_[parents_[at]];
    return at;
  }
  void join(std::size_t a, std::size_t b) { parents_[root(a)] = root(b); }

 private:
  std::vector<std::size_t> parents_;
};

/// Joins each cell with those that touch it and come after it in the order of cells.
void join_neighbors(const std::vector<Cell>& cells, Sets& pieces) {
  for (int dx = 0; dx <= 1; ++dx)
    for (int dy = -1; dy <= 1; ++dy) {
      if (dx == 0 && dy < 0) continue;
      // The three cells of a line along z, of which the order moves on as the cell's own does.
      std::size_t next = 0;
      for (std::size_t c = 0; c < cells.size(); ++c) {
        const Cell& cell = cells[c];
        const Cell first{cell.body, cell.x + dx, cell.y + dy, cell.z - 1};
        while (next < cells.size() && cells[next] < first) ++next;
        for (std::size_t n = next; n < cells.size() && n < next + 3; ++n)
          if (std::tie(cells[n].body, cells[n].x, cells[n].y) == std::tie(first.body, first.x, first.y) &&
              cells[n].z <= cell.z + 1)
            pieces.join(c, n);
      }
    }
}

}  // namespace

std::vector<bool> in_large_pieces(const ParticleFrame& frame, std::span<const float> spacings) {
  const std::size_t count = frame.positions.size();
  std::vector<Cell> cell(count);
  for (std::size_t i = 0; i < count; ++i) cell[i] = cell_of(frame.positions[i], frame.bodies[i], spacings);
  std::vector<Cell> cells = cell;
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  Sets pieces(cells.size());
  join_neighbors(cells, pieces);

  std::vector<std::size_t> piece(count), in_piece(cells.size());
  std::vector<std::size_t> in_body(cells.empty() ? 0 : std::size_t{cells.back().body} + 1);
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = std::ranges::lower_bound(cells, cell[i]) - cells.begin();
    piece[i] = pieces.root(static_cast<std::size_t>(at));
    ++in_piece[piece[i]];
    ++in_body[frame.bodies[i]];
  }
  std::vector<bool> large(count);
  for (std::size_t i = 0; i < count; ++i) large[i] = k_large * in_piece[piece[i]] >= in_body[frame.bodies[i]];
  return large;
}

}  // namespace mallow::program
