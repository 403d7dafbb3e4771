#pragma once

#include <Eigen/Core>

namespace mallow::oracle {

/// [TK eq. 3]
double poly6(double r, double sigma);
/// C2, the kernel of densities where volume is kept. [Wendland 1995]
double wendland(double r, double sigma);

}  // namespace mallow::oracle
