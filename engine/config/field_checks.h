#pragma once

#include "config/allowed.h"
#include "core/checks.h"

namespace mallow {

template <class T>
void check_value(const std::string& path, const T& value, const Range& range, Checks& checks);

template <class Numbers>
void check_each(const std::string& path, const Numbers& numbers, const Range& range, Checks& checks) {
  std::size_t i = 0;
  for (const auto number : numbers) {
    if (!range.holds(number)) check_value(path + '[' + std::to_string(i) + ']', number, range, checks);
    ++i;
  }
}

/// Adds a problem where a value is not what its range allows, or not finite. path: as the user types it.
template <class T>
void check_value(const std::string& path, const T& value, const Range& range, Checks& checks) {
  if constexpr (k_is_optional<T>) {
    if (value) check_value(path, *value, range, checks);
  } else if constexpr (std::is_same_v<T, Vec3>) {
    checks.vector(path, value);
    if (value.allFinite()) check_each(path, value, range, checks);
  } else if constexpr (std::is_same_v<T, Count3>) {
    check_each(path, value, range, checks);
  } else if constexpr (std::is_same_v<T, Schedule>) {
    if (value.keys().empty()) checks.problem(path, "has no keys: at least one is needed");
    for (std::size_t k = 0; k < value.keys().size(); ++k) {
      const ScheduleKey& key = value.keys()[k];
      check_value(path, key.value, range, checks);
      checks.number(path + " time", key.time, k == 0 || key.time > value.keys()[k - 1].time,
                    "finite times, each above the one before");
    }
  } else if constexpr (Choice<T>) {
    const auto number = static_cast<std::size_t>(value);
    checks.number(path, number, number < choices(T{}).size(), allowed<T>(range));
  } else if constexpr (!std::is_same_v<T, bool>) {
    if (!range.holds(value) || !std::isfinite(static_cast<double>(value)))
      checks.number(path, value, false, allowed<T>(range));
  }
}

/// The same of every setting of a config. prefix: "solver.".
template <class Config>
void check_fields(const std::string& prefix, const Config& config, Checks& checks) {
  for_fields<Config>([&](const auto& field) {
    check_value(prefix + field.name, config.*field.member, field.range, checks);
  });
}

}  // namespace mallow
