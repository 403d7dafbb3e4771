// Linear blend skinning as mallow/skin.h writes it: one load, one product and one sum a particle, in the
// widest registers of the level; then four products of four for the vertex and three for its normal.
#include "surface/skin_lanes.h"

#include "core/lanes.h"

namespace mallow::MALLOW_LEVEL {
namespace {

constexpr std::size_t k_parts = k_skin_row / k_width;
/// Square of the length below which blended normals say nothing: they come from opposite turns.
constexpr float k_least_square = 1e-12f;

MALLOW_INLINE Quad all_of(float value) {
  return Quad{value, value, value, value};
}
MALLOW_INLINE Quad turned(const Quad* motion, const float* v) {
  return all_of(v[0]) * motion[0] + all_of(v[1]) * motion[1] + all_of(v[2]) * motion[2];
}
MALLOW_INLINE float squared(const Quad& v) {
  return v[0] * v[0] + (v[1] * v[1] + v[2] * v[2]);
}
/// What follows the three floats may be another thread's.
MALLOW_INLINE void store_three(const Quad& v, float* to) {
  copy_bytes(to, &v, 3 * sizeof(float));
}

MALLOW_INLINE void blend_motions(const VertexBinding& binding, const float* motions, Quad* motion) {
  Lanes sum[k_parts] = {};
  for (std::size_t k = 0; k < k_skin_particles; ++k) {
    const float* const row = motions + std::size_t{binding.particle[k]} * k_skin_row;
    for (std::size_t p = 0; p < k_parts; ++p) sum[p] += binding.weight[k] * load(row + p * k_width);
  }
  copy_bytes(motion, sum, sizeof sum);
}

void blend(const VertexBinding* bindings, const float* motions, const float origin[3], const float* vertices,
           const float* normals, std::size_t begin, std::size_t end, float* to_vertices,
           float* to_normals) noexcept {
  const Quad from = {origin[0], origin[1], origin[2], 0};
  for (std::size_t v = begin; v < end; ++v) {
    Quad motion[4];
    blend_motions(bindings[v], motions, motion);
    const Quad x = turned(motion, vertices + 3 * v) + motion[3] + from;
    Quad n = turned(motion, normals + 3 * v);
    float square = squared(n);
    if (square < k_least_square) {
      for (std::size_t c = 0; c < 3; ++c)
        motion[c] = load_quad(motions + std::size_t{bindings[v].particle[0]} * k_skin_row + 4 * c);
      n = turned(motion, normals + 3 * v);
      square = squared(n);
    }
    store_three(x, to_vertices + 3 * v);
    store_three(n / all_of(root(square)), to_normals + 3 * v);
  }
}

}  // namespace

extern const SkinLanes skin_lanes;
const SkinLanes skin_lanes = {blend};

}  // namespace mallow::MALLOW_LEVEL
