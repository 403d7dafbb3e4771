#include "tradeoff/tables.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mallow/version.h"
#include "program/machine.h"
#include "program/run_report.h"
#include "tradeoff/text.h"

namespace mallow::tradeoff {
namespace {

using Json = nlohmann::ordered_json;

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == text.npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

std::string overrides_of(const Study& study, const TuningRow& row) try {
  std::string text;
  for (const program::SceneChange& change : changes_of(study, row.choice))
    text += (text.empty() ? "" : "; ") + change.key + '=' + change.now;
  return text;
} catch (const ConfigError&) {
  return "";  // a setting that cannot be made
}

Json to_json(const TuningSpread& spread) {
  return {{"median", spread.median}, {"lowest", spread.lowest}, {"highest", spread.highest}};
}

Json row_json(const Study& study, const TuningRow& row) {
  Json json = {{"setting", row.setting.name},
               {"changes", overrides_of(study, row)},
               {"on_front", row.on_front},
               {"failure", row.failure}};
  if (!row.failure.empty()) return json;
  json["particles"] = row.particles;
  json["steps"] = row.steps;
  json["frame_seconds"] = to_json(row.frame);
  json["mean_frame_seconds"] = to_json(row.mean);
  json["drawing_seconds"] = row.drawing;
  json["repeats"] = row.repeats;
  json["error_h"] = row.error;
  json["rms_h"] = row.errors.rms;
  json["median_h"] = row.errors.median;
  json["worst_h"] = row.errors.worst;
  if (row.errors.pixels) json["rms_pixels"] = *row.errors.pixels;
  if (row.errors.worst_pixels) json["worst_pixels"] = *row.errors.worst_pixels;
  json["drawing_error_h"] = row.drawing_error;
  for (std::size_t m = 0; m < row.errors.measures.size(); ++m) {
    const TuningMeasure& measure = study.result.measures[m];
    json["measures"][measure.name] = {{"unit", measure.unit},
                                      {"rms", row.errors.measures[m]},
                                      {"mean_of_last_third", row.errors.statistics[m]}};
  }
  json["state_hash"] = program::hash_text(row.state_hash);
  return json;
}

}  // namespace

std::vector<std::size_t> by_cost(std::span<const TuningRow> rows) {
  const std::vector<TuningPoint> points = points_of(rows);
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return points[i].cost; });
  return order;
}

std::string csv_of(const Study& study) {
  std::string text =
      "setting,changes,on_front,particles,steps,frame [ms],frame_lowest [ms],frame_highest [ms],mean_frame "
      "[ms],drawing [ms],repeats,error [h],rms [h],median [h],worst [h],rms [pixels],worst [pixels],"
      "drawing_error [h]";
  for (const TuningMeasure& m : study.result.measures)
    text += ',' + quoted(m.name + " [" + m.unit + "]") + ',' + quoted("mean " + m.name + " [" + m.unit + "]");
  text += ",failure\n";
  for (const TuningRow& row : study.result.rows) {
    text += quoted(row.setting.name) + ',' + quoted(overrides_of(study, row)) + ',' +
            (row.on_front ? "1" : "0") + ',';
    const bool ran = row.failure.empty();
    if (ran)
      text += format("%zu,%lld,%.6g,%.6g,%.6g,%.6g,%.6g,%d,%.6g,%.6g,%.6g,%.6g,", row.particles,
                     static_cast<long long>(row.steps), 1e3 * row.frame.median, 1e3 * row.frame.lowest,
                     1e3 * row.frame.highest, 1e3 * row.mean.median, 1e3 * row.drawing, row.repeats, row.error,
                     row.errors.rms, row.errors.median, row.errors.worst);
    else
      text += std::string(12, ',');
    text += ran && row.errors.pixels ? format("%.6g,%.6g,", *row.errors.pixels, *row.errors.worst_pixels) : ",,";
    text += ran ? format("%.6g", row.drawing_error) : "";
    for (std::size_t m = 0; m < study.result.measures.size(); ++m)
      text += m < row.errors.measures.size()
                  ? format(",%.6g,%.6g", row.errors.measures[m], row.errors.statistics[m])
                  : ",,";
    text += ',' + quoted(row.failure) + '\n';
  }
  return text;
}

nlohmann::ordered_json json_of(const Study& study, const std::optional<Goal>& goal,
                               const std::optional<Pick>& pick) {
  const TuningResult& result = study.result;
  Json json = {{"scene", study.knobs.own().file.string()},
               {"version", version()},
               {"machine", program::machine_json()},
               {"threads", study.threads},
               {"frames", result.frames},
               {"frame_time", study.config.frame_time},
               {"budget", study.config.budget},
               {"seconds", result.seconds},
               {"interrupted", result.interrupted},
               {"left_out", result.left_out},
               {"findings", findings(study)}};
  json["reference"] = {{"converged", result.converged}, {"error_h", result.reference_error}};
  if (result.order) json["reference"]["order"] = *result.order;
  for (const TuningLevel& level : result.levels) {
    Json& added = json["reference"]["levels"].emplace_back(
        Json{{"time_step", level.time_step}, {"steps", level.steps}, {"difference_h", level.difference}});
    if (level.order) added["order"] = *level.order;
  }
  json["chaos"] = {{"chaotic", result.chaotic}, {"twin_h", result.twin}, {"twin_statistic_h", result.twin_statistic}};
  if (result.parted_at) json["chaos"]["parted_at_frame"] = *result.parted_at;
  json["settings"] = Json::array();
  for (const TuningRow& row : result.rows) json["settings"].push_back(row_json(study, row));
  if (goal && pick)
    json["pick"] = {{"goal", to_string(*goal)},
                    {"setting", result.rows[pick->row].setting.name},
                    {"holds", pick->holds},
                    {"again_frame_seconds", to_json(pick->again.frame)},
                    {"same_bits", pick->again.state_hash == result.rows[pick->row].state_hash},
                    {"tried", pick->tried}};
  return json;
}

std::string text_table(const Study& study) {
  const std::vector<TuningRow>& rows = study.result.rows;
  std::string text = format("%-58s %10s %19s %8s %9s %9s\n", "setting", "ms a frame", "range", "error h",
                            "pixels", "speed");
  for (const std::size_t i : by_cost(rows)) {
    const TuningRow& row = rows[i];
    const bool preset = row.setting.name.starts_with("quality ");
    if (!row.failure.empty() || row.repeats == 0 || !(row.on_front || i == 0 || preset)) continue;
    std::string name = (row.on_front ? "* " : "  ") + row.setting.name;
    text += format("%-58s %10.4g %8.4g .. %7.4g %8.3g %9s %8.2fx\n", name.c_str(), 1e3 * row.frame.median,
                   1e3 * row.frame.lowest, 1e3 * row.frame.highest, row.error,
                   row.errors.pixels ? format("%.3g", *row.errors.pixels).c_str() : "-",
                   rows.front().frame.median / row.frame.median);
  }
  return text;
}

}  // namespace mallow::tradeoff
