#pragma once

#include <optional>
#include <string>

#include "tradeoff/confirm.h"
#include "tradeoff/study.h"

namespace mallow::tradeoff {

/// What a study found, in words and a table, cheapest first.
std::string to_text(const Study& study);
/// What there is to know about the reference, chaos, and what was left out: a sentence each.
std::vector<std::string> remarks(const Study& study);
/// What the columns of to_text(), to_csv() and the page mean, a line each.
std::vector<std::string> column_help();
/// A row for each setting.
std::string to_csv(const Study& study);
std::string to_json(const Study& study, const std::optional<Picked>& picked = {});
/// Indices of rows, cheapest first.
std::vector<std::size_t> by_cost(const Study& study);
/// "%.3g" and the like.
std::string number(double value, int digits = 3);
/// "--budget 90s": two digits, rounded up.
std::string budget_option(double seconds);

}  // namespace mallow::tradeoff
