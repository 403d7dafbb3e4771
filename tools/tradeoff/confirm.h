#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tradeoff/study.h"

namespace mallow::tradeoff {

/// What `mallow tune` settled on.
struct Picked {
  std::size_t row = 0;  ///< of the study; it has the times of the runs that confirmed it too
  bool holds = false;  ///< false: the nearest, or, of an error that cannot be judged, the one that looks best
  std::string not_judged = {};  ///< why no setting can be said to hold, and what to do; empty where one can
  std::size_t more = 0;         ///< runs that confirmed it; 0 where the budget had ended
  double error = 0;             ///< in the last of them, or in the study where there is none [h]
  std::vector<std::string> dropped = {};  ///< settings that looked as good, each with why not
};

/// Picks by a limit and runs the pick again: one that then does not hold is dropped, and the next one is
/// picked. Times are medians of all runs of a setting, those of the study and the new ones. deadline:
/// wall_clock() at which what is picked is not run again; nor is it where the limit cannot be judged. Nothing
/// where no setting could be measured.
std::optional<Picked> confirm(Study& study, const Limit& limit, const StudyOptions& options, double deadline);

}  // namespace mallow::tradeoff
