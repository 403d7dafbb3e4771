#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mallow/export.h"
#include "mallow/vec3.h"

namespace mallow {

/// Points that stand for a body at rest, and how it starts to move.
struct Body {
  std::vector<Vec3> positions = {};   ///< [m], finite, at least one
  float spacing = 1.0f;               ///< distance of neighbouring points, h [m], > 0
  Vec3 velocity{0, 0, 0};             ///< of every point [m/s]
  std::vector<Vec3> velocities = {};  ///< of each point, added to `velocity`; empty or as long as `positions`
  /// α of each point, in [0, 1], in place of the material's; empty or as long as `positions`. What is soft,
  /// or flows, inside of what is not: regions count by the α of the particle that owns them and pairs of SPH
  /// by the mean of the two, so that momentum is kept exactly. [model 2, section 7]
  std::vector<float> alpha = {};
  /// Material::plastic_yield at each point, >= 0, in place of the material's, which must have one: what is
  /// very large never flows. Regions flow by that of the particle that owns them. Empty, or as long as
  /// `positions`.
  std::vector<float> plastic_yield = {};
  /// Factor on the material's elastic modulus at each point, >= 0, up to what a step carries: (1 − α) times
  /// it is bounded as Material::elastic_time_step says. Empty, where it is 1 everywhere, or as long as
  /// `positions`.
  std::vector<float> stiffness = {};
  /// Of each point at the start [K], finite, where the material carries heat; empty: the material's. Else as
  /// long as `positions`.
  std::vector<float> temperature = {};
  /// Acts on other bodies of its material that merge, and of its spacing, as on itself: two puddles become
  /// one. Bodies that do not merge touch. Where such bodies flow (Material::plastic_yield), move, and are
  /// pressed into each other as Material::merge_flow says, they become one body at the next check
  /// (SolverConfig::update_period), and a `merged` event names those that end: the one that was added first
  /// keeps its id, name, user data, mass and spacing, and of report_contacts() the lower impulse counts. Rows
  /// of all are one range; particles keep ids, velocities, pins, temperatures and what is painted on them,
  /// and emitters go on in the body that is there. Where only one has an alpha of its own by particle, those
  /// of the others keep the one that they have then.
  bool merges = false;
  /// Where it was torn (BodyEvent::Kind::torn), its parts become bodies of their own at the start of the next
  /// step, as by Simulation::split(): so they touch each other as bodies do, which parts of one body do not
  /// where alpha is 0, and come to rest and sleep each for itself.
  bool splits = false;
  /// What whoever made the body should know, in words: a mesh that was turned inside out, volume that the
  /// spacing loses. Nothing reads it but people.
  std::vector<std::string> notes = {};
};

/// Bodies move as their lattice lies where it is perfect: a fluid spreads in four lobes, a solid tears along
/// layers. This much is enough to lose its directions.
inline constexpr float k_default_jitter = 0.2f;

/// A box of count[0] × count[1] × count[2] cells of side `spacing` from `corner` on; a point in each cell's
/// centre.
struct Lattice {
  std::array<int, 3> count{1, 1, 1};  ///< each in [1, 100000000]
  float spacing = 1.0f;               ///< [m], > 0
  Vec3 corner{0, 0, 0};               ///< lowest corner of the box, half a cell from the first point
  float jitter = k_default_jitter;    ///< in [0, 0.45], as in Sampling
};

/// How a volume is filled: give one of `spacing` and `count`.
struct Sampling {
  std::optional<float> spacing = {};  ///< h [m], > 0
  /// Points wanted, in [1, 100000000]; met within 1% where the shape allows it.
  std::optional<int> count = {};
  /// Random displacement of every lattice point, at most jitter · h per axis and half of that as a rule, in
  /// [0, 0.45], so that points stay a tenth of h apart. It is free of divergence, so that bodies start as
  /// dense as a lattice, and at rest. The same for every run and machine.
  float jitter = k_default_jitter;
};

/// Signed distance to a closed shape [m], negative inside. Its slope is 1; up to 1.5 is sampled correctly.
using DistanceFunction = std::function<float(const Vec3&)>;

/// A closed shape given by its distance function and a box that holds it.
struct ImplicitShape {
  DistanceFunction distance;
  Aabb bounds;
  std::optional<double> volume = {};    ///< [m³]; where it is known, sample() notes when points miss it
  std::vector<std::string> notes = {};  ///< become those of bodies that are sampled from it
};

/// A ball. Throws ConfigError where the radius is not above 0.
MALLOW_EXPORT ImplicitShape sphere_shape(const Vec3& center, float radius);
/// The head of [TK] Fig. 5(a) in our own making: smoothly joined implicit shapes, 40 high, standing on z = 0,
/// looking along +x.
MALLOW_EXPORT ImplicitShape moai_shape();
/// An implicit shape by the name it has in scene files ("moai"). Throws ConfigError that lists the known
/// names.
MALLOW_EXPORT ImplicitShape implicit_shape(const std::string& name);
/// Every name implicit_shape() knows.
MALLOW_EXPORT std::span<const char* const> implicit_shape_names();

/// Where a shape is put: turned about x, then y, then z [degrees], scaled so that the longest side of its
/// bounds is `size` [m], and moved so that the middle of its bounds is at `center`. What is left out stays as
/// it is.
struct Placement {
  Vec3 rotate{0, 0, 0};
  std::optional<float> size = {};  ///< > 0
  std::optional<Vec3> center = {};
};
/// The shape, placed. Throws ConfigError where a value is out of range.
MALLOW_EXPORT ImplicitShape place(const ImplicitShape& shape, const Placement& placement);

/// The points of a lattice box. Throws ConfigError.
MALLOW_EXPORT Body sample(const Lattice& lattice);
/// The points of a cubic lattice inside a shape. This is the one sampler of volumes: library, scene files and
/// command line report the same count. Where the points stand for over 10% more or less than the shape's
/// volume, the body's notes name both, and a spacing that does better. Throws ConfigError where a value is
/// out of range, no point lies inside, or floats cannot tell neighbouring points apart.
MALLOW_EXPORT Body sample(const ImplicitShape& shape, const Sampling& sampling);

}  // namespace mallow
