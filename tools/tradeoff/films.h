#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tradeoff/study.h"

namespace mallow::tradeoff {

/// The scene as it is and another setting, at the same moments beside each other in one film: so they stay in
/// step.
struct SideBySide {
  std::string file = {};  ///< name of it, beside the page; empty: there is none
  std::string why = {};   ///< there is none
  std::size_t row = 0;    ///< of the study, at the right
  std::size_t pictures = 0;
};

/// The setting that is worth to be seen beside the scene as it is: the pick, or else the cheapest that no
/// other beats. Nothing where there is but the scene as it is.
std::optional<std::size_t> row_to_show(const Study& study, std::optional<std::size_t> picked = {});

/// Runs both again and writes the film, of as many pictures as there is time for until `deadline`, by
/// wall_clock(). What keeps it from that is in `why`. Throws Stopped, and IoError where the film cannot be
/// written.
SideBySide film_side_by_side(const Study& study, std::size_t row, const StudyOptions& options,
                             double deadline, const std::filesystem::path& file);

}  // namespace mallow::tradeoff
