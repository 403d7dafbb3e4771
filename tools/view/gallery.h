#pragma once

#include <epoxy/gl.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "view/offscreen_picture.h"
#include "view/scene_drawer.h"
#include "view/stepping_thread.h"

namespace mallow::view {

/// A scene to choose.
struct GalleryScene {
  std::filesystem::path file;
  std::string name;   ///< "standard/drop"
  std::string about;  ///< the comment that the file begins with
};
/// The scenes of a folder and its folders, by name: those of the folder itself first.
std::vector<GalleryScene> find_scenes(const std::filesystem::path& folder);
/// Throws ConfigError where there are none: `option` names what said where to look.
void check_scenes(const std::filesystem::path& folder, const std::string& option);
/// Where the picture of a scene is kept: the name changes with the file.
std::filesystem::path thumbnail_file(const GalleryScene& scene);

/// Scenes with their pictures. Those that have none yet are run for a moment on a thread of their own while
/// nobody plays, and their pictures are kept in the user's cache.
class Gallery {
 public:
  explicit Gallery(const std::filesystem::path& folder);
  ~Gallery();
  Gallery(const Gallery&) = delete;
  Gallery& operator=(const Gallery&) = delete;

  /// Draws all of the window; returns the scene that was chosen.
  std::optional<std::filesystem::path> draw(double wall);
  /// Takes the picture of one more scene, bit by bit: to be called before draw().
  void make_thumbnails(double wall);
  /// Nobody looks at the gallery.
  void rest();
  const std::vector<GalleryScene>& scenes() const { return scenes_; }
  std::size_t missing() const;

 private:
  struct Maker;
  void finish_thumbnail();

  std::filesystem::path folder_;
  std::vector<GalleryScene> scenes_;
  std::vector<GLuint> pictures_;  ///< of each scene; 0: none yet
  std::vector<bool> tried_;
  std::vector<std::string> why_not_;  ///< there is no picture of it
  std::unique_ptr<Maker> maker_;
};

}  // namespace mallow::view
