#include <algorithm>
#include <exception>
#include <utility>

#include "core/parallel.h"
#include "mallow/surface.h"
#include "surface/drawn_particles.h"
#include "surface/dual_mesher.h"
#include "surface/mesh_parts.h"
#include "surface/mesh_smoothing.h"
#include "surface/particle_order.h"
#include "surface/surface_checks.h"
#include "surface/surface_extent.h"
#include "surface/surface_field.h"
#include "surface/surfacer_access.h"

namespace mallow {
namespace {

/// A surface is small where a thread has so many more particles to see to.
constexpr std::size_t k_small_share = 4;

}  // namespace

struct Surfacer::Work {
  SurfaceConfig config;
  std::shared_ptr<Executor> executor;  ///< that `threads` points to
  Threads threads = 1;
  ParticleOrder order;
  // One for each surface.
  std::vector<SurfaceField> fields;
  std::vector<DrawnParticles> drawn;
  std::vector<MeshPart> parts;
  std::vector<float> spacings;  ///< the widest [m]
  DualMesher mesher;
  Mesh mesh;
  std::size_t kept = 0;  ///< surfaces of the frame before
  bool whole = false;    ///< the mesh and all that belongs to it are those of one frame
  Mesh fresh;            ///< surfaces that are drawn anew where others are kept
  MeshCounts counts;
  std::vector<std::uint32_t> body_of_row;  ///< of joined surfaces with several bodies
  std::vector<std::uint32_t> bodies;       ///< the same by particle, in the order of its field
  MeshSmoother smoother;
  std::vector<SurfacePart> body_parts;

  void draw(const SurfaceParticles& particles);
  void draw_all(const SurfaceParticles& particles);
  void find_spacings(const SurfaceParticles& particles);
  void find_bodies(const SurfaceParticles& particles);
  void find_changes(const SurfaceParticles& particles, const Extent& extent, bool keep);
  SurfaceSource source_of(const SurfaceParticles& all, std::size_t surface, const Extent& extent) const;
  void build_fields(const SurfaceParticles& particles, const Extent& extent);
  void draw_one(const SurfaceSource& source, std::size_t surface, Mesh& to);
  template <class Visit>
  void at_vertices(const Visit& visit);
  void find_materials(const SurfaceField& field, Mesh& to);
  void find_velocities(const SurfaceField& field, const PickedVectors& velocities, Mesh& to);
  void list_parts(const SurfaceParticles& particles);
};

/// Calls visit(run, points, n) for the vertices of the surface drawn last, a run of them in or next to one
/// block at a time, as n points for SurfaceField::mean_at().
template <class Visit>
void Surfacer::Work::at_vertices(const Visit& visit) {
  const auto& runs = mesher.block_vertices();
  parallel_for(
      threads, runs.size(),
      [&](std::size_t begin, std::size_t end) {
        thread_local std::vector<float> points[3];
        for (std::size_t r = begin; r < end; ++r) {
          const std::size_t n = padded(runs[r].count);
          for (std::vector<float>& axis : points) axis.resize(std::max(axis.size(), n));
          float *const x = points[0].data(), *const y = points[1].data(), *const z = points[2].data();
          const Eigen::Vector3f* const from = &mesher.local(runs[r].first);
          for (std::size_t v = 0; v < runs[r].count; ++v) {
            x[v] = from[v].x();
            y[v] = from[v].y();
            z[v] = from[v].z();
          }
          // What fills up to eights is to lie near the others.
          for (float* const axis : {x, y, z})
            std::fill(axis + runs[r].count, axis + n, axis[runs[r].count - 1]);
          visit(runs[r], ConstVectors{points[0].data(), points[1].data(), points[2].data()}, n);
        }
      },
      4);
}

/// Each vertex of a joined surface belongs to the body that has the largest share of the weight there.
void Surfacer::Work::find_materials(const SurfaceField& field, Mesh& to) {
  at_vertices([&](const DualMesher::BlockVertices& run, ConstVectors points, std::size_t n) {
    field.body_at(run.block, points, n, bodies, std::span(to.material_ids).subspan(run.first, run.count));
  });
}

void Surfacer::Work::find_velocities(const SurfaceField& field, const PickedVectors& velocities, Mesh& to) {
  to.velocities.resize(to.vertices.size());
  at_vertices([&](const DualMesher::BlockVertices& run, ConstVectors points, std::size_t n) {
    thread_local std::vector<float> means[3];
    for (std::vector<float>& mean : means) mean.resize(std::max(mean.size(), n));
    field.mean_at(run.block, points, n, velocities, {means[0].data(), means[1].data(), means[2].data()});
    const float *const x = means[0].data(), *const y = means[1].data(), *const z = means[2].data();
    Vec3* const first = to.velocities.data() + run.first;
    for (std::size_t v = 0; v < run.count; ++v) first[v] = Vec3(x[v], y[v], z[v]);
  });
}

/// The fields of all surfaces that are drawn anew. Those with a small share of the particles are built side
/// by side, each on one thread, as their loops are too short to be shared; the others one after the other.
void Surfacer::Work::build_fields(const SurfaceParticles& particles, const Extent& extent) {
  const auto build = [&](std::size_t s) {
    const SurfaceSource source = source_of(particles, s, extent);
    fields[s].build(source.positions, source.spacing, config, source.frame, threads);
  };
  const std::size_t small = order.count() / (k_small_share * static_cast<std::size_t>(threads.count()));
  std::vector<std::size_t> side_by_side;
  for (std::size_t s = 0; s < parts.size(); ++s) {
    if (!parts[s].fresh) continue;
    if (threads.count() > 1 && order.rows(s).size() <= small)
      side_by_side.push_back(s);
    else
      build(s);
  }
  std::vector<std::exception_ptr> errors(side_by_side.size());  // loops must not throw
  parallel_for(
      threads, side_by_side.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          try {
            build(side_by_side[k]);
          } catch (...) {
            errors[k] = std::current_exception();
          }
        }
      },
      1);
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

/// Appends the surface around the particles of a body, or of all where they are joined.
void Surfacer::Work::draw_one(const SurfaceSource& source, std::size_t surface, Mesh& to) {
  SurfaceField& field = fields[surface];
  const MeshCounts first = counts;
  mesher.append(field, config.adaptivity, threads, counts, to);
  to.material_ids.resize(to.vertices.size(), static_cast<std::uint32_t>(surface));
  if (!source.bodies.empty()) find_materials(field, to);
  if (source.velocities.size() > 0) find_velocities(field, source.velocities, to);
  if (config.smoothing > 0) smoother.smooth(config.smoothing, first.vertices, first.triangles, threads, to);
  parts[surface] = {first.vertices, counts.vertices - first.vertices, first.triangles,
                    counts.triangles - first.triangles, true};
}

SurfaceSource Surfacer::Work::source_of(const SurfaceParticles& all, std::size_t surface,
                                        const Extent& extent) const {
  const std::span<const std::uint32_t> rows = order.rows(surface);
  SurfaceSource source{.positions = {all.positions, rows},
                       .velocities = {},
                       .bodies = bodies,
                       .spacing = spacings[surface],
                       .frame = make_frame(config, spacings[surface], extent)};
  if (!all.velocities.empty()) source.velocities = {all.velocities, rows};
  return source;
}

/// Where surfaces that share one are of several bodies: which particle is of which.
void Surfacer::Work::find_bodies(const SurfaceParticles& particles) {
  bodies.clear();
  const auto in_body_0 = [](const SurfaceBody& body) { return body.body == 0; };
  if (!config.joined || std::ranges::all_of(particles.bodies, in_body_0)) return;
  body_of_row.resize(particles.positions.size());
  for (const SurfaceBody& body : particles.bodies) {
    const Simulation::Rows rows = rows_of(body, body_of_row.size());
    for (std::size_t row = rows.begin; row < rows.end; ++row) body_of_row[row] = body.body;
  }
  for (const std::uint32_t row : order.rows(0)) bodies.push_back(body_of_row[row]);
}

void Surfacer::Work::find_spacings(const SurfaceParticles& particles) {
  spacings.assign(order.surfaces(), 0.0f);
  for (const SurfaceBody& body : particles.bodies) {
    float& widest = spacings[config.joined ? 0 : body.body];
    widest = std::max(widest, body.spacing);
  }
}

/// Marks the surfaces that are to be drawn anew, and counts those that are kept as they are.
void Surfacer::Work::find_changes(const SurfaceParticles& particles, const Extent& extent, bool keep) {
  kept = 0;
  for (std::size_t s = 0; s < parts.size(); ++s) {
    if (order.rows(s).empty()) {
      fields[s].clear();
      drawn[s] = {};
      parts[s] = {};
      continue;
    }
    const bool same = drawn[s].note(source_of(particles, s, extent), threads) && keep;
    parts[s].fresh = !same;
    kept += same ? 1 : 0;
  }
}

void Surfacer::Work::draw_all(const SurfaceParticles& particles) {
  const bool keep = std::exchange(whole, false);
  find_spacings(particles);
  find_bodies(particles);
  const float widest = *std::ranges::max_element(spacings);
  const Extent extent = extent_of(particles, static_cast<double>(config.particle_radius * widest));
  find_changes(particles, extent, keep);
  counts = {};
  Mesh& to = kept > 0 ? fresh : mesh;
  to.velocities.clear();
  to.material_ids.clear();
  build_fields(particles, extent);
  for (std::size_t s = 0; s < parts.size(); ++s)
    if (parts[s].fresh) draw_one(source_of(particles, s, extent), s, to);
  if (kept > 0) put_together(fresh, threads, parts, mesh);
  whole = true;
}

/// What SurfacePart says of the bodies of the mesh.
void Surfacer::Work::list_parts(const SurfaceParticles& particles) {
  body_parts.clear();
  if (config.joined) return;
  std::vector<const SurfaceBody*> first(parts.size(), nullptr);
  for (const SurfaceBody& body : particles.bodies)
    if (first[body.body] == nullptr) first[body.body] = &body;
  for (std::size_t s = 0; s < parts.size(); ++s) {
    if (order.rows(s).empty()) continue;
    const MeshPart& part = parts[s];
    body_parts.push_back({static_cast<std::uint32_t>(s), std::string(first[s]->name), first[s]->material,
                          part.first_vertex, part.vertices, part.first_triangle, part.triangles});
  }
}

void Surfacer::Work::draw(const SurfaceParticles& particles) {
  check(particles);
  order.sort(particles, config.joined);
  fields.resize(order.surfaces());
  drawn.resize(order.surfaces());
  parts.resize(order.surfaces());
  if (order.count() > 0) {
    draw_all(particles);
  } else {
    for (SurfaceField& field : fields) field.clear();
    mesh = {};
    kept = 0;
    whole = false;
  }
  list_parts(particles);
}

Surfacer::Surfacer(const SurfaceConfig& config, int threads, std::shared_ptr<Executor> executor) {
  check(config, threads);
  work_ = std::make_unique<Work>();
  work_->config = config;
  work_->executor = std::move(executor);
  work_->threads = Threads(threads, work_->executor);
}
Surfacer::~Surfacer() = default;
Surfacer::Surfacer(Surfacer&&) noexcept = default;
Surfacer& Surfacer::operator=(Surfacer&&) noexcept = default;

const Mesh& Surfacer::draw(const SurfaceParticles& particles) {
  work_->draw(particles);
  return work_->mesh;
}

std::span<const SurfacePart> Surfacer::parts() const {
  return work_->body_parts;
}

std::size_t Surfacer::surface_count() const {
  return work_->fields.size();
}

std::size_t Surfacer::bytes() const {
  // Two triangles a vertex, and place, normal and velocity.
  constexpr std::size_t k_vertex_bytes = 5 * sizeof(Vec3) + sizeof(std::uint32_t);
  std::size_t bytes = work_->order.bytes() + work_->mesher.bytes() +
                      (work_->mesh.vertices.capacity() + work_->fresh.vertices.capacity()) * k_vertex_bytes;
  for (const SurfaceField& field : work_->fields) bytes += field.bytes();
  for (const DrawnParticles& particles : work_->drawn) bytes += particles.bytes();
  return bytes;
}

std::span<const SurfaceField> SurfacerAccess::fields(const Surfacer& surfacer) {
  return surfacer.work_->fields;
}
std::size_t SurfacerAccess::kept(const Surfacer& surfacer) {
  return surfacer.work_->kept;
}
const Threads& SurfacerAccess::threads(const Surfacer& surfacer) {
  return surfacer.work_->threads;
}

Mesh surface(StridedVectors positions, float spacing, const SurfaceConfig& config, int threads) {
  Surfacer surfacer(config, threads);
  return surfacer.draw({.positions = positions, .bodies = {{.spacing = spacing}}});
}

}  // namespace mallow
