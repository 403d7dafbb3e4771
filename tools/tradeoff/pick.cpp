#include "tradeoff/pick.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tradeoff/text.h"

namespace mallow::tradeoff {
namespace {

/// Second runs of picks, at most.
constexpr std::size_t k_most_tried = 4;
constexpr int k_repeats_again = 3;

/// By what a goal judges the error of a row.
double error_of(const TuningRow& row, const Goal& goal, bool chaotic) {
  if (goal.kind != Goal::Kind::pixels) return row.error;
  if (chaotic) return std::numeric_limits<double>::infinity();  // places tell nothing
  return row.errors.pixels.value_or(std::numeric_limits<double>::infinity());
}

std::vector<TuningPoint> points(std::span<const TuningRow> rows, const Goal& goal, bool chaotic) {
  std::vector<TuningPoint> result = points_of(rows);
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (std::isfinite(result[i].cost)) result[i].error = error_of(rows[i], goal, chaotic);
  return result;
}

}  // namespace

Goal parse_error_goal(const std::string& text) {
  double value = 0;
  std::size_t used = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const std::string unit = text.substr(used);
  if (used == 0 || !(value > 0) || !std::isfinite(value) || (unit != "h" && unit != "px"))
    throw ConfigError("error", "'" + text + "' is no error above 0: 0.1h (spacings) or 2px (pixels)");
  return {unit == "h" ? Goal::Kind::error : Goal::Kind::pixels, value};
}

std::string to_string(const Goal& goal) {
  switch (goal.kind) {
    case Goal::Kind::frame:
      return format("a frame in %.4g ms", 1e3 * goal.most);
    case Goal::Kind::error:
      return format("an error of at most %.4g h", goal.most);
    case Goal::Kind::pixels:
      return format("an error of at most %.4g pixels", goal.most);
  }
  return "";
}

std::vector<std::size_t> candidates(std::span<const TuningRow> rows, const Goal& goal, bool chaotic) {
  const std::vector<TuningPoint> all = points(rows, goal, chaotic);
  std::vector<std::size_t> front = pareto_front(all);
  if (goal.kind == Goal::Kind::frame) {
    std::erase_if(front, [&](std::size_t i) { return all[i].cost > (1 - k_spare) * goal.most; });
    std::ranges::reverse(front);  // cheapest first it was
  } else {
    std::erase_if(front, [&](std::size_t i) { return all[i].error > goal.most; });
  }
  return front;
}

std::optional<std::size_t> nearest(std::span<const TuningRow> rows, const Goal& goal, bool chaotic) {
  const std::vector<std::size_t> front = pareto_front(points(rows, goal, chaotic));
  if (front.empty()) return std::nullopt;
  return goal.kind == Goal::Kind::frame ? front.front() : front.back();
}

std::optional<Pick> pick(const Study& study, const Goal& goal) {
  const std::vector<TuningRow>& rows = study.result.rows;
  Pick result;
  const auto again = [&](std::size_t i) {
    result.row = i;
    result.again = time_setting(rows[i].setting, study.result.frames, k_repeats_again, study.config);
  };
  for (const std::size_t i : candidates(rows, goal, study.result.chaotic)) {
    if (result.tried.size() == k_most_tried) break;
    again(i);
    // The same bits have the same error.
    const bool holds = result.again.failure.empty() && result.again.repeats > 0 &&
                       (goal.kind == Goal::Kind::frame ? result.again.frame.median <= goal.most
                                                       : result.again.state_hash == rows[i].state_hash);
    if (holds) {
      result.holds = true;
      return result;
    }
    if (study.config.stop && study.config.stop()) return result;
    result.tried.push_back(rows[i].setting.name);
  }
  const std::optional<std::size_t> near = nearest(rows, goal, study.result.chaotic);
  if (!near) return std::nullopt;
  again(*near);
  return result;
}

std::optional<std::size_t> no_slower(std::span<const TuningRow> rows) {
  if (rows.empty() || rows.front().repeats == 0) return std::nullopt;
  return most_accurate_within(points_of(rows), rows.front().frame.median);
}

std::string told(const Study& study, const Pick& pick, const Goal& goal) {
  const TuningRow& row = study.result.rows[pick.row];
  std::string text;
  const auto share = [&](double value) {
    const double spare = 1 - value / goal.most;
    return spare >= 0 ? format("%.0f%% to spare", 100 * spare) : format("%.0f%% too much", -100 * spare);
  };
  if (goal.kind == Goal::Kind::frame)
    text = format("%.4g ms a frame, %s; error %.3g h", 1e3 * row.frame.median,
                  share(row.frame.median).c_str(), row.error);
  else if (goal.kind == Goal::Kind::error)
    text = format("error %.3g h, %s; %.4g ms a frame", row.error, share(row.error).c_str(),
                  1e3 * row.frame.median);
  else
    text = format("error %.3g pixels, %s; %.4g ms a frame", row.errors.pixels.value_or(0),
                  share(row.errors.pixels.value_or(0)).c_str(), 1e3 * row.frame.median);
  if (pick.again.repeats > 0) {
    text += format("; run again %d times: %.4g ms (%.4g to %.4g)", pick.again.repeats,
                   1e3 * pick.again.frame.median, 1e3 * pick.again.frame.lowest,
                   1e3 * pick.again.frame.highest);
    text += pick.again.state_hash == row.state_hash ? ", the same bits" : ", other bits";
  }
  return text;
}

}  // namespace mallow::tradeoff
