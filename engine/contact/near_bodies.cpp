#include "contact/near_bodies.h"

#include <algorithm>

#include "core/bounds.h"
#include "core/parallel.h"

namespace mallow {
namespace {

bool are_near(const Aabb& a, const Aabb& b, float reach) {
  return (a.min.array() <= b.max.array() + reach).all() && (b.min.array() <= a.max.array() + reach).all();
}

bool is_near(const Vec3& x, const Aabb& box, float reach) {
  return (x.array() >= box.min.array() - reach).all() && (x.array() <= box.max.array() + reach).all();
}

void find_boxes(const VectorColumn& positions, const std::vector<TouchingBody>& bodies,
                const Threads& threads, NearBodies& near) {
  near.blocks.clear();
  for (const TouchingBody& body : bodies) near.blocks.add(body.end - body.begin);
  near.block_box.resize(near.blocks.blocks.size());
  parallel_for(threads, near.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const std::size_t first = bodies[block.range].begin;
    near.block_box[number] = box_around(positions, first + block.begin, first + block.end);
  });
  near.body_box.assign(bodies.size(), empty_box());
  for (std::size_t b = 0; b < near.block_box.size(); ++b) {
    Aabb& box = near.body_box[near.blocks.blocks[b].range];
    box = box_around(box, near.block_box[b]);
  }
}

/// Sweeps over the bodies along the axis on which they are spread most.
void find_others(const std::vector<TouchingBody>& bodies, float reach, NearBodies& near) {
  const std::size_t n = bodies.size();
  near.others.resize(n);
  near.by_place.resize(n);
  Aabb all = empty_box();
  for (std::uint32_t b = 0; b < n; ++b) {
    near.others[b].clear();
    near.by_place[b] = b;
    all = box_around(all, {near.body_box[b].min, near.body_box[b].min});
  }
  int axis = 0;
  (all.max - all.min).maxCoeff(&axis);
  const auto lowest = [&](std::uint32_t b) { return near.body_box[b].min[axis]; };
  std::ranges::sort(near.by_place, [&](std::uint32_t a, std::uint32_t b) {
    return lowest(a) != lowest(b) ? lowest(a) < lowest(b) : a < b;
  });
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t a = near.by_place[k];
    const float end = near.body_box[a].max[axis] + reach;
    for (std::size_t l = k + 1; l < n && lowest(near.by_place[l]) <= end; ++l) {
      const std::uint32_t b = near.by_place[l];
      if (bodies[a].group == bodies[b].group || !are_near(near.body_box[a], near.body_box[b], reach))
        continue;
      near.others[a].push_back(b);
      near.others[b].push_back(a);
    }
  }
}

}  // namespace

void find_near_bodies(const VectorColumn& positions, const std::vector<TouchingBody>& bodies, float reach,
                      const Execution& execution, NearBodies& near) {
  find_boxes(positions, bodies, execution.threads, near);
  find_others(bodies, reach, near);
  near.count.assign(near.blocks.blocks.size(), 0);
  near.block_others.resize(near.blocks.blocks.size());
  near.found.resize_unset(positions.size());
  parallel_for(execution.threads, near.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    const std::size_t first = bodies[block.range].begin;
    std::uint32_t* const found = near.found.data() + first + block.begin;
    std::uint32_t count = 0;
    std::vector<std::uint32_t>& others = near.block_others[number];
    others.clear();
    for (const std::uint32_t other : near.others[block.range])
      if (are_near(near.block_box[number], near.body_box[other], reach)) others.push_back(other);
    for (std::size_t i = block.begin; i < block.end && !others.empty(); ++i) {
      const Vec3 x = positions.get(first + i);
      const auto holds = [&](std::uint32_t other) { return is_near(x, near.body_box[other], reach); };
      if (std::ranges::any_of(others, holds)) found[count++] = static_cast<std::uint32_t>(first + i);
    }
    near.count[number] = count;
  });
  std::size_t total = 0;
  for (const std::uint32_t count : near.count) total += count;
  near.row.resize_unset(total);
  near.body.resize_unset(total);
  std::size_t place = 0;
  for (std::size_t b = 0; b < near.count.size(); ++b) {
    const RangeBlocks::Block& block = near.blocks.blocks[b];
    std::copy_n(near.found.data() + bodies[block.range].begin + block.begin, near.count[b],
                near.row.data() + place);
    std::fill_n(near.body.data() + place, near.count[b], block.range);
    place += near.count[b];
  }
}

}  // namespace mallow
