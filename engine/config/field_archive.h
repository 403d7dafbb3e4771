#pragma once

#include <vector>

#include "config/allowed.h"
#include "core/archive.h"
#include "mallow/schedule.h"

/// Settings in archives of both ways, which are called alike (core/archive.h).
namespace mallow {

/// The values of a list; each takes at least `bytes_each`.
template <class Archive, class List, class Pass>
void pass_list(Archive& archive, List& values, std::size_t bytes_each, const Pass& pass) {
  if constexpr (Archive::k_packs)
    archive(static_cast<std::uint64_t>(values.size()));
  else
    values.resize(archive.count(bytes_each));
  for (auto& value : values) pass(value);
}

template <class Archive, class T>
void pass_value(Archive& archive, T& value) {
  using Value = std::remove_const_t<T>;
  if constexpr (std::is_same_v<Value, Schedule>) {
    std::vector<ScheduleKey> keys = value.keys();
    pass_list(archive, keys, sizeof(ScheduleKey), [&](ScheduleKey& key) {
      archive(key.time);
      archive(key.value);
    });
    if constexpr (!Archive::k_packs) value = Schedule(std::move(keys));
  } else if constexpr (Choice<Value>) {
    auto number = static_cast<std::uint8_t>(value);
    archive(number);
    if constexpr (!Archive::k_packs) {
      if (number >= choices(Value{}).size()) archive.fail("there is no choice " + std::to_string(number));
      value = static_cast<Value>(number);
    }
  } else if constexpr (k_is_optional<Value>) {
    bool given = value.has_value();
    archive(given);
    if constexpr (!Archive::k_packs) {
      value.reset();
      if (given) value.emplace();
    }
    if (given) pass_value(archive, *value);
  } else {
    archive(value);
  }
}

/// Every setting that states hold, in the order of the table.
template <class Archive, class Config>
void pass_fields(Archive& archive, Config& config) {
  for_fields<std::remove_const_t<Config>>([&](const auto& field) {
    if (field.in_states()) pass_value(archive, config.*field.member);
  });
}

}  // namespace mallow
