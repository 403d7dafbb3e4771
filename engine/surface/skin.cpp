#include "mallow/skin.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/archive.h"
#include "core/parallel.h"
#include "mallow/errors.h"
#include "mallow/instruction_level.h"
#include "surface/shape_turns.h"
#include "surface/skin_binding.h"

namespace mallow {
namespace {

const SkinLanes& best_skin_lanes() {
  static const InstructionLevel level = best_instruction_level();
  return MALLOW_SELECT(level, skin_lanes);
}

/// The row of skin_lanes.h for x = R (v̄ − rest) + at. Scales R to a rotation.
void set_motion(const Eigen::Quaternionf& rotation, const Vec3& rest, const Vec3& at, float* row) {
  const float x = rotation.x(), y = rotation.y(), z = rotation.z(), w = rotation.w();
  const float s = 2 / rotation.squaredNorm();
  const float columns[9] = {1 - s * (y * y + z * z), s * (x * y + z * w),     s * (x * z - y * w),
                            s * (x * y - z * w),     1 - s * (x * x + z * z), s * (y * z + x * w),
                            s * (x * z + y * w),     s * (y * z - x * w),     1 - s * (x * x + y * y)};
  for (std::size_t a = 0; a < 3; ++a) {
    const float turned = columns[a] * rest[0] + columns[3 + a] * rest[1] + columns[6 + a] * rest[2];
    for (std::size_t c = 0; c < 3; ++c) row[4 * c + a] = columns[3 * c + a];
    row[12 + a] = at[static_cast<Eigen::Index>(a)] - turned;
    row[4 * a + 3] = at[static_cast<Eigen::Index>(a)];
  }
  row[15] = 0;
}

float* floats(std::vector<Vec3>& vectors) {
  static_assert(sizeof(Vec3) == 3 * sizeof(float));
  return vectors.front().data();
}

}  // namespace

struct Skin::Work {
  std::shared_ptr<Executor> executor;  ///< that `threads` points to
  Threads threads = 1;
  BodyId body{};
  float spacing = 0, region_radius = 0;  ///< [m]

  // By number of a particle of the body, in the order of slots.
  std::vector<ParticleId> ids;
  std::vector<std::uint32_t> rows;  ///< where it was last
  std::vector<Vec3> rest;           ///< x̄ in the reference shape that the vertices are in [m]

  // By place among those that carry vertices.
  std::vector<std::uint32_t> carriers;  ///< their numbers, ascending
  std::vector<Vec3> bound_at;           ///< from the first of them, when the mesh was bound [m]
  Column<float> motions;                ///< k_skin_row each

  Column<VertexBinding> bindings;  ///< to places
  std::vector<Vec3> vertices;      ///< v̄ [m]
  std::vector<Vec3> normals;       ///< n̄
  std::vector<float> stretch;
  Mesh mesh;

  // Scratch.
  std::vector<Eigen::Quaternionf> turns;
  std::vector<Vec3> next_rest;

  void size_columns();
  void find_particles(const Simulation& simulation);
  void find_rows(const Simulation& simulation);
  void choose_carriers();
  Vec3 origin(const VectorView& positions) const { return positions[rows[carriers.front()]]; }
  void set_motions(const Simulation& simulation, const VectorView& rest_now, const Vec3& origin);
  void take_rest_pose(const Vec3& origin);
  void take_reference(const Simulation& simulation, const VectorView& rest_now);
  void blend(const Vec3& origin, std::vector<Vec3>& to_vertices, std::vector<Vec3>& to_normals);
};

void Skin::Work::find_particles(const Simulation& simulation) {
  const Simulation::Rows body_rows = simulation.rows(body);
  const std::span<const ParticleId> all = simulation.ids();
  ids.assign(all.begin() + static_cast<std::ptrdiff_t>(body_rows.begin),
             all.begin() + static_cast<std::ptrdiff_t>(body_rows.end));
  std::ranges::sort(ids, {}, [](ParticleId id) { return slot_of(id); });
  rows.assign(ids.size(), 0);
}

/// Those that follow from others.
void Skin::Work::size_columns() {
  rows.resize(ids.size(), 0);
  turns.resize(carriers.size());
  motions.resize(carriers.size() * k_skin_row);
  mesh.material_ids.assign(vertices.size(), slot_of(body));
  stretch.assign(vertices.size(), 0.0f);
}

/// Rows seldom move: most are where they were.
void Skin::Work::find_rows(const Simulation& simulation) {
  const std::span<const ParticleId> all = simulation.ids();
  const Simulation::Rows range = simulation.rows(body);
  for (std::size_t p = 0; p < ids.size(); ++p) {
    if (rows[p] < all.size() && all[rows[p]] == ids[p] && rows[p] >= range.begin && rows[p] < range.end)
      continue;
    const std::size_t row = simulation.row(ids[p]);
    if (row < range.begin || row >= range.end)
      throw ConfigError("simulation", "is not the one that the skin was bound to: particle " +
                                          std::to_string(ids[p]) + " is not of body " +
                                          std::to_string(static_cast<std::uint64_t>(body)));
    rows[p] = static_cast<std::uint32_t>(row);
  }
}

/// Those particles that carry a vertex get places; bindings go by these from then on.
void Skin::Work::choose_carriers() {
  std::vector<std::uint32_t> place(ids.size(), 0);
  for (const VertexBinding& binding : bindings)
    for (const std::uint32_t p : binding.particle) place[p] = 1;
  for (std::uint32_t p = 0; p < place.size(); ++p) {
    if (place[p] == 0) continue;
    place[p] = static_cast<std::uint32_t>(carriers.size());
    carriers.push_back(p);
  }
  for (VertexBinding& binding : bindings)
    for (std::uint32_t& p : binding.particle) p = place[p];
  motions.resize(carriers.size() * k_skin_row);
}

/// Positions are relative to a point of the body, so that single precision is that of its size.
void Skin::Work::set_motions(const Simulation& simulation, const VectorView& rest_now, const Vec3& origin) {
  const RotationView rotations = simulation.rotations(body);
  const std::size_t first = simulation.rows(body).begin;
  const VectorView positions = simulation.positions();
  parallel_for(threads, carriers.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t row = rows[carriers[k]];
      set_motion(rotations[row - first], rest_now[row - first], positions[row] - origin,
                 motions.data() + k * k_skin_row);
    }
  });
}

/// v̄ and n̄ that the present motions take to where the mesh is, in double.
void Skin::Work::take_rest_pose(const Vec3& origin) {
  vertices.resize(mesh.vertices.size());
  normals.resize(mesh.vertices.size());
  parallel_for(threads, vertices.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Eigen::Matrix4d blended = Eigen::Matrix4d::Zero();
      for (std::size_t k = 0; k < k_skin_particles; ++k) {
        const float* const row = motions.data() + bindings[v].particle[k] * k_skin_row;
        blended += static_cast<double>(bindings[v].weight[k]) *
                   Eigen::Map<const Eigen::Matrix4f>(row).cast<double>();
      }
      const Eigen::Matrix3d inverse = blended.topLeftCorner<3, 3>().inverse();
      const Eigen::Vector3d x = mesh.vertices[v].cast<double>() - origin.cast<double>();
      vertices[v] = (inverse * (x - blended.topRightCorner<3, 1>())).cast<float>();
      normals[v] = (inverse * mesh.normals[v].cast<double>()).normalized().cast<float>();
    }
  });
}

/// The reference shape is another one: vertices and normals go there.
void Skin::Work::take_reference(const Simulation& simulation, const VectorView& rest_now) {
  const std::size_t first = simulation.rows(body).begin;
  next_rest.resize(rest.size());
  for (std::size_t p = 0; p < rest.size(); ++p) next_rest[p] = rest_now[rows[p] - first];
  find_turns(rest, next_rest, spacing, region_radius, carriers, threads, turns);
  for (std::size_t k = 0; k < carriers.size(); ++k)
    set_motion(turns[k], rest[carriers[k]], next_rest[carriers[k]], motions.data() + k * k_skin_row);
  rest.swap(next_rest);
  blend({0, 0, 0}, vertices, normals);
}

void Skin::Work::blend(const Vec3& origin, std::vector<Vec3>& to_vertices, std::vector<Vec3>& to_normals) {
  parallel_for(threads, vertices.size(), [&](std::size_t begin, std::size_t end) {
    best_skin_lanes().blend(bindings.data(), motions.data(), origin.data(), floats(vertices), floats(normals),
                            begin, end, floats(to_vertices), floats(to_normals));
  });
}

Skin::Skin() : work_(std::make_unique<Work>()) {}

Skin::Skin(Simulation& simulation, BodyId body, Mesh mesh, int threads, std::shared_ptr<Executor> executor)
    : Skin() {
  Work& w = *work_;
  simulation.rows(body);  // throws where there is none
  check_skin(mesh);
  const SimulationInfo info = simulation.info();  // prepares
  w.executor = std::move(executor);
  w.threads = Threads(threads, w.executor);
  w.body = body;
  w.spacing = simulation.spacing(body);
  const std::vector<BodyId> bodies = simulation.bodies();  // in the order of the info
  w.region_radius =
      info.bodies[static_cast<std::size_t>(std::ranges::find(bodies, body) - bodies.begin())].region_radius;
  w.mesh = std::move(mesh);
  if (w.mesh.normals.empty()) w.mesh.normals = vertex_normals(w.mesh);
  for (Vec3& normal : w.mesh.normals) normal.normalize();
  w.mesh.velocities.clear();

  const VectorView rest_now = simulation.rest_positions(body), positions = simulation.positions();
  w.find_particles(simulation);
  w.find_rows(simulation);
  w.bindings = bind_vertices(w.mesh.vertices, {positions, w.rows}, w.spacing, w.threads);
  w.choose_carriers();
  const std::size_t first = simulation.rows(body).begin;
  for (const std::uint32_t row : w.rows) w.rest.push_back(rest_now[row - first]);
  for (const std::uint32_t p : w.carriers) w.bound_at.push_back(positions[w.rows[p]] - w.origin(positions));
  w.set_motions(simulation, rest_now, w.origin(positions));
  w.take_rest_pose(w.origin(positions));
  w.size_columns();
}
Skin::~Skin() = default;
Skin::Skin(Skin&&) noexcept = default;
Skin& Skin::operator=(Skin&&) noexcept = default;

const Mesh& Skin::update(const Simulation& simulation) {
  Work& w = *work_;
  const VectorView rest_now = simulation.rest_positions(w.body), positions = simulation.positions();
  w.find_rows(simulation);
  w.mesh.velocities.clear();
  const std::size_t first = simulation.rows(w.body).begin;
  const auto moved = [&](std::uint32_t p) { return rest_now[w.rows[p] - first] != w.rest[p]; };
  if (std::ranges::any_of(w.carriers, moved)) w.take_reference(simulation, rest_now);
  w.set_motions(simulation, rest_now, w.origin(positions));
  w.blend(w.origin(positions), w.mesh.vertices, w.mesh.normals);
  return w.mesh;
}

const Mesh& Skin::mesh() const {
  return work_->mesh;
}
BodyId Skin::body() const {
  return work_->body;
}

std::span<const float> Skin::stretch() {
  Work& w = *work_;
  parallel_for(w.threads, w.stretch.size(), [&](std::size_t begin, std::size_t end) {
    const auto at = [&](std::uint32_t k) {
      const float* const row = w.motions.data() + k * k_skin_row;
      return Vec3(row[3], row[7], row[11]);
    };
    for (std::size_t v = begin; v < end; ++v) {
      const std::uint32_t* const by = w.bindings[v].particle;
      float most = 0;
      for (std::size_t k = 1; k < k_skin_particles; ++k)
        most =
            std::max(most, (at(by[k]) - at(by[0])).norm() - (w.bound_at[by[k]] - w.bound_at[by[0]]).norm());
      w.stretch[v] = most / w.spacing;
    }
  });
  return w.stretch;
}

const Mesh& Skin::find_velocities(const Simulation& simulation) {
  Work& w = *work_;
  w.find_rows(simulation);
  const VectorView velocities = simulation.velocities();
  w.mesh.velocities.resize(w.vertices.size());
  parallel_for(w.threads, w.vertices.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Vec3 sum(0, 0, 0);
      for (std::size_t k = 0; k < k_skin_particles; ++k)
        sum += w.bindings[v].weight[k] * velocities[w.rows[w.carriers[w.bindings[v].particle[k]]]];
      w.mesh.velocities[v] = sum;
    }
  });
  return w.mesh;
}

namespace {

constexpr std::uint32_t k_version = 2;
constexpr const char* k_chunk = "skin";

template <class T>
void pass_list(PackingArchive& archive, const std::vector<T>& list) {
  archive(static_cast<std::uint64_t>(list.size()));
  archive.array(list.data(), list.size());
}
template <class T>
void pass_list(UnpackingArchive& archive, std::vector<T>& list) {
  list.resize(archive.count(sizeof(T)));
  archive.array(list.data(), list.size());
}

/// One list for both ways. bindings: the column as a list.
template <class Archive, class Work, class Bindings>
void pass_skin(Archive& archive, Work& work, Bindings& bindings) {
  archive(work.spacing);
  archive(work.region_radius);
  pass_list(archive, work.ids);
  pass_list(archive, work.rest);
  pass_list(archive, work.carriers);
  pass_list(archive, work.bound_at);
  pass_list(archive, bindings);
  pass_list(archive, work.vertices);
  pass_list(archive, work.normals);
  pass_list(archive, work.mesh.triangles);
}

bool are_below(std::span<const std::uint32_t> numbers, std::size_t count) {
  return std::ranges::all_of(numbers, [&](std::uint32_t number) { return number < count; });
}

template <class Work>
void require_valid(const UnpackingArchive& archive, const Work& work,
                   std::span<const VertexBinding> bindings) {
  const auto require = [&](bool ok, const char* what) {
    if (!ok) archive.fail(what);
  };
  require(work.spacing > 0 && std::isfinite(work.spacing) && work.region_radius > 0 &&
              std::isfinite(work.region_radius),
          "spacing and region radius must be finite and above 0");
  require(!work.vertices.empty() && work.normals.size() == work.vertices.size() &&
              bindings.size() == work.vertices.size(),
          "there must be a normal and a binding for each vertex, and one vertex at least");
  require(!work.carriers.empty() && work.bound_at.size() == work.carriers.size() &&
              work.rest.size() == work.ids.size() && are_below(work.carriers, work.ids.size()),
          "its particles are not those of the body");
  for (const auto* vectors : {&work.rest, &work.bound_at, &work.vertices, &work.normals})
    for (const Vec3& v : *vectors) require(v.allFinite(), "a vector is not finite");
  for (const VertexBinding& binding : bindings)
    require(are_below(binding.particle, work.carriers.size()) &&
                std::ranges::all_of(binding.weight, [](float w) { return w >= 0 && w <= 1; }),
            "a vertex follows what is no particle of it");
  for (const auto& triangle : work.mesh.triangles)
    require(are_below(triangle, work.vertices.size()), "a triangle has what is no vertex");
}

}  // namespace

std::string Skin::save() const {
  const Work& w = *work_;
  PackingArchive archive;
  const std::vector<VertexBinding> bindings(w.bindings.begin(), w.bindings.end());
  archive(k_version);
  archive(static_cast<std::uint64_t>(w.body));
  pass_skin(archive, w, bindings);
  return archive.take();
}

Skin Skin::restore(const std::string& saved, int threads, std::shared_ptr<Executor> executor) {
  Skin skin;
  Work& w = *skin.work_;
  UnpackingArchive archive(k_chunk, saved);
  std::uint32_t version = 0;
  std::uint64_t body = 0;
  std::vector<VertexBinding> bindings;
  archive(version);
  if (version != k_version)
    archive.fail("is of version " + std::to_string(version) + "; this build of mallow reads " +
                 std::to_string(k_version));
  archive(body);
  pass_skin(archive, w, bindings);
  archive.finish();
  require_valid(archive, w, bindings);
  w.executor = std::move(executor);
  w.threads = Threads(threads, w.executor);
  w.body = BodyId{body};
  w.bindings.resize(bindings.size());
  std::ranges::copy(bindings, w.bindings.begin());
  w.mesh.vertices = w.vertices;
  w.mesh.normals = w.normals;
  w.size_columns();
  return skin;
}

std::size_t Skin::bytes() const {
  const Work& w = *work_;
  const auto of = [](const auto& list) { return list.capacity() * sizeof(list.front()); };
  return of(w.ids) + of(w.rows) + of(w.rest) + of(w.carriers) + of(w.bound_at) + w.motions.bytes() +
         w.bindings.bytes() + of(w.vertices) + of(w.normals) + of(w.stretch) + of(w.mesh.vertices) +
         of(w.mesh.normals) + of(w.mesh.material_ids) + of(w.mesh.triangles) + of(w.turns) + of(w.next_rest);
}

}  // namespace mallow
