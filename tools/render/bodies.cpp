#include "render/bodies.h"

#include <tbb/task_arena.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "mallow/errors.h"

namespace mallow::render {
namespace {

RTCRayHit embree_ray(const Ray& ray, float t_max) {
  RTCRayHit query{};
  query.ray.org_x = ray.origin.x();
  query.ray.org_y = ray.origin.y();
  query.ray.org_z = ray.origin.z();
  query.ray.dir_x = ray.direction.x();
  query.ray.dir_y = ray.direction.y();
  query.ray.dir_z = ray.direction.z();
  query.ray.tfar = t_max;
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

void check_palette(std::span<const std::uint32_t> bodies, std::span<const Appearance> palette, bool any) {
  const std::size_t needed =
      bodies.empty() ? (any ? 1 : 0) : std::size_t{1} + *std::max_element(bodies.begin(), bodies.end());
  if (palette.size() >= needed) return;
  throw ConfigError("palette", std::to_string(palette.size()) + " are not enough: body " +
                                   std::to_string(needed - 1) + " needs one too");
}

// Area-weighted means of the triangles around each vertex.
std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 area = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    for (const std::uint32_t v : {a, b, c}) normals[v] += area;
  }
  for (Vec3& normal : normals) normal.normalize();
  return normals;
}

}  // namespace

// Without a number of threads: with one, Embree caps TBB's threads for the whole process, OpenVDB's too, and
// TBB prints a warning wherever something asks for more.
Bodies::Bodies() : device_(rtcNewDevice("set_affinity=0")) {
  if (!device_)
    throw Error("Embree cannot create a device: error " + std::to_string(rtcGetDeviceError(nullptr)));
}

void Bodies::check() const {
  const RTCError error = rtcGetDeviceError(device_.get());
  if (error == RTC_ERROR_NONE) return;
  throw Error("Embree cannot hold the frame: error " + std::to_string(error) +
              (error == RTC_ERROR_OUT_OF_MEMORY ? " (out of memory)" : ""));
}

void Bodies::commit(RTCGeometry geometry) {
  scene_.reset(rtcNewScene(device_.get()));
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  if (geometry != nullptr) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
  }
  // One thread builds: a tree built by several may order its leaves differently each time, and with it which
  // of two triangles a ray through their common edge hits.
  tbb::task_arena(1).execute([&] { rtcCommitScene(scene_.get()); });
  check();
}

void Bodies::set_mesh(const Mesh& mesh, std::span<const Appearance> palette) {
  check_palette(mesh.material_ids, palette, !mesh.triangles.empty());
  mesh_ = &mesh;
  body_of_ = mesh.material_ids;
  palette_ = palette;
  normals_ = mesh.normals.empty() ? vertex_normals(mesh) : std::vector<Vec3>{};
  if (mesh.triangles.empty()) return commit(nullptr);

  const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Vec3), mesh.vertices.size());
  void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(mesh.triangles[0]), mesh.triangles.size());
  check();
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), static_cast<Vec3*>(vertices));
  std::copy(mesh.triangles.begin(), mesh.triangles.end(),
            static_cast<std::array<std::uint32_t, 3>*>(triangles));
  commit(geometry);
}

void Bodies::set_points(std::span<const Vec3> positions, float radius, std::span<const std::uint32_t> bodies,
                        std::span<const Appearance> palette) {
  check_palette(bodies, palette, !positions.empty());
  mesh_ = nullptr;
  body_of_ = bodies;
  palette_ = palette;
  if (positions.empty()) return commit(nullptr);

  const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT);
  auto* balls = static_cast<Eigen::Vector4f*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(Eigen::Vector4f), positions.size()));
  check();
  for (std::size_t i = 0; i < positions.size(); ++i) balls[i] << positions[i], radius;
  commit(geometry);
}

std::optional<Bodies::Hit> Bodies::nearest(const Ray& ray, float t_max) const {
  RTCRayHit query = embree_ray(ray, t_max);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  Hit hit;
  hit.t = query.ray.tfar;
  hit.position = hit.outside = ray.at(hit.t);
  hit.face = Vec3(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
  if (hit.face.dot(ray.direction) > 0) hit.face = -hit.face;
  if (mesh_ != nullptr) {
    fill_mesh_hit(query, hit);
  } else {
    hit.normal = hit.face;
    const Appearance& appearance = palette_[body_of_.empty() ? 0 : body_of_[query.hit.primID]];
    hit.albedo = appearance.color;
    hit.finish = appearance.finish;
  }
  // A smooth normal may look away from the viewer near the silhouette; it may not there.
  const float facing = hit.normal.dot(ray.direction);
  if (facing > -0.02f) hit.normal = (hit.normal - (facing + 0.02f) * ray.direction).normalized();
  return hit;
}

void Bodies::fill_mesh_hit(const RTCRayHit& query, Hit& hit) const {
  const auto& corners = mesh_->triangles[query.hit.primID];
  const std::vector<Vec3>& normals = mesh_->normals.empty() ? normals_ : mesh_->normals;
  const std::array<float, 3> weights{1 - query.hit.u - query.hit.v, query.hit.u, query.hit.v};
  hit.normal.setZero();
  hit.albedo.setZero();
  float clay = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    hit.normal += weights[k] * normals[corners[k]];
    const Appearance& appearance = palette_[body_of_.empty() ? 0 : body_of_[corners[k]]];
    hit.albedo += weights[k] * appearance.color;
    if (appearance.finish == Finish::clay) clay += weights[k];
  }
  // Where bodies are joined the seam runs through the triangles, as colours change there.
  hit.finish = clay > 0.5f ? Finish::clay : Finish::jelly;
  hit.normal = hit.normal.squaredNorm() > 1e-12f ? Vec3(hit.normal.normalized()) : hit.face;
  // Meshes without a clear outside are lit from the side that is seen.
  if (hit.normal.dot(hit.face) < 0) hit.normal = -hit.normal;

  // Rays start on the surface that the smooth normals stand for, so that coarse triangles do not shade
  // themselves (Hanika 2021, "Hacking the shadow terminator").
  Vec3 lift = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& n = normals[corners[k]];
    const float below = (hit.position - mesh_->vertices[corners[k]]).dot(n);
    if (below < 0) lift -= weights[k] * below * n;
  }
  if (lift.dot(hit.face) > 0) hit.outside += lift;
}

float Bodies::distance(const Ray& ray) const {
  RTCRayHit query = embree_ray(ray, k_far);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_.get(), &context, &query);
  return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? k_far : query.ray.tfar;
}

bool Bodies::occludes(const Ray& ray) const {
  RTCRay query = embree_ray(ray, k_far).ray;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene_.get(), &context, &query);
  return query.tfar < 0;
}

}  // namespace mallow::render
