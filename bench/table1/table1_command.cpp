#include "table1/table1_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>

#include "harness/command.h"
#include "harness/plot.h"
#include "mallow/scene.h"
#include "table1/table1_row.h"

namespace mallow::bench {
namespace {

struct Table1Options {
  CommonOptions common;
  std::vector<std::string> rows;
  Table1Settings settings;
};

const PaperRow& paper_row(const std::string& name) {
  return *std::ranges::find(paper_rows(), name, &PaperRow::name);
}

BarChart chart(const Json& rows) {
  BarChart chart{.title = "Table 1: frames a second",
                 .y_label = "FPS",
                 .groups = {},
                 .series = {"FPS (1), paper", "FPS (1), mallow", "FPS (2), paper", "FPS (2), mallow",
                            "FPS (2) and picture, mallow"},
                 .values = std::vector<std::vector<double>>(5)};
  for (const Json& row : rows) {
    chart.groups.push_back(row["name"]);
    const char* keys[] = {"paper_fps1", "fps1", "paper_fps2", "fps2", "fps2_rendered"};
    for (std::size_t s = 0; s < 5; ++s) chart.values[s].push_back(row[keys[s]]);
  }
  return chart;
}

void run(const Table1Options& options) {
  std::vector<std::string> known;
  for (const PaperRow& row : paper_rows()) known.push_back(row.name);
  const std::vector<std::string> names = chosen("--rows", options.rows, known);
  // A mesh that is missing is told before hours of work, not after.
  for (const std::string& name : names) read_scene(data_file("scenes/table1/" + name + ".toml"));

  Results results("table1", options.common.output, options.common.threads, to_json(options.settings));
  for (const std::string& name : names) {
    std::fprintf(stderr, "table1: %s\n", name.c_str());
    results.add(measure_row(paper_row(name), options.settings, options.common.threads));
    stop_if_interrupted(results);
  }
  results.close();
  write_svg(results.file(".svg"), chart(results.rows()));
  std::fputs(markdown_table(results.rows(), {{"name", "row"},
                                             {"particles", "n^p"},
                                             {"avg_neighbors", "neighbours", 1},
                                             {"alpha", "alpha"},
                                             {"gamma_u", "gamma_u", 0},
                                             {"v_size", "V-size"},
                                             {"ms_per_step", "ms", 3},
                                             {"fps1", "FPS (1)", 0},
                                             {"paper_fps1", "paper", 1},
                                             {"fps1_ratio", "ratio", 0},
                                             {"native_ratio", "native", 0},
                                             {"fps2", "FPS (2)", 1},
                                             {"fps2_rendered", "with picture", 2},
                                             {"paper_fps2", "paper", 2},
                                             {"fps2_ratio", "ratio", 1},
                                             {"surface_ms", "surface ms", 1},
                                             {"plain_surface_ratio", "times OpenVDB's", 1},
                                             {"surface_distance", "off [h]", 3},
                                             {"plain_surface_distance", "OpenVDB's", 3},
                                             {"textbook_ms", "textbook ms", 1},
                                             {"textbook_ratio", "ratio", 1}})
                 .c_str(),
             stdout);
}

}  // namespace

void add_table1_command(CLI::App& app) {
  const auto options = std::make_shared<Table1Options>();
  CLI::App* command =
      add_command(app, "table1", "The paper's Table 1, ours and a textbook implementation beside it",
                  options->common, [options] { run(*options); });
  command->add_option("--rows", options->rows, "Rows to measure, by name; all where left out")
      ->delimiter(',');
  command->add_option("--steps", options->settings.steps, "Steps of every run")
      ->check(CLI::Range(2, 1'000'000))
      ->capture_default_str();
  command->add_option("--repeats", options->settings.repeats, "Runs that are timed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--surface-every", options->settings.surface_every,
                   "Frames from one timed surface to the next")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command
      ->add_option("--textbook-seconds", options->settings.textbook_seconds,
                   "Time for the textbook implementation, per row; 0 leaves it out")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
}

}  // namespace mallow::bench
