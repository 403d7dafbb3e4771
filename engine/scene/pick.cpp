#include <algorithm>
#include <cmath>
#include <limits>

#include "mallow/tuning.h"

namespace mallow {
namespace {

bool is_finite(const Trade& trade) {
  return std::isfinite(trade.cost) && std::isfinite(trade.error);
}

/// The least by `better` of those that hold; else the least by `nearer` of all.
template <class Holds, class Better, class Nearer>
std::optional<Pick> pick(std::span<const Trade> trades, const Holds& holds, const Better& better,
                         const Nearer& nearer) {
  std::optional<Pick> best;
  for (std::size_t i = 0; i < trades.size(); ++i) {
    const Trade& trade = trades[i];
    if (!is_finite(trade)) continue;
    const bool good = holds(trade);
    const auto beats = [&](const Trade& other) { return good ? better(trade, other) : nearer(trade, other); };
    if (!best || (good && !best->holds) || (good == best->holds && beats(trades[best->index])))
      best = Pick{i, good};
  }
  return best;
}

bool is_cheaper(const Trade& a, const Trade& b) {
  return a.cost != b.cost ? a.cost < b.cost : a.error < b.error;
}
bool is_more_accurate(const Trade& a, const Trade& b) {
  return a.error != b.error ? a.error < b.error : a.cost < b.cost;
}

}  // namespace

std::vector<std::size_t> pareto_front(std::span<const Trade> trades) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < trades.size(); ++i)
    if (is_finite(trades[i])) order.push_back(i);
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return is_cheaper(trades[a], trades[b]); });
  double best = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> front;
  for (const std::size_t i : order) {
    if (trades[i].error >= best) continue;
    best = trades[i].error;
    front.push_back(i);
  }
  return front;
}

std::optional<Pick> pick_by_error(std::span<const Trade> trades, double error) {
  return pick(
      trades, [&](const Trade& trade) { return trade.error <= error; }, is_cheaper, is_more_accurate);
}

std::optional<Pick> pick_by_cost(std::span<const Trade> trades, double cost) {
  return pick(
      trades, [&](const Trade& trade) { return trade.cost <= cost; }, is_more_accurate, is_cheaper);
}

std::optional<double> convergence_order(std::span<const double> differences) {
  if (differences.size() < 2) return std::nullopt;
  const double before = differences[differences.size() - 2], last = differences.back();
  if (!(before > 0) || !(last > 0)) return std::nullopt;
  return std::log2(before / last);
}

}  // namespace mallow
