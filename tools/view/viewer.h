#pragma once

#include <filesystem>
#include <future>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "view/camera.h"
#include "view/film_recorder.h"
#include "view/gallery.h"
#include "view/mouse.h"
#include "view/offscreen_picture.h"
#include "view/panels.h"
#include "view/scene_drawer.h"
#include "view/settings_model.h"
#include "view/stepping_thread.h"
#include "view/window.h"

namespace mallow::view {

struct ViewerOptions {
  std::filesystem::path scene;   ///< a scene file, or the folder of a run; empty: the gallery
  std::filesystem::path scenes;  ///< folder of the gallery
  std::vector<std::string> overrides;
  int threads = 1;
  bool lowers_threads = false;  ///< beside other programs
  int samples = 0;              ///< a pixel; 0: 4, or 1 where the driver draws in software
  Window::Options window;
  bool paused = false;
};

/// The window's side: takes frames of the stepping thread, draws them and the panels, and turns what the hand
/// does into commands.
class Viewer {
 public:
  explicit Viewer(const ViewerOptions& options);
  /// Closed while a film is recorded, it makes the film of what there is, and prints where it is.
  ~Viewer();

  bool is_open() const { return !window_.should_close(); }
  /// Takes events and draws a picture where something has changed. may_wait: until then.
  void draw_next(bool may_wait);

  void open(const std::filesystem::path& scene);
  Window& window() { return window_; }
  const Frame& frame() { return stepping_->frame(); }
  OrbitCamera& camera() { return camera_; }
  ViewState& state() { return state_; }
  SettingsModel* settings() { return settings_.get(); }
  Gallery& gallery();
  bool shows_gallery() const { return !settings_; }
  void send(std::function<void(Session&)> command) { stepping_->send(std::move(command)); }
  /// The part of the window that shows the scene, in pixels from its upper left corner.
  struct Area {
    int left, top, width, height;
  };
  Area area() const;
  /// Frames that were taken from the stepping thread, and pictures that were drawn.
  std::uint64_t frames_taken() const { return frames_taken_; }
  std::uint64_t pictures() const { return pictures_; }
  /// That is being recorded, or null.
  const FilmRecorder* film() const { return film_.get(); }
  bool joins_films() const { return !joining_.empty(); }
  /// Of the scene alone, without panels.
  render::Image scene_picture() {
    if (picture_is_old_) draw_scene();
    return picture_.read();
  }
  /// Draws the scene again and again, and gives wall and processor time of one picture [s].
  std::array<double, 2> measure_drawing(int pictures);
  std::size_t triangles() const { return drawer_.triangles(); }

 private:
  WindowEvents events();
  void on_key(int key, bool shift, bool repeated);
  bool take_frame();
  void draw_scene();
  void draw_scene(int width, int height);
  void film_frame();
  void show_picture();
  void draw_gui();
  void draw_marks();
  void draw_placed_marks();
  void do_what_was_asked();
  void begin_film();
  void end_film();
  void take_joined_films();
  void notice(const std::string& text);
  void show_gallery();
  Vec3 on_screen(const Vec3& x) const;
  void tell_mouse(float x, float y);

  ViewerOptions options_;
  Window window_;
  SceneDrawer drawer_;
  OffscreenPicture picture_;
  OrbitCamera camera_;
  Mouse mouse_;
  ViewState state_;
  std::unique_ptr<Gallery> gallery_;
  std::unique_ptr<SettingsModel> settings_;
  std::unique_ptr<FilmRecorder> film_;
  std::vector<std::future<std::string>> joining_;  ///< films that are not written yet
  std::uint64_t filmed_ = 0;                       ///< number of the last frame in a film, see Frame
  Rate drawn_;
  int scene_ = -1;              ///< that is drawn, see Frame
  bool is_rebuilt_ = false;     ///< the next scene is the same one, from its start
  std::string run_folder_;      ///< that the scene was opened from; empty: from its file
  bool stale_ = true;           ///< the picture of the scene is
  bool picture_is_old_ = true;  ///< what is seen was drawn into the window itself
  int busy_pictures_ = 0;       ///< that are drawn after the last event, so that panels settle
  double last_picture_ = 0;
  double quiet_at_ = std::numeric_limits<double>::infinity();  ///< a message goes then [s]
  int message_ = 0, camera_number_ = 0;                        ///< see Frame
  std::uint64_t frames_taken_ = 0, pictures_ = 0;
  std::unique_ptr<SteppingThread> stepping_;  // last: its thread wakes the window
};

}  // namespace mallow::view
