#include "tradeoff/knobs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <sstream>

namespace mallow::bench {
namespace {

std::string text(double value) {
  std::ostringstream stream;
  stream << value;
  return stream.str();
}

std::string override_of(const char* key, double value) {
  std::ostringstream stream;
  stream.precision(9);
  stream << key << '=' << value;
  return stream.str();
}

/// What the scene is made of, as far as knobs go.
struct Base {
  double time_step, spacing, support_radius, region_radius;
  std::array<int, 3> count;
  int update_interval;
  bool sph, shape, updates;

  explicit Base(const Scene& scene) {
    const Material& material = scene.materials.front().material;
    const Lattice& box = std::get<Lattice>(scene.bodies.front().source);
    time_step = static_cast<double>(scene.solver.time_step.value());
    spacing = static_cast<double>(box.spacing);
    support_radius = static_cast<double>(*scene.solver.support_radius);
    region_radius = static_cast<double>(material.region_radius.value_or(*scene.solver.support_radius));
    count = box.count;
    update_interval = scene.solver.update_interval.value();
    sph = material.alpha.highest() > 0;
    shape = material.alpha.lowest() < 1;
    // Above gravity, only an impact could update the shape: the knob would be a lottery.
    updates = shape && material.update_threshold.value() < scene.solver.gravity.norm();
  }
};

/// `factor` times the particles along every side of the same box; radii stay the same number of spacings.
Setting particle_count(const Base& base, double factor) {
  std::array<int, 3> count;
  for (std::size_t a = 0; a < 3; ++a)
    count[a] = std::max(3, static_cast<int>(std::lround(factor * base.count[a])));
  const double share = static_cast<double>(base.count[0]) / count[0];
  std::ostringstream counts;
  counts << "body[0].box.count=[" << count[0] << ", " << count[1] << ", " << count[2] << "]";
  return {.knobs = "particles",
          .label = "n " + std::to_string(count[0] * count[1] * count[2]),
          .overrides = {counts.str(), override_of("body[0].box.spacing", base.spacing * share),
                        override_of("solver.support_radius", base.support_radius * share),
                        override_of("material[0].region_radius", base.region_radius * share)}};
}

struct Knob {
  std::string name;
  std::function<bool(const Base&)> applies;
  std::vector<double> values, few;
  std::function<Setting(const Base&, double)> at;
};

const std::vector<Knob>& all_knobs() {
  const auto always = [](const Base&) { return true; };
  const auto sph = [](const Base& base) { return base.sph; };
  const auto shape = [](const Base& base) { return base.shape; };
  static const std::vector<Knob> k_knobs = {
      {"particles", always, {0.5, 2.0 / 3, 5.0 / 6, 7.0 / 6, 4.0 / 3}, {2.0 / 3}, particle_count},
      {"support_radius",
       sph,
       {1.5, 1.75, 2.5, 3.0},
       {1.5},
       [](const Base& base, double spacings) -> Setting {
         return {.knobs = "support_radius",
                 .label = "sigma " + text(spacings) + " h",
                 .overrides = {override_of("solver.support_radius", spacings * base.spacing)}};
       }},
      {"region_radius",
       shape,
       {1.5, 1.75, 2.5, 3.0},
       {1.5},
       [](const Base& base, double spacings) -> Setting {
         return {.knobs = "region_radius",
                 .label = "region " + text(spacings) + " h",
                 .overrides = {override_of("material[0].region_radius", spacings * base.spacing)}};
       }},
      {"time_step",
       always,
       {1.5, 2.0 / 3, 0.5, 0.25},  // twice as long is more than elastic bodies carry
       {1.5, 0.5},
       [](const Base& base, double factor) -> Setting {
         return {.knobs = "time_step",
                 .label = "dt " + text(base.time_step * factor),
                 .overrides = {},
                 .time_step_factor = factor};
       }},
      {"rotation_iterations",
       shape,
       {0, 1, 2},
       {1},
       [](const Base&, double iterations) -> Setting {
         return {.knobs = "rotation_iterations",
                 .label = iterations == 0 ? "exact rotations" : "iterations " + text(iterations),
                 .overrides = {override_of("solver.rotation_iterations", iterations)}};
       }},
      {"region_stride",
       shape,
       {2, 3, 4, 8},
       {4},
       [](const Base&, double stride) -> Setting {
         return {.knobs = "region_stride",
                 .label = "stride " + text(stride),
                 .overrides = {override_of("material[0].region_stride", stride)}};
       }},
      {"volume_iterations",
       always,
       {1, 2, 3},
       {1},
       [](const Base&, double iterations) -> Setting {
         return {.knobs = "volume_iterations",
                 .label = "volume " + text(iterations),
                 .overrides = {override_of("solver.volume_iterations", iterations)}};
       }},
      {"neighbor_slack",
       sph,
       {0.05, 0.1, 0.2, 0.3},
       {0.1},
       [](const Base&, double slack) -> Setting {
         return {.knobs = "neighbor_slack",
                 .label = "slack " + text(slack),
                 .overrides = {override_of("solver.neighbor_slack", slack)}};
       }},
      {"arithmetic",
       sph,
       {0},
       {0},
       [](const Base&, double) -> Setting {
         return {.knobs = "arithmetic", .label = "native", .overrides = {"solver.arithmetic=\"native\""}};
       }},
      {"update_interval",
       [](const Base& base) { return base.updates; },
       {0.5, 2, 4},
       {2},
       [](const Base& base, double factor) -> Setting {
         const double interval = std::max(1.0, std::round(base.update_interval * factor));
         return {.knobs = "update_interval",
                 .label = "interval " + text(interval),
                 .overrides = {override_of("solver.update_interval", interval)}};
       }},
      {"quality",
       always,
       {0, 1, 2},
       {0, 2},
       [](const Base&, double index) -> Setting {
         const Quality quality = qualities()[static_cast<std::size_t>(index)];
         return {.knobs = "quality", .label = name(quality), .overrides = {}, .quality = quality};
       }},
      {"formulation",
       sph,
       {0},
       {0},
       [](const Base&, double) -> Setting {
         return {.knobs = "formulation", .label = "printed", .overrides = {"solver.formulation=\"printed\""}};
       }},
  };
  return k_knobs;
}

Setting joined(const Setting& a, const Setting& b) {
  if (a.baseline()) return b;
  if (b.baseline()) return a;
  Setting both = a;
  both.knobs += '+' + b.knobs;
  both.label += ", " + b.label;
  both.overrides.insert(both.overrides.end(), b.overrides.begin(), b.overrides.end());
  both.time_step_factor *= b.time_step_factor;
  return both;
}

/// Those that change what is computed and not what is modelled: their combinations are worth a look.
const std::vector<std::pair<std::string, std::vector<double>>> k_combined = {
    {"particles", {2.0 / 3}},  {"time_step", {2, 1.5, 0.5}}, {"rotation_iterations", {1}},
    {"region_stride", {2, 4}}, {"neighbor_slack", {0.1}},    {"arithmetic", {0}},
};

}  // namespace

std::span<const std::string> knob_names() {
  static const std::vector<std::string> k_names = [] {
    std::vector<std::string> names;
    for (const Knob& knob : all_knobs()) names.push_back(knob.name);
    return names;
  }();
  return k_names;
}

std::vector<Setting> make_settings(const Scene& scene, std::span<const std::string> knobs, bool small) {
  const Base base(scene);
  const Setting as_written{.knobs = "as written", .label = "as written"};
  std::vector<Setting> settings = {as_written};
  const auto used = [&](const Knob& knob) {
    return knob.applies(base) && std::find(knobs.begin(), knobs.end(), knob.name) != knobs.end();
  };
  for (const Knob& knob : all_knobs())
    if (used(knob))
      for (const double value : small ? knob.few : knob.values) settings.push_back(knob.at(base, value));
  if (small) return settings;

  std::vector<Setting> products = {as_written};
  for (const auto& [name, values] : k_combined) {
    const Knob& knob = *std::ranges::find(all_knobs(), name, &Knob::name);
    if (!used(knob)) continue;
    std::vector<Setting> next = products;
    for (const Setting& product : products)
      for (const double value : values) next.push_back(joined(product, knob.at(base, value)));
    products = std::move(next);
  }
  for (Setting& product : products)
    if (product.knobs.find('+') != std::string::npos) settings.push_back(std::move(product));
  return settings;
}

Setting fewer_particles(const Scene& scene, int side) {
  const Base base(scene);
  return particle_count(base, static_cast<double>(side) / base.count[0]);
}

Scene read_scene_at(const std::filesystem::path& file, const Setting& setting) {
  Scene scene = read_scene(file, setting.overrides);
  if (setting.quality) scene = with_quality(scene, *setting.quality);
  return setting.time_step_factor == 1 ? scene
                                       : at_time_step(scene, static_cast<float>(setting.time_step_factor));
}

}  // namespace mallow::bench
