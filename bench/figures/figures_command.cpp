#include "figures/figures_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "figures/contact_sheet.h"
#include "figures/figure.h"
#include "figures/record.h"
#include "harness/command.h"
#include "harness/plot.h"
#include "program/failure.h"

namespace mallow::bench {
namespace {

struct FiguresOptions {
  CommonOptions common;
  std::vector<std::string> only;
  bool small = false;
  bool no_pictures = false;
};

/// Four decimals: more than a plot shows, and a third of the file.
Json rounded(const Curve& curve) {
  Json values = Json::array();
  for (const double value : curve) values.push_back(std::round(value * 1e4) / 1e4);
  return values;
}

Json curves_json(const std::vector<Run>& runs) {
  Json takes = Json::object();
  for (const Run& run : runs) {
    Json& take = takes[run.about["take"].get<std::string>()];
    take["time"] = rounded(run.times);
    for (const auto& [key, curve] : run.recording.curves) take[key] = rounded(curve);
  }
  return takes;
}

Json claim_row(const Figure& figure, const Claim& claim, const std::vector<Run>& runs) {
  Json takes = Json::array();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Json& about = runs[i].about;
    std::string settings;
    for (const std::string text : about["overrides"]) settings += (settings.empty() ? "" : "; ") + text;
    takes.push_back({{"take", about["take"]},
                     {"value", i < claim.values.size() ? Json(claim.values[i]) : Json()},
                     {"scene", about["scene"]},
                     {"settings", settings},
                     {"particles", about["particles"]},
                     {"state_hash", about["state_hash"]}});
  }
  return {{"figure", figure.name},      {"claim", claim.name},
          {"sentence", claim.sentence}, {"measure", claim.measure},
          {"measured", claim.measured}, {"bound", claim.bound == Bound::at_least ? "at least" : "at most"},
          {"limit", claim.limit},       {"unit", claim.unit},
          {"holds", holds(claim)},      {"takes", takes}};
}

void draw_curves(const Figure& figure, const std::vector<Run>& runs, const Results& results) {
  for (const Quantity& quantity : figure.quantities) {
    Plot plot{.title = figure.title, .x_label = "time [s]", .y_label = quantity.label, .series = {}};
    for (const Run& run : runs) {
      Series& series = plot.series.emplace_back(Series{.title = run.about["take"], .points = {}});
      const Curve& curve = run.recording[quantity.key];
      for (std::size_t i = 0; i < curve.size(); ++i) series.points.emplace_back(run.times[i], curve[i]);
    }
    const std::string ending = figure.quantities.size() == 1 ? ".svg" : "_" + quantity.key + ".svg";
    write_svg(results.file("_" + figure.name + ending), plot);
  }
}

std::vector<Run> run_takes(const Figure& figure, const FiguresOptions& options, const Results& results) {
  std::optional<ContactSheet> sheet;
  if (!options.no_pictures) sheet.emplace(results.file("_" + figure.name + ".png"), options.common.threads);
  std::vector<Run> runs;
  for (const Take& take : figure.takes(options.small)) {
    runs.push_back(
        record(figure, take, options.common.threads,
               [&](const Scene& scene, const SimulationInfo& info, int number, const ParticleFrame& frame) {
                 stop_if_interrupted(results);
                 if (!sheet) return;
                 if (number == 0) {
                   std::vector<float> spacings;
                   for (const BodyInfo& body : info.bodies) spacings.push_back(body.spacing);
                   sheet->begin_take(scene, frame, spacings);
                 }
                 if (std::ranges::find(figure.moments, number) != figure.moments.end()) sheet->add(frame);
               }));
    std::fprintf(stderr, "figures: %s, %s: %.1f s\n", figure.name.c_str(), take.name.c_str(),
                 runs.back().about["seconds"].get<double>());
  }
  if (sheet) sheet->close();
  return runs;
}

std::string number_text(const Json& row, const char* key) {
  char text[64];
  std::snprintf(text, sizeof text, "%.3g%s%s", row[key].get<double>(), row["unit"].empty() ? "" : " ",
                row["unit"].get<std::string>().c_str());
  return text;
}

void print_claims(const Json& rows) {
  Json lines = Json::array();
  for (const Json& row : rows) {
    lines.push_back({{"claim", row["figure"].get<std::string>() + ": " + row["sentence"].get<std::string>() +
                                   " (" + row["measure"].get<std::string>() + ')'},
                     {"measured", number_text(row, "measured")},
                     {"limit", row["bound"].get<std::string>() + ' ' + number_text(row, "limit")},
                     {"holds", row["holds"] ? "yes" : "NO"}});
  }
  std::fputs(
      markdown_table(lines,
                     {{"claim", "claim"}, {"measured", "measured"}, {"limit", "limit"}, {"holds", "holds"}})
          .c_str(),
      stdout);
}

/// Throws RunFailure where a claim does not hold.
void check(const Json& rows) {
  std::string failed;
  for (const Json& row : rows) {
    if (row["holds"]) continue;
    failed += (failed.empty() ? "" : ", ") + row["figure"].get<std::string>() + '.' +
              row["claim"].get<std::string>();
  }
  if (!failed.empty()) throw program::RunFailure("what the paper shows does not hold: " + failed);
}

void run(const FiguresOptions& options) {
  const std::vector<Figure> all = figures();
  std::vector<std::string> known;
  for (const Figure& figure : all) known.push_back(figure.name);
  const std::vector<std::string> names = chosen("--only", options.only, known);
  std::vector<Figure> wanted;
  for (const Figure& figure : all)
    if (std::ranges::find(names, figure.name) != names.end()) wanted.push_back(figure);
  // A mesh that is missing is told before hours of work, not after.
  for (const Figure& figure : wanted)
    for (const Take& take : figure.takes(options.small))
      read_scene(data_file("scenes/" + take.scene), take.overrides);

  Results results("figures", options.common.output, options.common.threads,
                  {{"only", names}, {"small", options.small}, {"pictures", !options.no_pictures}});
  Json curves = Json::object(), runs_json = Json::array();
  for (const Figure& figure : wanted) {
    const std::vector<Run> runs = run_takes(figure, options, results);
    std::vector<Recording> recordings;
    for (const Run& run : runs) {
      recordings.push_back(run.recording);
      runs_json.push_back(run.about);
      runs_json.back()["figure"] = figure.name;
    }
    curves[figure.name] = curves_json(runs);
    results.set("runs", runs_json);
    results.set("curves", curves);
    for (const Claim& claim : figure.judge(recordings)) results.add(claim_row(figure, claim, runs));
    draw_curves(figure, runs, results);
  }
  results.close();
  print_claims(results.rows());
  check(results.rows());
}

}  // namespace

void add_figures_command(CLI::App& app) {
  const auto options = std::make_shared<FiguresOptions>();
  CLI::App* command = add_command(app, "figures", "What the paper's figures show, as claims that can fail",
                                  options->common, [options] { run(*options); });
  command->add_option("--only", options->only, "Figures, by name; all where left out")->delimiter(',');
  command->add_flag("--small", options->small, "The same claims of scenes with fewer particles");
  command->add_flag("--no-pictures", options->no_pictures, "No contact sheets");
}

}  // namespace mallow::bench
