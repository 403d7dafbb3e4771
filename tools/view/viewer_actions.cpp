// What keys and buttons ask the viewer for.
#include <epoxy/gl.h>
// After the loader.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
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
    case GLFW_KEY_U:
      state_.release_pins = true;
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

void Viewer::begin_film() {
  const Area seen = area();
  film_ = std::make_unique<FilmRecorder>(
      free_name("view", ".mp4"), settings_->scene().render.frames_per_second, seen.width, seen.height);
  send([](Session& session) {
    session.set_recording(true);
    session.set_paused(false);
  });
}

void Viewer::end_film() {
  if (!film_) return;
  send([](Session& session) { session.set_recording(false); });
  joining_.push_back(FilmRecorder::finish(std::move(film_)));
}

/// Says where films are that have been joined meanwhile.
void Viewer::take_joined_films() {
  std::erase_if(joining_, [this](std::future<std::string>& film) {
    if (film.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    try {
      notice(film.get());
    } catch (const std::exception& error) {
      notice(error.what());
    }
    busy_pictures_ = std::max(busy_pictures_, 1);
    return true;
  });
}

Viewer::~Viewer() {
  if (film_) joining_.push_back(FilmRecorder::finish(std::move(film_)));
  for (std::future<std::string>& film : joining_) {
    try {
      std::puts(film.get().c_str());
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
    }
  }
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
    is_rebuilt_ = true;
    stepping_->rebuild(settings_->to_rebuild());
  }
  if (asked(state_.release_pins)) send([](Session& session) { session.release_pins(); });
  if (asked(state_.save)) {
    const std::string folder = free_name("view_" + settings_->scene().file.stem().string(), "").string();
    send([folder](Session& session) { session.save_run(folder); });
  }
  if (asked(state_.copy)) {
    std::vector<std::string> without;
    if (frame().touched) without.emplace_back("what the mouse did");
    if (frame().stats.rung != k_as_written) without.emplace_back("its place between realtime and accurate");
    const std::string line = settings_->command_line(run_folder_, without);
    window_.copy(line);
    notice("copied: " + line);
  }
  if (asked(state_.film)) film_ ? end_film() : begin_film();
} catch (const std::exception& error) {
  notice(error.what());
}

}  // namespace mallow::view
