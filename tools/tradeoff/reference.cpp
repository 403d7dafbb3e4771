#include "tradeoff/reference.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mallow::tradeoff {
namespace {

/// The reference is converged where its last halving moved particles by less than this share of what the
/// scene as it is is off.
constexpr double k_little = 0.1;
/// No solver.time_step_factor is halved to less.
constexpr double k_shortest_factor = 0.01;
constexpr double k_grown = 1.25;  ///< see parts_again()

/// Whether the last halving moved particles farther than the one before, by more than chance.
bool parts_again(const std::vector<double>& differences) {
  const std::size_t n = differences.size();
  return n > 1 && differences[n - 1] > k_grown * differences[n - 2];
}

/// What the last of several differences says of the way that is left.
double error_left(const Reference& reference) {
  if (reference.differences.empty()) return 0;
  if (reference.parts_again) return reference.differences.back();
  // What is left of a geometric series; with no order known, as much as the last difference.
  const double ratio = reference.order && *reference.order > 0.2 ? std::exp2(*reference.order) : 2;
  return reference.differences.back() / (ratio - 1);
}

bool can_halve(double factor, const Scene& scene, double halvings) {
  return std::exp2(-halvings) * factor * static_cast<double>(scene.solver.time_step_factor) >
         k_shortest_factor;
}

}  // namespace

Reference find_reference(const ReferenceSearch& search, Runner& runner) {
  const Scene& scene = search.scene;
  const auto run_finest = [&](double factor) {
    return runner.run(finest(scene, static_cast<float>(factor)), {.deadline = search.end});
  };
  Reference reference;
  const bool is_finest = print_scene(finest(scene, 1)) == print_scene(scene);
  const double begin = wall_clock();
  // Steps alone cost more, not drawing.
  const std::vector<double>& drawing = search.plain.draw_seconds;
  double factor = 1, cost = search.plain_cost - std::accumulate(drawing.begin(), drawing.end(), 0.0);
  Motion before = is_finest ? search.plain : run_finest(1);
  if (!is_finest) cost = wall_clock() - begin;
  const double building = std::min(cost, before.other_seconds);  // of which shorter steps need no more
  reference.factors.push_back(1);
  reference.motion = before;
  while (can_halve(factor, scene, 1) && 2 * cost - building < search.until - wall_clock()) {
    factor /= 2;
    const double started = wall_clock();
    search.say("reference, steps of 1/" + std::to_string(static_cast<int>(1 / factor)));
    Motion motion = run_finest(factor);
    cost = wall_clock() - started;
    if (!motion.failure.empty() || motion.moments.size() != before.moments.size()) break;
    reference.seconds = cost;
    reference.factors.push_back(factor);
    reference.differences.push_back(motion_error(before, motion).rms);
    reference.late_shape = motion_error(before, motion, k_late).shape();
    // The one before stays the reference: in still shorter steps rounding counts more than the step.
    reference.parts_again = parts_again(reference.differences);
    if (reference.parts_again) break;
    reference.factor = factor;
    reference.motion = motion;
    before = std::move(motion);
    const double off = motion_error(search.plain, reference.motion).rms;
    reference.order = convergence_order(reference.differences);
    reference.converged =
        reference.differences.back() < k_little * off && error_left(reference) <= search.enough;
    if (reference.converged) break;
  }
  reference.order = convergence_order(reference.differences);
  reference.error = error_left(reference);
  return reference;
}

bool would_go_on(const Reference& reference, const Scene& scene, double halvings) {
  return !reference.converged && !reference.parts_again && can_halve(reference.factor, scene, halvings);
}

}  // namespace mallow::tradeoff
