#pragma once

#include <optional>
#include <string>

#include "tradeoff/study.h"

namespace mallow::tradeoff {

/// One page of HTML that needs no other file: the front, the table, and what to paste. picked: of the rows.
std::string to_page(const Study& study, std::optional<std::size_t> picked = {});

}  // namespace mallow::tradeoff
