#include "cli/materials_command.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "mallow/materials.h"
#include "mallow/scene.h"

namespace mallow::cli {
namespace {

/// Of what alpha 0 has, in the width of a column; "-" for fluids.
void print_modulus(const Material& material, float alpha) {
  if (material.youngs_modulus && alpha < 1)
    std::printf(" %10.4g", static_cast<double>((1 - alpha) * *material.youngs_modulus));
  else
    std::printf(" %10s", "-");
}

/// A file that belongs to the program: `installed` below share/mallow, `source` below the folder that it was
/// built in. What is nowhere is named as the source calls it.
std::string file_of_program(const std::string& installed, const std::string& source,
                            const std::string& anchor = {}) {
  namespace fs = std::filesystem;
  constexpr int k_highest = 5;  // PREFIX/bin/mallow, SOURCE/build/release/bin/mallow
  std::error_code error;
  fs::path folder = fs::read_symlink("/proc/self/exe", error);
  for (int above = 0; above < k_highest && folder.has_parent_path(); ++above) {
    folder = folder.parent_path();
    for (const fs::path& file : {folder / "share/mallow" / installed, folder / source})
      if (fs::exists(file, error)) return file.string() + anchor;
  }
  return source + anchor + " (in the source of mallow)";
}

void list_materials() {
  std::printf("%-14s %6s %10s %16s  %s\n", "material", "alpha", "E [Pa] *", "density [kg/m3]", "what it is");
  for (const MaterialPreset& preset : material_presets()) {
    const Material& material = preset.material;
    const float alpha = material.alpha.at(0);
    std::printf("%-14s %6.2f", preset.name, static_cast<double>(alpha));
    print_modulus(material, alpha);
    std::printf(" %16.4g  %s\n", static_cast<double>(material.rest_density.value_or(0)), preset.about);
  }
  std::printf(
      "\n* as it acts: (1 - alpha) youngs_modulus. Write youngs_modulus = E/(1 - alpha) for a material of "
      "your own."
      "\nIn a scene: material = \"honey\" of a body or an emitter, in metres and under 9.81 m/s2."
      "\nAll numbers of one and where they come from: mallow materials honey"
      "\nA picture of cubes of them all, dropped, squeezed and on a slope: %s\n",
      file_of_program("pictures/materials.jpg", "data/pictures/materials.jpg").c_str());
}

/// "566 Pa", "13.3 Pa s".
std::string rounded(double value, const char* unit) {
  constexpr std::size_t k_longest = 64;
  char text[k_longest];
  std::snprintf(text, k_longest, value < 100 ? "%.3g %s" : "%.0f %s", value, unit);
  return text;
}

/// What a material that yields does, in the terms of tables: see tools/docs/materials_by_name.md.
void print_what_acts(const Material& material) {
  const float alpha = material.alpha.at(0);
  if (!material.youngs_modulus || alpha >= 1) return;
  const double modulus = static_cast<double>((1 - alpha) * *material.youngs_modulus);
  std::string text = "E = " + rounded(modulus, "Pa") + " acts, G = " + rounded(modulus / 3, "Pa");
  if (material.plastic_yield) {
    const double in_shear = static_cast<double>(*material.plastic_yield) * modulus / std::sqrt(2.0);
    text += "; it yields at " + rounded(in_shear, "Pa") + " in shear, " +
            rounded(std::sqrt(3.0) * in_shear, "Pa") + " pulled";
    if (material.plastic_creep)
      text += ", and flows beyond with " +
              rounded(modulus / (2 * static_cast<double>(*material.plastic_creep)), "Pa s");
  }
  std::printf("\nAt alpha %g: %s.\n", static_cast<double>(alpha), text.c_str());
}

void describe(const std::string& name) {
  const MaterialPreset& preset = *find_preset(name);
  std::printf("%s: %s\n\n%s", preset.name, preset.about, describe_material(preset).c_str());
  print_what_acts(preset.material);
  std::printf("\n%s\n\n", preset.source);
  std::printf("file     %s\n",
              file_of_program("materials/" + name + ".toml", "data/materials/" + name + ".toml").c_str());
  std::printf("picture  %s\n", file_of_program("pictures/materials/" + name + ".jpg",
                                               "data/pictures/materials/" + name + ".jpg")
                                   .c_str());
  std::printf("page     %s\n",
              file_of_program("materials_by_name.md", "tools/docs/materials_by_name.md", "#" + name).c_str());
  std::printf("in a scene: material = \"%s\", and --set material.%s.friction=0.5 turns one number of it\n",
              preset.name, preset.name);
}

}  // namespace

void add_materials_command(CLI::App& app) {
  CLI::App* const command = app.add_subcommand("materials", "List the materials that scenes know by name");
  const auto name = std::make_shared<std::string>();
  std::vector<std::string> names;
  for (const MaterialPreset& preset : material_presets()) names.emplace_back(preset.name);
  command->add_option("name", *name, "One of them: its numbers, where they come from, its picture")
      ->check(CLI::IsMember(names));
  command->callback([name] { name->empty() ? list_materials() : describe(*name); });
}

}  // namespace mallow::cli
