// Damping towards a group's motion as a rigid whole: sections 3 and 4 B of the second chapter.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "oracle/oracle.h"

namespace mallow::oracle {

// ζ: what hardly moves comes to rest, what moves is left alone more and more.
double Oracle::damping_rate(const Group& group, double deformation_speed) const {
  if (group.material.deformation_damping) return double{*group.material.deformation_damping};
  const double ratio = deformation_speed * dt0_ / (0.02 * group.spacing);
  return 0.3 / (dt0_ * (1 + ratio * ratio));
}

// v' += (1 − exp(−ζ Δt)) (v_rigid − v'), of what is held together by a shape.
void Oracle::damp(double dt) {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (groups_[g].least_alpha == 1) continue;
    double n = 0;
    Vec center = Vec::Zero(), velocity = Vec::Zero(), spin = Vec::Zero();
    const auto each = [&](const auto& what) {
      for (Particle& p : particles_)
        if (p.group == g) what(p);
    };
    each([&](const Particle& p) { n += 1, center += p.x, velocity += p.v; });
    center /= n;
    velocity /= n;
    Matrix inertia = Matrix::Zero();
    each([&](const Particle& p) {
      const Vec arm = p.x - center;
      spin += arm.cross(p.v - velocity);
      inertia += arm.squaredNorm() * Matrix::Identity() - arm * arm.transpose();
    });
    const Vec turning = inertia.inverse() * spin;
    const auto rigid = [&](const Particle& p) { return Vec(velocity + turning.cross(p.x - center)); };
    double squares = 0;
    each([&](const Particle& p) { squares += (p.v - rigid(p)).squaredNorm() / n; });
    const double share = 1 - std::exp(-damping_rate(groups_[g], std::sqrt(squares)) * dt);
    each([&](Particle& p) {
      if (!p.pinned && share > 0) p.v += share * (rigid(p) - p.v);
    });
  }
}

}  // namespace mallow::oracle
