#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace mallow::bench {

/// A quantity over the frames of a run, frame 0 first.
using Curve = std::vector<double>;

/// What was measured of one run.
struct Recording {
  double spacing = 1;                   ///< h of the sampled body [m]
  std::map<std::string, Curve> curves;  ///< by the quantity's key
  const Curve& operator[](const std::string& key) const { return curves.at(key); }
};

enum class Bound { at_least, at_most };

/// What a figure of the paper shows, as a number that can be on the wrong side of a limit.
struct Claim {
  std::string name;      ///< "wider_regions_are_stiffer"
  std::string sentence;  ///< what the figure shows
  std::string measure;   ///< what `measured` is
  double measured;
  Bound bound;
  double limit;
  std::string unit = {};            ///< of `measured` and `limit`; empty: a ratio or a number
  std::vector<double> values = {};  ///< what `measured` comes from, one per recording; may be empty
};

/// A number that is not one is on the wrong side of every limit.
inline bool holds(const Claim& claim) {
  return claim.bound == Bound::at_least ? claim.measured >= claim.limit : claim.measured <= claim.limit;
}

}  // namespace mallow::bench
