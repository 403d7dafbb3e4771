#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mallow/appearance.h"
#include "mallow/body.h"
#include "mallow/export.h"
#include "mallow/ids.h"
#include "mallow/mesh.h"
#include "mallow/saved_state.h"

/// Files of meshes, particles and checkpoints: target mallow::scene. Files may come from strangers. Readers
/// check every count against the bytes that are left before they allocate, and throw IoError that names file,
/// line (of text), field, value and what is allowed. They open only the file that they are given, and refuse
/// what is beyond:
///
///   file                                   2 GiB - 1 byte, a regular file (scene: 16 MiB)
///   line of text                           1 MiB
///   vertices, triangles, points            100,000,000 each
///   corners of a polygon                   1,048,576
///   header of a PLY                        1 MiB, 1000 elements and properties
///   memory                                 the file, and 12 bytes for each vertex, normal, velocity,
///                                          triangle and corner of an STL, 4 for each body or material id,
///                                          twice that while they grow: 11 GB
///
/// and for scenes (mallow/scene.h)
///
///   tables and lists within each other     16
///   keys within keys (a.b.c)               9
///   values                                 1,000,000, which take 500 MB at the most
///   names; paths                           256 bytes; 4096 bytes
///   materials, bodies, colliders, pins     10,000 each
///   particles                              100,000,000 in all
///   paths of meshes and points             in the scene's folder, see SceneReadOptions
///   problems that are listed               1000
namespace mallow {

class Simulation;
struct SurfaceParticles;

/// Triangles of an OBJ, PLY, STL or OFF file, by its ending; polygons are split into triangles.
MALLOW_EXPORT Mesh read_mesh(const std::filesystem::path& file);

/// The same, with vertices relative to `origin`, whose components are whole numbers: 0 unless the first
/// vertex is over 1,000 from 0 along that axis. Numbers are then read in double, so that a mesh in the
/// coordinates of a map (y = 4,500,000 m) keeps its shape.
MALLOW_EXPORT Mesh read_mesh(const std::filesystem::path& file, Eigen::Vector3d& origin);

/// Points of a PLY or CSV file, by its ending: columns or properties x, y, z and, if there, vx, vy, vz; and
/// alpha, stiffness, plastic_yield and temperature, which become the members of Body of these names. Others
/// are passed over, and a note of the body names them; where one was probably meant as one of these, such as
/// youngs_modulus for stiffness, that is an error. A PLY's alpha that is a byte beside red, green and blue is
/// of a colour. Columns of a CSV stand between commas, semicolons or tabs, in quotes or not, in capitals or
/// not, and may be called as ParaView does: Points:0, Velocity:0. spacing goes into the body as it is.
MALLOW_EXPORT Body read_points(const std::filesystem::path& file, float spacing);

/// What a frame of particles holds on disk, in id order.
struct ParticleFrame {
  std::vector<Vec3> positions;
  std::vector<Vec3> velocities;
  std::vector<std::uint32_t> bodies;     ///< body of each particle
  double time = 0;                       ///< simulated time [s]
  std::int64_t step = 0;                 ///< steps taken
  std::vector<ParticleId> ids = {};      ///< of each particle, by ascending slot; none: 0, 1, 2, ...
  std::vector<float> alphas = {};        ///< of each particle, where some have their own; else none
  std::vector<float> temperatures = {};  ///< of each particle [K], where some carry heat; else none
};

/// The particles of a simulation as they are now.
MALLOW_EXPORT ParticleFrame snapshot(const Simulation& simulation);

/// The particles of a frame for a Surfacer, as views: the meshes are those of surface_particles() of the
/// simulation that it shows, bit by bit. spacings: h of each body [m]; throws ConfigError where a body has
/// none.
MALLOW_EXPORT SurfaceParticles surface_particles(const ParticleFrame& frame, std::span<const float> spacings);

/// Binary PLY with x y z vx vy vz group, which is the slot of the body, time and step as comments. Bodies are
/// `uchar` where all are below 256, `uint` where not. A frame with ids has `id` and `generation` too, the
/// slot of each particle and how many had it before, by which programs follow particles that come and go;
/// likewise `alpha` and `temperature`.
MALLOW_EXPORT void write_particles(const std::filesystem::path& file, const ParticleFrame& frame);
/// What write_particles() wrote. Throws IoError.
MALLOW_EXPORT ParticleFrame read_particles(const std::filesystem::path& file);

/// `id,x,y,z,vx,vy,vz,body` with nine significant digits, which give back the same floats; body is the slot
/// of the body, as in write_particles(). Behind them `alpha` and `temperature` [K] where the frame has them.
MALLOW_EXPORT void write_state_csv(const std::filesystem::path& file, const ParticleFrame& frame);

/// Binary PLY with normals, velocities and material ids where the mesh has them; ids are `uchar` where all
/// are below 256, `uint` where not.
MALLOW_EXPORT void write_mesh_ply(const std::filesystem::path& file, const Mesh& mesh);

/// What files say of a body, to which Mesh::material_ids assign vertices.
struct MeshBody {
  Appearance appearance;
  std::string name = {};  ///< of the body; empty: "group 0", by its number
  std::string material =
      {};  ///< of its material, which bodies share where it is the same; empty: "material 0"
};

/// The axis that points up in a file; in the engine it is z.
enum class UpAxis : std::uint8_t { y, z };
/// A vector of the engine, with z up, as one with y up: a quarter turn about x.
inline Vec3 with_y_up(const Vec3& v) {
  return {v.x(), v.z(), 0 - v.y()};  // no -0
}

/// What an OBJ file is to hold beside vertices and triangles.
struct ObjOptions {
  UpAxis up = UpAxis::z;                        ///< a comment in the file says which one it is
  std::span<const MeshBody> bodies = {};        ///< `g` and `usemtl` for each; empty: neither
  std::filesystem::path material_library = {};  ///< of write_mtl(), in the OBJ's folder; empty: no `usemtl`
};
/// Wavefront OBJ, with normals where the mesh has them. A triangle is of the body that most of its corners
/// are of, of the smallest id of three that differ; triangles of a body stand together, in their order. What
/// a name may not hold there (blanks, #, \) becomes _. Throws ConfigError as write_mesh_glb() where there are
/// bodies.
MALLOW_EXPORT void write_mesh_obj(const std::filesystem::path& file, const Mesh& mesh,
                                  const ObjOptions& options = {});
/// The materials of bodies for OBJ files. Colours are sRGB, as most programs take them (three.js, MeshLab,
/// VTK); Blender takes them as linear. Throws ConfigError where a colour is out of range.
MALLOW_EXPORT void write_mtl(const std::filesystem::path& file, std::span<const MeshBody> bodies);

/// glTF 2.0 binary: for each body that has triangles a node and a mesh with its name, and a material with
/// that of the scene; velocities as attribute _VELOCITY. A triangle is of a body as in write_mesh_obj(). The
/// node above them turns z, which is up in the mesh, to glTF's y. A mesh without triangles gives a scene
/// without a mesh, as glTF knows no empty one. bodies: one for each material id; throws ConfigError where one
/// is missing, a colour is out of range or a name is not UTF-8, or a number is not finite, as JSON could not
/// say it.
MALLOW_EXPORT void write_mesh_glb(const std::filesystem::path& file, const Mesh& mesh,
                                  std::span<const MeshBody> bodies);

/// Where the vertices of a mesh are at a time.
struct MeshPose {
  double time = 0;             ///< [s]
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<Vec3> normals;   ///< one for each vertex
};
/// The same with one animation, "motion", of a mesh that keeps its vertices: a morph target for each pose
/// after the first, with normals, and weights that go from one to the next in a straight line. mesh: gives
/// triangles and material ids, its own places are passed over. poses: at least one, at ascending times >= 0,
/// with as many vertices and normals as the mesh. A pose takes 24 bytes a vertex. Throws ConfigError where
/// poses are not as said, and as write_mesh_glb() does.
MALLOW_EXPORT void write_animation_glb(const std::filesystem::path& file, const Mesh& mesh,
                                       std::span<const MeshPose> poses, std::span<const MeshBody> bodies);

/// How a GlbSeries is packed.
enum class GlbPacking : std::uint8_t {
  quantized,  ///< KHR_mesh_quantization, which most programs read, Blender from 3.0 on
  meshopt,    ///< EXT_meshopt_compression too, a fifth of the size: three.js, Babylon.js; not Blender
};
/// Whether this build has meshoptimizer, which GlbPacking::meshopt needs.
MALLOW_EXPORT bool can_compress_glb();

/// glTF 2.0 binary that plays frames of a surface, whose vertices and triangles are others in each: a node
/// "frame 0" for each frame, and in it one with the name of each body that has triangles there, with its
/// material. The animation "frames" shows one frame at a time by steps of scales between 0 and 1, each until
/// the next begins and the last as long as the one before it; programs that play nothing show the first.
/// Places are rounded to a grid of 2^13 to 2^14 steps along the longest side of the frame's box, normals to
/// about a degree; velocities are left out. y is up, as in write_mesh_glb(). Holds the packed frames in
/// memory.
class MALLOW_EXPORT GlbSeries {
 public:
  /// bodies: one for each material id. Throws ConfigError where a colour is out of range, a name is not
  /// UTF-8, or the build cannot pack like that.
  explicit GlbSeries(std::span<const MeshBody> bodies, GlbPacking packing = GlbPacking::quantized);
  ~GlbSeries();
  /// Moves, with its frames.
  GlbSeries(GlbSeries&&) noexcept;
  /// @copydoc GlbSeries(GlbSeries&&)
  GlbSeries& operator=(GlbSeries&&) noexcept;

  /// time: [s], >= 0, above that of the frame before. A mesh without triangles is a frame that shows nothing.
  /// Throws ConfigError, and adds nothing, where a body is missing, a number is not finite, or the time is
  /// not as said.
  void add(const Mesh& mesh, double time);
  /// How many were added.
  std::size_t frames() const;
  /// Writes the file, whole or not at all, and is empty then. Throws IoError.
  void write(const std::filesystem::path& file) &&;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

/// How meshes stand in the space and time of USD, where a time code is a frame.
struct UsdOptions {
  UpAxis up = UpAxis::z;
  double frames_per_second = 30;  ///< how fast a player shows them, > 0
  /// Simulated seconds in a second of USD, that is in `frames_per_second` frames; > 0. Velocities are
  /// multiplied by it, so that they are per second of USD and lead from one frame to the next.
  double speed = 1;
};
/// USD's text: a Mesh /surface/mesh with normals and velocities where the mesh has them, in metres, and a
/// UsdPreviewSurface /surface/materials/NAME for each material, which is bound to the mesh or, where there
/// are several bodies, to a GeomSubset of its faces for each, with its name; faces have the primvar
/// displayColor and, of several bodies, the primvar group. Characters that USD does not allow in a name
/// become
/// _, and displayName keeps the name as it was. frame: its time code, at which all that changes between
/// frames has time samples; left out: values that always hold. Takes bodies and throws as write_mesh_glb()
/// does.
MALLOW_EXPORT void write_mesh_usda(const std::filesystem::path& file, const Mesh& mesh,
                                   std::span<const MeshBody> bodies, const UsdOptions& options = {},
                                   std::optional<int> frame = {});

/// VTK's XML PolyData, triangles with the point arrays Normals, Velocity and Material where the mesh has
/// them. Material and Group are UInt8 where all are below 256, UInt32 where not. bodies: field arrays of
/// text, BodyNames and MaterialNames, say of each by its number, which is what Material and Group hold, what
/// it and its material are called; none: no such arrays. Throws ConfigError where there are bodies, and too
/// few of them.
MALLOW_EXPORT void write_mesh_vtp(const std::filesystem::path& file, const Mesh& mesh,
                                  std::span<const MeshBody> bodies = {});

/// VTK's XML PolyData, vertices with the point arrays Velocity, Group, which is the body, and Id, and Alpha
/// and Temperature where the frame has them; bodies as in write_mesh_vtp().
MALLOW_EXPORT void write_particles_vtp(const std::filesystem::path& file, const ParticleFrame& frame,
                                       std::span<const MeshBody> bodies = {});
/// OpenVDB points, see points_vdb() in mallow/level_set.h for the attributes and for what is thrown.
/// voxel_size: [m], > 0; twice the spacing gives about 8 points a voxel.
MALLOW_EXPORT void write_particles_vdb(const std::filesystem::path& file, const ParticleFrame& frame,
                                       float voxel_size, int threads = 0);

/// A file of a series and the time that it shows [s].
struct TimedFile {
  std::filesystem::path file;  ///< relative to the collection
  double time = 0;
};
/// ParaView's collection (PVD): what plays VTP files at their times.
MALLOW_EXPORT void write_pvd(const std::filesystem::path& file, std::span<const TimedFile> frames);

/// A file that write_mesh_usda() wrote for a frame.
struct UsdFrame {
  std::filesystem::path file;  ///< relative to the series
  int number = 0;              ///< its time code, >= 0
};
/// "surface.manifest.usda" for "surface.usda".
MALLOW_EXPORT std::filesystem::path usda_manifest(const std::filesystem::path& series);
/// USD's text that plays the files of frames as one Mesh whose values change. The files are value clips of
/// the prim /surface: a program opens only those of the frames that it shows, and one that knows no value
/// clips shows the first frame. The manifest, which names the attributes that change, is written too. frames:
/// ascending; throws ConfigError where not. bodies and options: those of the frames.
MALLOW_EXPORT void write_usda_series(const std::filesystem::path& file, std::span<const UsdFrame> frames,
                                     std::span<const MeshBody> bodies, const UsdOptions& options = {});

/// A saved state as a file, compressed, every bit of it under a checksum. Whole or not at all; the checkpoint
/// that was there is kept as previous_checkpoint(), so that whenever a writer is killed, one of the two is
/// whole. Throws IoError.
MALLOW_EXPORT void write_checkpoint(const std::filesystem::path& file, const SavedState& state);
/// Throws IoError for a file that is not, bit by bit, what was written, and for one of another version of the
/// format or from a machine of the other byte order: a damaged checkpoint is never read.
MALLOW_EXPORT SavedState read_checkpoint(const std::filesystem::path& file);
/// "checkpoint.previous" for "checkpoint".
MALLOW_EXPORT std::filesystem::path previous_checkpoint(const std::filesystem::path& file);

/// Whether a file takes what is written as it comes, and must stay what it is: a device or pipe. Throws
/// IoError for /dev/stdout and the like where they lead to a file, as nothing can be put in their place.
MALLOW_EXPORT bool is_written_in_place(const std::filesystem::path& file);
/// Writes a file whole or not at all: `write` gets a name beside it, which is synced and renamed when it
/// returns and removed when it throws. What is_written_in_place() is given to `write` itself.
MALLOW_EXPORT void write_whole(const std::filesystem::path& file,
                               const std::function<void(const std::filesystem::path& beside)>& write);
/// The same for content that is already there.
MALLOW_EXPORT void write_whole(const std::filesystem::path& file, std::string_view content);

}  // namespace mallow
