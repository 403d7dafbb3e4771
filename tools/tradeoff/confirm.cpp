#include "tradeoff/confirm.h"

#include <cmath>

#include "tradeoff/runner.h"
#include "tradeoff/tables.h"

namespace mallow::tradeoff {
namespace {

/// Times of one run alone say little beside other programs.
constexpr std::size_t k_timed_again = 3;

std::string milliseconds(double seconds) {
  return number(1e3 * seconds) + " ms";
}

std::string why_not(const Study& study, const Row& row, const Limit& limit, double error) {
  if (!limit.is_time)
    return row.setting.name + ": " + number(error) + " h off when run again, " + number(study.error(row)) +
           " h before, where " + number(limit.most) + " h are allowed";
  return row.setting.name + ": " + milliseconds(row.frame_seconds()) + " a frame in the median of " +
         std::to_string(row.seconds.size()) + (row.seconds.size() == 1 ? " run (" : " runs (") +
         milliseconds(row.least_frame_seconds()) + " to " + milliseconds(row.most_frame_seconds()) +
         "), where " + milliseconds(limit.most) + " are allowed; " + number(study.error(row)) + " h off";
}

/// Runs a row again and adds the times to it.
void run_more(const Study& study, Row& row, const Limit& limit, const StudyOptions& options, double deadline,
              Picked& picked) {
  picked.error = study.error(row);
  for (picked.more = 0; picked.more < (limit.is_time ? k_timed_again : 1); ++picked.more) {
    const std::optional<Row> again = run_again(study, row.setting, options, deadline);
    if (!again) return;
    row.seconds.push_back(again->median_seconds());
    row.drawing.push_back(again->median_drawing());
    picked.error = study.error(*again);
  }
}

/// Settings that are as accurate as the pick, and were fast enough in some run but not in the median.
std::vector<std::string> passed_over(const Study& study, const Limit& limit, const Picked& picked,
                                     const std::vector<bool>& is_dropped) {
  std::vector<std::string> texts;
  const double error = study.error(study.rows[picked.row]);
  for (std::size_t i = 0; i < study.rows.size(); ++i) {
    const Row& row = study.rows[i];
    if (i != picked.row && !is_dropped[i] && limit.is_time && row.frame_seconds() > limit.most &&
        row.least_frame_seconds() <= limit.most && study.error(row) < error)
      texts.push_back(why_not(study, row, limit, 0));
  }
  return texts;
}

/// Why an error cannot be judged by this study.
std::string not_judged(const Study& study, const Limit& limit) {
  if (limit.is_time) return "";
  if (study.reference.differences.empty())
    return "no halving of the steps fitted into the budget: give more by --budget";
  if (study.reference_error() <= limit.most) return "";
  return "the reference itself is off by about " + number(study.reference_error()) +
         " h: ask for no less than that, or give " +
         // More budget would be spent on more frames first.
         (stretch(study).empty() ? "more by --budget" : "less run.frames, or far more by --budget");
}

}  // namespace

std::optional<Picked> confirm(Study& study, const Limit& limit, const StudyOptions& options,
                              double deadline) {
  std::vector<Trade> trades = study.trades();
  if (std::string why = not_judged(study, limit); !why.empty()) {
    const std::optional<Pick> pick = limit.pick(trades);
    if (!pick) return std::nullopt;
    return Picked{
        .row = pick->index, .not_judged = std::move(why), .error = study.error(study.rows[pick->index])};
  }
  std::vector<bool> is_dropped(trades.size(), false);
  std::optional<Picked> nearest;
  std::vector<std::string> dropped;
  for (;;) {
    const std::optional<Pick> pick = limit.pick(trades);
    if (!pick || (!pick->holds && nearest)) break;
    Picked picked{.row = pick->index, .holds = pick->holds};
    Row& row = study.rows[pick->index];
    run_more(study, row, limit, options, deadline, picked);
    const double found = limit.is_time ? row.frame_seconds() : picked.error;
    picked.holds = found <= limit.most;
    if (!nearest || picked.holds) nearest = picked;
    if (picked.holds || !pick->holds) break;
    dropped.push_back(why_not(study, row, limit, picked.error));
    is_dropped[pick->index] = true;
    trades[pick->index].cost = std::nan("");
  }
  if (!nearest) return nearest;
  nearest->dropped = std::move(dropped);
  if (nearest->holds)
    for (std::string& text : passed_over(study, limit, *nearest, is_dropped))
      nearest->dropped.push_back(std::move(text));
  mark_front(study);
  return nearest;
}

}  // namespace mallow::tradeoff
