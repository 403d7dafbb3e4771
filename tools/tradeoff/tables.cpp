#include "tradeoff/tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>

#include "program/csv.h"
#include "program/machine.h"

namespace mallow::tradeoff {
namespace {

using Json = nlohmann::ordered_json;

struct Range {
  double least = 0, most = 0;  ///< of a frame's steps [s]
};
Range range(const Row& row) {
  const auto [least, most] = std::ranges::minmax(row.seconds);
  return {least, most};
}

Json to_json(const MotionError& error, const Study& study) {
  Json json = {{"median_h", error.median},       {"rms_h", error.rms},       {"worst_h", error.worst},
               {"worst_time", error.worst_time}, {"height_h", error.height}, {"spread_h", error.spread},
               {"center_h", error.center},       {"volume", error.volume},   {"energy", error.energy},
               {"unmatched", error.unmatched}};
  if (error.median_pixels) json["median_pixels"] = *error.median_pixels;
  if (error.worst_pixels) json["worst_pixels"] = *error.worst_pixels;
  for (std::size_t m = 0; m < std::min(study.measures.size(), error.measures.size()); ++m)
    json["measures"][study.measures[m]] = error.measures[m];
  return json;
}

std::string padded(const std::string& text, std::size_t width) {
  return text.size() < width ? text + std::string(width - text.size(), ' ') : text;
}

/// Names, a comma between each.
std::string joined(const std::vector<std::string>& names, const char* comma = "; ") {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : comma) + name;
  return text;
}

std::string reference_remark(const Reference& reference) {
  std::string text = "reference: steps of " + number(reference.factor) + " times the scene's";
  if (reference.differences.empty())
    return text + "; no halving of them fitted into the budget, so errors are from the scene as it is";
  text += ", each halving moved particles by ";
  std::vector<std::string> differences;
  for (const double difference : reference.differences) differences.push_back(number(difference) + " h");
  text += joined(differences, ", ");
  if (reference.order) text += "; order of convergence " + number(*reference.order, 2);
  return text + "; itself off by about " + number(reference.error) + " h" +
         (reference.converged     ? ""
          : reference.parts_again ? ", as still shorter steps part from it again"
                                  : ", as half the budget ended it");
}

std::string chaos_remark(const Study& study) {
  const std::string moved = study.last_bit ? "one position moved by its last bit moves particles by " +
                                                 number(study.last_bit->rms) + " h"
                                           : study.no_last_bit;
  if (!study.chaotic)
    return (study.last_bit ? "not chaotic: " : "whether it is chaotic is not known: ") + moved;
  // What the last bit does not move may still go elsewhere with each step length, as where contacts differ.
  std::string text =
      (study.parts ? "the motion is chaotic: " : "shorter steps lead to no one motion: ") + moved;
  if (!study.reference.differences.empty())
    text += ", the last halving of steps by " + number(study.reference.differences.back()) + " h";
  text += ". So settings are judged by height, spread and centre over the last quarter";
  if (study.last_bit_late)
    text += ", which the last bit moves by " + number(study.last_bit_late->shape()) + " h";
  return text;
}

}  // namespace

std::string number(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string budget_option(double seconds) {
  const double digit = std::pow(10, std::floor(std::log10(seconds)) - 1);
  return "--budget " + number(digit * std::ceil(seconds / digit), 6) + "s";
}

std::vector<std::size_t> by_cost(const Study& study) {
  std::vector<std::size_t> order(study.rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return study.rows[i].frame_seconds(); });
  return order;
}

std::vector<std::string> remarks(const Study& study) {
  std::vector<std::string> lines;
  if (!stretch(study).empty())
    lines.push_back("judged by " + stretch(study) +
                    ": the budget carries no more, so what comes later is not judged");
  lines.push_back(std::to_string(study.frames) + " of " + std::to_string(study.all_frames) + " frames, " +
                  std::to_string(study.threads) + (study.threads == 1 ? " thread, " : " threads, ") +
                  number(study.spent) + " s in all");
  lines.push_back(reference_remark(study.reference));
  lines.push_back(chaos_remark(study));
  if (!study.left_out.empty()) lines.push_back("left out, as the budget ended: " + joined(study.left_out));
  if (!study.failed.empty()) lines.push_back("could not be run: " + joined(study.failed));
  return lines;
}

std::string to_text(const Study& study) {
  std::size_t width = 8;
  for (const Row& row : study.rows) width = std::max(width, row.setting.name.size());
  std::string text =
      "  " + padded("setting", width) +
      "  steps [ms]          range  surface [ms]  error [h]  surface  median   worst  worst [px]  "
      "height [h]   volume   energy";
  for (const std::string& measure : study.measures) text += "  " + measure;
  text += '\n';
  for (const std::size_t i : by_cost(study)) {
    const Row& row = study.rows[i];
    const Range times = range(row);
    char line[320];
    std::snprintf(line, sizeof line,
                  "  %10.3f  %6.3f..%6.3f  %12.3f  %9.3g %8s %7.2g %7.2g  %10.3g  %10.2g %8.2g %8.2g",
                  1e3 * row.median_seconds(), 1e3 * times.least, 1e3 * times.most, 1e3 * row.median_drawing(),
                  study.error(row), row.surface ? number(*row.surface, 2).c_str() : "-", row.error.median,
                  row.error.worst, row.error.worst_pixels.value_or(0), row.error.height, row.error.volume,
                  row.error.energy);
    text += (row.on_front ? "* " : "  ") + padded(row.setting.name, width) + line;
    for (const double measure : row.error.measures) text += "  " + number(measure);
    text += '\n';
  }
  text += "* on the front: nothing that costs no more is as near to the reference\n";
  for (const std::string& line : remarks(study)) text += line + '\n';
  return text;
}

std::vector<std::string> column_help() {
  return {
      "steps [ms], range (steps_ms, steps_ms_least, steps_ms_most): wall time of a frame's steps, median and "
      "range of the "
      "timed runs (runs)",
      "surface [ms] (surface_ms): of drawing a frame's surface; frame_ms: steps and surface",
      "error [h] (error_h): what settings are judged by, rms_h, or late_shape_h where the motion is chaotic; "
      "or "
      "surface_error_h where that is larger",
      "surface [h] (surface_error_h): how far the drawn surface is from one with twice as many voxels around "
      "the "
      "same particles, root mean square; empty, or -, where none is drawn",
      "median, rms, worst [h] (median_h, rms_h, worst_h): distance of a particle from where the reference "
      "has "
      "it, over all particles and moments; h is the spacing of its body",
      "median, worst [px] (median_px, worst_px): the same as the scene's camera sees it; empty, or 0, where "
      "it "
      "is out of view",
      "height (height_h), spread_h, center_h: of the height of the box around all particles, of their root "
      "mean square distance from the vertical through the centre, and of the centre of mass; root mean "
      "square "
      "over moments [h]",
      "late_shape_h: the worst of height, spread and centre over the last quarter [h]",
      "volume: of the particles' volume, as a share of the reference's",
      "energy: of kinetic energy and that of gravity and elasticity in sum, as a share of the reference's "
      "largest kinetic energy",
      "frames, all_frames: the first so many frames, of all that the scene has, are judged",
      "on_front, *: nothing that costs no more is as near to the reference",
      "those of --measure: root mean square error over moments, in m, m³, m/s or J"};
}

std::string to_csv(const Study& study) {
  std::string text =
      "setting,frames,all_frames,on_front,runs,steps_ms,steps_ms_least,steps_ms_most,surface_ms,frame_ms,"
      "error_h,surface_error_h,median_h,rms_"
      "h,"
      "worst_h,median_px,worst_px,height_h,spread_h,center_h,late_shape_h,volume,energy";
  for (const std::string& measure : study.measures) text += ',' + program::csv_quoted(measure);
  text += '\n';
  for (const std::size_t i : by_cost(study)) {
    const Row& row = study.rows[i];
    const Range times = range(row);
    text += program::csv_quoted(row.setting.name);
    for (const int count : {study.frames, study.all_frames, row.on_front ? 1 : 0})
      text += ',' + std::to_string(count);
    text += ',' + std::to_string(row.seconds.size());
    for (const double value : {1e3 * row.median_seconds(), 1e3 * times.least, 1e3 * times.most,
                               1e3 * row.median_drawing(), 1e3 * row.frame_seconds(), study.error(row)})
      text += ',' + number(value, 6);
    text += ',' + (row.surface ? number(*row.surface, 6) : std::string());
    for (const double value : {row.error.median, row.error.rms, row.error.worst})
      text += ',' + number(value, 6);
    for (const auto& pixels : {row.error.median_pixels, row.error.worst_pixels})
      text += ',' + (pixels ? number(*pixels, 6) : std::string());
    for (const double value : {row.error.height, row.error.spread, row.error.center, row.late.shape(),
                               row.error.volume, row.error.energy})
      text += ',' + number(value, 6);
    for (const double value : row.error.measures) text += ',' + number(value, 6);
    text += '\n';
  }
  return text;
}

std::string to_json(const Study& study, const std::optional<Picked>& picked) {
  Json rows = Json::array();
  for (const std::size_t i : by_cost(study)) {
    const Row& row = study.rows[i];
    rows.push_back({{"setting", row.setting.name},
                    {"on_front", row.on_front},
                    {"frame_seconds", row.seconds},
                    {"surface_seconds", row.drawing},
                    {"steps", row.motion.steps},
                    {"error_h", study.error(row)},
                    {"surface_error_h", row.surface ? Json(*row.surface) : Json()},
                    {"errors", to_json(row.error, study)},
                    {"last_quarter", to_json(row.late, study)},
                    {"paste", lines_to_paste(study.rows.front().setting.scene, row.setting.scene)}});
  }
  const Reference& reference = study.reference;
  Json json = {{"scene", study.scene},
               {"frames", study.frames},
               {"all_frames", study.all_frames},
               {"frame_time", study.frame_time},
               {"threads", study.threads},
               {"machine", program::machine_json()},
               {"seconds", study.spent},
               {"reference",
                {{"factor", reference.factor},
                 {"factors", reference.factors},
                 {"differences_h", reference.differences},
                 {"order", reference.order ? Json(*reference.order) : Json()},
                 {"error_h", reference.error},
                 {"converged", reference.converged}}},
               {"chaotic", study.last_bit ? Json(study.chaotic) : Json()},
               {"left_out", study.left_out},
               {"failed", study.failed},
               {"settings", rows}};
  if (study.last_bit)
    json["last_bit"] = {{"all", to_json(*study.last_bit, study)},
                        {"last_quarter", to_json(*study.last_bit_late, study)}};
  if (picked)
    json["pick"] = {{"setting", study.rows[picked->row].setting.name},
                    {"holds", picked->holds},
                    {"not_judged", picked->not_judged},
                    {"frame_seconds", study.rows[picked->row].frame_seconds()},
                    {"error_h", picked->error},
                    {"run_again", picked->more},
                    {"dropped", picked->dropped}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace mallow::tradeoff
