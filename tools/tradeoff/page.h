#pragma once

#include <optional>
#include <string>

#include "tradeoff/films.h"
#include "tradeoff/study.h"

namespace mallow::tradeoff {

/// One page of HTML that needs no other file but its film: the front, two settings side by side, the table,
/// and what to paste. picked: of the rows.
std::string to_page(const Study& study, std::optional<std::size_t> picked = {},
                    const std::optional<SideBySide>& film = {});

}  // namespace mallow::tradeoff
