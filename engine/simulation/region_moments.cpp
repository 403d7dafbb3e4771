#include "simulation/region_moments.h"

namespace mallow {
namespace {

using Vec = Eigen::Vector3d;

}  // namespace

Places places(const Simulation::State& state, const BodyState& body) {
  Places all;
  const auto x = [&](std::size_t i) { return Vec(state.store.position.get(body.begin + i).cast<double>()); };
  const auto rest = [&](std::size_t i) { return Vec(body.shape.reference.get(i).cast<double>()); };
  for (std::size_t i = 0; i < body.size(); ++i) {
    all.x.push_back(x(i) - x(0));
    all.rest.push_back(rest(i) - rest(0));
  }
  return all;
}

std::vector<Numbers<Moments::k_count>> region_moments(const ShapeMatching& shape, const Places& at) {
  std::vector<Numbers<Moments::k_count>> rows(at.x.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double w = static_cast<double>(shape.weight[i]);
    const Vec &x = at.x[i], &r = at.rest[i];
    Moments own;
    own.weight() = w;
    own.x() = w * x;
    own.r() = w * r;
    own.xr() = w * x * r.transpose();
    own.xx() = w * x.squaredNorm();
    own.rr() << r.x() * r.x(), r.y() * r.y(), r.z() * r.z(), r.y() * r.z(), r.x() * r.z(), r.x() * r.y();
    own.rr() *= w;
    rows[i] = own.all;
  }
  return sum_lists<Moments::k_count>(shape.regions, std::move(rows));
}

}  // namespace mallow
