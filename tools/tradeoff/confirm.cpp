#include "tradeoff/confirm.h"

#include <cmath>

#include "tradeoff/reference.h"
#include "tradeoff/runner.h"
#include "tradeoff/tables.h"

namespace mallow::tradeoff {
namespace {

/// Times of one run alone say little beside other programs.
constexpr std::size_t k_timed_again = 3;
/// Order of convergence below which nothing is foretold of shorter steps.
constexpr double k_least_order = 0.2;

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

/// Halvings of the steps after which the reference is near enough, by the order that they had so far; nothing
/// where that foretells nothing.
std::optional<double> halvings_needed(const Study& study, double most) {
  const double order = study.reference.order.value_or(0);
  if (study.chaotic || order < k_least_order) return std::nullopt;
  return std::ceil(std::log2(study.reference_error() / most) / order);
}

/// The budget for so many more [s]; each takes as long as all before it.
double budget_needed(const Study& study, double halvings, double kept) {
  return std::exp2(halvings + 1) * study.reference.seconds / (k_reference_share * (1 - kept));
}

/// What to do about a reference that is too far off itself.
std::string way_out(const Study& study, double most, double kept) {
  if (study.chaotic && study.last_bit_late && study.last_bit_late->shape() > most)
    return "; no budget brings it nearer, as the last bit of one position moves shapes by " +
           number(study.last_bit_late->shape()) + " h: ask for more than that, or judge less run.frames";
  const std::optional<double> halvings = halvings_needed(study, most);
  if (!would_go_on(study.reference, study.rows.front().setting.scene, halvings.value_or(1)))
    return "; no budget brings it near enough, as its steps are halved no further than helps and than "
           "solver.time_step_factor 0.01: ask for no less than that";
  const std::string or_give = ": ask for no less than that, or give ";
  // More budget would be spent on more frames first.
  const std::string frames =
      stretch(study).empty() ? "" : "--set run.frames=" + std::to_string(study.frames) + " and ";
  return or_give + frames +
         (halvings ? "about " + budget_option(budget_needed(study, *halvings, kept)) : "more by --budget");
}

/// Why an error cannot be judged by this study. kept: as in its options.
std::string not_judged(const Study& study, const Limit& limit, double kept) {
  if (limit.is_time) return "";
  if (study.reference.differences.empty())
    return "no halving of the steps fitted into the budget: give more by --budget";
  if (study.reference_error() <= limit.most) return "";
  return "the reference itself is off by about " + number(study.reference_error()) + " h" +
         way_out(study, limit.most, kept);
}

}  // namespace

std::optional<Picked> confirm(Study& study, const Limit& limit, const StudyOptions& options,
                              double deadline) {
  std::vector<Trade> trades = study.trades();
  if (std::string why = not_judged(study, limit, options.kept); !why.empty()) {
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
