#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "mallow/appearance.h"
#include "mallow/body.h"
#include "mallow/collider.h"
#include "mallow/export.h"
#include "mallow/material.h"
#include "mallow/quality.h"
#include "mallow/simulation.h"
#include "mallow/skin.h"
#include "mallow/solver_config.h"
#include "mallow/surface_config.h"

/// Scene files (TOML): target mallow::scene.
namespace mallow {

struct MaterialPreset;

/// A material of a scene: what moves, and how it looks.
struct SceneMaterial {
  std::string name = {};
  Material material;
  std::optional<Vec3> color = {};  ///< linear RGB in [0, 1]; left out: one of a palette
  Finish finish = Finish::jelly;
};

/// A ball, filled with points.
struct SphereSource {
  Vec3 center{0, 0, 0};  ///< [m]
  float radius = 1.0f;   ///< [m], > 0
  Sampling sampling;
};
/// A closed mesh of a file, placed and filled with points.
struct MeshSource {
  std::filesystem::path file = {};  ///< relative to the scene
  Sampling sampling;
  Placement placement;
};
/// The points of a file.
struct PointsSource {
  std::filesystem::path file = {};  ///< relative to the scene
  float spacing = 1.0f;             ///< h [m], > 0
};
/// One of the shapes that implicit_shape() knows, placed and filled with points.
struct ImplicitSource {
  std::string shape = {};  ///< a name of implicit_shape_names()
  Sampling sampling;
  Placement placement;
};
/// Where the points of a body come from.
using BodySource = std::variant<Lattice, SphereSource, MeshSource, PointsSource, ImplicitSource>;

/// A convex hull of the corners of a mesh, or of points.
struct HullSource {
  std::filesystem::path file = {};  ///< relative to the scene; empty: `points` are given
  std::vector<Vec3> points = {};    ///< [m]
  bool inside = false;              ///< ConvexHull::inside
};
/// A closed mesh of a file as an obstacle, see mesh_collider().
struct MeshColliderSource {
  std::filesystem::path file = {};      ///< relative to the scene
  int voxels = k_mesh_collider_voxels;  ///< along its longest side, in [8, 512]
  std::optional<float> size = {};       ///< longest side [m], > 0; left out: as in the file
  std::optional<Vec3> center = {};      ///< middle of its box [m]; left out: where the file has it
  bool inside = false;                  ///< DistanceField::inside
};
/// What a shape was made of that scene files do not hold as it is.
using ShapeSource = std::variant<std::monostate, HullSource, MeshColliderSource>;

/// A PoseKeyframe as scene files have it.
struct SceneKeyframe {
  float time = 0;           ///< [s], after that of the keyframe before
  Vec3 translate{0, 0, 0};  ///< [m]
  Vec3 rotate{0, 0, 0};     ///< about x, then y, then z [degrees]
};

/// A collider of a scene.
struct SceneCollider : Collider {
  /// What scene files make of the pose: read_scene() sets both, print_scene() prints these.
  Vec3 translate{0, 0, 0};  ///< [m]
  Vec3 rotate{0, 0, 0};     ///< about x, then y, then z [degrees]
  bool visible = true;      ///< in pictures; it acts on particles in any case
  /// Of its parts in order, where any of them is a hull or a mesh: read_scene() makes those parts of these.
  std::vector<ShapeSource> sources = {};
  std::vector<SceneKeyframe> scene_keyframes = {};  ///< what scene files make of `keyframes`, as of the pose
};

/// What particles of a body have of their own that are in a shape when the scene begins; of several shapes
/// the last counts. Shapes are those of colliders: where these keep particles out is in them.
struct ScenePaint : SceneCollider {
  std::optional<float> alpha = {};              ///< in [0, 1], see Body::alpha
  std::optional<float> stiffness = {};          ///< >= 0, see Body::stiffness
  std::optional<float> plastic_yield = {};      ///< >= 0, see Body::plastic_yield
  std::optional<float> paint_temperature = {};  ///< [K], see Body::temperature
};

/// A body of a scene. `material` is the name of one of its materials.
struct SceneBody {
  std::string material = {};
  std::string group = {};  ///< bodies with one name here are one piece; empty: a piece of its own
  bool merges = false;     ///< Body::merges
  bool splits = false;     ///< Body::splits
  BodySource source;
  Vec3 velocity{0, 0, 0};
  std::vector<ScenePaint> paint = {};
  /// A mesh that follows the body and is drawn in place of a surface around its particles, relative to the
  /// scene; empty: none. It is placed as the body's own mesh or implicit shape is, with the same turn, scale
  /// and shift, and lies as it is where the body has neither.
  std::filesystem::path skin = {};
  int line = 0;  ///< of the scene file; 0 where it did not come from one
};

/// An emitter of a scene. `material` is the name of one of its materials.
struct SceneEmitter : Emitter {
  std::string material = {};
  /// What scene files make of the pose: read_scene() sets both, print_scene() prints these.
  Vec3 translate{0, 0, 0};                          ///< [m]
  Vec3 rotate{0, 0, 0};                             ///< about x, then y, then z [degrees]
  std::vector<SceneKeyframe> scene_keyframes = {};  ///< what scene files make of `keyframes`, as of the pose
  int line = 0;                                     ///< of the scene file; 0 where it did not come from one
};

/// A sink of a scene: particles that come into the box, or out of it, are removed.
struct SceneSink {
  Aabb box;
  bool outside = false;
  int line = 0;  ///< of the scene file; 0 where it did not come from one
};

/// A pin of a scene: what is in the box when the scene begins moves with `velocity` [m/s].
struct ScenePin {
  Aabb box;
  Vec3 velocity{0, 0, 0};
  int line = 0;  ///< of the scene file; 0 where it did not come from one
};

/// Frame k of a run shows the time k · frame_time, whatever steps lead there: Simulation::step_towards(). So
/// frames are as far apart in an impact, where steps are short, as elsewhere, and the frames of runs with
/// other settings can be compared.
struct RunConfig {
  int frames = 240;                       ///< >= 0
  std::optional<double> frame_time = {};  ///< [s], > 0; left out: Δt0, SolverConfig::time_step
};

/// How pictures are taken.
struct RenderConfig {
  int width = 960;   ///< pixels, in [16, 8192]
  int height = 540;  ///< pixels, in [16, 8192]
  int samples = 4;   ///< most rays per pixel to each light, in [1, 256]
  /// Pixels whose light is known this well after one ray take no more; of white, in [0, 1]. 0: all take
  /// `samples`.
  float noise = 0.004f;
  std::optional<Vec3> eye = {};  ///< left out: chosen so that the scene is in view
  std::optional<Vec3> target = {};
  float field_of_view = 35.0f;  ///< vertical, degrees, in [1, 120]
  int frames_per_second = 30;   ///< of the film, in [1, 120]
  /// Share of a frame's time that the shutter is open, in [0, 1]: what moves is blurred. 0: nothing is.
  float shutter = 0;
  /// A Radiance picture (.hdr) of all around to light by, z up, relative to the scene; empty: a studio.
  std::filesystem::path environment = {};
};

/// All that a scene file says.
struct Scene {
  std::filesystem::path file = {};
  SolverConfig solver;
  std::vector<SceneMaterial> materials = {};
  std::vector<SceneBody> bodies = {};
  std::vector<SceneCollider> colliders = {};
  std::vector<ScenePin> pins = {};
  std::vector<SceneEmitter> emitters = {};
  std::vector<SceneSink> sinks = {};
  SurfaceConfig surface;
  RunConfig run;
  RenderConfig render;
};

/// The names of meshes and points in a scene, relative to it.
MALLOW_EXPORT std::vector<std::filesystem::path*> named_files(Scene& scene);

/// How a scene is read.
struct SceneReadOptions {
  /// The files that it names may lie anywhere. Left out: in its folder or below, or below the nearest folder
  /// above it that holds a file .mallow-root, once `..` and links are followed. Names in overrides always
  /// may.
  bool allow_outside_paths = false;
};

/// Reads a scene. Each override is "section.key=value" ("solver.time_step=0.1", "material[0].alpha=0.5") with
/// the value in TOML. Throws ConfigError with all problems at once, each with file, line and column.
MALLOW_EXPORT Scene read_scene(const std::filesystem::path& file, std::span<const std::string> overrides = {},
                               const SceneReadOptions& options = {});
/// The same of a text that is there already; `file` is what messages name and what paths are relative to.
MALLOW_EXPORT Scene parse_scene(const std::string& text, const std::filesystem::path& file,
                                std::span<const std::string> overrides = {},
                                const SceneReadOptions& options = {});
/// The scene as a TOML document with every value in it, defaults too; read_scene() gives the same scene back.
MALLOW_EXPORT std::string print_scene(const Scene& scene);
/// Every key a scene file may hold: one line each with default, range, unit and meaning. Lines that begin
/// with # say which shapes a body, a paint and a collider may have.
MALLOW_EXPORT std::string describe_scene_keys();
/// The numbers of a material by name, one line each: key, value as scene files hold it, unit and meaning.
/// What it leaves out is not listed, nor are color and finish.
MALLOW_EXPORT std::string describe_material(const MaterialPreset& preset);

/// The same scene in steps of `factor` times its own, see mallow/quality.h; frames stay as long as they are.
MALLOW_EXPORT Scene at_time_step(const Scene& scene, float factor);
/// The same scene turned between speed and accuracy, see mallow/quality.h; frames stay as long as they are.
MALLOW_EXPORT Scene with_quality(const Scene& scene, Quality quality);

/// The points of a body as the scene would add them. Throws ConfigError or IoError.
MALLOW_EXPORT Body sample(const SceneBody& body, const std::filesystem::path& scene_file, int threads = 0);
/// Gives points of a body, where the scene begins, what its paint says.
MALLOW_EXPORT void paint(const SceneBody& body, const Material& material, Body& points);
/// What the parts of a scene are called in its simulation: entry k is of the part k of each list of the
/// scene.
struct SceneIds {
  std::vector<BodyId> bodies = {};  ///< bodies of one group share theirs
  std::vector<ColliderId> colliders = {};
  std::vector<PinId> pins = {};
  std::vector<EmitterId> emitters = {};  ///< Simulation::body() has their strands
  std::vector<SinkId> sinks = {};
};
/// The simulation of a scene, ready to step. `threads` as in SolverConfig. notes: where given, gets those of
/// all bodies, each with the body's path in front. ids: where given, gets the ids of all parts. Bodies are
/// called by their group or, without one, "body[k]"; strands "emitter[k]": see Simulation::find_body().
/// Throws ConfigError with all problems found.
MALLOW_EXPORT Simulation build(const Scene& scene, int threads = 0, std::vector<std::string>* notes = nullptr,
                               SceneIds* ids = nullptr);
/// The skins of a scene's bodies, in their order. simulation: what build() made, before its first step.
/// `threads` as in SolverConfig. Throws ConfigError with all problems found: a mesh that is not near its
/// body, an alpha that reaches 1, a file that cannot be read.
MALLOW_EXPORT std::vector<Skin> skins(const Scene& scene, Simulation& simulation, int threads = 0);
/// Whether each body that build() makes has a skin, in order of BodyId.
MALLOW_EXPORT std::vector<bool> skinned_bodies(const Scene& scene);
/// Simulated time of a frame [s]: what the scene says, or Δt0. info: of its simulation.
MALLOW_EXPORT double frame_time(const Scene& scene, const SimulationInfo& info);
/// What can be run, but is hardly meant, a sentence each: that of the simulation, and of what the scene alone
/// knows, its materials by name and how long its frames are.
MALLOW_EXPORT std::vector<std::string> warnings(const Scene& scene, const SimulationInfo& info);
/// The material of each body that build() makes, in order of BodyId: the strands of emitters come last.
MALLOW_EXPORT std::vector<std::size_t> body_materials(const Scene& scene);

}  // namespace mallow
