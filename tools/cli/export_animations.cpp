#include "cli/export_animations.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "mallow/errors.h"
#include "program/frame_surface.h"

namespace mallow::cli {

std::string animation_name(const std::string& format) {
  return format == "meshopt" ? "surface.meshopt.glb" : "surface.glb";
}

SurfaceAnimation::SurfaceAnimation(const std::vector<std::string>& formats, std::span<const MeshBody> bodies,
                                   double frames_per_second)
    : formats_(formats), frames_per_second_(frames_per_second) {
  for (const std::string& format : formats) {
    const bool compress = format == "meshopt";
    if (compress && !can_compress_glb())
      throw ConfigError("--animation meshopt",
                        "is not allowed: this mallow was built without meshoptimizer; install "
                        "libmeshoptimizer-dev, configure and build again");
    files_.emplace_back(bodies, compress ? GlbPacking::meshopt : GlbPacking::quantized);
  }
}

void SurfaceAnimation::add(const Mesh& mesh, int number) {
  if (!first_) first_ = number;
  for (GlbSeries& file : files_) file.add(mesh, (number - *first_) / frames_per_second_);
}

void SurfaceAnimation::write(const std::filesystem::path& out) {
  if (!any()) return;
  const std::size_t frames = files_.front().frames();
  for (std::size_t i = 0; i < files_.size(); ++i)
    std::move(files_[i]).write(out / animation_name(formats_[i]));
  std::printf("animation %zu\n", frames);
}

SkinAnimation::SkinAnimation(const program::CachedRun& run) : run_(run), skinned_(skinned_bodies(run.scene)) {
  if (std::find(skinned_.begin(), skinned_.end(), true) == skinned_.end())
    throw IoError({run.cache.folder().string(), 0, 0, "--skins", "no body of the run's scene has a skin"});
}

void SkinAnimation::add(const Mesh& mesh, int number) {
  Mesh part = program::part_of(mesh, skinned_);
  if (poses_.empty()) {
    first_ = part;
    first_frame_ = number;
  }
  if (part.triangles != first_.triangles || part.normals.size() != first_.vertices.size())
    throw IoError({run_.cache.surface_file(number).string(), 0, 0, "--skins",
                   "has other skins than the frames before it; run the scene again"});
  poses_.push_back({static_cast<double>(number - first_frame_) / run_.scene.render.frames_per_second,
                    std::move(part.vertices), std::move(part.normals)});
}

void SkinAnimation::write(const std::filesystem::path& file, std::span<const MeshBody> bodies) const {
  if (poses_.empty()) return;
  write_animation_glb(file, first_, poses_, bodies);
  std::printf("skins %zu\n", poses_.size());
}

}  // namespace mallow::cli
