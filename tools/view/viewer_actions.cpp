// What keys and buttons ask the viewer for.
#include <epoxy/gl.h>
// After the loader.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "view/viewer.h"

namespace mallow::view {

void Viewer::on_key(int key, bool, bool repeated) {
  if (key == GLFW_KEY_BACKSPACE) state_.back = true;
  if (key == GLFW_KEY_PERIOD) state_.step = true;
  if (repeated) return;
  if (key >= GLFW_KEY_1 && key < GLFW_KEY_1 + static_cast<int>(k_tool_names.size()))
    state_.tool = static_cast<Tool>(key - GLFW_KEY_1);
  const auto set_speed = [&](double speed) {
    state_.as_fast_as_possible = false;
    state_.speed = std::clamp(speed, 0.05, 4.0);
    send([now = state_.speed](Session& session) { session.set_speed(now); });
  };
  switch (key) {
    case GLFW_KEY_SPACE:
      state_.pause = true;
      break;
    case GLFW_KEY_R:
      state_.reset = true;
      break;
    case GLFW_KEY_F:
      state_.film = true;
      break;
    case GLFW_KEY_S:
      state_.save = true;
      break;
    case GLFW_KEY_C:
      state_.copy = true;
      break;
    case GLFW_KEY_H:
      state_.help = !state_.help;
      break;
    case GLFW_KEY_TAB:
      state_.panels = !state_.panels;
      break;
    case GLFW_KEY_HOME:
      state_.camera = true;
      break;
    case GLFW_KEY_ESCAPE:
      state_.gallery = true;
      break;
    case GLFW_KEY_LEFT_BRACKET:
      set_speed(state_.speed / 2);
      break;
    case GLFW_KEY_RIGHT_BRACKET:
      set_speed(state_.speed * 2);
      break;
    case GLFW_KEY_EQUAL:
      state_.as_fast_as_possible = true;
      send([](Session& session) { session.set_speed(std::numeric_limits<double>::infinity()); });
      break;
    case GLFW_KEY_P:
    case GLFW_KEY_K:
      if (key == GLFW_KEY_P)
        state_.drawn = state_.drawn == Drawn::surface ? Drawn::particles : Drawn::surface;
      else
        state_.shown =
            static_cast<Shown>((static_cast<std::size_t>(state_.shown) + 1) % k_shown_names.size());
      if (key == GLFW_KEY_K) state_.drawn = Drawn::particles;
      send([drawn = state_.drawn, shown = state_.shown](Session& session) { session.show(drawn, shown); });
      break;
    default:
      break;
  }
}

void Viewer::toggle_film() {
  if (film_) {
    send([](Session& session) { session.set_recording(false); });
    notice(film_->finish());
    film_.reset();
    return;
  }
  film_.emplace(free_name("view", ".mp4"), settings_->scene().render.frames_per_second);
  send([](Session& session) {
    session.set_recording(true);
    session.set_paused(false);
  });
}

void Viewer::do_what_was_asked() try {
  const auto asked = [](bool& flag) { return std::exchange(flag, false); };
  if (asked(state_.gallery)) {
    if (!shows_gallery()) return show_gallery();
    return;
  }
  if (!settings_) return;
  if (asked(state_.pause)) send([](Session& session) { session.set_paused(!session.is_paused()); });
  if (asked(state_.step)) send([](Session& session) { session.step_once(); });
  if (asked(state_.back)) send([](Session& session) { session.go_back(); });
  if (asked(state_.reset)) send([](Session& session) { session.reset(); });
  if (state_.go_to)
    send([time = *std::exchange(state_.go_to, {})](Session& session) { session.go_to(time); });
  if (asked(state_.camera)) {
    camera_ = OrbitCamera(frame().camera, frame().bounds);
    stale_ = true;
  }
  if (asked(state_.rebuild)) {
    settings_->was_rebuilt();
    stepping_->open(settings_->scene());
  }
  if (asked(state_.save)) {
    const std::string folder = free_name("view_" + settings_->scene().file.stem().string(), "").string();
    send([folder](Session& session) { session.save_run(folder); });
  }
  if (asked(state_.copy)) {
    const std::string line = settings_->command_line();
    window_.copy(line);
    notice("copied: " + line);
  }
  if (asked(state_.film)) toggle_film();
} catch (const std::exception& error) {
  film_.reset();
  notice(error.what());
}

}  // namespace mallow::view
