#pragma once

#include <vector>

namespace mallow::bench {

/// A choice: what it costs and how wrong it is, both to be small.
struct Choice {
  double cost = 0;
  double error = 0;
};

/// Indices of the choices that no other beats, cheapest first: whatever costs no more than one of them is
/// worse. Choices that are not finite are on no front.
std::vector<std::size_t> pareto_front(const std::vector<Choice>& choices);

}  // namespace mallow::bench
