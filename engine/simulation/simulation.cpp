#include <limits>

#include "core/checks.h"
#include "simulation/phases.h"
#include "simulation/state.h"

namespace mallow {

namespace {

/// a, g − x -> v', contact, v' -> x': in one loop where nothing stands between them. [TK eq. 10 to 13]
void move(Simulation::State& s, const ChosenStep& step, PhaseTimer& timer, StepReport& report) {
  if ((s.keeps_volume() || s.bodies_touch() || s.walls()) && !s.awake.empty()) {
    move_bodies(s, step.time_step, {.predict = true});  // a, g − x -> v'
    timer.lap(Phase::motion);
    if (s.keeps_volume()) correct_volume(s, step.time_step, report);  // ρ, v' -> v' that keep ρ
    timer.lap(Phase::volume);
    if (s.bodies_touch()) resolve_touching(s, step.time_step);  // x, v' -> v' of what touches
    if (s.walls()) rub_walls(s, step.time_step);  // a^wall, v' -> v' that friction of walls slows
    timer.lap(Phase::body_contact);
    move_bodies(s, step.time_step, {.collide = true, .advance = true});  // contact with colliders, v' -> x'
  } else {
    move_bodies(s, step.time_step, {.predict = true, .collide = true, .advance = true});
  }
}

/// What calls left to be told is told by the step that succeeds.
void keep_events(Simulation::State& s) {
  const auto end = s.events.begin() + static_cast<std::ptrdiff_t>(s.events_of_calls);
  s.next_events.insert(s.next_events.begin(), s.events.begin(), end);
  s.events.clear();
}

}  // namespace

// Algorithm 3.3 of [TK], as the model settles it. Surfacing is not a phase: it reads the views between steps.
StepReport take_step(Simulation::State& s, double end, const PhaseHook& after_phase) {
  Sph& sph = s.sph;
  const VectorColumn& x = s.store.position;
  StepReport report;
  PhaseTimer timer(report.seconds, after_phase);

  read_alphas(s);                                    // time, T -> alpha
  wake_bodies(s);                                    // what moves or changed -> bodies that move
  report.updated_references = update_references(s);  // |a_ext| -> x̄, regions       [TK 3.2, eq. 14]
  sort_fluids(s);                                    // rows of fluids -> cell order
  timer.lap(Phase::reference_update);

  s.sph_ran = s.needs_sph();
  s.density_ran = s.sph_ran || s.keeps_volume();
  if (s.density_ran) {
    report.neighbors_found = find_neighbors(x, s.execution, sph);  // x -> lists within σ
    timer.lap(Phase::neighbors);
    find_walls(s);                      // x, colliders -> share of walls
    compute_density(s.execution, sph);  // lists, x, share -> ρ, p      [TK eq. 3]
    timer.lap(Phase::density);
  }
  if (s.sph_ran) {
    thin_by_heat(s);  // T -> μ
    compute_accelerations(s.store.velocity, {s.store.alpha, s.viscosity}, s.execution,
                          sph);  // ρ, p, x, v -> a^SPH   [TK eq. 1, 2, 4]
    press_walls(s);              // ρ, a^SPH -> a^wall
    timer.lap(Phase::accelerations);
  }

  call_force(s);                                             // x, v -> user part of a_ext
  const ChosenStep step = choose_time_step(s, end, report);  // v, a, time left -> Δt        [TK eq. 12]
  timer.lap(Phase::time_step);

  const int iterations = s.config.rotation_iterations;
  s.matched.time_step = step.time_step;                         // in which regions flow  [model 2, section 5]
  const VectorColumn& led = lead_positions(s);                  // x, v -> x + τ v
  weigh_regions(s);                                             // alpha, stiffness -> e_j
  match_small_bodies(led, iterations, s.execution, s.matched);  // x, x̄ -> R_j, g − x     [TK eq. 7]
  sum_regions(led, s.execution, s.matched);                     // x, x̄ -> sums over N_j
  timer.lap(Phase::region_sums);
  solve_rotations(iterations, s.execution, s.matched);  // sums -> R_j, and S_j of the next step
  timer.lap(Phase::rotations);
  compute_goals(s.execution, s.matched);  // R_j -> g − x       [TK eq. 7]
  timer.lap(Phase::goals);

  move(s, step, timer, report);     // a, g − x, x, v -> v', x'      [TK eq. 10 to 13]
  conduct_heat(s, step.time_step);  // x, T, colliders -> T
  report.awake_bodies = s.awake.size();
  tell_contacts(s, step.time_step);  // impulses -> events of contacts
  finish_step(s, step);              // v', x' -> v, x; c ← c + 1
  rest_bodies(s, step.time_step);    // v -> bodies that sleep
  timer.lap(Phase::motion);
  return report;
}

StepReport Simulation::step_towards(double end) {
  prepare();
  state_->require_ahead(end);
  split_torn(*state_);                        // parts that were torn off -> bodies
  const int joined = join_bodies(*state_);    // κ -> bodies that are one   [model 2, section 5]
  const std::size_t drained = flow(*state_);  // time -> rows of strands, what sinks take
  prepare();
  state_->events_of_calls = 0;
  try {
    StepReport report = take_step(*state_, end);
    report.updated_references += joined;
    report.drained = drained;
    return report;
  } catch (...) {
    keep_events(*state_);
    throw;
  }
}

StepReport Simulation::step() {
  return step_towards(std::numeric_limits<double>::infinity());
}

AdvanceReport Simulation::advance(double seconds) {
  Checks checks;
  checks.number("seconds", seconds, seconds >= 0, "a finite number, 0 or above");
  checks.finish();
  AdvanceReport report;
  const double end = time() + seconds;
  while (time() < end) report.add(step_towards(end));
  return report;
}

}  // namespace mallow
