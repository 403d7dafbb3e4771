#pragma once

#include <functional>
#include <optional>
#include <string>

#include <imgui.h>

struct GLFWwindow;

namespace mallow::view {

/// What the window tells of the hand. Pixels are those of the window from its upper left corner.
struct WindowEvents {
  std::function<void(int key, bool shift, bool repeated)> key;
  std::function<void(int button, bool pressed, bool shift)> button;
  std::function<void(float x, float y)> moved;
  std::function<void(float clicks)> wheel;
};

/// A window with OpenGL 3.3 and Dear ImGui in it.
class Window {
 public:
  struct Options {
    int width = 1280, height = 720;
    bool visible = true;
    bool wait_for_screen = true;  ///< a picture for each that the screen shows, where the driver can
  };
  /// Throws RunFailure where there is no display or no OpenGL 3.3.
  Window(const Options& options, WindowEvents events);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  bool should_close() const;
  void close();
  /// Takes events: those that are there, or after a wait for the first one, of so many seconds at most.
  void poll(double longest_wait);
  /// Ends a wait in poll(); any thread may call it.
  static void wake();
  int width() const { return width_; }    ///< of the framebuffer; 0 while minimised
  int height() const { return height_; }  ///< the same
  void resize(int width, int height);
  void minimise();
  void restore();
  void set_title(const std::string& title);
  void copy(const std::string& text);
  std::string copied() const;

  void begin_gui();
  /// Draws what was said since begin_gui().
  void end_gui();
  void swap();

  // As if the hand did it, for scripts.
  void send_key(int key, bool shift);
  void send_button(int button, bool pressed, bool shift);
  void send_move(float x, float y);
  void send_wheel(float clicks) { events_.wheel(clicks); }

  /// What draws, as the driver calls it.
  const std::string& renderer() const { return renderer_; }
  bool draws_in_software() const;

 private:
  static Window& of(GLFWwindow* window);
  void set_callbacks();

  WindowEvents events_;
  GLFWwindow* window_ = nullptr;
  int width_ = 0, height_ = 0;
  std::string renderer_;
  std::optional<ImVec2> scripted_mouse_;
  bool scripted_buttons_[3] = {false, false, false};
};

}  // namespace mallow::view
