#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "colliders/shapes.h"
#include "config/field_archive.h"
#include "config/field_checks.h"
#include "config/field_tables.h"
#include "config/run_field_tables.h"

namespace mallow {
namespace field_table_test {

/// Calls visit.operator()<Config>(name, header) with each config that has a table.
template <class Visit>
void for_tables(const Visit& visit) {
  visit.template operator()<SolverConfig>("SolverConfig", "solver_config.h");
  visit.template operator()<Material>("Material", "material.h");
  visit.template operator()<Sampling>("Sampling", "body.h");
  visit.template operator()<Placement>("Placement", "body.h");
  visit.template operator()<Lattice>("Lattice", "body.h");
  visit.template operator()<Collider>("Collider", "collider.h");
  visit.template operator()<Emitter>("Emitter", "emitter.h");
  visit.template operator()<Sphere>("Sphere", "collider.h");
  visit.template operator()<Box>("Box", "collider.h");
  visit.template operator()<Capsule>("Capsule", "collider.h");
  visit.template operator()<Cylinder>("Cylinder", "collider.h");
  visit.template operator()<Cone>("Cone", "collider.h");
  visit.template operator()<ConvexHull>("ConvexHull", "collider.h");
  visit.template operator()<DistanceField>("DistanceField", "collider.h");
  visit.template operator()<Plane>("Plane", "collider.h");
  visit.template operator()<SurfaceConfig>("SurfaceConfig", "surface_config.h");
  visit.template operator()<RunConfig>("RunConfig", "scene.h");
  visit.template operator()<RenderConfig>("RenderConfig", "scene.h");
}

/// Calls visit(name of the config, field) with each setting of each.
template <class Visit>
void for_settings(const Visit& visit) {
  for_tables([&]<class Config>(const std::string& name, const char*) {
    for_fields<Config>([&](const auto& field) { visit(Config{}, name + '.' + field.name, field); });
  });
}

std::string problems_of(Checks& checks) {
  try {
    checks.finish();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return {};
}

template <class T>
std::string problem(const std::string& path, const T& value, const Range& range) {
  Checks checks;
  check_value(path, value, range, checks);
  return problems_of(checks);
}

TEST(field_table, every_default_is_in_its_range) {
  for_settings([](const auto& config, const std::string& path, const auto& field) {
    if (field.left_out == k_required) return;
    EXPECT_EQ(problem(path, config.*field.member, field.range), "");
  });
}

TEST(field_table, settings_of_a_config_have_a_meaning_and_a_name_each) {
  std::set<std::string> paths;
  for_settings([&](const auto&, const std::string& path, const auto& field) {
    EXPECT_TRUE(paths.insert(path).second) << path;
    EXPECT_NE(std::string(field.doc), "") << path;
  });
}

template <class T>
T beyond(double bound, int direction) {
  if constexpr (std::is_integral_v<T>)
    return static_cast<T>(static_cast<long>(bound) + direction);
  else
    return std::nextafter(static_cast<T>(bound),
                          static_cast<T>(direction) * std::numeric_limits<T>::infinity());
}

/// Bounds that are values of T are allowed, and what lies next to them outside is not.
template <class T>
void expect_sharp(const std::string& path, const Range& range, const T&) {
  if constexpr (k_is_optional<T>) {
    expect_sharp(path, range, typename T::value_type{});
  } else if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
    const auto outside = [&](T value) {
      std::ostringstream text;
      text << path << ": " << value << " is not allowed: " << allowed<T>(range);
      EXPECT_EQ(problem(path, value, range), text.str());
    };
    if (std::isfinite(range.lowest)) {
      const T lowest = static_cast<T>(range.lowest);
      if (range.above_lowest) outside(lowest);
      if (!range.above_lowest) {
        EXPECT_EQ(problem(path, lowest, range), "");
      }
      outside(beyond<T>(range.lowest, -1));
    }
    if (std::isfinite(range.highest)) {
      EXPECT_EQ(problem(path, static_cast<T>(range.highest), range), "");
      if (range.highest < std::numeric_limits<int>::max()) outside(beyond<T>(range.highest, 1));
    }
    if constexpr (std::is_floating_point_v<T>)
      for (const T value : {std::numeric_limits<T>::infinity(), std::numeric_limits<T>::quiet_NaN()})
        outside(value);
  }
}

TEST(field_table, checks_refuse_what_is_next_to_a_bound_and_say_what_is_allowed) {
  for_settings([](const auto& config, const std::string& path, const auto& field) {
    expect_sharp(path, field.range, config.*field.member);
  });
  EXPECT_EQ(problem("color", Vec3(0, 1.5f, -1), between(0, 1)),
            "color[1]: 1.5 is not allowed: a number in [0, 1]\n"
            "color[2]: -1 is not allowed: a number in [0, 1]");
  EXPECT_EQ(problem("kind", static_cast<SurfaceKind>(3), k_any),
            "kind: 3 is not allowed: \"blended\", \"anisotropic\" or \"spheres\"");
}

TEST(field_table, range_of_a_member_is_that_of_its_table) {
  static_assert(range_of(&SurfaceConfig::voxels).highest == 1024);
  static_assert(range_of(&RenderConfig::width).lowest == 16 && range_of(&RenderConfig::samples).lowest == 1);
}

template <class Config>
std::string names_in_states() {
  std::string names;
  for_fields<Config>([&](const auto& field) {
    if (field.in_states()) names += std::string(names.empty() ? "" : " ") + field.name;
  });
  return names;
}

// What fails here has changed what saved states hold: their version in saved_state.cpp must be counted up.
TEST(field_table, states_of_version_11_hold_these_settings_in_this_order) {
  EXPECT_EQ(
      names_in_states<SolverConfig>(),
      "time_step time_step_factor support_radius gravity update_period update_interval formulation "
      "acoustic_limit contact contact_offset wall_pressure volume_iterations volume_tolerance sleep_speed "
      "sleep_time air_temperature rotation_iterations "
      "neighbor_slack arithmetic "
      "memory_limit");
  EXPECT_EQ(names_in_states<Material>(),
            "alpha update_threshold plastic_yield plastic_yield_by_temperature plastic_creep merge_flow "
            "tear_strain pressure_coefficient "
            "viscosity elastic_time_step youngs_modulus particle_mass "
            "rest_density cohesion friction adhesion damping_time deformation_damping region_radius "
            "region_stride temperature conductivity specific_heat latent_heat solidus liquidus heat_transfer "
            "alpha_by_temperature viscosity_by_temperature");
  EXPECT_EQ(names_in_states<Collider>(),
            "velocity angular_velocity surface_velocity restitution friction temperature heat_transfer "
            "measure_load");
  EXPECT_EQ(names_in_states<Emitter>(),
            "radius width height spacing velocity speed start stop jitter most_particles merges");
  EXPECT_EQ(names_in_states<Sphere>(), "center radius inside");
  EXPECT_EQ(names_in_states<Box>(), "min max inside");
  EXPECT_EQ(names_in_states<Capsule>(), "start end radius inside");
  EXPECT_EQ(names_in_states<Cylinder>(), "start end radius inside");
  EXPECT_EQ(names_in_states<Cone>(), "start end start_radius end_radius inside");
  EXPECT_EQ(names_in_states<ConvexHull>(), "inside");
  EXPECT_EQ(names_in_states<DistanceField>(), "inside");
  EXPECT_EQ(names_in_states<Plane>(), "normal offset");
}

template <class Config>
std::string packed(const Config& config) {
  PackingArchive archive;
  pass_fields(archive, config);
  return archive.take();
}

template <class Config>
Config unpacked(const std::string& bytes) {
  UnpackingArchive archive("test", bytes);
  Config config;
  pass_fields(archive, config);
  archive.finish();
  return config;
}

TEST(field_table, archives_give_back_every_kind_of_value) {
  const SolverConfig solver{.time_step = 0.25f,
                            .support_radius = 2,
                            .gravity = {1, 2, 3},
                            .update_interval = 7,
                            .formulation = Formulation::printed,
                            .acoustic_limit = false};
  const auto read = unpacked<SolverConfig>(packed(solver));
  EXPECT_EQ(packed(read), packed(solver));
  EXPECT_EQ(read.time_step, 0.25f);
  EXPECT_EQ(read.gravity, Vec3(1, 2, 3));
  EXPECT_FALSE(read.update_period.has_value());
  EXPECT_EQ(read.update_interval, 7);
  EXPECT_EQ(read.formulation, Formulation::printed);
  EXPECT_FALSE(read.acoustic_limit);
  const Material material{.alpha = {{0, 0.5f}, {2, 1}}, .region_stride = 3};
  const auto again = unpacked<Material>(packed(material));
  ASSERT_EQ(again.alpha.keys().size(), 2u);
  EXPECT_EQ(again.alpha.keys()[1].time, 2);
  EXPECT_EQ(packed(again), packed(material));
}

TEST(field_table, archives_refuse_a_choice_that_there_is_not) {
  std::string bytes = packed(SolverConfig{});
  // Behind the optional members that are left out: time_step, support_radius, update_period, update_interval.
  constexpr std::size_t k_formulation = 1 + 4 + 1 + 12 + 1 + 1;
  bytes[k_formulation] = 2;
  EXPECT_THROW(unpacked<SolverConfig>(bytes), ConfigError);
}

/// The comment of a member, on one line: that which stands behind it, or above it.
std::string doc_of(const std::string& header, const std::string& config, const std::string& member) {
  std::ifstream file(MALLOW_HEADERS + header);
  const std::regex begin("struct " + config + "\\b.*"), declares(" .*\\b" + member + "(\\{.*| = .*|;.*)");
  std::string line, above;
  while (std::getline(file, line) && !std::regex_match(line, begin)) {
  }
  while (std::getline(file, line) && line != "};") {
    const std::size_t comment = line.find("///");
    if (std::regex_match(line, declares) && line.find_first_not_of(' ') != comment) {
      if (comment == std::string::npos) return above;
      std::string behind = line.substr(comment);
      while (std::getline(file, line) && line.find_first_not_of(' ') == line.find("///<"))
        behind += line.substr(line.find("///<") + 4);
      return behind;
    }
    if (line.find_first_not_of(' ') == comment)
      above += line.substr(comment + 3);
    else
      above.clear();
  }
  return "no member " + member + " of " + config;
}

/// " > 0", " >= 1" or "in [0, 1]", as comments have it.
std::string documented(const Range& range) {
  const bool open = !(range.highest < std::numeric_limits<int>::max());
  return range_text(open ? Range{.lowest = range.lowest, .above_lowest = range.above_lowest} : range);
}

TEST(field_table, public_headers_document_the_same_ranges) {
  for_tables([]<class Config>(const std::string& config, const char* header) {
    for_fields<Config>([&](const auto& field) {
      using Member = std::remove_cvref_t<decltype(Config{}.*field.member)>;
      if (std::is_same_v<Member, AlphaSchedule>) return;  // its class says it
      const std::string doc = doc_of(header, config, field.name), range = documented(field.range);
      if (range.empty() || doc.find("as in ") != std::string::npos) return;
      EXPECT_NE(doc.find(range.substr(1)), std::string::npos)
          << header << ", " << config << "::" << field.name << " has to say" << range << ", not:" << doc;
    });
  });
}

}  // namespace field_table_test
}  // namespace mallow
