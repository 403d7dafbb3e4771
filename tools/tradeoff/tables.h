#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tradeoff/pick.h"

namespace mallow::tradeoff {

/// A row for every setting: what it is, what it costs, how far it is off.
std::string csv_of(const Study& study);
/// All that was measured. pick: of `mallow tune`.
nlohmann::ordered_json json_of(const Study& study, const std::optional<Goal>& goal = {},
                               const std::optional<Pick>& pick = {});
/// The front, the scene as it is and the presets, to be read in a terminal.
std::string text_table(const Study& study);

/// Rows in the order of their cost; what failed comes last.
std::vector<std::size_t> by_cost(std::span<const TuningRow> rows);

}  // namespace mallow::tradeoff
