#pragma once

#include <string>
#include <vector>

#include "stability/setup.h"

namespace mallow::bench {

/// All extremes, group by group.
class Catalogue {
 public:
  explicit Catalogue(int long_steps) : long_steps_(long_steps) {}

  std::vector<Extreme> list() &&;

 private:
  void add(const std::string& name, const Setup& base, const Change& change, const Trial& trial = {});
  void add_free(const std::string& name, const Change& change);
  void neighbors();
  void few_particles();
  void shapes();
  void magnitudes();
  void places();
  void contacts();
  /// As stiff as a step can carry, on a floor that gives all back: model 2, section 4 B.
  void elastic_limit();
  void schedules();
  /// Matter that flows takes energy and gives none: model 2, section 5.
  void flow();
  /// Contact takes energy and adds none: model 2, section 4 C.
  void bodies_that_touch();
  /// Damping at its limit takes energy and adds none.
  void damping();
  /// Energy comes with matter: what is asked is that all stays finite and slow.
  void bodies_that_come_and_go();
  /// What pushes does work; particles stay finite, and outside of it.
  void colliders_that_move();
  void add_kept(const std::string& name, const Setup& base, int iterations, const Change& change,
                const Trial& trial = {});
  /// Corrections take energy but for what was pressed together at the start: model 2, section 2.
  void kept_volumes();
  /// What its particles have of their own, side by side: of one half and of the other.
  void painted_bodies();
  void heated_bodies();

  int long_steps_;
  std::vector<Extreme> list_;
};

}  // namespace mallow::bench
