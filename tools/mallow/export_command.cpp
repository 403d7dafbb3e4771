#include "mallow/export_command.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mallow/cached_run.h"
#include "mallow/errors.h"
#include "mallow/failure.h"
#include "mallow/files.h"
#include "mallow/group_appearances.h"
#include "mallow/input_files.h"
#include "mallow/level_set.h"
#include "mallow/run_mark.h"
#include "mallow/shell_word.h"

namespace mallow::cli {
namespace {

namespace fs = std::filesystem;

struct ExportOptions : CachedRunOptions {
  std::vector<std::string> surface;    ///< formats
  std::vector<std::string> particles;  ///< formats
  std::string out;
};

bool contains(const std::vector<std::string>& formats, const char* format) {
  return std::find(formats.begin(), formats.end(), format) != formats.end();
}

/// USD's seconds are those of the simulation, as velocities are per second of it; players show a frame after
/// the other as the film does. frame_time: between frames [s].
UsdTimeline usd_timeline(const Scene& scene, double frame_time) {
  const double film = scene.render.frames_per_second;
  const double rate = 1 / frame_time;
  // A scene in real time says 0.0333, or a float next to 1/30, but means the film's rate.
  return {std::abs(rate - film) < 2e-3 * film ? film : rate, film};
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
    check_writable(out / kind / "frame");
  }

  template <class Write>
  void add(int number, double time, const Write& write) {
    for (const std::string& format : formats_) write(format, out_ / kind_ / frame_name(number, format));
    vtp_frames_.push_back({fs::path(kind_) / frame_name(number, "vtp"), time});
    usda_frames_.push_back({fs::path(kind_) / frame_name(number, "usda"), number});
  }
  void finish(const Scene& scene) const {
    const std::string name = (out_ / kind_).string();
    if (contains(formats_, "vtp")) write_pvd(name + ".pvd", vtp_frames_);
    if (contains(formats_, "usda"))
      write_usda_series(name + ".usda", usda_frames_, usd_timeline(scene, frame_time(scene)));
    if (!formats_.empty()) std::printf("%s %zu\n", kind_, vtp_frames_.size());
  }

 private:
  /// Frame k shows the time k · frame_time; one that is alone goes with any.
  double frame_time(const Scene& scene) const {
    const int last = usda_frames_.back().number;
    return last > 0 ? vtp_frames_.back().time / last : 1.0 / scene.render.frames_per_second;
  }

  fs::path out_;
  const char* kind_;
  const std::vector<std::string>& formats_;
  std::vector<TimedFile> vtp_frames_;
  std::vector<UsdFrame> usda_frames_;
};

void check_formats(const ExportOptions& options) {
  if (options.surface.empty() && options.particles.empty()) {
    throw ConfigError("--surface, --particles", "at least one is needed, with the formats to write");
  }
}

/// A run that was ended early may lack the last frame's surface; one without any has nothing to export.
void require_surfaces(const Cache& cache) {
  if (!cache.surface_frames().empty()) return;
  throw IoError(
      {cache.folder().string(), 0, 0, "--surface",
       "the run has no surfaces; 'mallow surface " + shell_word(cache.folder().string()) + "' draws them"});
}

/// A scene may name what an earlier export wrote.
void refuse_inputs(const ExportOptions& options, const CachedRun& run, const fs::path& out) {
  const InputFiles inputs(run.scene);
  const auto check = [&](const char* kind, const std::vector<std::string>& formats) {
    for (const std::string& format : formats)
      for (const int frame : run.cache.particle_frames())
        inputs.refuse(out / kind / frame_name(frame, format), "--out");
  };
  check("surface", options.surface);
  check("particles", options.particles);
}

/// Two exports into one folder would mix their frames.
RunLock lock_folder(const fs::path& out) {
  std::error_code error;
  fs::create_directories(out, error);
  if (error) throw IoError({out.string(), 0, 0, "--out", "cannot be made: " + error.message()});
  return RunLock::for_exports(out);
}

void export_frames(const ExportOptions& options) {
  check_formats(options);
  const CachedRun run = open_cached_run(options, "");
  const Cache& cache = run.cache;
  if (!options.surface.empty()) require_surfaces(cache);
  const fs::path out = options.out.empty() ? cache.export_folder() : fs::path(options.out);
  refuse_inputs(options, run, out);
  const RunLock lock = lock_folder(out);
  Series surfaces(out, "surface", options.surface);
  Series particles(out, "particles", options.particles);
  const std::vector<Appearance> palette = group_appearances(run.scene);
  const float voxel_size = 2 * *std::max_element(run.spacings.begin(), run.spacings.end());

  // Level sets are no part of a cache: they are drawn again, with the run's settings.
  Surfacer surfacer(run.scene.surface, run.threads);
  const auto draw_level_set = [&](const ParticleFrame& frame) {
    surfacer.draw({.positions = frame.positions, .groups = frame.groups, .spacings = run.spacings});
    return surfacer.level_set_vdb();
  };
  const auto write_surface = [&](const Mesh& mesh, const std::string& format, const fs::path& file) {
    if (format == "obj") write_mesh_obj(file, mesh);
    if (format == "glb") write_mesh_glb(file, mesh, palette);
    if (format == "vtp") write_mesh_vtp(file, mesh);
    if (format == "usda") write_mesh_usda(file, mesh, palette);
  };
  const auto write_points = [&](const ParticleFrame& frame, const std::string& format, const fs::path& file) {
    if (format == "vdb") write_particles_vdb(file, frame, voxel_size, run.threads);
    if (format == "vtp") write_particles_vtp(file, frame);
    if (format == "csv") write_state_csv(file, frame);
  };
  try {
    for_each_frame(cache.particle_frames(), "exporting", [&](int number) {
      const ParticleFrame frame =
          read_particles(cache.particles_file(number));  // tells the time of surfaces too
      if (!options.particles.empty()) {
        particles.add(number, frame.time, [&](const std::string& format, const fs::path& file) {
          write_points(frame, format, file);
        });
      }
      if (options.surface.empty() || !fs::exists(cache.surface_file(number))) return;
      const Mesh mesh = read_mesh(cache.surface_file(number));
      surfaces.add(number, frame.time, [&](const std::string& format, const fs::path& file) {
        if (format == "vdb")
          write_whole(file, draw_level_set(frame));
        else
          write_surface(mesh, format, file);
      });
    });
    surfaces.finish(run.scene);
    particles.finish(run.scene);
  } catch (const std::exception& error) {
    throw RunFailure(error.what());
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
  command->add_option("--out", options->out, "Folder for surface/ and particles/; DIR/export if left out");
  command->add_option("--threads", options->threads, "Number of threads; 0: one for each processor")
      ->check(CLI::Range(0, 1024));
  command->footer(
      "Velocities: _VELOCITY in glb, Velocity in vtp, velocities in usda, v in vdb, vx vy vz in csv; "
      "an OBJ has none.\n"
      "surface.pvd and surface.usda play the frames; a time code of USD is a frame.");
  command->callback([options] { export_frames(*options); });
}

}  // namespace mallow::cli
