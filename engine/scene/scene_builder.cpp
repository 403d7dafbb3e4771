#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "config/gravity_units.h"
#include "config/validation.h"
#include "core/precision.h"
#include "mallow/files.h"
#include "mallow/level_set.h"
#include "mallow/scene.h"
#include "scene/field_reader.h"
#include "scene/scene_fields.h"

namespace mallow {
namespace scene_file {
namespace {

/// The groups of a scene in the order in which its bodies name them.
struct Groups {
  struct Group {
    std::string name;
    std::size_t material;
  };
  std::vector<Group> list;
  std::vector<std::size_t> of_body;
  std::vector<std::size_t> of_emitter;  ///< materials
};

/// Throws ConfigError where a body or an emitter names a material that is not there, or a group changes its
/// material. What read_scene() gives has neither; a scene that was put together in code may.
Groups groups_of(const Scene& scene) {
  std::map<std::string, std::size_t> material_index;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) material_index.emplace(scene.materials[i].name, i);
  Groups groups;
  std::map<std::string, std::size_t> named;
  Problems problems(scene.file.string());
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const SceneBody& body = scene.bodies[i];
    const Place place{.line = body.line};
    const std::string path = element_path("body", i);
    const auto material = material_index.find(body.material);
    if (material == material_index.end()) {
      problems.add(place, path + ".material", "unknown material '" + body.material + "'");
      continue;
    }
    const auto [known, added] = named.emplace(body.group.empty() ? path : body.group, groups.list.size());
    const bool own = body.group.empty();
    const std::size_t group = own ? groups.list.size() : known->second;
    if (own || added)
      groups.list.push_back({own ? path : body.group, material->second});
    else if (groups.list[group].material != material->second)
      problems.add(place, path + ".material",
                   "'" + body.material + "' is not allowed: group '" + body.group + "' is of '" +
                       scene.materials[groups.list[group].material].name + "'");
    groups.of_body.push_back(group);
  }
  for (std::size_t i = 0; i < scene.emitters.size(); ++i) {
    const SceneEmitter& emitter = scene.emitters[i];
    const auto material = material_index.find(emitter.material);
    if (material == material_index.end())
      problems.add({.line = emitter.line}, element_path("emitter", i) + ".material",
                   "unknown material '" + emitter.material + "'");
    else
      groups.of_emitter.push_back(material->second);
  }
  problems.finish();
  return groups;
}

/// Runs what adds one thing of a scene to a simulation; what is wrong with it becomes a problem of that
/// place.
template <class Add>
void collect(Problems& problems, int line, const std::string& path, const Add& add) {
  try {
    add();
  } catch (const ConfigError& error) {
    for (const Problem& problem : error.problems()) problems.add({.line = line}, path, to_string(problem));
  } catch (const IoError& error) {
    problems.add({.line = line}, path, to_string(error.problem()));
  }
}

/// Adds a body to a simulation. Where what is wrong is its material's, `refused` gets that.
BodyId add_body(Simulation& simulation, const Body& points, MaterialId material, const Groups::Group& group,
                std::set<std::size_t>& refused) try {
  return simulation.add_body(points, material, group.name);
} catch (const ConfigError& error) {
  if (std::ranges::all_of(error.problems(),
                          [](const Problem& problem) { return problem.field.starts_with("material."); }))
    refused.insert(group.material);
  throw;
}

/// The same problems, which name the file too.
std::vector<Problem> about(const std::filesystem::path& file, const ConfigError& error) {
  std::vector<Problem> problems = error.problems();
  for (Problem& problem : problems)
    if (problem.file.empty()) problem.file = file.string();
  return problems;
}

/// The same problems of a body, which say by what its particles are too stiff: its paint, or its file.
std::vector<Problem> about_stiffness(const SceneBody& body, const std::filesystem::path& folder,
                                     const ConfigError& error) {
  const auto paints = [](const ScenePaint& paint) { return paint.stiffness || paint.alpha; };
  const auto* points = std::get_if<PointsSource>(&body.source);
  std::vector<Problem> problems = error.problems();
  for (Problem& problem : problems) {
    if (problem.field != "body.stiffness") continue;
    if (const auto paint = std::ranges::find_if(body.paint, paints); paint != body.paint.end())
      problem.field = element_path(k_paint_key, static_cast<std::size_t>(paint - body.paint.begin()));
    else if (points)
      problem.file = (folder / points->file).string();
  }
  return problems;
}

/// Moves a body. Throws ConfigError where floats cannot tell its points apart then.
void move(Body& body, const Eigen::Vector3d& by) {
  if (by.isZero(0)) return;
  for (Vec3& x : body.positions) {
    x = (by + x.cast<double>()).cast<float>();
    if (const auto why = why_too_far(x, body.spacing))
      throw ConfigError("center", "is not given, and the mesh lies where a point at " + *why);
  }
}

struct Sample {
  const std::filesystem::path& folder;
  int threads;

  Body operator()(const Lattice& lattice) const { return mallow::sample(lattice); }
  Body operator()(const SphereSource& source) const {
    return mallow::sample(sphere_shape(source.center, source.radius), source.sampling);
  }
  Body operator()(const MeshSource& source) const {
    const std::filesystem::path file = folder / source.file;
    Eigen::Vector3d origin;
    const Mesh mesh = read_mesh(file, origin);
    try {
      // Before the placed shape's bounds are rounded until they are empty.
      if (source.placement.center && source.sampling.spacing)
        if (const auto why = why_too_far(*source.placement.center, *source.sampling.spacing))
          throw ConfigError("center", *why);
      const ImplicitShape shape = mesh_shape(mesh, k_mesh_voxels, threads);
      Body body = mallow::sample(place(shape, source.placement), source.sampling);
      for (std::string& note : body.notes) note = file.string() + ": " + note;
      // Without a centre it stays where the file has it, which counts only now that all points are there.
      if (!source.placement.center) move(body, origin);
      return body;
    } catch (const ConfigError& error) {
      throw ConfigError(about(file, error));
    }
  }
  Body operator()(const PointsSource& source) const {
    Body body = read_points(folder / source.file, source.spacing);
    for (std::string& note : body.notes) note = source.file.string() + ": " + note;
    return body;
  }
  Body operator()(const ImplicitSource& source) const {
    return mallow::sample(place(implicit_shape(source.shape), source.placement), source.sampling);
  }
};

/// The skin of a body, where the body is.
struct PlaceSkin {
  const std::filesystem::path& folder;
  Mesh skin;
  Eigen::Vector3d origin;  ///< of the skin's vertices

  Mesh operator()(const MeshSource& source) const {
    Eigen::Vector3d own_origin;
    const Mesh own = read_mesh(folder / source.file, own_origin);
    const Mesh placed = place(moved(skin, origin - own_origin), source.placement, bounds(own));
    return source.placement.center ? placed : moved(placed, own_origin);
  }
  Mesh operator()(const ImplicitSource& source) const {
    return place(moved(skin, origin), source.placement, implicit_shape(source.shape).bounds);
  }
  Mesh operator()(const auto&) const { return moved(skin, origin); }

  static Mesh moved(Mesh mesh, const Eigen::Vector3d& by) {
    for (Vec3& x : mesh.vertices) x = (by + x.cast<double>()).cast<float>();
    return mesh;
  }
};

Skin bind_skin(const SceneBody& body, BodyId id, const Material& material,
               const std::filesystem::path& folder, Simulation& simulation, int threads) {
  const bool paints_fluid =
      std::ranges::any_of(body.paint, [](const ScenePaint& paint) { return paint.alpha.value_or(0) >= 1; });
  if (material.alpha_by_temperature.value_or(material.alpha).highest() >= 1 || paints_fluid)
    throw ConfigError("skin", "is not allowed where alpha reaches 1, as a fluid has no shape to follow");
  if (body.merges && flows(material))
    throw ConfigError("skin",
                      "is not allowed on a body that merges and flows, as it may become part of another");
  if (body.splits)
    throw ConfigError("skin",
                      "is not allowed on a body that splits, as its parts become bodies of their own");
  Eigen::Vector3d origin;
  const Mesh mesh = read_mesh(folder / body.skin, origin);
  return {simulation, id, std::visit(PlaceSkin{folder, mesh, origin}, body.source), threads};
}

/// A column with the values of those that are in the shapes; empty where no shape has one.
void paint_column(const SceneBody& body, std::optional<float> ScenePaint::*value, float otherwise,
                  const Body& points, std::vector<float>& column) {
  for (const ScenePaint& paint : body.paint) {
    if (!(paint.*value)) continue;
    if (column.empty()) column.assign(points.positions.size(), otherwise);
    for (std::size_t i = 0; i < column.size(); ++i)
      if (nearest(paint, points.positions[i]).distance <= 0) column[i] = *(paint.*value);
  }
}

/// Columns of a file that do nothing.
void look_at_columns(const Material& material, Body& points) {
  const auto follows = [&](const char* key) {
    points.notes.push_back(std::string("its ") + key + " has no effect, as it follows the material's " + key +
                           "_by_temperature; give a temperature in its place");
  };
  if (!points.alpha.empty() && material.alpha_by_temperature) follows("alpha");
  if (!points.plastic_yield.empty() && material.plastic_yield_by_temperature) follows("plastic_yield");
}

/// Paint that does nothing.
void look_at_paint(const SceneBody& body, const Material& material, Body& points) {
  for (std::size_t k = 0; k < body.paint.size(); ++k) {
    const ScenePaint& paint = body.paint[k];
    const std::string name = element_path(k_paint_key, k);
    const auto is_in = [&](const Vec3& x) { return nearest(paint, x).distance <= 0; };
    if (std::ranges::none_of(points.positions, is_in))
      points.notes.push_back(name + " holds none of the body's " + std::to_string(points.positions.size()) +
                             " particles: its shape stands in the world, where the body starts; move it");
    const auto follows = [&](const char* key) {
      points.notes.push_back(name + '.' + key + " has no effect, as it follows the material's " + key +
                             "_by_temperature; paint a temperature in its place");
    };
    if (paint.alpha && material.alpha_by_temperature) follows("alpha");
    if (paint.plastic_yield && material.plastic_yield_by_temperature) follows("plastic_yield");
  }
}

/// Of meshes as wide as this that give so many points, hardly one is meant to be [m].
constexpr float k_wide_mesh = 1;
constexpr std::size_t k_many_points = 200'000;
constexpr float k_centimetre = 0.01f;

/// A file in centimetres, read as metres, gives more points than anyone waits for.
void look_at_size(const SceneBody& body, const Vec3& gravity, Body& points) {
  const auto* mesh = std::get_if<MeshSource>(&body.source);
  if (!mesh || mesh->placement.size || !is_in_metres(gravity) || points.positions.size() < k_many_points)
    return;
  Vec3 low = points.positions.front(), high = low;
  for (const Vec3& x : points.positions) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const float width = (high - low).maxCoeff() + points.spacing;
  if (width < k_wide_mesh) return;
  std::ostringstream text;
  text.precision(2);  // points are jittered
  text << mesh->file.string() << ": it is about " << width << " m wide, as the file has it, and gives "
       << points.positions.size() << " particles " << points.spacing
       << " m apart; give size = " << k_centimetre * width
       << " where the file is in centimetres, or a larger spacing";
  points.notes.push_back(text.str());
}

}  // namespace
}  // namespace scene_file

void paint(const SceneBody& body, const Material& material, Body& points) {
  using namespace scene_file;
  look_at_columns(material, points);
  paint_column(body, &ScenePaint::alpha, material.alpha.at(0), points, points.alpha);
  paint_column(body, &ScenePaint::stiffness, 1, points, points.stiffness);
  const auto& yields = material.plastic_yield_by_temperature;
  paint_column(body, &ScenePaint::plastic_yield,
               yields ? yields->highest() : material.plastic_yield.value_or(0), points, points.plastic_yield);
  paint_column(body, &ScenePaint::paint_temperature, material.temperature.value_or(0), points,
               points.temperature);
  look_at_paint(body, material, points);
}

Body sample(const SceneBody& body, const std::filesystem::path& scene_file, int threads) {
  const std::filesystem::path folder = scene_file.parent_path();
  Body points = std::visit(scene_file::Sample{folder, threads}, body.source);
  points.velocity += body.velocity;
  points.merges = body.merges;
  points.splits = body.splits;
  return points;
}

Simulation build(const Scene& scene, int threads, std::vector<std::string>* notes, SceneIds* scene_ids) {
  using namespace scene_file;
  const Groups groups = groups_of(scene);
  SolverConfig config = scene.solver;
  if (threads != 0) config.threads = threads;
  Simulation simulation(config);
  Problems problems(scene.file.string());

  std::map<std::size_t, MaterialId> materials;
  // A material is wrong once, however many bodies have it.
  std::set<std::size_t> tried, refused;
  const auto add_material = [&](std::size_t number) {
    const SceneMaterial& material = scene.materials[number];
    if (!tried.insert(number).second) return;
    collect(problems, 0, "material." + material.name,
            [&] { materials[number] = simulation.add_material(material.material, material.name); });
  };
  for (const auto& group : groups.list) add_material(group.material);
  for (const std::size_t material : groups.of_emitter) add_material(material);
  problems.finish();
  SceneIds named;
  std::vector<std::optional<BodyId>> ids(groups.list.size());
  std::size_t particles = 0;
  for (std::size_t i = 0; i < scene.bodies.size() && particles <= k_most_particles; ++i) {
    const SceneBody& body = scene.bodies[i];
    const std::string path = element_path("body", i) + '.' + key_of(body.source);
    collect(problems, body.line, path, [&] {
      Body points = mallow::sample(body, scene.file, config.threads);
      paint(body, scene.materials[groups.list[groups.of_body[i]].material].material, points);
      look_at_size(body, scene.solver.gravity, points);
      particles += points.positions.size();
      if (particles > k_most_particles)
        throw ConfigError({}, "is one body too many: with it there are " + std::to_string(particles) +
                                  " particles, and at most " + std::to_string(k_most_particles) +
                                  " are allowed");
      const std::size_t number = groups.of_body[i];
      const auto& group = groups.list[number];
      try {
        if (ids[number])
          simulation.extend_body(*ids[number], points);
        else if (!refused.contains(group.material))
          ids[number] = add_body(simulation, points, materials.at(group.material), group, refused);
      } catch (const ConfigError& error) {
        throw ConfigError(about_stiffness(body, scene.file.parent_path(), error));
      }
      if (notes)
        for (const std::string& note : points.notes) notes->push_back(path + ": " + note);
    });
  }
  for (std::size_t i = 0; i < scene.colliders.size(); ++i)
    collect(problems, 0, element_path("collider", i),
            [&] { named.colliders.push_back(simulation.add_collider(scene.colliders[i])); });
  // Without all of its bodies, whatever else a scene says of itself would be beside the point.
  problems.finish();
  for (const std::size_t group : groups.of_body) named.bodies.push_back(*ids[group]);
  for (std::size_t i = 0; i < scene.pins.size(); ++i)
    collect(problems, scene.pins[i].line, element_path("pin", i),
            [&] { named.pins.push_back(simulation.pin(scene.pins[i].box, scene.pins[i].velocity)); });
  for (std::size_t i = 0; i < scene.emitters.size(); ++i)
    collect(problems, scene.emitters[i].line, element_path("emitter", i), [&] {
      named.emitters.push_back(simulation.add_emitter(scene.emitters[i], materials.at(groups.of_emitter[i]),
                                                      element_path("emitter", i)));
    });
  for (std::size_t i = 0; i < scene.sinks.size(); ++i)
    collect(problems, scene.sinks[i].line, element_path("sink", i),
            [&] { named.sinks.push_back(simulation.add_sink(scene.sinks[i].box, scene.sinks[i].outside)); });
  collect(problems, 0, {}, [&] { simulation.prepare(); });
  problems.finish();
  if (scene_ids) *scene_ids = std::move(named);
  return simulation;
}

std::vector<Skin> skins(const Scene& scene, Simulation& simulation, int threads) {
  using namespace scene_file;
  std::vector<Skin> skins;
  if (std::ranges::all_of(scene.bodies, [](const SceneBody& body) { return body.skin.empty(); }))
    return skins;
  const Groups groups = groups_of(scene);
  Problems problems(scene.file.string());
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const SceneBody& body = scene.bodies[i];
    if (body.skin.empty()) continue;
    const std::size_t group = groups.of_body[i];
    collect(problems, body.line, element_path("body", i) + ".skin", [&] {
      skins.push_back(bind_skin(body, BodyId{static_cast<std::uint32_t>(group)},
                                scene.materials[groups.list[group].material].material,
                                scene.file.parent_path(), simulation, threads));
    });
  }
  problems.finish();
  return skins;
}

std::vector<bool> skinned_bodies(const Scene& scene) {
  const scene_file::Groups groups = scene_file::groups_of(scene);
  std::vector<bool> skinned(groups.list.size(), false);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (!scene.bodies[i].skin.empty()) skinned[groups.of_body[i]] = true;
  return skinned;
}

std::vector<std::filesystem::path*> named_files(Scene& scene) {
  std::vector<std::filesystem::path*> files;
  for (SceneBody& body : scene.bodies) {
    if (auto* mesh = std::get_if<MeshSource>(&body.source)) files.push_back(&mesh->file);
    if (auto* points = std::get_if<PointsSource>(&body.source)) files.push_back(&points->file);
    if (!body.skin.empty()) files.push_back(&body.skin);
  }
  const auto add = [&](std::vector<ShapeSource>& sources) {
    for (ShapeSource& source : sources) {
      if (auto* hull = std::get_if<HullSource>(&source); hull && !hull->file.empty())
        files.push_back(&hull->file);
      if (auto* mesh = std::get_if<MeshColliderSource>(&source)) files.push_back(&mesh->file);
    }
  };
  for (SceneBody& body : scene.bodies)
    for (ScenePaint& paint : body.paint) add(paint.sources);
  for (SceneCollider& collider : scene.colliders) add(collider.sources);
  if (!scene.render.environment.empty()) files.push_back(&scene.render.environment);
  return files;
}

std::vector<std::size_t> body_materials(const Scene& scene) {
  std::vector<std::size_t> materials;
  const scene_file::Groups groups = scene_file::groups_of(scene);
  for (const auto& group : groups.list) materials.push_back(group.material);
  materials.insert(materials.end(), groups.of_emitter.begin(), groups.of_emitter.end());
  return materials;
}

}  // namespace mallow
