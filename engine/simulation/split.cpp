// Bodies that were torn: their parts become bodies of their own.
#include <algorithm>
#include <charconv>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>

#include "shape_matching/parts.h"
#include "shape_matching/reshape.h"
#include "simulation/membership.h"
#include "simulation/phases.h"
#include "simulation/state.h"

namespace mallow {
namespace {

using Places = std::vector<std::uint32_t>;  ///< of particles of a body, ascending

/// The particle whose part keeps the id, where an emitter holds one: of the last layer, as new ones are put
/// behind that.
std::optional<std::uint32_t> held_particle(const Simulation::State& s, const BodyState& body) {
  for (const EmitterState& emitter : s.emitters)
    if (emitter.body == body.id)
      for (auto layer = emitter.held.rbegin(); layer != emitter.held.rend(); ++layer)
        for (const ParticleId id : *layer)
          if (const std::optional<std::size_t> row = s.store.slots.find(id);
              row && *row >= body.begin && *row < body.end)  // an earlier part may have taken some along
            return static_cast<std::uint32_t>(*row - body.begin);
  return {};
}

/// The parts of a body, that which keeps the id first, with all crumbs; the others in the order of their
/// first particles.
std::vector<Places> list_pieces(const Simulation::State& s, const BodyState& body, const Parts& parts) {
  std::map<std::uint32_t, Places> by_part;
  Places crumbs;
  for (std::uint32_t i = 0; i < parts.of.size(); ++i)
    (parts.of[i] == Parts::k_none ? crumbs : by_part[parts.of[i]]).push_back(i);
  auto kept = std::ranges::max_element(by_part, {}, [](const auto& part) { return part.second.size(); });
  if (const auto held = held_particle(s, body); held && parts.of[*held] != Parts::k_none)
    kept = by_part.find(parts.of[*held]);
  std::vector<Places> pieces(1);
  std::ranges::merge(kept->second, crumbs, std::back_inserter(pieces[0]));
  for (auto& [first, places] : by_part)
    if (first != kept->first) pieces.push_back(std::move(places));
  return pieces;
}

/// A body as another is, without its particles.
BodyState body_like(const BodyState& body) {
  BodyState like;
  like.material = body.material;
  like.merges = body.merges;
  like.splits = body.splits;
  like.spacing = body.spacing;
  like.mass = body.mass;
  like.rest_density = body.rest_density;
  like.viscosity = body.viscosity;
  like.elastic_time_step = body.elastic_time_step;
  like.judged_external = body.judged_external;
  like.recent_external = body.recent_external;
  like.enabled = body.enabled;
  like.user_data = body.user_data;
  like.hit_impulse = body.hit_impulse;
  like.paints_alpha = body.paints_alpha;
  like.paints_stiffness = body.paints_stiffness;
  like.paints_yield = body.paints_yield;
  like.is_heated = body.is_heated;
  like.grew = false;
  return like;
}

const std::string& whole_of(const BodyState& body) {
  return body.whole.empty() ? body.name : body.whole;
}

/// Numbers the parts of a whole: "bar, part 2" and so on, whichever of them they are torn from. No number
/// comes again as long as one of them is there, also where the part that had it has merged or is gone.
class PartNames {
 public:
  explicit PartNames(Simulation::State& s) : s_(s) {}

  void name(const BodyState& torn, BodyState& part) {
    if (last_.empty()) look_at_all();
    part.whole = whole_of(torn);
    part.name = part.whole + std::string(k_part) + std::to_string(++last_[part.whole]);
  }
  /// Once all parts are among the bodies.
  void keep() const {
    if (last_.empty()) return;
    for (BodyState& body : s_.bodies) body.last_part = last_.at(whole_of(body));
  }

 private:
  static constexpr std::string_view k_part = ", part ";

  void look_at_all() {
    for (const BodyState& body : s_.bodies) {
      raise(whole_of(body), body.last_part);
      // Somebody may have called a body so.
      const std::size_t place = body.name.rfind(k_part);
      if (place == body.name.npos) continue;
      std::uint32_t number = 0;
      std::from_chars(body.name.data() + place + k_part.size(), body.name.data() + body.name.size(), number);
      raise(body.name.substr(0, place), number);
    }
  }
  void raise(const std::string& whole, std::uint32_t number) {
    std::uint32_t& last = last_[whole];
    last = std::max(last, number);
  }

  Simulation::State& s_;
  std::unordered_map<std::string, std::uint32_t> last_;  ///< number of each whole; empty until asked for
};

/// Rows of a body in the order of its pieces.
void sort_rows(Simulation::State& s, const BodyState& body, const std::vector<Places>& pieces) {
  Places order;
  for (const Places& piece : pieces) order.insert(order.end(), piece.begin(), piece.end());
  s.store.permute(body.begin, order, s.execution.threads);
}

std::vector<BodyId> split_body(Simulation::State& s, BodyState& body, PartNames& names) {
  if (!body.shape.built) return {body.id};
  find_parts(body.shape, s.parts_before);
  if (s.parts_before.count < 2) return {body.id};
  wake_island(s, body);
  const std::vector<Places> pieces = list_pieces(s, body, s.parts_before);
  CarriedRegions carried = carry_regions(body.shape);
  std::vector<SplitShape> shapes;
  Places leaving;
  for (const Places& piece : std::span(pieces).subspan(1)) {
    shapes.push_back(split_off(piece, carried, body.shape));
    leaving.insert(leaving.end(), piece.begin(), piece.end());
  }
  std::ranges::sort(leaving);
  sort_rows(s, body, pieces);
  erase_from_reference(leaving, carried, body.shape);
  body.end = body.begin + pieces[0].size();
  body.apart = false;
  rebuild_shape(s, body, carried);

  std::vector<BodyId> ids = {body.id};
  std::size_t place = s.place_of(body), end = body.end;
  for (std::size_t k = 1; k < pieces.size(); ++k) {
    BodyState part = body_like(body);
    part.id = BodyId{s.body_slots.take()};
    names.name(body, part);
    part.begin = end;
    part.end = end += pieces[k].size();
    part.shape = std::move(shapes[k - 1].shape);
    rebuild_shape(s, part, shapes[k - 1].carried);
    ids.push_back(part.id);
    s.next_events.push_back({.kind = BodyEvent::Kind::split, .body = body.id, .other = part.id});
    ++part.material->bodies;
    s.body_names.add(part);
    s.bodies.insert(++place, std::move(part));
  }
  number_bodies(s);
  s.rows_changed();
  return ids;
}

}  // namespace

std::vector<BodyId> split_body(Simulation::State& s, BodyState& body) {
  PartNames names(s);
  std::vector<BodyId> ids = split_body(s, body, names);
  names.keep();
  return ids;
}

void split_torn(Simulation::State& s) {
  std::vector<BodyState*> torn;
  for (BodyState& body : s.bodies)
    if (body.splits && body.apart && body.moves()) torn.push_back(&body);
  PartNames names(s);
  for (BodyState* body : torn) split_body(s, *body, names);
  names.keep();
  if (!torn.empty()) prepare(s);
}

}  // namespace mallow
