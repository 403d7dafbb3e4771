#include "view/gallery.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <limits>

#include <imgui.h>
#include "program/fnv.h"

namespace mallow::view {
namespace fs = std::filesystem;
namespace {

constexpr int k_width = 288, k_height = 162;  ///< of a picture
constexpr int k_pictured_frame = 45;          ///< at the earliest; of long scenes at two fifths
constexpr double k_patience = 6;              ///< [s] for one picture

/// The comment at the beginning of a file, as one line.
std::string first_comment(const fs::path& file) {
  std::ifstream lines(file);
  std::string about;
  for (std::string line; std::getline(lines, line) && line.starts_with('#');)
    about +=
        (about.empty() ? "" : " ") +
        line.substr(line.find_first_not_of("# ") == line.npos ? line.size() : line.find_first_not_of("# "));
  return about;
}

fs::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) return fs::path(cache) / "mallow";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "mallow";
  return fs::temp_directory_path() / "mallow";
}

// Pictures in the cache are PPM, which takes no library to read.
void write_picture(const fs::path& file, const render::Image& image) {
  std::error_code ignored;
  fs::create_directories(file.parent_path(), ignored);
  const fs::path beside = file.string() + ".part";
  {
    std::ofstream out(beside, std::ios::binary);
    out << "P6 " << image.width << ' ' << image.height << " 255\n";
    out.write(reinterpret_cast<const char*>(image.rgb.data()),
              static_cast<std::streamsize>(image.rgb.size()));
    if (!out) return;  // a cache that cannot be written is none
  }
  fs::rename(beside, file, ignored);
}

std::optional<render::Image> read_picture(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string kind;
  int most = 0;
  render::Image image;
  if (!(in >> kind >> image.width >> image.height >> most) || kind != "P6" || most != 255)
    return std::nullopt;
  if (image.width != k_width || image.height != k_height) return std::nullopt;
  in.get();
  image.rgb.resize(3 * static_cast<std::size_t>(k_width * k_height));
  in.read(reinterpret_cast<char*>(image.rgb.data()), static_cast<std::streamsize>(image.rgb.size()));
  if (!in) return std::nullopt;
  return image;
}

GLuint texture_of(const render::Image& image) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, image.width, image.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
               image.rgb.data());
  return texture;
}

}  // namespace

std::vector<GalleryScene> find_scenes(const fs::path& folder) {
  std::vector<GalleryScene> scenes;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, error)) {
    if (!entry.is_regular_file() || entry.path().extension() != ".toml") continue;
    const fs::path name = fs::relative(entry.path(), folder).replace_extension();
    scenes.push_back({entry.path(), name.generic_string(), first_comment(entry.path())});
  }
  std::ranges::sort(scenes, {}, [](const GalleryScene& scene) {
    return std::pair(std::ranges::count(scene.name, '/'), scene.name);
  });
  return scenes;
}

void check_scenes(const fs::path& folder, const std::string& option) {
  const char* const allowed =
      "give a folder with scene files (*.toml) in it or below, or a scene: mallow view SCENE";
  if (!fs::is_directory(folder))
    throw ConfigError(option, "'" + folder.string() + "' is no folder; " + allowed);
  if (find_scenes(folder).empty())
    throw ConfigError(option, "there are no scenes in '" + folder.string() + "'; " + allowed);
}

fs::path thumbnail_file(const GalleryScene& scene) {
  std::error_code error;
  const std::string key = fs::absolute(scene.file).string() + '\n' +
                          std::to_string(fs::last_write_time(scene.file, error).time_since_epoch().count());
  return cache_folder() / "thumbnails" / (std::to_string(program::fnv(key)) + ".ppm");
}

/// The scene whose picture is being made.
struct Gallery::Maker {
  std::size_t scene;
  double started;
  int pictured_frame;
  SteppingThread thread{SessionOptions{.threads = 1, .rewind_bytes = 1}, {}};
  SceneDrawer drawer;
  OffscreenPicture picture;
  OrbitCamera camera;
  int built = -1;
};

Gallery::Gallery(const fs::path& folder)
    : folder_(folder),
      scenes_(find_scenes(folder)),
      pictures_(scenes_.size(), 0),
      tried_(scenes_.size(), false),
      why_not_(scenes_.size()) {
  for (std::size_t k = 0; k < scenes_.size(); ++k)
    if (const auto picture = read_picture(thumbnail_file(scenes_[k]))) pictures_[k] = texture_of(*picture);
}

Gallery::~Gallery() {
  glDeleteTextures(static_cast<GLsizei>(pictures_.size()), pictures_.data());
}

void Gallery::rest() {
  maker_.reset();
}

std::size_t Gallery::missing() const {
  std::size_t count = 0;
  for (std::size_t k = 0; k < scenes_.size(); ++k) count += pictures_[k] == 0 && !tried_[k] ? 1 : 0;
  return count;
}

void Gallery::make_thumbnails(double wall) {
  if (maker_) {
    const bool fresh = maker_->thread.take_frame();
    const Frame& frame = maker_->thread.frame();
    if (fresh && !frame.building && !frame.mesh.triangles.empty() && frame.scene != maker_->built) {
      maker_->built = frame.scene;
      maker_->camera = OrbitCamera(frame.camera, frame.bounds);
      maker_->camera.set_aspect(static_cast<float>(k_width) / k_height);
      maker_->drawer.begin_scene(maker_->camera, frame.bounds);
    }
    const bool late = wall - maker_->started > k_patience && maker_->built >= 0;
    if (fresh && frame.failed) {
      why_not_[maker_->scene] = frame.message;
      maker_.reset();
    } else if (fresh && maker_->built >= 0 && (frame.stats.frame >= maker_->pictured_frame || late)) {
      finish_thumbnail();
    }
    return;
  }
  for (std::size_t k = 0; k < scenes_.size(); ++k) {
    if (pictures_[k] != 0 || tried_[k]) continue;
    tried_[k] = true;
    try {
      Scene scene = read_scene(scenes_[k].file);
      maker_ = std::unique_ptr<Maker>(
          new Maker{.scene = k,
                    .started = wall,
                    .pictured_frame = std::max(k_pictured_frame, 2 * scene.run.frames / 5),
                    .drawer = SceneDrawer(false),
                    .picture = {},
                    .camera = {}});
      maker_->thread.open(scene);
      maker_->thread.send(
          [](Session& session) { session.set_speed(std::numeric_limits<double>::infinity()); });
    } catch (const Error& error) {  // it lacks a mesh, say
      why_not_[k] = error.what();
      maker_.reset();
    }
    return;
  }
}

void Gallery::finish_thumbnail() {
  maker_->drawer.take(maker_->thread.frame());
  maker_->picture.resize(k_width, k_height, 4);
  maker_->picture.bind();
  maker_->drawer.draw(maker_->camera, k_width, k_height);
  const render::Image image = maker_->picture.read();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  write_picture(thumbnail_file(scenes_[maker_->scene]), image);
  pictures_[maker_->scene] = texture_of(image);
  maker_.reset();
}

std::optional<fs::path> Gallery::draw(double) {
  std::optional<fs::path> chosen;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0, 0));
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("gallery", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::SetWindowFontScale(1.5f);
  ImGui::TextUnformatted("mallow");
  ImGui::SetWindowFontScale(1);
  if (scenes_.empty())  // since the start
    ImGui::TextWrapped("There are no scenes in %s. Open one: mallow view SCENE", folder_.string().c_str());
  else
    ImGui::TextDisabled("choose a scene to play with; what the mouse and the keys do is under ? (H)");
  const float cell = k_width + 14;
  const int columns = std::max(1, static_cast<int>((size.x - 30) / cell));
  for (std::size_t k = 0; k < scenes_.size(); ++k) {
    if (static_cast<int>(k) % columns != 0) ImGui::SameLine();
    ImGui::PushID(static_cast<int>(k));
    ImGui::BeginGroup();
    const ImVec2 form(k_width, k_height);
    const bool pressed =
        pictures_[k] != 0
            ? ImGui::ImageButton(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(pictures_[k])),
                                 form, ImVec2(0, 0), ImVec2(1, 1), 2)
            : ImGui::Button(!why_not_[k].empty() ? "cannot be opened"
                            : tried_[k]          ? "..."
                                                 : scenes_[k].name.c_str(),
                            ImVec2(k_width + 4, k_height + 4));
    if (ImGui::IsItemHovered() && !(scenes_[k].about.empty() && why_not_[k].empty())) {
      ImGui::BeginTooltip();
      ImGui::PushTextWrapPos(420);
      ImGui::TextUnformatted(scenes_[k].about.c_str());
      ImGui::TextUnformatted(why_not_[k].c_str());
      ImGui::PopTextWrapPos();
      ImGui::EndTooltip();
    }
    ImGui::TextUnformatted(scenes_[k].name.c_str());
    ImGui::EndGroup();
    ImGui::PopID();
    if (pressed) chosen = scenes_[k].file;
  }
  ImGui::End();
  return chosen;
}

}  // namespace mallow::view
