#include <algorithm>
#include <string>

#include "files/byte_reader.h"
#include "files/mesh_materials.h"
#include "files/usda_text.h"
#include "mallow/errors.h"
#include "mallow/files.h"

/// Frames of a mesh as value clips: openusd.org, "Sequencable, Re-timable Animated Value Clips".
namespace mallow {
namespace {

void require_ascending(std::span<const UsdFrame> frames) {
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (frames[f].number >= 0 && (f == 0 || frames[f].number > frames[f - 1].number)) continue;
    throw ConfigError("frames[" + std::to_string(f) + "].number",
                      std::to_string(frames[f].number) + " is not allowed: from 0 on, ascending");
  }
}

/// The reference of a file beside or below: without "./" USD would look for it along a search path.
std::string asset_path(const std::filesystem::path& file) {
  const std::string path = (file.is_absolute() ? "" : "./") + file.generic_string();
  if (std::any_of(path.begin(), path.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }))
    fail_file(file, "cannot be named in USD: a name has to be on one line there");
  if (path.find('@') == std::string::npos) return '@' + path + '@';
  if (path.find("@@@") != std::string::npos) fail_file(file, "cannot be named in USD: @@@ ends a path there");
  return "@@@" + path + "@@@";
}

/// `name = [...]` with what `append` writes of each frame.
template <class Append>
void append_frames(std::string& text, const char* name, std::span<const UsdFrame> frames,
                   const Append& append) {
  text += std::string("            ") + name + " = [";
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (f > 0) text += ", ";
    append(f);
  }
  text += "]\n";
}

/// Which file is read at which time; times within the files are those of the series.
void append_clips(std::string& text, const std::filesystem::path& manifest,
                  std::span<const UsdFrame> frames) {
  const auto append_pair = [&](std::size_t f, const std::string& second) {
    text += '(' + std::to_string(frames[f].number) + ", " + second + ')';
  };
  text += "    clips = {\n        dictionary default = {\n";
  append_frames(text, "double2[] active", frames, [&](std::size_t f) { append_pair(f, std::to_string(f)); });
  append_frames(text, "asset[] assetPaths", frames,
                [&](std::size_t f) { text += asset_path(frames[f].file); });
  text += "            asset manifestAssetPath = " + asset_path(manifest) +
          "\n            string primPath = \"/surface\"\n";
  append_frames(text, "double2[] times", frames,
                [&](std::size_t f) { append_pair(f, std::to_string(frames[f].number)); });
  text += "        }\n    }\n";
}

/// Attributes of which a frame has values, without any. Those that it does not name keep the values of the
/// first frame.
std::string manifest_text(std::span<const UsdFrame> frames, std::span<const MeshBody> bodies,
                          const UsdOptions& options) {
  std::string text = usd_header(options, frames.front().number, frames.back().number);
  const auto declare = [&](const UsdAttribute& attribute) {
    text += std::string(attribute.depth * 4, ' ') + attribute.declaration;
    append_interpolation(text, attribute);
    text += '\n';
  };
  text += "def Xform \"surface\"\n{\n    def Mesh \"mesh\"\n    {\n";
  for (const UsdAttribute& attribute :
       {k_usd_extent, k_usd_counts, k_usd_corners, k_usd_points, k_usd_normals, k_usd_velocities})
    declare(attribute);
  if (bodies.size() > 1) {
    declare(k_usd_color);
    declare(k_usd_group);
    for (const std::string& name : name_bodies(bodies, usd_name).names) {
      text += "\n        def GeomSubset \"" + name + "\"\n        {\n";
      declare(k_usd_subset_indices);
      text += "        }\n";
    }
  }
  return text + "    }\n}\n";
}

}  // namespace

std::filesystem::path usda_manifest(const std::filesystem::path& series) {
  return std::filesystem::path(series).replace_extension(".manifest.usda");
}

void write_usda_series(const std::filesystem::path& file, std::span<const UsdFrame> frames,
                       std::span<const MeshBody> bodies, const UsdOptions& options) {
  require_ascending(frames);
  require_bodies(bodies);
  require_valid(options);
  if (frames.empty()) {
    write_whole(file, usd_header(options, {}, {}) + "def Xform \"surface\"\n{\n}\n");
    return;
  }

  const std::filesystem::path manifest = usda_manifest(file);
  std::string text =
      usd_header(options, frames.front().number, frames.back().number) + "def Xform \"surface\" (\n";
  append_clips(text, manifest.filename(), frames);
  // What no frame changes comes from the first: prims, materials, and which attributes there are.
  text += "    prepend references = " + asset_path(frames.front().file) +
          "\n)\n{\n    def Mesh \"mesh\"\n    {\n    }\n}\n";
  write_whole(manifest, manifest_text(frames, bodies, options));
  write_whole(file, text);
}

}  // namespace mallow
