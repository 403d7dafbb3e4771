#include "kernels/kernels_command.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "harness/command.h"
#include "kernels/kernel_set.h"

namespace mallow::bench {
namespace {

struct KernelsOptions : CommonOptions {
  std::string filter = ".";
  double min_time = 0.2;
  int repeats = 3;
  bool all_levels = false;
};

KernelVariants variants(const KernelsOptions& options) {
  KernelVariants variants{{1}, {best_instruction_level()}};
  if (options.threads > 1) variants.threads.push_back(options.threads);
  if (options.all_levels)
    for (const auto level : {InstructionLevel::v3, InstructionLevel::baseline})
      if (level < best_instruction_level()) variants.levels.push_back(level);
  return variants;
}

void print_tables(const Json& rows) {
  std::printf("%s", markdown_table(rows, {{"kernel", "kernel"},
                                          {"scene", "scene"},
                                          {"threads", "threads"},
                                          {"level", "level"},
                                          {"item", "item"},
                                          {"ns_per_item.min", "ns/item", 3},
                                          {"ns_per_item.median", "median", 3},
                                          {"core_ns_per_item", "ns/item/core", 3},
                                          {"ms.min", "ms", 3},
                                          {"ms.max", "slowest", 3},
                                          {"times_as_long", "of row additions"}})
                        .c_str());
  // Errors are far below the digits of the table above.
  Json errors = Json::array();
  const auto in_text = [](const Json& value) {
    if (!value.is_number()) return std::string("-");
    char text[32];
    std::snprintf(text, sizeof text, "%.1e", value.get<double>());
    return std::string(text);
  };
  for (const Json& row : rows) {
    const Json& about = row["about"];
    if (row["threads"] != 1 || !about.contains("error_max")) continue;  // threads change no result
    errors.push_back({{"kernel", row["kernel"]},
                      {"scene", row["scene"]},
                      {"level", row["level"]},
                      {"ns", row["core_ns_per_item"]},
                      {"median", in_text(about["error_median"])},
                      {"max", in_text(about["error_max"])},
                      {"determined", about["determined_share"]},
                      {"undecided", about.contains("undecided_share") ? about["undecided_share"] : Json()},
                      {"determinant", in_text(about["determinant_error_max"])}});
  }
  if (errors.empty()) return;
  std::printf("\nrotations against a reference in extended precision, where that is well determined\n\n%s",
              markdown_table(errors, {{"kernel", "kernel"},
                                      {"scene", "matrices"},
                                      {"level", "level"},
                                      {"ns", "ns/matrix/core", 1},
                                      {"median", "median error [rad]"},
                                      {"max", "largest error [rad]"},
                                      {"determined", "well determined"},
                                      {"undecided", "left to the exact solver"},
                                      {"determinant", "largest error of det"}})
                  .c_str());
}

void run_kernels(const KernelsOptions& options) {
  KernelSet set;
  const KernelVariants which = variants(options);
  add_region_sums(which, set);
  add_rotations(which, set);
  add_neighbors(which, set);
  add_sph(which, set);
  add_surface(which, set);
  add_skin(which, set);
  const KernelTiming timing{options.filter, options.min_time, options.repeats};
  set.check(timing);

  Results results("kernels", options.output, options.threads,
                  {{"filter", options.filter},
                   {"min_time", options.min_time},
                   {"repeats", options.repeats},
                   {"all_levels", options.all_levels}});
  set.run(timing, results);
  results.close();
  print_tables(results.rows());
}

}  // namespace

void add_kernels_command(CLI::App& app) {
  const auto options = std::make_shared<KernelsOptions>();
  CLI::App* command = add_command(
      app, "kernels", "The parts of a step and of a surface by themselves, beside what the machine can do",
      *options, [options] { run_kernels(*options); });
  command
      ->add_option("--filter", options->filter,
                   "Regular expression that is looked for in kernel/scene/threads/level")
      ->capture_default_str();
  command
      ->add_option("--min-time", options->min_time,
                   "Time that each repeat of a kernel takes at the least [s]")
      ->check(CLI::Range(0.0001, 60.0))
      ->capture_default_str();
  command
      ->add_option("--repeats", options->repeats,
                   "Repeats of each kernel; the fastest, the middle and the slowest one are kept")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_flag("--all-levels", options->all_levels,
                    "Every instruction level of the machine, not only its best");
}

}  // namespace mallow::bench
