#pragma once

#include <cstdint>

namespace mallow {

/// Clusters of a grid and the list of each, as lanes read them: build_cluster_lists().
struct ClusterLists {
  const std::uint32_t* first;    ///< place of the first particle of each cluster, and where the last one ends
  const std::uint32_t* begin;    ///< per cluster, where its list starts in `indices`
  const std::uint32_t* count;    ///< how long it is
  const std::uint32_t* indices;  ///< sorted places
  const std::uint32_t* row_of;   ///< sorted place -> row of the particle store
};

}  // namespace mallow
