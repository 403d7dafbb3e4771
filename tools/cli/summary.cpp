#include "cli/summary.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "program/html.h"
#include "program/progress.h"

namespace mallow::cli {
namespace {

using program::html_text;

using json = nlohmann::ordered_json;

constexpr std::size_t k_pictures = 6;

constexpr const char* k_head = R"(<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>mallow: what ran</title>
<style>
  body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
  h1 { font-size: 1.6rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
  table { border-collapse: collapse; } td, th { padding: .15rem .9rem .15rem 0; text-align: left; }
  td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
  video { width: 100%; } .stills { display: grid; grid-template-columns: repeat(3, 1fr); gap: .5rem; }
  .stills img { width: 100%; display: block; } .bad { color: #b00020; } footer { margin-top: 2rem; color: #666; }
  rect { fill: #3b7a9e; } code { background: #f3f3f3; padding: 0 .2rem; }
</style>
)";

[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...) {
  char text[256];
  std::va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

std::string fact(const char* what, const std::string& value) {
  return format("<tr><th>%s</th><td>", what) + value + "</td></tr>\n";
}

struct Bar {
  std::string name;
  double seconds;
  double per;  ///< ms per step or frame
};

/// A table with a bar per row, as long as its share of the longest.
std::string bars(const std::vector<Bar>& rows, const char* per) {
  double total = 0, longest = 1e-12;
  for (const Bar& row : rows) {
    total += row.seconds;
    longest = std::max(longest, row.seconds);
  }
  std::string html = format(
      "<table>\n<tr><th></th><th class=n>seconds</th><th class=n>%s</th><th "
      "class=n>share</th><th></th></tr>\n",
      per);
  for (const Bar& row : rows) {
    html += "<tr><td>" + html_text(row.name) + "</td>";
    html += format("<td class=n>%.3f</td><td class=n>%.3f</td><td class=n>%.1f%%</td>", row.seconds, row.per,
                   100 * row.seconds / std::max(total, 1e-12));
    html += format(
        "<td><svg width=\"260\" height=\"14\"><rect width=\"%.1f\" height=\"14\" "
        "rx=\"2\"/></svg></td></tr>\n",
        260 * row.seconds / longest);
  }
  return html + "</table>\n";
}

/// Particles that each sink took.
std::string drained(const json& sinks) {
  std::string text;
  for (const auto& sink : sinks)
    text += (text.empty() ? "" : ", ") + sink.at("name").get<std::string>() +
            format(" %lld", sink.at("drained").get<long long>());
  return html_text(text);
}

std::string facts(const json& report) {
  const auto& step = report.at("time_step");
  std::string html = "<table>\n";
  html += fact("scene", "<code>" + html_text(report.at("scene").get<std::string>()) + "</code>");
  for (const auto& setting : report.at("overrides")) {
    html += fact("changed", "<code>" + html_text(setting.get<std::string>()) + "</code>");
  }
  html += fact("particles", std::to_string(report.at("particles").get<long long>()));
  html += fact("frames", format("%lld, %.4g s from one to the next", report.at("frames").get<long long>(),
                                report.at("frame_time").get<double>()));
  html += fact("steps", std::to_string(report.at("steps").get<long long>()));
  html += fact("simulated time", format("%.4g s", report.at("simulated_time").get<double>()));
  html += fact("time step", format("%.4g s (smallest %.4g s, %lld steps shortened by a limit)",
                                   step.at("mean").get<double>(), step.at("smallest").get<double>(),
                                   step.at("limited_steps").get<long long>()));
  html += fact("reference updates", std::to_string(report.at("reference_updates").size()));
  // Reports of earlier versions count none.
  if (const auto events = report.find("events"); events != report.end())
    html +=
        fact("bodies",
             format("yielded %lld times, tore %lld times, parts merged %lld times; %lld bodies came as parts "
                    "of others were split off, %lld ended as they merged with others",
                    events->at("yielded").get<long long>(), events->at("torn").get<long long>(),
                    events->at("merged").get<long long>(), events->value("split", 0ll),
                    events->value("merged_bodies", 0ll)));
  if (const auto sinks = report.find("sinks"); sinks != report.end() && !sinks->empty())
    html += fact("drained", drained(*sinks));
  html += fact("memory", format("%.1f MiB", report.at("bytes").get<double>() / (1024.0 * 1024.0)));
  html +=
      fact("machine", html_text(report.at("machine").at("processor").get<std::string>()) +
                          format(", %d cores, %d threads used", report.at("machine").at("cores").get<int>(),
                                 report.at("threads").get<int>()));
  html += fact("state hash", "<code>" + html_text(report.at("state_hash").get<std::string>()) + "</code>");
  html += fact("mallow", html_text(report.at("version").get<std::string>()));
  return html + "</table>\n";
}

std::string groups(const json& report) {
  std::string html =
      "<h2>Groups</h2>\n<table>\n<tr><th>group</th><th>material</th><th class=n>particles</th>"
      "<th class=n>spacing</th><th class=n>average neighbours</th></tr>\n";
  for (const auto& group : report.at("groups")) {
    html += "<tr><td>" + html_text(group.at("name").get<std::string>()) + "</td><td>" +
            html_text(group.at("material").get<std::string>()) + "</td>";
    html += format("<td class=n>%lld</td><td class=n>%.4g</td><td class=n>%.2f</td></tr>\n",
                   group.at("particles").get<long long>(), group.at("spacing").get<double>(),
                   group.at("average_neighbors").get<double>());
  }
  return html + "</table>\n";
}

std::string times(const json& report) {
  std::vector<Bar> stages, phases;
  // Frame 0 is written too.
  const double frames = report.at("frames").get<double>() + 1;
  double total = 0;
  for (const char* stage : {"build", "motion", "particles", "surface", "pictures", "film"}) {
    const double seconds = report.at("stage_seconds").at(stage).get<double>();
    total += seconds;
    stages.push_back({stage, seconds, 1000 * seconds / frames});
  }
  for (const auto& phase : report.at("phases")) {
    phases.push_back({phase.at("name").get<std::string>(), phase.at("seconds").get<double>(),
                      phase.at("ms_per_step").get<double>()});
  }
  return "<h2>Time: " + program::duration_text(total) + " in all</h2>\n" + bars(stages, "ms per frame") +
         "<h2>Time of the phases of a step</h2>\n" + bars(phases, "ms per step");
}

std::string stills(const program::Cache& cache) {
  const std::vector<int> frames = cache.image_frames();
  if (frames.empty()) return "";
  std::string html = "<h2>Pictures</h2>\n<div class=stills>\n";
  const std::size_t count = std::min(frames.size(), k_pictures);
  for (std::size_t i = 0; i < count; ++i) {
    const int frame = frames[count > 1 ? i * (frames.size() - 1) / (count - 1) : 0];
    const std::string file = "images/" + cache.image_file(frame).filename().string();
    html += "<a href=\"" + file + "\"><img src=\"" + file + format("\" alt=\"frame %d\"></a>\n", frame);
  }
  return html + "</div>\n";
}

std::string credits(const Scene& scene) {
  for (const SceneBody& body : scene.bodies) {
    const auto* mesh = std::get_if<MeshSource>(&body.source);
    if (!mesh) continue;
    const std::string file = mesh->file.filename().string();
    if (file.starts_with("bunny") || file.starts_with("armadillo")) {
      return "<p>The model in <code>" + html_text(file) +
             "</code> is from the <a href=\"http://graphics.stanford.edu/data/3Dscanrep/\">Stanford 3D "
             "Scanning "
             "Repository</a>, Stanford Computer Graphics Laboratory.</p>\n";
    }
  }
  return "";
}

}  // namespace

void write_summary(const program::Cache& cache, const Scene& scene, const json& report) {
  std::string html = k_head;
  try {
    html += "<h1>" + html_text(std::filesystem::path(report.at("scene").get<std::string>()).stem().string()) +
            "</h1>\n";
    if (!report.at("complete").get<bool>()) {
      html +=
          "<p class=bad>This run did not end: " + html_text(report.at("error").get<std::string>()) + "</p>\n";
    }
    if (std::filesystem::exists(cache.film_file()))
      html += "<video controls loop muted src=\"film.mp4\"></video>\n";
    html += stills(cache) + "<h2>What ran</h2>\n" + facts(report) + groups(report) + times(report);
  } catch (const json::exception& error) {
    throw IoError({cache.report_file().string(), 0, 0, "", error.what()});
  }
  html += "<footer>" + credits(scene) +
          "<p>Simulated with mallow, after K. Takamatsu and T. Kanai, "
          "<i>A Fast and Practical Method for Animating Particle-Based Viscoelastic "
          "Fluids</i>.</p></footer>\n</html>\n";
  write_whole(cache.summary_file(), html);
}

}  // namespace mallow::cli
