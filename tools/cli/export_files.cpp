#include "cli/export_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>

#include "cli/export_animations.h"
#include "mallow/errors.h"
#include "mallow/files.h"
#include "mallow/level_set.h"
#include "mallow/surface.h"
#include "program/body_appearances.h"
#include "program/output_files.h"

namespace mallow::cli {
namespace fs = std::filesystem;
namespace export_files {  // named, as Export::Work holds what is in it

/// Beside the OBJ files, which all name it.
constexpr const char* k_materials = "materials.mtl";

bool contains(const std::vector<std::string>& formats, const char* format) {
  return std::find(formats.begin(), formats.end(), format) != formats.end();
}

/// All bodies that there have been: those that have the slots of frames now, and behind them those that had
/// them before. So one list is that of all frames, as what plays them asks for.
std::vector<program::SlotBody> all_bodies(const program::CachedRun& run) {
  std::vector<program::SlotBody> all = run.bodies;
  for (const program::PastBody& past : run.past) all.push_back(past.body);
  return all;
}

/// What files say of each.
std::vector<MeshBody> mesh_bodies(const program::CachedRun& run, std::span<const program::SlotBody> all) {
  const std::vector<Appearance> appearances =
      program::body_appearances(run.scene, program::material_names(all));
  std::vector<MeshBody> bodies;
  for (std::size_t b = 0; b < all.size(); ++b)
    bodies.push_back({appearances[b], all[b].name, all[b].material});
  return bodies;
}

/// Slots of a frame -> places in all_bodies().
void number_bodies(const program::CachedRun& run, int frame, std::vector<std::uint32_t>& bodies) {
  const std::vector<std::uint32_t> numbers = program::slot_numbers_at(frame, run.bodies.size(), run.past);
  for (std::uint32_t& body : bodies)
    if (body < numbers.size()) body = numbers[body];
}

/// Simulated seconds from a frame to the next, as the particles say.
double frame_time(const program::CachedRun& run) {
  const std::vector<int> frames = run.cache.particle_frames();
  const double film = 1.0 / run.scene.render.frames_per_second;
  if (frames.size() < 2) return film;
  const auto time = [&](int frame) { return read_particles(run.cache.particles_file(frame)).time; };
  const double mean = (time(frames.back()) - time(frames.front())) / (frames.back() - frames.front());
  if (!(mean > 0)) return film;  // frames that all show one time
  // A scene in real time says 0.0333, or a float next to 1/30, but means the film's rate.
  return std::abs(mean - film) < 2e-3 * film ? film : mean;
}

/// A frame of USD is one of the film, and its seconds are the film's.
UsdOptions usd_options(const program::CachedRun& run, UpAxis up) {
  const double rate = run.scene.render.frames_per_second;
  return {.up = up, .frames_per_second = rate, .speed = frame_time(run) * rate};
}

/// Frames of one kind in all of their formats: OUT/surface/frame_000000.glb and what plays them where a
/// format has such a file, OUT/surface.pvd for VTP and OUT/surface.usda.
class Series {
 public:
  /// Throws IoError where it cannot be written.
  Series(const fs::path& out, const char* kind, const std::vector<std::string>& formats)
      : out_(out), kind_(kind), formats_(formats) {
    if (formats.empty()) return;
    std::error_code error;
    fs::create_directories(out / kind, error);
    if (error) throw IoError({(out / kind).string(), 0, 0, "", "cannot be made: " + error.message()});
    program::check_writable(out / kind / "frame");
  }

  /// The files of a frame.
  std::vector<fs::path> files(int number) const {
    std::vector<fs::path> files;
    for (const std::string& format : formats_)
      files.push_back(out_ / kind_ / program::frame_name(number, format));
    return files;
  }
  template <class Write>
  void write(int number, const Write& write) const {
    for (const std::string& format : formats_)
      write(format, out_ / kind_ / program::frame_name(number, format));
  }
  /// A frame that is there, for what plays them.
  void add(int number, double time) {
    vtp_frames_.push_back({fs::path(kind_) / program::frame_name(number, "vtp"), time});
    usda_frames_.push_back({fs::path(kind_) / program::frame_name(number, "usda"), number});
  }
  void finish(std::span<const MeshBody> bodies, const UsdOptions& usd) const {
    const std::string name = (out_ / kind_).string();
    if (contains(formats_, "vtp")) write_pvd(name + ".pvd", vtp_frames_);
    if (contains(formats_, "usda")) write_usda_series(name + ".usda", usda_frames_, bodies, usd);
    if (contains(formats_, "obj")) write_mtl(out_ / kind_ / k_materials, bodies);
    if (!formats_.empty()) std::printf("%s %zu\n", kind_, vtp_frames_.size());
  }

 private:
  fs::path out_;
  const char* kind_;
  const std::vector<std::string>& formats_;
  std::vector<TimedFile> vtp_frames_;
  std::vector<UsdFrame> usda_frames_;
};

void turn(std::vector<Vec3>& vectors) {
  for (Vec3& vector : vectors) vector = with_y_up(vector);
}

/// Writes a frame in one of the formats.
class FrameWriter {
 public:
  FrameWriter(const program::CachedRun& run, UpAxis up)
      : run_(run),
        usd_(usd_options(run, up)),
        spacings_(program::spacings_of(all_bodies(run))),
        bodies_(mesh_bodies(run, all_bodies(run))),
        surfacer_(run.scene.surface, run.threads),
        voxel_size_(2 * *std::max_element(spacings_.begin(), spacings_.end())) {}

  const UsdOptions& usd() const { return usd_; }
  std::span<const MeshBody> bodies() const { return bodies_; }

  ParticleFrame read_particles(int number) const {
    ParticleFrame frame = mallow::read_particles(run_.cache.particles_file(number));
    number_bodies(run_, number, frame.bodies);
    if (usd_.up == UpAxis::z) return frame;
    turn(frame.positions);
    turn(frame.velocities);
    return frame;
  }
  Mesh read_surface(int number) const {
    Mesh mesh = read_mesh(run_.cache.surface_file(number));
    number_bodies(run_, number, mesh.material_ids);
    return mesh;
  }
  void write_particles(const ParticleFrame& frame, const std::string& format, const fs::path& file) const {
    if (format == "vdb") write_particles_vdb(file, frame, voxel_size_, run_.threads);
    if (format == "vtp") write_particles_vtp(file, frame, bodies_);
    if (format == "csv") write_state_csv(file, frame);
  }
  /// mesh: of read_surface()
  void write_surface(const Mesh& mesh, int number, const std::string& format, const fs::path& file) const {
    if (format == "obj")
      write_mesh_obj(file, mesh, {.up = usd_.up, .bodies = bodies_, .material_library = k_materials});
    if (format == "glb") write_mesh_glb(file, mesh, bodies_);
    if (format == "vtp") write_mesh_vtp(file, turned(mesh), bodies_);
    if (format == "usda") write_mesh_usda(file, mesh, bodies_, usd_, number);
  }
  /// Level sets are no part of a cache: they are drawn again, with the run's settings.
  void write_level_set(const ParticleFrame& frame, const fs::path& file) {
    SurfaceParticles particles = surface_particles(frame, spacings_);
    particles.velocities = {};
    std::vector<std::string> names;
    for (const SceneMaterial& material : run_.scene.materials) names.push_back(material.name);
    for (SurfaceBody& body : particles.bodies) {
      body.name = bodies_.at(body.body).name;
      const auto material = std::ranges::find(names, bodies_.at(body.body).material);
      body.material = static_cast<MaterialId>(material - names.begin());
      if (material == names.end()) names.push_back(bodies_.at(body.body).material);
    }
    surfacer_.draw(particles);
    write_whole(file, level_set_vdb(surfacer_, names));
  }

 private:
  Mesh turned(Mesh mesh) const {
    if (usd_.up == UpAxis::z) return mesh;
    for (std::vector<Vec3>* vectors : {&mesh.vertices, &mesh.normals, &mesh.velocities}) turn(*vectors);
    return mesh;
  }

  const program::CachedRun& run_;
  UsdOptions usd_;
  std::vector<float> spacings_;   ///< of all_bodies() [m]
  std::vector<MeshBody> bodies_;  ///< likewise
  Surfacer surfacer_;
  float voxel_size_;
};

}  // namespace export_files

using namespace export_files;

struct Export::Work {
  Work(const ExportOptions& options, const program::CachedRun& run, const fs::path& out)
      : options_(options),
        run_(run),
        out_(out),
        surfaces_(out, "surface", options.surface),
        particles_(out, "particles", options.particles),
        writer_(run, options.up == "y" ? UpAxis::y : UpAxis::z),
        animation_(options.animation, writer_.bodies(), run.scene.render.frames_per_second) {
    if (!options.skins.empty()) skins_.emplace(run);
  }

  /// The files of a frame.
  void write_frame(int number) {
    ParticleFrame frame;
    if (!options_.particles.empty() || contains(options_.surface, "vdb"))
      frame = writer_.read_particles(number);
    if (!options_.particles.empty())
      particles_.write(number, [&](const std::string& format, const fs::path& file) {
        writer_.write_particles(frame, format, file);
      });
    if (options_.surface.empty() || !has_surface(number)) return;
    const Mesh mesh = writer_.read_surface(number);
    surfaces_.write(number, [&](const std::string& format, const fs::path& file) {
      if (format == "vdb")
        writer_.write_level_set(frame, file);
      else
        writer_.write_surface(mesh, number, format, file);
    });
  }
  /// A frame for what plays all of them.
  void add_frame(int number) {
    const double time = read_particles(run_.cache.particles_file(number)).time;  // of surfaces too
    if (!options_.particles.empty()) particles_.add(number, time);
    if (!has_surface(number)) return;
    if (!options_.surface.empty()) surfaces_.add(number, time);
    if (!animation_.any() && !skins_) return;
    const Mesh mesh = writer_.read_surface(number);
    animation_.add(mesh, number);
    if (skins_) skins_->add(mesh, number);
  }
  /// What plays the frames that were added.
  void finish() {
    surfaces_.finish(writer_.bodies(), writer_.usd());
    particles_.finish(writer_.bodies(), writer_.usd());
    animation_.write(out_);
    if (skins_) skins_->write(out_ / "skins.glb", writer_.bodies());
  }

  program::SharedFrames::Files files(int number) const {
    std::vector<fs::path> written = particles_.files(number);
    if (has_surface(number))
      for (fs::path& file : surfaces_.files(number)) written.push_back(std::move(file));
    return {{run_.cache.particles_file(number), run_.cache.surface_file(number)}, std::move(written)};
  }

  /// A run that was ended early may lack that of the last frame.
  bool has_surface(int number) const { return fs::exists(run_.cache.surface_file(number)); }

  const ExportOptions& options_;
  const program::CachedRun& run_;
  fs::path out_;
  Series surfaces_, particles_;
  FrameWriter writer_;
  SurfaceAnimation animation_;
  std::optional<SkinAnimation> skins_;
};

Export::Export(const ExportOptions& options, const program::CachedRun& run, const fs::path& out)
    : work_(std::make_unique<Work>(options, run, out)) {}
Export::~Export() = default;

void Export::write_frame(int number) {
  work_->write_frame(number);
}
void Export::add_frame(int number) {
  work_->add_frame(number);
}
void Export::finish() {
  work_->finish();
}
program::SharedFrames::Files Export::files(int number) const {
  return work_->files(number);
}

}  // namespace mallow::cli
