#include "view/viewer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <utility>

#include <imgui.h>

namespace mallow::view {
namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

constexpr double k_picture_seconds = 1.0 / 60;
constexpr double k_idle_wait = 0.25;  ///< [s]
constexpr int k_settling = 3;         ///< pictures after an event, until panels have their sizes

}  // namespace

Viewer::Viewer(const ViewerOptions& options)
    : options_(options),
      window_(options.window, events()),
      drawer_(window_.draws_in_software() && options.samples <= 1),
      stepping_(std::make_unique<SteppingThread>(
          SessionOptions{.threads = options.threads, .lowers_threads = options.lowers_threads},
          Window::wake)) {
  if (options_.samples == 0) options_.samples = window_.draws_in_software() ? 1 : 4;
  if (!options.scene.empty()) open(options.scene);
}

WindowEvents Viewer::events() {
  const auto busy = [this] { busy_pictures_ = k_settling; };
  return {.key =
              [this, busy](int key, bool shift, bool repeated) {
                busy();
                on_key(key, shift, repeated);
              },
          .button =
              [this, busy](int button, bool pressed, bool shift) {
                busy();
                if (shows_gallery()) return;
                mouse_.button(button, pressed, shift, frame(), camera_, state_,
                              [this](auto command) { send(std::move(command)); });
                stale_ = true;
              },
          .moved =
              [this, busy](float x, float y) {
                busy();
                const bool was_at_work = mouse_.is_at_work();
                tell_mouse(x, y);
                stale_ = stale_ || was_at_work;
              },
          .wheel =
              [this, busy](float clicks) {
                busy();
                camera_.zoom(clicks);
                stale_ = true;
              }};
}

void Viewer::open(const std::filesystem::path& scene) {
  const bool is_run = std::filesystem::is_directory(scene);
  const std::filesystem::path file = is_run ? scene / "scene.toml" : scene;
  const Scene read = read_scene(file, options_.overrides, {.allow_outside_paths = is_run});
  end_film();
  is_rebuilt_ = false;
  run_folder_ = is_run ? scene.string() : "";
  settings_ = std::make_unique<SettingsModel>(read, options_.overrides);
  send([paused = options_.paused](Session& session) { session.set_paused(paused); });
  if (is_run)
    stepping_->open_run(scene.string());
  else
    stepping_->open(read);
  if (gallery_) gallery_->rest();
  window_.set_title("mallow: " + scene.filename().string());
}

Gallery& Viewer::gallery() {
  if (!gallery_) gallery_ = std::make_unique<Gallery>(options_.scenes);
  return *gallery_;
}

void Viewer::show_gallery() {
  end_film();
  settings_.reset();
  stale_ = true;
  send([](Session& session) { session.set_paused(true); });
  window_.set_title("mallow");
}

void Viewer::notice(const std::string& text) {
  state_.notice = text;
  state_.notice_since = wall_seconds();
  quiet_at_ = state_.notice_since + k_message_seconds;
}

Viewer::Area Viewer::area() const {
  const int width = window_.width(), height = window_.height();
  if (!state_.panels || width <= 2 * k_settings_width || height <= 2 * (k_top_height + state_.time_height))
    return {0, 0, width, height};
  return {0, k_top_height, width - k_settings_width, height - k_top_height - state_.time_height};
}

void Viewer::tell_mouse(float x, float y) {
  const Area seen = area();
  mouse_.move(x - static_cast<float>(seen.left), y - static_cast<float>(seen.top),
              static_cast<float>(seen.width), static_cast<float>(seen.height), camera_,
              [this](auto command) { send(std::move(command)); });
}

bool Viewer::take_frame() {
  if (!stepping_->take_frame()) return false;
  ++frames_taken_;
  const Frame& taken = frame();
  if (taken.building || !settings_) return true;
  if (taken.message_number != message_) {
    message_ = taken.message_number;
    state_.message_since = wall_seconds();
    quiet_at_ = state_.message_since + k_message_seconds;
  }
  if (taken.scene != scene_ || taken.camera_number != camera_number_)
    camera_ = OrbitCamera(taken.camera, taken.bounds);
  camera_.set_field_of_view(taken.camera.field_of_view);
  camera_number_ = taken.camera_number;
  if (taken.scene != scene_) {
    scene_ = taken.scene;
    drawer_.begin_scene(camera_, taken.bounds);
    settings_->was_rebuilt();
    if (std::exchange(is_rebuilt_, false)) run_folder_.clear();
  }
  settings_->take(taken);
  drawer_.take(taken);
  stale_ = true;
  return true;
}

void Viewer::draw_scene(int width, int height) {
  picture_.resize(width, height, options_.samples);
  camera_.set_aspect(static_cast<float>(width) / static_cast<float>(height));
  picture_.bind();
  drawer_.draw(camera_, width, height);
  picture_is_old_ = false;
}

void Viewer::draw_scene() {
  const Area seen = area();
  draw_scene(seen.width, seen.height);
  stale_ = false;
}

/// The picture that a film waits for, which has its own size: the window may change, or lie in the dock.
void Viewer::film_frame() {
  const Frame& taken = frame();
  if (!film_ || shows_gallery() || taken.building || !taken.finished || taken.number == filmed_) return;
  filmed_ = taken.number;
  const Area seen = area();
  draw_scene(film_->width(), film_->height());
  stale_ = seen.width != film_->width() || seen.height != film_->height();
  try {
    film_->add(picture_.read(), taken.stats.frame);
  } catch (const std::exception& error) {
    notice(std::string("no film: ") + error.what());
    film_.reset();
    send([](Session& session) { session.set_recording(false); });
  }
}

void Viewer::draw_next(bool may_wait) {
  const double rest = last_picture_ + k_picture_seconds - wall_seconds();
  // While a film's pictures are being written the next frame is left where it is: the scene waits for it.
  const bool film_is_busy = film_ && film_->is_busy();
  const bool works = (shows_gallery() && gallery().missing() > 0) || film_is_busy || joins_films();
  // One that lies there already wakes nobody.
  const bool film_goes_on = film_ && !film_is_busy && stepping_->has_frame();
  const double wait = busy_pictures_ > 0 || stale_ || works ? std::max(0.0, rest) : k_idle_wait;
  window_.poll(!may_wait || film_goes_on ? 0 : wait);
  const bool fresh = !film_is_busy && take_frame();
  if (fresh) {
    busy_pictures_ = std::max(busy_pictures_, 1);
    film_frame();
  }
  take_joined_films();
  if (wall_seconds() > quiet_at_) {
    quiet_at_ = std::numeric_limits<double>::infinity();
    busy_pictures_ = std::max(busy_pictures_, 1);
  }
  if (window_.width() == 0 || window_.height() == 0) {  // minimised
    if (!film_) window_.poll(k_idle_wait);
    return;
  }
  if (const Area seen = area(); picture_.width() != seen.width || picture_.height() != seen.height)
    stale_ = true;
  if (may_wait &&
      (!(stale_ || busy_pictures_ > 0 || works) || wall_seconds() < last_picture_ + 0.5 * k_picture_seconds))
    return;
  busy_pictures_ = std::max(0, busy_pictures_ - 1);
  last_picture_ = wall_seconds();
  drawn_.add(last_picture_);
  if (shows_gallery()) {
    gallery().make_thumbnails(last_picture_);
  }
  show_picture();
  ++pictures_;
  do_what_was_asked();
}

/// With one sample a pixel a scene that moves is drawn where it is seen, as a copy takes a tenth of the time;
/// one that stands lies ready for what moves above it.
void Viewer::show_picture() {
  const Area seen = area();
  const int bottom = window_.height() - seen.top - seen.height;
  const bool into_window = !shows_gallery() && stale_ && options_.samples <= 1;
  if (!shows_gallery() && !into_window && (stale_ || picture_is_old_)) draw_scene();
  // What lies behind panels is cleared, as that costs less than their own background.
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glClearColor(0.09f, 0.10f, 0.12f, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  if (into_window) {
    picture_.resize(seen.width, seen.height, options_.samples);
    camera_.set_aspect(static_cast<float>(seen.width) / static_cast<float>(seen.height));
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    drawer_.draw(camera_, seen.width, seen.height, seen.left, bottom);
    stale_ = false;
    picture_is_old_ = true;
  } else if (!shows_gallery()) {
    picture_.show(seen.left, bottom);
  }
  draw_gui();
  window_.swap();
}

void Viewer::draw_gui() {
  window_.begin_gui();
  if (shows_gallery()) {
    if (const auto chosen = gallery().draw(last_picture_)) {
      try {
        open(*chosen);
      } catch (const Error& error) {
        notice(error.what());
      }
    }
    draw_message({}, state_, last_picture_);
    draw_help(state_);
    window_.end_gui();
    return;
  }
  const Send send_command = [this](auto command) { send(std::move(command)); };
  if (state_.panels) {
    draw_top_bar(frame(), state_, drawn_.per_second(last_picture_));
    draw_time_bar(frame(), state_, film_ != nullptr, send_command);
    draw_settings(frame(), *settings_, state_, send_command);
    draw_legend(frame(), state_);
  }
  draw_message(frame(), state_, last_picture_);
  draw_help(state_);
  draw_marks();
  window_.end_gui();
}

Vec3 Viewer::on_screen(const Vec3& x) const {
  const Eigen::Vector4f clip = camera_.projection_view() * x.homogeneous();
  const Area seen = area();
  return {static_cast<float>(seen.left) + 0.5f * (1 + clip.x() / clip.w()) * static_cast<float>(seen.width),
          static_cast<float>(seen.top) + 0.5f * (1 - clip.y() / clip.w()) * static_cast<float>(seen.height),
          clip.w()};
}

void Viewer::draw_marks() {
  draw_placed_marks();
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  constexpr ImU32 k_mark = IM_COL32(255, 160, 50, 230);
  if (frame().grab) {
    const Vec3 from = on_screen((*frame().grab)[0]), to = on_screen((*frame().grab)[1]);
    list.AddLine(ImVec2(from.x(), from.y()), ImVec2(to.x(), to.y()), k_mark, 2.5f);
    list.AddCircleFilled(ImVec2(from.x(), from.y()), 5, k_mark);
    list.AddCircleFilled(ImVec2(to.x(), to.y()), 4, k_mark);
  }
  const auto left = static_cast<float>(area().left), top = static_cast<float>(area().top);
  if (const auto& from = mouse_.cut_from())
    list.AddLine(ImVec2(left + from->x(), top + from->y()), ImVec2(left + mouse_.x(), top + mouse_.y()),
                 k_mark, 2.5f);
}

std::array<double, 2> Viewer::measure_drawing(int pictures) {
  const auto started = wall_seconds();
  const std::clock_t processor = std::clock();
  for (int k = 0; k < pictures; ++k) {
    camera_.turn(4, 0);
    // As while a scene moves.
    drawer_.take(frame());
    stale_ = true;
    show_picture();
    glFinish();
  }
  return {(wall_seconds() - started) / pictures,
          static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC / pictures};
}

}  // namespace mallow::view
