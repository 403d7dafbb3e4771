#pragma once

#include <Eigen/Core>

namespace mallow::oracle {

/// [TK eq. 3]
double poly6(double r, double sigma);
/// Of the volume constraint's kernel: S of a half space at distance d. [Wendland 1995]
double wendland_half_space_share(double d, double sigma);

}  // namespace mallow::oracle
