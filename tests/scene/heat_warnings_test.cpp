// What is said of heat that cannot be meant, and of what is meant nothing.
#include "scene/scene_fixture.h"
#include "scene/warning_scenes.h"

namespace mallow {
namespace heat_warnings_test {

using heat_warnings = SceneFixture;

/// A cube of a material by name on a plate, under 9.81 m/s², for as long as heat takes; lines of [solver], of
/// the body and of the plate.
std::string on_a_plate(const std::string& material, const std::string& solver, const std::string& body,
                       const std::string& plate, const std::string& frames = "50000") {
  return "[solver]\ngravity = [0, 0, -9.81]\n" + solver + "\n[[body]]\nmaterial = \"" + material +
         "\"\nbox = { count = [4, 4, 4], spacing = 0.005, corner = [0, 0, 0] }\n" + body +
         "\n[[collider]]\nplane = {}\n" + plate + "\n[run]\nframe_time = 0.033\nframes = " + frames + "\n";
}

std::string painted(const std::string& temperature) {
  return "paint = [{ sphere = { radius = 9.0 }, temperature = " + temperature + " }]";
}

TEST_F(heat_warnings, name_what_counts_for_nothing_without_a_temperature) {
  EXPECT_TRUE(warns(warnings_of(read(jelly("conductivity = 1.0"))),
                    "conductivity 1 has no effect, as it carries no heat; give material.temperature"));
  EXPECT_TRUE(warns(warnings_of(read(jelly("latent_heat = 4e4\nsolidus = 300.0\nliquidus = 305.0"))),
                    "latent_heat 40000, solidus 300, liquidus 305 have no effect, as it carries no heat"));
  EXPECT_TRUE(warns(warnings_of(read(jelly("heat_transfer = 10.0"))), "heat_transfer 10 has no effect"));
  EXPECT_TRUE(warns(warnings_of(read(jelly("specific_heat = 4200.0"))), "specific_heat 4200 has no effect"));
  EXPECT_FALSE(
      warns(warnings_of(read(jelly("temperature = 300.0\nconductivity = 1.0\nheat_transfer = 10.0"))),
            "carries no heat"));
}

TEST_F(heat_warnings, name_what_is_given_beside_keys_by_temperature) {
  const auto butter = [&](const std::string& change) {
    return warnings_of(SceneFixture::read(on_a_plate("butter", "", "", ""), {"material.butter." + change}));
  };
  EXPECT_TRUE(warns(butter("alpha=0.9"),
                    "alpha 0.9 has no effect, as alpha_by_temperature is what it follows, "
                    "0.4 at its temperature of 291"));
  EXPECT_TRUE(warns(butter("viscosity=3"), "viscosity 3 has no effect"));
  EXPECT_FALSE(warns(butter("temperature=295"), "has no effect")) << "butter has an alpha beside its keys";
  const std::string own =
      "temperature = 300.0\nconductivity = 1.0\nplastic_yield_by_temperature = [[299.0, "
      "0.1], [310.0, 0.01]]\nalpha = 0.3\n";
  EXPECT_TRUE(
      warns(warnings_of(read(jelly(own + "plastic_yield = 0.3"))), "plastic_yield 0.3 has no effect"));
  EXPECT_FALSE(warns(warnings_of(read(jelly(own))), "has no effect"));
}

TEST_F(heat_warnings, name_a_specific_heat_in_kilojoules) {
  const auto with = [&](const std::string& heat) {
    return warns(warnings_of(read(jelly("temperature = 300.0\nconductivity = 1.0\nspecific_heat = " + heat))),
                 "give 4200 for 4.2 kJ/(kg K)");
  };
  EXPECT_TRUE(with("4.2"));
  EXPECT_FALSE(with("4200.0"));
}

TEST_F(heat_warnings, name_temperatures_at_which_nothing_that_there_is_changes) {
  const std::string plate = "[[collider]]\nplane = { offset = -1.0 }\ntemperature = 350.0\n";
  for (const std::string what : {"alpha", "viscosity", "plastic_yield"}) {
    const std::string melts = "temperature = 290.0\nconductivity = 1.0\n" + what +
                              "_by_temperature = [[300.0, 0.1], [310.0, 0.9]]" +
                              (what == "alpha" ? "" : "\nalpha = 0.3");
    const auto stays = [&](const std::string& more) {
      return warns(warnings_of(read(jelly(melts, more))), what + " stays 0.1");
    };
    EXPECT_TRUE(stays("")) << what;
    EXPECT_FALSE(stays(plate)) << what;
    EXPECT_TRUE(
        stays("[[emitter]]\nmaterial = \"blob\"\nradius = 0.3\nspacing = 0.1\ntranslate = [5, 0, 5]\n"));
  }
}

TEST_F(heat_warnings, leave_what_comes_later_in_a_change_that_has_begun) {
  const auto with = [&](const std::string& viscosity) {
    return warns(
        warnings_of(read(jelly("temperature = 302.0\nconductivity = 1.0\nalpha_by_temperature = [[300.0, "
                               "0.1], [310.0, 0.9]]\nviscosity_by_temperature = " +
                               viscosity))),
        "viscosity stays");
  };
  EXPECT_FALSE(with("[[305.0, 500.0], [310.0, 300.0]]"));
  EXPECT_TRUE(with("[[32.0, 500.0], [37.0, 300.0]]")) << "degrees Celsius";
}

TEST_F(heat_warnings,
       take_the_temperatures_that_particles_have_not_that_of_a_material_whose_are_all_painted) {
  const auto air = [&](const std::string& temperature) {
    return warnings_of(read(on_a_plate("chocolate", "air_temperature = 290.0", painted(temperature), "")));
  };
  EXPECT_TRUE(
      warns(air("290"), "alpha_by_temperature changes from 300 to 305 K, but nothing is warmer than 290"));
  EXPECT_TRUE(air("302").empty());
}

TEST_F(heat_warnings, name_degrees_celsius_beside_kelvins_and_say_how_many_kelvins_they_are) {
  const std::string left_out = "stands beside an air of 293.15 K, as solver.air_temperature is left out";
  const auto mixed = warnings_of(read(on_a_plate("butter", "", painted("18"), "temperature = 60")));
  ASSERT_EQ(mixed.size(), 2u) << "one for each, and none of what follows from them";
  EXPECT_TRUE(mixed[0].starts_with("body 'body[0]': a temperature of 18 " + left_out)) << mixed[0];
  EXPECT_TRUE(warns(mixed, "give 291.15 for 18 degrees Celsius, or solver.air_temperature in the same unit"));
  EXPECT_TRUE(mixed[1].starts_with("collider 0: a temperature of 60 " + left_out)) << mixed[1];
  EXPECT_TRUE(warns(mixed, "give 333.15 for 60 degrees Celsius"));
  const auto air = warnings_of(read(on_a_plate("butter", "air_temperature = 20", "", "")));
  ASSERT_EQ(air.size(), 1u);
  EXPECT_TRUE(warns(air,
                    "solver.air_temperature: a temperature of 20 stands beside the kelvins in which material "
                    "'butter' melts"));
}

TEST_F(heat_warnings, name_a_run_that_heat_gets_nowhere_in) {
  const auto of = [&](const std::string& material, const std::string& plate, const std::string& frames) {
    return warnings_of(read(on_a_plate(material, "", "", plate, frames)));
  };
  const auto few = of("butter", "temperature = 333", "90");
  ASSERT_EQ(few.size(), 1u);
  EXPECT_TRUE(few[0].starts_with("material 'butter': in the 2.97 s of the run heat comes 0.000")) << few[0];
  EXPECT_TRUE(warns(few, "m far into it, less than its spacing of 0.005 m"));
  EXPECT_TRUE(of("butter", "temperature = 333", "50000").empty());
  EXPECT_FALSE(warns(of("jelly", "temperature = 333", "90"), "heat comes")) << "carries no heat";
}

TEST_F(heat_warnings, name_colliders_that_heat_nothing) {
  const std::string plate = "[[collider]]\nplane = { offset = -1.0 }\ntemperature = 400.0\n";
  EXPECT_TRUE(warns(warnings_of(read(jelly("alpha = 0.3", plate))),
                    "collider 0: its temperature has no effect, as no body carries heat"));
  EXPECT_FALSE(warns(warnings_of(read(jelly("alpha = 0.3\ntemperature = 300.0\nconductivity = 1.0", plate))),
                     "its temperature has no effect"));
}

TEST_F(heat_warnings, leave_scenes_alone_that_are_in_one_unit) {
  const std::string celsius = "temperature = 20.0\nconductivity = 1.0\nheat_transfer = 10.0\nalpha = 0.3";
  const std::string air = "[solver]\nair_temperature = 20.0\n";
  std::string in_celsius = jelly(celsius, "[[collider]]\nplane = { offset = -1.0 }\ntemperature = 350.0\n");
  EXPECT_TRUE(warns(warnings_of(read(in_celsius)), "a temperature of 20")) << "but for the air";
  EXPECT_TRUE(warnings_of(read(in_celsius.replace(0, 9, air))).empty());
  const std::string no_air = "temperature = 0.0\nconductivity = 1.0\nalpha = 0.3";
  EXPECT_TRUE(warnings_of(read(jelly(no_air))).empty()) << "a unit that starts anywhere";
  const auto cold = [&](const std::string& plate) {
    return warnings_of(read(on_a_plate("butter", "", "", "temperature = " + plate)));
  };
  EXPECT_TRUE(cold("77.4").empty()) << "boiling nitrogen";
  EXPECT_TRUE(cold("333").empty());
}

}  // namespace heat_warnings_test
}  // namespace mallow
