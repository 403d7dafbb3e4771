#include "cli/materials_command.h"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "mallow/materials.h"

namespace mallow::cli {
namespace {

/// Of what alpha 0 has, in the width of a column; "-" for fluids.
void print_modulus(const Material& material, float alpha) {
  if (material.youngs_modulus && alpha < 1)
    std::printf(" %10.4g", static_cast<double>((1 - alpha) * *material.youngs_modulus));
  else
    std::printf(" %10s", "-");
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
      "\nIn a scene: material = \"honey\" of a body or an emitter, in metres and under 9.81 m/s2.\n"
      "A picture of cubes of them all, dropped, squeezed and on a slope: data/pictures/materials.jpg\n");
}

}  // namespace

void add_materials_command(CLI::App& app) {
  app.add_subcommand("materials", "List the materials that scenes know by name")->callback([] {
    list_materials();
  });
}

}  // namespace mallow::cli
