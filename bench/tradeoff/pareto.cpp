#include "tradeoff/pareto.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mallow::bench {

std::vector<std::size_t> pareto_front(const std::vector<Choice>& choices) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < choices.size(); ++i)
    if (std::isfinite(choices[i].cost) && std::isfinite(choices[i].error)) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return choices[a].cost != choices[b].cost ? choices[a].cost < choices[b].cost
                                              : choices[a].error < choices[b].error;
  });
  std::vector<std::size_t> front;
  double best = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (choices[i].error >= best) continue;
    best = choices[i].error;
    front.push_back(i);
  }
  return front;
}

}  // namespace mallow::bench
