// Settings that nobody means: of how matter flows, how thick it is, and how its volume is kept.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "colliders/ways.h"
#include "config/gravity_units.h"
#include "config/validation.h"
#include "shape_matching/plastic.h"
#include "simulation/settings.h"
#include "simulation/state.h"
#include "simulation/warning_list.h"

namespace mallow {
namespace {

/// What is squashed to a quarter, or pulled to 2.6 times its length, has this strain: what yields there
/// springs back from all else. It is a number in percent or pascals.
constexpr float k_boundless_yield = 1;
/// A hard impact takes up to 8 a step, in the mean, to a mean compression of 0.001: so many more change
/// nothing.
constexpr int k_many_iterations = 20;

/// Mean compression that nobody means to leave.
constexpr float k_loose_tolerance = 0.05f;

class MatterWarnings {
 public:
  explicit MatterWarnings(const Simulation::State& state) : state_(state) {}

  std::vector<std::string> list() && {
    std::ranges::transform(state_.colliders, std::back_inserter(thickness_), blade_thickness);
    for (const BodyState& body : state_.bodies) {
      look_at_yield(body);
      look_at_standing_still(body);
      look_at_flow(body);
      look_at_viscosity(body);
      look_at_splits(body);
      look_at_blades(body);
    }
    look_at_tolerance();
    look_at_iterations();
    return list_.take();
  }

 private:
  const char* unit(const char* name) const { return unit_of(state_.config.gravity, name); }

  /// Where particles have their own, a high one may be what holds the others.
  void look_at_yield(const BodyState& body) {
    const Material& material = body.material->settings;
    const bool follows = material.plastic_yield_by_temperature.has_value();
    if (!flows(material) || (body.paints_yield && !follows)) return;
    const float yield = follows ? material.plastic_yield_by_temperature->lowest() : *material.plastic_yield;
    if (yield < k_boundless_yield) return;
    list_.add(body, follows ? "plastic_yield_by_temperature of " : "plastic_yield ", yield,
              follows ? " and more" : "", " is a strain of ", 100 * yield,
              "%: it springs back from all that does not squash it to a quarter; pastes and doughs yield at "
              "0.02 to 0.2");
  }

  /// What can flow nowhere, or is damped so long that it breaks.
  void look_at_standing_still(const BodyState& body) {
    if (!body.shape.flows) return;
    if (!body.keeps_reference())
      return list_.add(body, "plastic_yield has no effect where alpha is 1: a fluid flows by itself");
    const Material& material = body.material->settings;
    if (material.damping_time > state_.longest_step() && !material.plastic_creep)
      list_.add(body, "damping_time ", material.damping_time, " s is longer than a step, ",
                state_.longest_step(),
                " s, and what the damper bears flows at once too: a blow may break it into shards; give "
                "material.plastic_creep, or lower it");
    if (!body.shape.built) return;
    for (std::size_t j = 0; j < body.shape.region_weight.size(); ++j)
      if (!is_thin(stretched_moment(body.shape, j))) return;
    list_.add(body,
              "plastic_yield has no effect, as its particles are one layer, or a line: they have no strain "
              "across; two layers do");
  }

  void look_at_flow(const BodyState& body) {
    const Material& material = body.material->settings;
    const Material usual;
    if (!flows(material)) {
      const auto look = [&](const char* field, float value, float left_out) {
        if (value != left_out)
          list_.add(body, field, ' ', value,
                    " has no effect, as it does not flow; give material.plastic_yield");
      };
      look("merge_flow", material.merge_flow, usual.merge_flow);
      look("tear_strain", material.tear_strain, usual.tear_strain);
    } else if (material.merge_flow > k_far_flow && material.merge_flow <= k_farthest_flow) {
      // Above that half of it never gets: who asks for so much wants pieces to stay apart.
      list_.add(body, "merge_flow ", material.merge_flow, " is more than the ", k_far_flow,
                " at which what flows takes a new reference shape, from which flow is counted anew: hardly "
                "anything that touches becomes one; give less than ",
                k_far_flow);
    }
  }

  /// What splits has to be torn, and not to become one again.
  void look_at_splits(const BodyState& body) {
    if (!body.splits) return;
    const Material& material = body.material->settings;
    if (!body.keeps_reference())
      list_.add(body, "splits has no effect where alpha is 1: a fluid is in no parts that are held together");
    else if (body.merges && body.shape.flows)
      list_.add(
          body,
          "splits and merges undo each other: parts that were torn off become one with it again where they "
          "are pressed together; leave one of them out");
    else if (!flows(material) && !material.update_threshold && !body.melts() &&
             std::ranges::any_of(state_.colliders, is_driven))
      list_.add(
          body,
          "splits where it is torn, and what is elastic is not by what moves through it: its shape gives "
          "way to more than update_threshold alone, ",
          body.material->update_threshold, unit(" m/s2"),
          " in the mean; give material.plastic_yield, so that it flows and is cut where a blade works");
  }

  /// What is thinner than a gap at which matter tears goes through it and cuts nothing.
  void look_at_blades(const BodyState& body) {
    const Material& material = body.material->settings;
    if (!flows(material) || !body.keeps_reference()) return;
    const float gap = (1 + material.tear_strain) * body.shape.region_radius;
    for (std::size_t c = 0; c < state_.colliders.size(); ++c) {
      const float thickness = thickness_[c];
      if (!(thickness + body.spacing <= gap)) continue;
      list_.add(body, "collider ", c, " is ", thickness, unit(" m"),
                " thick across its way, too thin to cut: with a spacing it opens a gap of ",
                thickness + body.spacing, unit(" m"), ", and matter tears beyond ", gap, unit(" m"),
                ", (1 + tear_strain) times the radius of its regions; make it thicker than ",
                gap - body.spacing, unit(" m"), ", or give a smaller tear_strain or spacing");
    }
  }

  /// Where pressure_coefficient is given too, the scene is one of several that differ in alpha.
  void look_at_viscosity(const BodyState& body) {
    const Material& material = body.material->settings;
    const Schedule& alpha = material.alpha_by_temperature.value_or(material.alpha);
    const bool acts_on_others = state_.bodies.size() > 1 && !state_.sph.apart;
    if (!material.viscosity || !(*material.viscosity > 0) || material.pressure_coefficient) return;
    if (body.paints_alpha || alpha.highest() > 0 || acts_on_others) return;
    list_.add(body, "viscosity ", *material.viscosity,
              " has no effect where alpha is 0: it acts by the share alpha of a fluid; give alpha, or "
              "material.damping_time, which slows what is elastic");
  }

  void look_at_tolerance() {
    const float tolerance = state_.config.volume_tolerance;
    if (tolerance > 0 && state_.volume_iterations() == 0)
      list_.add(
          "solver.volume_tolerance ends volume iterations, of which there are none: give volume_iterations");
    else if (tolerance > k_loose_tolerance)
      list_.add("solver.volume_tolerance ", tolerance,
                " ends volume iterations where matter is compressed by ", 100 * tolerance,
                "% in the mean, as it hardly ever is: none are taken; 0.001 to 0.05 are usual, and 0 "
                "takes all");
  }

  void look_at_iterations() {
    const int iterations = state_.volume_iterations();
    if (iterations <= k_many_iterations || state_.config.volume_tolerance > 0 || !state_.keeps_volume())
      return;
    list_.add(
        "solver.volume_iterations ", iterations,
        " are all taken in every step, each about half as long as a step without, where a hard impact "
        "takes 8 to a mean compression of 0.001; give solver.volume_tolerance = 0.001, at which they end");
  }

  const Simulation::State& state_;
  std::vector<float> thickness_;  ///< of each collider, as a blade [m]
  WarningList list_;
};

}  // namespace

std::vector<std::string> matter_warnings(const Simulation::State& state) {
  return MatterWarnings(state).list();
}

}  // namespace mallow
