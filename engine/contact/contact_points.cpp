#include "contact/contact_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "shape_matching/run_tables.h"
#include "shape_matching/shape_matching.h"

namespace mallow {
namespace {

static_assert(k_most_points == k_block);

/// N_i of a particle that is in several regions: it turns with the first, from the middle of all.
Vec3 outward(const ShapeMatching& shape, std::size_t i) {
  Vec3 middle = Vec3::Zero();
  const std::vector<std::uint32_t> regions = decode(shape.by_particle(), i);
  for (const std::uint32_t region : regions) middle += shape.center.get(region);
  const Vec3 rest = shape.reference.get(i) - middle / static_cast<float>(regions.size());
  const std::size_t region = shape.first_region(i);
  const auto& q = shape.rotation;
  return Eigen::Quaternionf(q[3][region], q[0][region], q[1][region], q[2][region]) * rest;
}

ConstVectors from(const VectorColumn& column, std::size_t first) {
  return {column.x() + first, column.y() + first, column.z() + first};
}

BlockColumns columns_of(const VectorColumn& positions, const std::uint16_t* pin, const TouchingBody& body,
                        const RangeBlocks::Block& block, VectorColumn& outwards) {
  BlockColumns columns{.position = from(positions, body.begin + block.begin),
                       .reference = {},
                       .center = {},
                       .rotation = {},
                       .outward = {},
                       .pin = pin ? pin + body.begin + block.begin : nullptr,
                       .half_spacing = 0.5f * body.spacing,
                       .inverse_mass = 1.0f / body.mass,
                       .friction = std::sqrt(body.friction),
                       .adhesion = std::sqrt(body.adhesion)};
  if (!body.shape) return columns;
  if (body.shape->region_stride == 1) {
    columns.reference = from(body.shape->reference, block.begin);
    columns.center = from(body.shape->center, block.begin);
    for (std::size_t k = 0; k < 4; ++k) columns.rotation[k] = body.shape->rotation[k].data() + block.begin;
    return columns;
  }
  outwards.resize(k_block);
  for (std::size_t i = block.begin; i < block.end; ++i)
    outwards.set(i - block.begin, outward(*body.shape, i));
  columns.outward = raw(std::as_const(outwards));
  return columns;
}

}  // namespace

std::size_t ContactPoints::bytes() const {
  std::size_t sum = first.bytes() + first_row.capacity() * sizeof(std::size_t);
  for (const VectorColumn* column : {&position, &low, &high, &motion.velocity, &found_motion.velocity})
    sum += column->bytes();
  for (const Column<float>* column :
       {&place, &outward, &matter, &velocity, &inverse_mass, &motion.spread, &found_motion.spread})
    sum += column->bytes();
  return sum;
}

void place_points(const VectorColumn& positions, const std::uint16_t* pin,
                  const std::vector<TouchingBody>& bodies, const NearBlocks& near, const Execution& execution,
                  ContactPoints& points) {
  const std::vector<RangeBlocks::Block>& blocks = near.blocks.blocks;
  points.first.resize_unset(blocks.size() + 1);
  points.first[0] = 0;
  points.first_row.resize(blocks.size());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::size_t rows = near.others[b].empty() ? 0 : blocks[b].end - blocks[b].begin;
    points.first[b + 1] =
        points.first[b] + static_cast<std::uint32_t>((rows + k_cluster - 1) / k_cluster * k_cluster);
    points.first_row[b] = bodies[blocks[b].range].begin + blocks[b].begin;
  }
  const std::size_t n = points.first[blocks.size()];
  points.position.resize_unset(n);
  points.inverse_mass.resize_unset(n);
  for (Column<float>* rows : {&points.place, &points.outward, &points.matter, &points.velocity})
    rows->resize_unset(4 * n);
  for (VectorColumn* corner : {&points.low, &points.high}) corner->resize_unset(n / k_cluster);
  const PointLanes& lanes = MALLOW_SELECT(execution.level, point_lanes);
  const PointColumns columns{raw(points.position), points.place.data(), points.outward.data(),
                             points.matter.data(), points.inverse_mass.data()};
  const FewColumns fews{raw(points.low), raw(points.high), {}, nullptr};
  parallel_for(execution.threads, near.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    if (points.first[number] == points.first[number + 1]) return;
    thread_local VectorColumn outwards;
    lanes.place(columns_of(positions, pin, bodies[block.range], block, outwards), block.end - block.begin,
                points.first[number], columns, fews);
  });
}

void move_points(const VectorColumn& velocities, const NearBlocks& near, const Execution& execution,
                 ContactPoints& points) {
  const std::size_t fews = points.size() / k_cluster;
  points.motion.velocity.resize_unset(fews);
  points.motion.spread.resize_unset(fews);
  const PointLanes& lanes = MALLOW_SELECT(execution.level, point_lanes);
  const FewColumns columns{{}, {}, raw(points.motion.velocity), points.motion.spread.data()};
  parallel_for(execution.threads, near.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    if (points.first[number] == points.first[number + 1]) return;
    lanes.set_velocities(from(velocities, points.first_row[number]), block.end - block.begin,
                         points.first[number], points.velocity.data(), columns);
  });
}

void return_points(const ContactPoints& points, const NearBlocks& near, const Execution& execution,
                   VectorColumn& velocities) {
  const PointLanes& lanes = MALLOW_SELECT(execution.level, point_lanes);
  const Vectors to = raw(velocities);
  parallel_for(execution.threads, near.blocks, [&](const RangeBlocks::Block& block, std::size_t number) {
    if (points.first[number] == points.first[number + 1]) return;
    const std::size_t row = points.first_row[number];
    lanes.get_velocities(points.velocity.data(), block.end - block.begin, points.first[number],
                         {to.x + row, to.y + row, to.z + row});
  });
}

}  // namespace mallow
