// Convex hulls by quickhull [Barber et al. 1996]: a simplex grows by the point that is farthest in front of
// one of its faces, which replaces all faces that see it.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "colliders/hull.h"
#include "mallow/errors.h"

namespace mallow {
namespace {

using Vec = Eigen::Vector3d;

/// What points may be off by, and how thick they have to be, in sizes of their box.
constexpr double k_rounding = 1e-6, k_least_thickness = 1e-4;
/// Each particle near a hull is tested against all of its planes.
constexpr std::size_t k_most_corners = 1024;

struct Face {
  std::array<int, 3> corners;  ///< counter-clockwise from outside
  Vec normal;
  double offset;
  std::vector<int> in_front = {};  ///< points that only this face is held responsible for
  bool is_part = true;
};

class HullBuilder {
 public:
  explicit HullBuilder(std::span<const Vec3> points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!points[i].allFinite())
        throw ConfigError("hull.points[" + std::to_string(i) + "]", "must be finite");
      points_.push_back(points[i].cast<double>());
    }
    if (points_.size() < 4)
      throw ConfigError("hull.points",
                        std::to_string(points_.size()) + " points enclose nothing: at least 4 are needed");
    start();
    for (std::size_t f = 0; f < faces_.size(); ++f)
      while (faces_[f].is_part && !faces_[f].in_front.empty()) grow(static_cast<int>(f));
  }

  HullData data() const;

 private:
  double distance(const Face& face, int point) const {
    return face.normal.dot(points_[index(point)]) - face.offset;
  }
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }

  template <class Measure>
  int farthest(const Measure& measure) const {
    int best = 0;
    for (int i = 1; i < static_cast<int>(points_.size()); ++i)
      if (measure(points_[index(i)]) > measure(points_[index(best)])) best = i;
    return best;
  }

  void start() {
    Vec min = points_[0], max = points_[0];
    for (const Vec& p : points_) {
      min = min.cwiseMin(p);
      max = max.cwiseMax(p);
    }
    const double size = (max - min).norm();
    rounding_ = k_rounding * std::max(size, 0.1 * max.cwiseAbs().cwiseMax(min.cwiseAbs()).maxCoeff());
    const double thick = std::max(k_least_thickness * size, 4 * rounding_);
    const auto require = [&](double extent, const char* shape) {
      if (!(extent > thick))
        throw ConfigError("hull.points", std::string("enclose nothing: all are ") + shape);
    };
    require(size, "at one place");
    const int a = farthest([&](const Vec& p) { return (p - min).squaredNorm(); });
    const Vec from = points_[index(a)];
    const int b = farthest([&](const Vec& p) { return (p - from).squaredNorm(); });
    const Vec line = (points_[index(b)] - from).normalized();
    const auto beside = [&](const Vec& p) { return (p - from).cross(line).norm(); };
    const int c = farthest(beside);
    require(beside(points_[index(c)]), "in one line");
    const Vec normal = line.cross(points_[index(c)] - from).normalized();
    const auto above = [&](const Vec& p) { return std::abs(normal.dot(p - from)); };
    const int d = farthest(above);
    require(above(points_[index(d)]), "in one plane");
    const bool is_front = normal.dot(points_[index(d)] - from) > 0;
    const int e = is_front ? c : b, f = is_front ? b : c;
    std::vector<int> all(points_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
    std::vector<int> first;
    for (const std::array<int, 3>& corners :
         {std::array{a, e, f}, std::array{a, f, d}, std::array{f, e, d}, std::array{e, a, d}})
      first.push_back(add(corners, normal));
    share(all, first);
  }

  int add(const std::array<int, 3>& corners, const Vec& otherwise) {
    const Vec &a = points_[index(corners[0])], &b = points_[index(corners[1])],
              &c = points_[index(corners[2])];
    const Vec cross = (b - a).cross(c - a);
    const double area = cross.norm();
    // A sliver has no normal of its own.
    const Vec normal = area > rounding_ * rounding_ ? Vec(cross / area) : otherwise;
    const int face = static_cast<int>(faces_.size());
    faces_.push_back({corners, normal, normal.dot(a + b + c) / 3});
    for (std::size_t k = 0; k < 3; ++k) face_of_[{corners[k], corners[(k + 1) % 3]}] = face;
    return face;
  }

  /// Gives each point to the first of the faces that it is in front of.
  void share(const std::vector<int>& points, const std::vector<int>& among) {
    for (const int point : points)
      for (const int face : among)
        if (distance(faces_[index(face)], point) > rounding_) {
          faces_[index(face)].in_front.push_back(point);
          break;
        }
  }

  void grow(int from) {
    const std::vector<int>& front = faces_[index(from)].in_front;
    const int point = *std::max_element(front.begin(), front.end(), [&](int a, int b) {
      return distance(faces_[index(from)], a) < distance(faces_[index(from)], b);
    });
    // All faces that see it hang together.
    std::vector<int> seeing{from}, orphans;
    faces_[index(from)].is_part = false;
    std::vector<std::pair<int, int>> horizon;
    for (std::size_t k = 0; k < seeing.size(); ++k) {
      const Face& face = faces_[index(seeing[k])];
      for (const int other : face.in_front)
        if (other != point) orphans.push_back(other);
      for (std::size_t edge = 0; edge < 3; ++edge) {
        const int a = face.corners[edge], b = face.corners[(edge + 1) % 3];
        const int next = face_of_.at({b, a});
        Face& neighbor = faces_[index(next)];
        if (!neighbor.is_part) continue;
        if (distance(neighbor, point) > 0.1 * rounding_) {
          neighbor.is_part = false;
          seeing.push_back(next);
        }
      }
    }
    for (const int face : seeing)
      for (std::size_t edge = 0; edge < 3; ++edge) {
        const auto& corners = faces_[index(face)].corners;
        const std::pair<int, int> rim(corners[edge], corners[(edge + 1) % 3]);
        if (faces_[index(face_of_.at({rim.second, rim.first}))].is_part) horizon.push_back(rim);
      }
    std::vector<int> added;
    for (const auto& [a, b] : horizon)
      added.push_back(add({a, b, point}, faces_[index(face_of_.at({b, a}))].normal));
    share(orphans, added);
    for (const int face : seeing) faces_[index(face)].in_front.clear();
  }

  std::vector<Vec> points_;
  std::vector<Face> faces_;
  std::map<std::pair<int, int>, int> face_of_;  ///< on the left of a directed edge
  double rounding_ = 0;                         ///< [m]
};

HullData HullBuilder::data() const {
  HullData data;
  data.rounding = static_cast<float>(rounding_);
  std::map<int, std::size_t> corners;
  for (const Face& face : faces_)
    for (const int corner : face.corners)
      if (face.is_part && corners.emplace(corner, corners.size()).second)
        data.corners.push_back(points_[index(corner)].cast<float>());
  if (corners.size() > k_most_corners)
    throw ConfigError("hull.points", "have a hull of " + std::to_string(corners.size()) +
                                         " corners: at most " + std::to_string(k_most_corners) +
                                         " are allowed, take fewer points");
  // Triangles of one plane are one face.
  std::map<int, std::size_t> plane_of;
  std::vector<const Face*> planes;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const Face& face = faces_[f];
    if (!face.is_part) continue;
    const auto is_same = [&](const Face* other) {
      return other->normal.dot(face.normal) > 0.99 &&
             std::all_of(face.corners.begin(), face.corners.end(),
                         [&](int corner) { return std::abs(distance(*other, corner)) <= rounding_; });
    };
    const auto known = std::find_if(planes.begin(), planes.end(), is_same);
    plane_of[static_cast<int>(f)] = static_cast<std::size_t>(known - planes.begin());
    if (known == planes.end()) planes.push_back(&face);
  }
  for (const Face* face : planes) {
    // So far out that all corners are behind it.
    double offset = face->offset;
    for (const auto& [corner, number] : corners)
      offset = std::max(offset, face->normal.dot(points_[index(corner)]));
    const Vec3 normal = face->normal.cast<float>();
    data.planes.push_back({normal[0], normal[1], normal[2], static_cast<float>(offset)});
  }
  for (const auto& [edge, face] : face_of_) {
    const auto [a, b] = edge;
    if (a > b || !faces_[index(face)].is_part) continue;
    if (plane_of.at(face) == plane_of.at(face_of_.at({b, a}))) continue;
    const Vec along = points_[index(b)] - points_[index(a)];
    const Vec3 start = points_[index(a)].cast<float>(), direction = along.normalized().cast<float>();
    data.edges.push_back({{start[0], start[1], start[2]},
                          {direction[0], direction[1], direction[2]},
                          static_cast<float>(along.norm())});
  }
  return data;
}

}  // namespace

ConvexHull convex_hull(std::span<const Vec3> points, bool inside) {
  return {std::make_shared<const HullData>(HullBuilder(points).data()), inside};
}

}  // namespace mallow
