#pragma once

#include <cstdint>
#include <limits>
#include <tuple>
#include <type_traits>

namespace mallow {

/// The numbers a setting takes; those of a vector or of an alpha schedule, component by component.
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool above_lowest = false;  ///< `lowest` itself is not allowed

  /// Whether a number is between the bounds. A float is compared with bounds that are rounded as it is, so
  /// that 0.01f is in [0.01, 4].
  template <class T>
  constexpr bool holds(T value) const {
    using Compared = std::conditional_t<std::is_same_v<T, float>, float, double>;
    const auto number = static_cast<Compared>(value);
    const auto low = static_cast<Compared>(lowest);
    return (above_lowest ? number > low : number >= low) && number <= static_cast<Compared>(highest);
  }
};
inline constexpr Range k_finite{};
inline constexpr Range k_any{};  ///< of words and flags
inline constexpr Range k_positive{.lowest = 0, .above_lowest = true};
inline constexpr Range k_not_negative{.lowest = 0};
constexpr Range between(double lowest, double highest) {
  return {.lowest = lowest, .highest = highest};
}
constexpr Range at_least(int lowest) {
  return between(lowest, std::numeric_limits<int>::max());
}

/// Where the value of a setting is written down. Threads, for one, belong to a machine: in neither.
enum class Written : std::uint8_t { nowhere, in_scenes, in_states, everywhere };

/// In place of Field::left_out: a scene without the setting is refused.
inline constexpr char k_required[] = "required";

/// All there is to say of a setting but its value; its default is that of the member. What reads, checks,
/// prints, saves or shows settings walks tables of these, so that each is described once.
template <class Owner, class T>
struct Field {
  const char* name;
  T Owner::*member;
  Range range;
  const char* unit;  ///< empty for plain numbers, words and flags
  const char* doc;
  const char* left_out = "";  ///< what holds without it, where the member's value does not say so
  Written written = Written::everywhere;

  constexpr bool in_scenes() const { return written == Written::in_scenes || written == Written::everywhere; }
  constexpr bool in_states() const { return written == Written::in_states || written == Written::everywhere; }
};
template <class Owner, class T, class... Others>
Field(const char*, T Owner::*, Others...) -> Field<Owner, T>;

/// Specialised for every config with a `static constexpr std::tuple k_fields` of its settings, see
/// config/field_tables.h; for a shape of colliders in the file of that shape.
template <class Config>
struct FieldTable;

/// Calls visit(field) with each setting of a config, in order.
template <class Config, class Visit>
constexpr void for_fields(const Visit& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, FieldTable<Config>::k_fields);
}

/// The range of one setting: range_of(&SurfaceConfig::voxels).
template <class Owner, class T>
constexpr Range range_of(T Owner::*member) {
  Range range;
  for_fields<Owner>([&](const auto& field) {
    if constexpr (std::is_same_v<decltype(field.member), T Owner::*>)
      if (field.member == member) range = field.range;
  });
  return range;
}

}  // namespace mallow
