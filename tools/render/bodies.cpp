#include "render/bodies.h"

#include <tbb/task_arena.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "config/choices.h"
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
  query.ray.time = ray.time;
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return query;
}

RTCIntersectContext context_of(Rays kind) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (kind == Rays::together) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

constexpr std::size_t k_packet = 8;

void set_ray(RTCRay8& packet, std::size_t k, const Ray& ray, float t_max) {
  packet.org_x[k] = ray.origin.x();
  packet.org_y[k] = ray.origin.y();
  packet.org_z[k] = ray.origin.z();
  packet.dir_x[k] = ray.direction.x();
  packet.dir_y[k] = ray.direction.y();
  packet.dir_z[k] = ray.direction.z();
  packet.tnear[k] = 0;
  packet.tfar[k] = t_max;
  packet.time[k] = ray.time;
  packet.mask[k] = ~0u;
  packet.id[k] = 0;
  packet.flags[k] = 0;
}

RTCHit record_of(const RTCHit8& packet, std::size_t k) {
  RTCHit record{};
  record.Ng_x = packet.Ng_x[k];
  record.Ng_y = packet.Ng_y[k];
  record.Ng_z = packet.Ng_z[k];
  record.u = packet.u[k];
  record.v = packet.v[k];
  record.primID = packet.primID[k];
  return record;
}

/// Calls visit(i, distance, what was hit or null) for each ray, of which the packets are traced together.
template <class Far, class Visit>
void for_packets(RTCScene scene, std::span<const Ray> rays, const Far& t_max, Rays kind, const Visit& visit) {
  for (std::size_t first = 0; first < rays.size(); first += k_packet) {
    const std::size_t count = std::min(k_packet, rays.size() - first);
    RTCRayHit8 query;
    alignas(32) std::array<int, k_packet> valid{};
    for (std::size_t k = 0; k < count; ++k) {
      const float end = t_max(first + k);
      valid[k] = end > 0 ? -1 : 0;
      set_ray(query.ray, k, rays[first + k], end);
      query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context = context_of(kind);
    rtcIntersect8(valid.data(), scene, &context, &query);
    for (std::size_t k = 0; k < count; ++k) {
      const bool hit = query.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
      const RTCHit record = hit ? record_of(query.hit, k) : RTCHit{};
      visit(first + k, query.ray.tfar[k], hit ? &record : nullptr);
    }
  }
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
  // A frame's tree is thrown away after it: one that is built in a third of the time is traced nearly as
  // fast.
  rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_MEDIUM);
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

void Bodies::set_mesh(const Mesh& mesh, std::span<const Appearance> palette, float exposure) {
  check_palette(mesh.material_ids, palette, !mesh.triangles.empty());
  mesh_ = &mesh;
  body_of_ = mesh.material_ids;
  palette_ = palette;
  normals_ = mesh.normals.empty() ? vertex_normals(mesh) : std::vector<Vec3>{};
  box_.reset();
  if (!mesh.vertices.empty()) box_ = bounds(mesh);
  if (mesh.triangles.empty()) return commit(nullptr);

  const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  const bool moves = exposure > 0 && !mesh.velocities.empty();
  // Where it is when the shutter opens and when it closes.
  const std::array<float, 2> times{-0.5f * exposure, 0.5f * exposure};
  rtcSetGeometryTimeStepCount(geometry, moves ? 2 : 1);
  for (unsigned slot = 0; slot < (moves ? 2u : 1u); ++slot) {
    auto* vertices = static_cast<Vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, slot, RTC_FORMAT_FLOAT3, sizeof(Vec3), mesh.vertices.size()));
    check();
    if (!moves) {
      std::copy(mesh.vertices.begin(), mesh.vertices.end(), vertices);
      continue;
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      vertices[v] = mesh.vertices[v] + times[slot] * mesh.velocities[v];
      box_ = {box_->min.cwiseMin(vertices[v]), box_->max.cwiseMax(vertices[v])};
    }
  }
  void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            sizeof(mesh.triangles[0]), mesh.triangles.size());
  check();
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
  box_.reset();
  if (positions.empty()) return commit(nullptr);

  const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_SPHERE_POINT);
  auto* balls = static_cast<Eigen::Vector4f*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, sizeof(Eigen::Vector4f), positions.size()));
  check();
  for (std::size_t i = 0; i < positions.size(); ++i) balls[i] << positions[i], radius;
  Aabb box{positions[0], positions[0]};
  for (const Vec3& x : positions) box = {box.min.cwiseMin(x), box.max.cwiseMax(x)};
  box_ = {box.min - Vec3::Constant(radius), box.max + Vec3::Constant(radius)};
  commit(geometry);
}

std::optional<Bodies::Hit> Bodies::nearest(const Ray& ray, float t_max) const {
  RTCRayHit query = embree_ray(ray, t_max);
  RTCIntersectContext context = context_of(Rays::scattered);
  rtcIntersect1(scene_.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return hit_of(ray, query.ray.tfar, query.hit);
}

void Bodies::nearest(std::span<const Ray> rays, std::span<const float> t_max,
                     std::span<std::optional<Hit>> hits, Rays kind) const {
  for_packets(
      scene_.get(), rays, [&](std::size_t i) { return t_max[i]; }, kind,
      [&](std::size_t i, float t, const RTCHit* record) {
        hits[i].reset();
        if (record != nullptr) hits[i] = hit_of(rays[i], t, *record);
      });
}

Vec3 Bodies::smooth_normal(const RTCHit& record) const {
  const auto& [a, b, c] = mesh_->triangles[record.primID];
  return (1 - record.u - record.v) * normals()[a] + record.u * normals()[b] + record.v * normals()[c];
}

Bodies::Hit Bodies::hit_of(const Ray& ray, float t, const RTCHit& record) const {
  Hit hit;
  hit.t = t;
  hit.position = hit.outside = ray.at(t);
  hit.face = Vec3(record.Ng_x, record.Ng_y, record.Ng_z).normalized();
  if (hit.face.dot(ray.direction) > 0) hit.face = -hit.face;
  if (mesh_ != nullptr) {
    fill_mesh_hit(record, ray.time == 0.5f, hit);
  } else {
    hit.normal = hit.face;
    const Appearance& appearance = palette_[body_of_.empty() ? 0 : body_of_[record.primID]];
    hit.albedo = appearance.color;
    hit.finish = appearance.finish;
  }
  // A smooth normal may look away from the viewer near the silhouette; it may not there.
  const float facing = hit.normal.dot(ray.direction);
  if (facing > -0.02f) hit.normal = (hit.normal - (facing + 0.02f) * ray.direction).normalized();
  return hit;
}

void Bodies::fill_mesh_hit(const RTCHit& record, bool in_place, Hit& hit) const {
  const auto& corners = mesh_->triangles[record.primID];
  const std::array<float, 3> weights{1 - record.u - record.v, record.u, record.v};
  hit.normal.setZero();
  hit.albedo.setZero();
  std::array<float, choices(Finish{}).size()> shares{};
  for (std::size_t k = 0; k < 3; ++k) {
    hit.normal += weights[k] * normals()[corners[k]];
    const Appearance& appearance = palette_[body_of_.empty() ? 0 : body_of_[corners[k]]];
    hit.albedo += weights[k] * appearance.color;
    shares[static_cast<std::size_t>(appearance.finish)] += weights[k];
  }
  // Where bodies are joined the seam runs through the triangles, as colours change there.
  hit.finish = static_cast<Finish>(std::ranges::max_element(shares) - shares.begin());
  hit.normal = hit.normal.squaredNorm() > 1e-12f ? Vec3(hit.normal.normalized()) : hit.face;
  // Meshes without a clear outside are lit from the side that is seen.
  if (hit.normal.dot(hit.face) < 0) hit.normal = -hit.normal;

  if (!in_place) return;  // the vertices are elsewhere at other times
  // Rays start on the surface that the smooth normals stand for, so that coarse triangles do not shade
  // themselves (Hanika 2021, "Hacking the shadow terminator").
  Vec3 lift = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& n = normals()[corners[k]];
    const float below = (hit.position - mesh_->vertices[corners[k]]).dot(n);
    if (below < 0) lift -= weights[k] * below * n;
  }
  if (lift.dot(hit.face) > 0) hit.outside += lift;
}

void Bodies::exits(std::span<const Ray> rays, std::span<Exit> exits) const {
  for_packets(
      scene_.get(), rays, [](std::size_t) { return k_far; }, Rays::scattered,
      [&](std::size_t i, float t, const RTCHit* record) {
        exits[i] = {};
        if (record == nullptr) return;
        const Vec3 outwards(record->Ng_x, record->Ng_y, record->Ng_z);
        exits[i] = {t, outwards.normalized(), outwards.dot(rays[i].direction) < 0};
        if (mesh_ != nullptr) {
          const Vec3 smooth = smooth_normal(*record);
          if (smooth.squaredNorm() > 1e-12f) exits[i].normal = smooth.normalized();
        }
        if (exits[i].normal.dot(rays[i].direction) > 0) exits[i].normal = -exits[i].normal;
      });
}

float Bodies::distance(const Ray& ray) const {
  RTCRayHit query = embree_ray(ray, k_far);
  RTCIntersectContext context = context_of(Rays::scattered);
  rtcIntersect1(scene_.get(), &context, &query);
  return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? k_far : query.ray.tfar;
}

bool Bodies::occludes(const Ray& ray) const {
  RTCRay query = embree_ray(ray, k_far).ray;
  RTCIntersectContext context = context_of(Rays::scattered);
  rtcOccluded1(scene_.get(), &context, &query);
  return query.tfar < 0;
}

void Bodies::occlude(std::span<const Ray> rays, std::span<std::uint8_t> seen, Rays kind) const {
  for (std::size_t first = 0; first < rays.size(); first += k_packet) {
    const std::size_t count = std::min(k_packet, rays.size() - first);
    RTCRay8 query;
    alignas(32) std::array<int, k_packet> valid{};
    for (std::size_t k = 0; k < count; ++k) {
      valid[k] = seen[first + k] != 0 ? -1 : 0;
      set_ray(query, k, rays[first + k], k_far);
    }
    RTCIntersectContext context = context_of(kind);
    rtcOccluded8(valid.data(), scene_.get(), &context, &query);
    for (std::size_t k = 0; k < count; ++k)
      if (query.tfar[k] < 0) seen[first + k] = 0;
  }
}

}  // namespace mallow::render
