// `mallow materials`: what it prints, and that the files it names are there.
#include "mallow/materials.h"

#include <sstream>

#include "cli/program.h"

namespace mallow::test {
namespace materials_test {

/// What follows `label` on its line; empty where there is none.
std::string after(const std::string& text, const std::string& label) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (const std::size_t at = line.find(label); at != line.npos) return line.substr(at + label.size());
  return {};
}

TEST(cli_materials, are_listed_with_a_picture_that_is_there) {
  const Outcome list = run_mallow({"materials"});
  EXPECT_EQ(list.exit_code, 0) << list.err;
  for (const MaterialPreset& preset : material_presets())
    EXPECT_NE(list.out.find(preset.about), std::string::npos) << preset.name;
  const std::string picture = after(list.out, "on a slope: ");
  EXPECT_TRUE(std::filesystem::is_regular_file(picture)) << picture;
}

TEST(cli_materials, are_told_by_name_with_numbers_units_sources_and_files) {
  for (const MaterialPreset& preset : material_presets()) {
    const Outcome one = run_mallow({"materials", preset.name});
    EXPECT_EQ(one.exit_code, 0) << one.err;
    EXPECT_NE(one.out.find(preset.source), std::string::npos) << one.out;
    EXPECT_NE(after(one.out, "rest_density").find(" kg/m³"), std::string::npos) << one.out;
    for (const std::string label : {"file     ", "picture  ", "page     "}) {
      std::string file = after(one.out, label);
      file = file.substr(0, file.find('#'));
      EXPECT_TRUE(std::filesystem::is_regular_file(file)) << file;
    }
  }
  const std::string dough = run_mallow({"materials", "dough"}).out;
  EXPECT_NE(dough.find("\nplastic_yield               0.08 "), std::string::npos) << dough;
  EXPECT_NE(dough.find("\nyoungs_modulus              20000.0 Pa "), std::string::npos) << dough;
  EXPECT_NE(
      dough.find("E = 10000 Pa acts, G = 3333 Pa; it yields at 566 Pa in shear, 980 Pa pulled, and flows "
                 "beyond with 250 Pa s"),
      std::string::npos)
      << dough;
  EXPECT_EQ(dough.find("conductivity"), std::string::npos) << "it carries no heat: " << dough;
  const std::string butter = run_mallow({"materials", "butter"}).out;
  EXPECT_NE(butter.find("[[291.0, 0.4], [301.0, 0.6], [307.0, 1.0]]"), std::string::npos) << butter;
  EXPECT_NE(butter.find("60000.0 J/kg"), std::string::npos) << butter;
}

TEST(cli_materials, that_nobody_knows_are_refused) {
  const Outcome unknown = run_mallow({"materials", "glass"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_EQ(unknown.out, "");
  EXPECT_NE(unknown.err.find("glass"), std::string::npos) << unknown.err;
}

}  // namespace materials_test
}  // namespace mallow::test
