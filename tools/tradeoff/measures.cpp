#include "tradeoff/measures.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "mallow/errors.h"

namespace mallow::tradeoff {
namespace {

using Of = double (*)(Simulation&, BodyId);

const std::array<std::pair<const char*, Of>, 10> k_measures = {{
    {"height", [](Simulation& s, BodyId b) { return double(s.bounds(b).max.z() - s.bounds(b).min.z()); }},
    {"top", [](Simulation& s, BodyId b) { return double(s.bounds(b).max.z()); }},
    {"extent_x", [](Simulation& s, BodyId b) { return double(s.bounds(b).max.x() - s.bounds(b).min.x()); }},
    {"extent_y", [](Simulation& s, BodyId b) { return double(s.bounds(b).max.y() - s.bounds(b).min.y()); }},
    {"center_x", [](Simulation& s, BodyId b) { return s.motion(b).center_of_mass.x(); }},
    {"center_y", [](Simulation& s, BodyId b) { return s.motion(b).center_of_mass.y(); }},
    {"center_z", [](Simulation& s, BodyId b) { return s.motion(b).center_of_mass.z(); }},
    {"volume", [](Simulation& s, BodyId b) { return s.volume(b); }},
    {"speed", [](Simulation& s, BodyId b) { return s.motion(b).velocity.norm(); }},
    {"kinetic_energy", [](Simulation& s, BodyId b) { return s.motion(b).kinetic_energy; }},
}};

std::string known_measures() {
  std::string text;
  for (const auto& [name, of] : k_measures) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

std::optional<BodyId> body_of(const std::string& name, const Simulation& simulation) {
  if (const auto body = simulation.find_body(name)) return body;
  const std::vector<BodyId> bodies = simulation.bodies();
  const bool is_number = !name.empty() && name.size() < 9 &&
                         std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; });
  if (is_number && std::stoul(name) < bodies.size()) return bodies[std::stoul(name)];
  return std::nullopt;
}

}  // namespace

Measure parse_measure(const std::string& text, const Simulation& simulation) {
  const std::size_t open = text.find('(');
  const std::string what = text.substr(0, open);
  const auto found =
      std::ranges::find_if(k_measures, [&](const auto& measure) { return what == measure.first; });
  if (found == k_measures.end() || open == text.npos || !text.ends_with(')'))
    throw ConfigError("--measure", "'" + text + "' is not known: one of " + known_measures() +
                                       ", of a body, like height(body)");
  const std::string name = text.substr(open + 1, text.size() - open - 2);
  const std::optional<BodyId> body = body_of(name, simulation);
  if (!body) {
    std::string names;
    for (const BodyId id : simulation.bodies()) names += (names.empty() ? "" : ", ") + simulation.name(id);
    throw ConfigError("--measure", "'" + text + "': there is no body '" + name + "'; there are " + names);
  }
  return {text, [of = found->second, body = *body](Simulation& s) {
            const auto bodies = s.bodies();
            return std::ranges::find(bodies, body) == bodies.end() ? 0 : of(s, body);  // it is gone
          }};
}

}  // namespace mallow::tradeoff
