#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "stability/trial.h"

namespace mallow::bench {

/// One setting of bodies that touch, rest, come or are pushed, turned from end to end, at every alpha.
struct Panel {
  std::string name;
  std::vector<float> values;
  std::function<Trial(float alpha, float value)> trial;
};
/// Friction, adhesion, mass ratio, speed, damping, spawn rate, speed of an emitter and of colliders.
std::vector<Panel> panels();

/// The alphas of all panels.
std::vector<float> panel_alphas(bool thin);

/// A field for each alpha and value. outcomes: panel by panel, value by value, alpha by alpha.
void write_panels(const std::filesystem::path& svg, const std::vector<Panel>& panels,
                  const std::vector<float>& alphas, const std::vector<Outcome>& outcomes);

}  // namespace mallow::bench
