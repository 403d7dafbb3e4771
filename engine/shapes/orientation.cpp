#include "shapes/orientation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <unsupported/Eigen/BVH>
#include <utility>

#include "shapes/line_crossing.h"

namespace mallow {
namespace {

/// Sets of triangles that know of each member whether it faces as the set's first one or the other way.
class Patches {
 public:
  explicit Patches(std::size_t count) : parent_(count), other_way_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t root(std::uint32_t t) { return find(t).first; }
  bool other_way(std::uint32_t t) { return find(t).second; }
  /// Joins the sets of two triangles that face the same way, or not. False where they are known to be
  /// otherwise.
  bool join(std::uint32_t a, std::uint32_t b, bool differ) {
    const auto [root_a, way_a] = find(a);
    const auto [root_b, way_b] = find(b);
    const bool other = way_a != way_b;
    if (root_a == root_b) return other == differ;
    const auto [low, high] = std::minmax(root_a, root_b);
    parent_[high] = low;
    other_way_[high] = other != differ;
    return true;
  }

 private:
  /// The root, and whether t faces another way than it. Halves the path.
  std::pair<std::uint32_t, bool> find(std::uint32_t t) {
    bool other = false;
    while (parent_[t] != t) {
      const std::uint32_t p = parent_[t];
      other_way_[t] ^= other_way_[p];  // a root's is 0
      parent_[t] = parent_[p];
      other = other != (other_way_[t] != 0);
      t = parent_[t];
    }
    return {t, other};
  }

  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> other_way_;
};

/// A triangle's edge, from its lower to its higher vertex.
struct Edge {
  std::uint32_t low, high, triangle;
  bool forward;  ///< the triangle runs along it from low to high
};

std::vector<Edge> sorted_edges(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return edges;
}

/// Calls visit(first, last) for the triangles of each edge.
template <class Visit>
void for_each_edge(const std::vector<Edge>& edges, const Visit& visit) {
  for (std::size_t begin = 0, end; begin < edges.size(); begin = end) {
    end = begin + 1;
    while (end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high)
      ++end;
    visit(begin, end);
  }
}

/// Turns triangles that face another way than most of those that they hang together with. How many, or
/// nothing where they cannot agree.
std::optional<std::size_t> make_neighbors_agree(const std::vector<Edge>& edges,
                                                std::vector<std::array<std::uint32_t, 3>>& triangles) {
  Patches patches(triangles.size());
  bool agree = true;
  for_each_edge(edges, [&](std::size_t begin, std::size_t end) {
    // Where more than two meet, it is not known which of them belong together.
    if (end - begin == 2)
      agree = patches.join(edges[begin].triangle, edges[begin + 1].triangle,
                           edges[begin].forward == edges[begin + 1].forward) &&
              agree;
  });
  if (!agree) return std::nullopt;
  std::vector<std::int64_t> balance(triangles.size(), 0);  // by root: triangles of its way less the others
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    balance[patches.root(t)] += patches.other_way(t) ? -1 : 1;
  std::vector<std::uint8_t> turned(triangles.size());
  std::size_t count = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    turned[t] = patches.other_way(t) == (balance[patches.root(t)] >= 0);
    count += turned[t];
    if (turned[t]) std::swap(triangles[t][1], triangles[t][2]);
  }
  for_each_edge(edges, [&](std::size_t begin, std::size_t end) {
    int net = 0;
    for (std::size_t e = begin; e < end; ++e)
      net += edges[e].forward != (turned[edges[e].triangle] != 0) ? 1 : -1;
    agree = agree && net == 0;
  });
  return agree ? std::optional(count) : std::nullopt;
}

/// Triangles that hang together, and what they enclose.
struct Shell {
  std::vector<std::uint32_t> triangles = {};
  double volume = 0;  ///< [m³], below 0 where it is inside out
  Eigen::AlignedBox3d box = {};
};

class Shells {
 public:
  Shells(const Mesh& mesh, const std::vector<Edge>& edges, Orientation& orientation)
      : mesh_(mesh), orientation_(orientation), from_(bounds(mesh).min.cast<double>()) {
    Patches sets(orientation.triangles.size());
    join_neighbors(edges, sets);
    std::vector<std::size_t> shell_of(orientation.triangles.size());
    for (std::uint32_t t = 0; t < orientation.triangles.size(); ++t) {
      const std::uint32_t root = sets.root(t);
      if (root == t) {
        shell_of[t] = shells_.size();
        shells_.emplace_back();
      }
      Shell& shell = shells_[shell_of[root]];
      shell.triangles.push_back(t);
      const auto [a, b, c] = corners(t);
      shell.volume += a.dot(b.cross(c)) / 6;
      for (const Eigen::Vector3d& corner : {a, b, c}) shell.box.extend(corner);
    }
  }

  /// Turns what is inside out; says what was done.
  void turn() {
    const auto inside_out = static_cast<std::size_t>(
        std::count_if(shells_.begin(), shells_.end(), [](const Shell& s) { return s.volume < 0; }));
    if (inside_out > 0) find_roots();
    std::size_t turned = 0, cavities = 0;
    for (std::size_t s = 0; s < shells_.size(); ++s) {
      const std::size_t root = inside_out > 0 ? roots_[s] : s;
      const bool turns = shells_[root].volume < 0;
      if (turns)
        for (const std::uint32_t t : shells_[s].triangles)
          std::swap(orientation_.triangles[t][1], orientation_.triangles[t][2]);
      const double volume = turns ? -shells_[s].volume : shells_[s].volume;
      orientation_.volume += volume;
      turned += turns;
      cavities += root != s && volume < 0;
    }
    say(turned, cavities);
  }

 private:
  /// +1 where a triangle runs along an edge from low to high, −1 where it runs the other way.
  int direction(const Edge& edge) const {
    const auto& [a, b, c] = orientation_.triangles[edge.triangle];
    const bool forward = (a == edge.low && b == edge.high) || (b == edge.low && c == edge.high) ||
                         (c == edge.low && a == edge.high);
    return forward ? 1 : -1;
  }

  /// Joins triangles of edges that two share; of others where the surfaces that meet there end, instead of
  /// going on within themselves, as where cubes touch along an edge.
  void join_neighbors(const std::vector<Edge>& edges, Patches& sets) const {
    for_each_edge(edges, [&](std::size_t begin, std::size_t end) {
      if (end - begin == 2) sets.join(edges[begin].triangle, edges[begin + 1].triangle, false);
    });
    std::vector<std::pair<std::size_t, std::size_t>> ends;
    for_each_edge(edges, [&](std::size_t begin, std::size_t end) {
      if (end - begin == 2) return;
      std::map<std::uint32_t, int> net;
      for (std::size_t e = begin; e < end; ++e) net[sets.root(edges[e].triangle)] += direction(edges[e]);
      if (std::any_of(net.begin(), net.end(), [](const auto& patch) { return patch.second != 0; }))
        ends.emplace_back(begin, end);
    });
    for (const auto& [begin, end] : ends)
      for (std::size_t e = begin + 1; e < end; ++e)
        sets.join(edges[e].triangle, edges[e - 1].triangle, false);
  }

  std::array<Eigen::Vector3d, 3> corners(std::uint32_t t) const {
    std::array<Eigen::Vector3d, 3> places;
    for (std::size_t k = 0; k < 3; ++k)
      places[k] = mesh_.vertices[orientation_.triangles[t][k]].cast<double>() - from_;
    return places;
  }

  /// A point of a shell's surface: the middle of its largest triangle, as corners may well lie on another
  /// shell.
  Eigen::Vector3d point_of(const Shell& shell) const {
    Eigen::Vector3d point = shell.box.min();
    double largest = -1;
    for (const std::uint32_t t : shell.triangles) {
      const auto [a, b, c] = corners(t);
      const double area = (b - a).cross(c - a).squaredNorm();
      if (area > largest) {
        largest = area;
        point = (a + b + c) / 3;
      }
    }
    return point;
  }

  bool holds(const Shell& shell, const Eigen::Vector3d& point) const {
    int winding = 0;
    for (const std::uint32_t t : shell.triangles) {
      const auto crossing = cross_line(corners(t), point.y(), point.z());
      if (crossing && crossing->x > point.x()) winding += crossing->turn;
    }
    return winding != 0;
  }

  /// The outermost shell that each shell lies within; itself where there is none.
  void find_roots() {
    std::vector<Eigen::AlignedBox3d> boxes;
    std::vector<std::size_t> numbers(shells_.size());
    for (const Shell& shell : shells_) boxes.push_back(shell.box);
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
    const Eigen::KdBVH<double, 3, std::size_t> tree(numbers.begin(), numbers.end(), boxes.begin(),
                                                    boxes.end());
    struct Around {
      const std::vector<Eigen::AlignedBox3d>& boxes;
      Eigen::Vector3d point;
      std::vector<std::size_t> found = {};
      bool intersectVolume(const Eigen::AlignedBox3d& box) const { return box.contains(point); }
      bool intersectObject(std::size_t s) {
        if (boxes[s].contains(point)) found.push_back(s);
        return false;
      }
    };
    const auto larger = [&](std::size_t a, std::size_t b) {
      return std::pair(-std::abs(shells_[a].volume), a) < std::pair(-std::abs(shells_[b].volume), b);
    };
    roots_.resize(shells_.size());
    for (std::size_t s = 0; s < shells_.size(); ++s) {
      Around around{boxes, point_of(shells_[s])};
      Eigen::BVIntersect(tree, around);
      std::sort(around.found.begin(), around.found.end(), larger);
      const auto root = std::find_if(around.found.begin(), around.found.end(), [&](std::size_t other) {
        return other == s || holds(shells_[other], around.point);
      });
      roots_[s] = root == around.found.end() ? s : *root;
    }
  }

  void say(std::size_t turned, std::size_t cavities) {
    const auto shells = [](std::size_t count) {
      return count == 1 ? std::string("a shell") : std::to_string(count) + " shells";
    };
    if (turned == shells_.size())
      orientation_.notes.emplace_back("the mesh is inside out: its triangles were turned");
    else if (turned > 0)
      orientation_.notes.push_back(shells(turned) + (turned == 1 ? " of the mesh is" : " of the mesh are") +
                                   " inside out and not within another: turned");
    if (cavities > 0)
      orientation_.notes.push_back(
          shells(cavities) + " within another " +
          (cavities == 1 ? "faces the other way: kept as a cavity" : "face the other way: kept as cavities"));
  }

  const Mesh& mesh_;
  Orientation& orientation_;
  Eigen::Vector3d from_;  ///< that places are relative to [m]
  std::vector<Shell> shells_ = {};
  std::vector<std::size_t> roots_ = {};
};

}  // namespace

Orientation orient(const Mesh& mesh) {
  Orientation result{.triangles = mesh.triangles};
  const std::vector<Edge> edges = sorted_edges(result.triangles);
  const std::optional<std::size_t> turned = make_neighbors_agree(edges, result.triangles);
  if (!turned) {
    result.triangles = mesh.triangles;
    result.even_odd = true;
    result.notes.emplace_back(
        "its triangles do not agree on which side is outside: inside is what lies behind an odd number of "
        "them");
    return result;
  }
  if (*turned > 0)
    result.notes.push_back(std::to_string(*turned) + (*turned == 1 ? " triangle faces" : " triangles face") +
                           " another way than most of their neighbours: turned");
  Shells(mesh, edges, result).turn();
  return result;
}

}  // namespace mallow
