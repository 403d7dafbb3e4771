#include "tradeoff/mesh_distance.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "mallow/errors.h"

namespace mallow::bench {
namespace {

/// The nearest point to p of the triangle abc (Ericson 2005, "Real-Time Collision Detection", section 5.1.5).
Eigen::Vector3d nearest_point(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                              const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

struct Query {
  const Mesh* mesh;
  Eigen::Vector3d point;
  double squared = std::numeric_limits<double>::infinity();
};

bool visit(RTCPointQueryFunctionArguments* arguments) {
  Query& query = *static_cast<Query*>(arguments->userPtr);
  const auto& [i, j, k] = query.mesh->triangles[arguments->primID];
  const auto corner = [&](std::uint32_t v) -> Eigen::Vector3d {
    return query.mesh->vertices[v].cast<double>();
  };
  const double squared =
      (nearest_point(query.point, corner(i), corner(j), corner(k)) - query.point).squaredNorm();
  if (squared >= query.squared) return false;
  query.squared = squared;
  // Rounded up, so that the box of a nearer triangle is never passed over.
  arguments->query->radius = std::nextafter(static_cast<float>(std::sqrt(squared)), 1e30f);
  return true;
}

/// Distances from points to a mesh, by Embree's tree.
class DistanceTo {
 public:
  explicit DistanceTo(const Mesh& mesh) : mesh_(mesh), device_(rtcNewDevice(nullptr)), scene_(nullptr) {
    if (!device_) throw Error("Embree gives no device");
    scene_.reset(rtcNewScene(device_.get()));
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(Vec3), mesh.vertices.size());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              sizeof(mesh.triangles[0]), mesh.triangles.size());
    if (!vertices || !triangles) throw Error("Embree cannot hold the mesh");
    std::copy(mesh.vertices.begin(), mesh.vertices.end(), static_cast<Vec3*>(vertices));
    std::copy(mesh.triangles.begin(), mesh.triangles.end(),
              static_cast<std::array<std::uint32_t, 3>*>(triangles));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
  }

  double operator()(const Vec3& point) const {
    Query query{&mesh_, point.cast<double>()};
    RTCPointQuery range{point.x(), point.y(), point.z(), 0, std::numeric_limits<float>::infinity()};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(scene_.get(), &range, &context, visit, &query);
    return std::sqrt(query.squared);
  }

 private:
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  const Mesh& mesh_;
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
};

MeshDistance one_way(const Mesh& from, const Mesh& to) {
  const DistanceTo distance(to);
  MeshDistance result;
  for (const Vec3& x : from.vertices) {
    const double d = distance(x);
    result.mean += d / static_cast<double>(from.vertices.size());
    result.hausdorff = std::max(result.hausdorff, d);
  }
  return result;
}

}  // namespace

MeshDistance mesh_distance(const Mesh& a, const Mesh& b) {
  const MeshDistance there = one_way(a, b), back = one_way(b, a);
  return {0.5 * (there.mean + back.mean), std::max(there.hausdorff, back.hausdorff)};
}

}  // namespace mallow::bench
