#include "cli/export_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/export_animations.h"
#include "cli/frame_loop.h"
#include "cli/messages.h"
#include "mallow/errors.h"
#include "mallow/files.h"
#include "mallow/level_set.h"
#include "mallow/surface.h"
#include "program/body_appearances.h"
#include "program/cached_run.h"
#include "program/failure.h"
#include "program/frame_range.h"
#include "program/input_files.h"
#include "program/output_files.h"
#include "program/run_mark.h"
#include "program/shared_frames.h"
#include "program/shell_word.h"

namespace mallow::cli {
namespace {

namespace fs = std::filesystem;

struct ExportOptions : program::CachedRunOptions {
  std::vector<std::string> surface;    ///< formats
  std::vector<std::string> particles;  ///< formats
  std::vector<std::string> animation;  ///< formats
  std::vector<std::string> skins;      ///< formats
  std::string up = "z";
  std::string out;
  FrameOptions frames;
};

/// Beside the OBJ files, which all name it.
constexpr const char* k_materials = "materials.mtl";

bool contains(const std::vector<std::string>& formats, const char* format) {
  return std::find(formats.begin(), formats.end(), format) != formats.end();
}

/// What files say of each body of the scene.
std::vector<MeshBody> mesh_bodies(const program::CachedRun& run) {
  const std::vector<Appearance> appearances = program::body_appearances(run.scene);
  const std::vector<std::size_t> materials = body_materials(run.scene);
  std::vector<MeshBody> bodies;
  for (std::size_t b = 0; b < materials.size(); ++b) {
    bodies.push_back({appearances[b], run.report.at("groups").at(b).value("name", ""),
                      run.scene.materials[materials[b]].name});
  }
  return bodies;
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

void check_formats(const ExportOptions& options) {
  if (options.surface.empty() && options.particles.empty() && options.animation.empty() &&
      options.skins.empty()) {
    throw ConfigError("--surface, --particles, --animation, --skins",
                      "at least one is needed, with the formats to write");
  }
}

/// A run that was ended early may lack the last frame's surface; one without any has nothing to export.
void require_surfaces(const program::Cache& cache) {
  if (!cache.surface_frames().empty()) return;
  throw IoError({cache.folder().string(), 0, 0, "--surface",
                 "the run has no surfaces; 'mallow surface " + program::shell_word(cache.folder().string()) +
                     "' draws them"});
}

/// A scene may name what an earlier export wrote.
void refuse_inputs(const ExportOptions& options, const program::CachedRun& run, const fs::path& out) {
  const program::InputFiles inputs(run.scene);
  const auto check = [&](const char* kind, const std::vector<std::string>& formats) {
    for (const std::string& format : formats)
      for (const int frame : run.cache.particle_frames())
        inputs.refuse(out / kind / program::frame_name(frame, format), "--out");
  };
  check("surface", options.surface);
  check("particles", options.particles);
  for (const std::string& format : options.animation) inputs.refuse(out / animation_name(format), "--out");
  if (!options.skins.empty()) inputs.refuse(out / "skins.glb", "--out");
}

/// Two exports into one folder would mix their frames.
program::RunLock lock_folder(const fs::path& out, bool shared) {
  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw IoError({out.string(), 0, 0, "--out", "cannot be made: " + error.message()});
  program::RunLock lock = program::RunLock::for_exports(out, shared);
  if (!shared) program::forget_shared_frames(out);
  return lock;
}

void turn(std::vector<Vec3>& vectors) {
  for (Vec3& vector : vectors) vector = with_y_up(vector);
}

/// Writes a frame in one of the formats.
class FrameWriter {
 public:
  FrameWriter(const program::CachedRun& run, UpAxis up)
      : run_(run),
        usd_(usd_options(run, up)),
        bodies_(mesh_bodies(run)),
        surfacer_(run.scene.surface, run.threads),
        voxel_size_(2 * *std::max_element(run.spacings.begin(), run.spacings.end())) {}

  const UsdOptions& usd() const { return usd_; }
  std::span<const MeshBody> bodies() const { return bodies_; }

  ParticleFrame read_particles(int number) const {
    ParticleFrame frame = mallow::read_particles(run_.cache.particles_file(number));
    if (usd_.up == UpAxis::z) return frame;
    turn(frame.positions);
    turn(frame.velocities);
    return frame;
  }
  void write_particles(const ParticleFrame& frame, const std::string& format, const fs::path& file) const {
    if (format == "vdb") write_particles_vdb(file, frame, voxel_size_, run_.threads);
    if (format == "vtp") write_particles_vtp(file, frame);
    if (format == "csv") write_state_csv(file, frame);
  }
  /// mesh: as the cache has it
  void write_surface(const Mesh& mesh, int number, const std::string& format, const fs::path& file) const {
    if (format == "obj")
      write_mesh_obj(file, mesh, {.up = usd_.up, .bodies = bodies_, .material_library = k_materials});
    if (format == "glb") write_mesh_glb(file, mesh, bodies_);
    if (format == "vtp") write_mesh_vtp(file, turned(mesh));
    if (format == "usda") write_mesh_usda(file, mesh, bodies_, usd_, number);
  }
  /// Level sets are no part of a cache: they are drawn again, with the run's settings.
  void write_level_set(const ParticleFrame& frame, const fs::path& file) {
    SurfaceParticles particles = surface_particles(frame, run_.spacings);
    particles.velocities = {};
    surfacer_.draw(particles);
    write_whole(file, level_set_vdb(surfacer_));
  }

 private:
  Mesh turned(Mesh mesh) const {
    if (usd_.up == UpAxis::z) return mesh;
    for (std::vector<Vec3>* vectors : {&mesh.vertices, &mesh.normals, &mesh.velocities}) turn(*vectors);
    return mesh;
  }

  const program::CachedRun& run_;
  UsdOptions usd_;
  std::vector<MeshBody> bodies_;
  Surfacer surfacer_;
  float voxel_size_;
};

/// All that an export writes.
class Export {
 public:
  Export(const ExportOptions& options, const program::CachedRun& run, const fs::path& out)
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
    const Mesh mesh = read_mesh(run_.cache.surface_file(number));
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
    const Mesh mesh = read_mesh(run_.cache.surface_file(number));
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

 private:
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

/// What makes the files what they are, beside the frames that they are made of.
std::string job_of(const ExportOptions& options, const program::CachedRun& run) {
  std::string job = print_scene(run.scene) + options.up + run.report.at("groups").dump();
  for (const auto* formats : {&options.surface, &options.particles, &options.animation, &options.skins})
    for (const std::string& format : *formats) job += (format == formats->front() ? '\n' : ' ') + format;
  return job;
}

/// Beside other processes; the one that finds all frames written adds what plays them.
void share_export(const ExportOptions& options, const program::CachedRun& run, const fs::path& out,
                  const std::vector<int>& chosen, Export& all) {
  const program::SharedFrames shared(out, "export", job_of(options, run),
                                     [&](int number) { return all.files(number); });
  for_each_frame(chosen, &shared, options.frames.share, "exporting",
                 [&](int number, const FrameClaim& claim) {
                   all.write_frame(number);
                   claim->done();
                 });
  const std::vector<int> frames = run.cache.particle_frames();
  std::vector<fs::path> made;
  for (const std::string& format : options.animation) made.push_back(out / animation_name(format));
  if (!options.skins.empty()) made.push_back(out / "skins.glb");
  const std::size_t left = shared.join(frames, made, [&] {
    for (const int number : frames) all.add_frame(number);
    all.finish();
  });
  if (left > 0) std::printf("left %zu\n", left);
}

void export_frames(const ExportOptions& options) {
  check_formats(options);
  const program::CachedRun run = program::open_cached_run(options, "");
  print_warning(run.cache.lock_warning());
  const program::Cache& cache = run.cache;
  if (!options.surface.empty() || !options.animation.empty() || !options.skins.empty())
    require_surfaces(cache);
  if (!options.skins.empty()) SkinAnimation{run};  // throws where there are none
  const std::vector<int> chosen = program::choose_frames(options.frames.range, cache.particle_frames());
  const fs::path out = options.out.empty() ? cache.export_folder() : fs::path(options.out);
  refuse_inputs(options, run, out);
  const program::RunLock lock = lock_folder(out, options.frames.shared());
  print_warning(lock.warning());
  Export all(options, run, out);
  try {
    if (options.frames.shared()) return share_export(options, run, out, chosen, all);
    for_each_frame(chosen, "exporting", [&](int number) {
      all.write_frame(number);
      all.add_frame(number);
    });
    all.finish();
  } catch (const std::exception& error) {
    throw program::RunFailure(error.what());
  }
}

}  // namespace

void add_export_command(CLI::App& app) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand(
      "export", "Write the surfaces and particles of an earlier run in the formats of other programs");
  command->add_option("DIR", options->folder, "The --out folder of a run")->required();
  command
      ->add_option("--surface", options->surface,
                   "Formats of the surfaces, with commas between: obj, glb (glTF; Blender, web), "
                   "vtp (ParaView), usda (USD), vdb (level sets)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"obj", "glb", "vtp", "usda", "vdb"}));
  command
      ->add_option("--particles", options->particles,
                   "Formats of the particles: vdb (OpenVDB points; Houdini), vtp (ParaView), csv")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"vdb", "vtp", "csv"}));
  command
      ->add_option(
          "--animation", options->animation,
          "Formats of the surfaces of all frames as one file that plays them: glb (glTF; Blender, web), "
          "surface.glb; meshopt (glTF compressed with EXT_meshopt_compression; web, not Blender), "
          "surface.meshopt.glb")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"glb", "meshopt"}));
  command
      ->add_option("--skins", options->skins,
                   "Formats of the skins of all frames as one animation: glb (glTF; Blender, web), skins.glb")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({"glb"}));
  command
      ->add_option(
          "--up", options->up,
          "The axis that points up in the files: z, as in the scene, or y; in glb it is y, as glTF has it")
      ->check(CLI::IsMember({"y", "z"}))
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder for surface/ and particles/; DIR/export if left out");
  command->add_option("--threads", options->threads, "Number of threads; 0: one for each processor")
      ->check(CLI::Range(0, 1024));
  command->footer(
      "Velocities: _VELOCITY in glb, Velocity in vtp, velocities in usda, v in vdb, vx vy vz in csv; "
      "an OBJ and an animation have none.\n"
      "Temperatures [K] where the scene has heat: temperature in csv, Temperature in vtp.\n"
      "Bodies of particles, counted from 0 as in report.json: Group in vtp, body in csv.\n"
      "Groups and materials have the names of the scene in obj (materials.mtl), glb and usda.\n"
      "surface.pvd plays the frames at their simulated times; surface.usda plays them as the film does: a\n"
      "time code is a frame, and velocities are per second of the film.");
  add_frame_options(*command, options->frames);
  command->callback([options] { export_frames(*options); });
}

}  // namespace mallow::cli
