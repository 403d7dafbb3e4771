#include "view/window.h"

#include <epoxy/gl.h>
// After the loader.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>

#include "program/failure.h"

namespace mallow::view {
namespace {

std::string last_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "no reason is given";
}

void set_style() {
  ImGui::StyleColorsDark();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0;
  style.FrameRounding = 4;
  style.GrabRounding = 4;
  style.WindowBorderSize = 0;
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.09f, 0.10f, 0.12f, 1);
  style.Colors[ImGuiCol_SliderGrab] = ImVec4(0.98f, 0.62f, 0.22f, 1);
  style.Colors[ImGuiCol_SliderGrabActive] = ImVec4(1, 0.75f, 0.35f, 1);
  style.Colors[ImGuiCol_CheckMark] = ImVec4(0.98f, 0.62f, 0.22f, 1);
}

/// Round corners and soft edges take a third of the time of panels where no graphics card draws.
void set_plain_style() {
  ImGuiStyle& style = ImGui::GetStyle();
  style.FrameRounding = style.GrabRounding = 0;
  style.AntiAliasedLines = style.AntiAliasedFill = false;
}

void set_font() {
  // Units have letters beyond Latin: m/s², α, κ, τ.
  static const ImWchar k_letters[] = {0x20,   0xFF,   0x370,  0x3FF,  0x2010, 0x2027,
                                      0x2190, 0x2193, 0x2212, 0x2212, 0};
  ImGuiIO& io = ImGui::GetIO();
  for (const char* file : {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"})
    if (FILE* found = std::fopen(file, "rb")) {
      std::fclose(found);
      io.Fonts->AddFontFromFileTTF(file, 14, nullptr, k_letters);
    }
  if (io.Fonts->Fonts.empty()) io.Fonts->AddFontDefault();
}

}  // namespace

Window::Window(const Options& options, WindowEvents events) : events_(std::move(events)) {
  if (!glfwInit()) throw program::RunFailure("mallow view opens no window: " + last_error());
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_VISIBLE, options.visible ? GLFW_TRUE : GLFW_FALSE);
  glfwWindowHint(GLFW_DEPTH_BITS, 24);
  glfwWindowHint(GLFW_STENCIL_BITS, 0);
  window_ = glfwCreateWindow(options.width, options.height, "mallow", nullptr, nullptr);
  if (window_ == nullptr) {
    const std::string why = last_error();
    glfwTerminate();
    throw program::RunFailure("mallow view needs OpenGL 3.3: " + why);
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(options.wait_for_screen ? 1 : 0);
  renderer_ = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  glfwGetFramebufferSize(window_, &width_, &height_);
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  set_style();
  if (draws_in_software()) set_plain_style();
  set_font();
  set_callbacks();
  ImGui_ImplGlfw_InitForOpenGL(window_, false);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

Window& Window::of(GLFWwindow* window) {
  return *static_cast<Window*>(glfwGetWindowUserPointer(window));
}

void Window::set_callbacks() {
  glfwSetWindowUserPointer(window_, this);
  glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* window, int width, int height) {
    of(window).width_ = width;
    of(window).height_ = height;
  });
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int code, int action, int modifiers) {
    ImGui_ImplGlfw_KeyCallback(window, key, code, action, modifiers);
    if (action != GLFW_RELEASE && !ImGui::GetIO().WantTextInput)
      of(window).events_.key(key, (modifiers & GLFW_MOD_SHIFT) != 0, action == GLFW_REPEAT);
  });
  glfwSetCharCallback(window_, ImGui_ImplGlfw_CharCallback);
  glfwSetWindowFocusCallback(window_, ImGui_ImplGlfw_WindowFocusCallback);
  glfwSetCursorEnterCallback(window_, ImGui_ImplGlfw_CursorEnterCallback);
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int modifiers) {
    ImGui_ImplGlfw_MouseButtonCallback(window, button, action, modifiers);
    // What was pressed outside of the panels is let go of wherever the mouse is.
    if (action == GLFW_RELEASE || !ImGui::GetIO().WantCaptureMouse)
      of(window).events_.button(button, action == GLFW_PRESS, (modifiers & GLFW_MOD_SHIFT) != 0);
  });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
    of(window).events_.moved(static_cast<float>(x), static_cast<float>(y));
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* window, double x, double y) {
    ImGui_ImplGlfw_ScrollCallback(window, x, y);
    if (!ImGui::GetIO().WantCaptureMouse) of(window).events_.wheel(static_cast<float>(y));
  });
}

bool Window::should_close() const {
  return glfwWindowShouldClose(window_) != 0;
}
void Window::close() {
  glfwSetWindowShouldClose(window_, GLFW_TRUE);
}
void Window::poll(double longest_wait) {
  if (longest_wait > 0)
    glfwWaitEventsTimeout(longest_wait);
  else
    glfwPollEvents();
}
void Window::wake() {
  glfwPostEmptyEvent();
}
void Window::resize(int width, int height) {
  glfwSetWindowSize(window_, width, height);
}
void Window::minimise() {
  glfwIconifyWindow(window_);
}
void Window::restore() {
  glfwRestoreWindow(window_);
}
void Window::set_title(const std::string& title) {
  glfwSetWindowTitle(window_, title.c_str());
}
void Window::copy(const std::string& text) {
  glfwSetClipboardString(window_, text.c_str());
}
std::string Window::copied() const {
  const char* const text = glfwGetClipboardString(window_);
  return text ? text : "";
}

void Window::begin_gui() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  if (scripted_mouse_) {
    ImGui::GetIO().MousePos = *scripted_mouse_;
    for (int k = 0; k < 3; ++k) ImGui::GetIO().MouseDown[k] = scripted_buttons_[k];
  }
  ImGui::NewFrame();
}

void Window::end_gui() {
  ImGui::Render();
  glViewport(0, 0, width_, height_);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Window::swap() {
  glfwSwapBuffers(window_);
}

void Window::send_key(int key, bool shift) {
  events_.key(key, shift, false);
}
void Window::send_button(int button, bool pressed, bool shift) {
  scripted_buttons_[button] = pressed;
  if (!pressed || !ImGui::GetIO().WantCaptureMouse) events_.button(button, pressed, shift);
}
void Window::send_move(float x, float y) {
  scripted_mouse_ = ImVec2(x, y);
  events_.moved(x, y);
}

bool Window::draws_in_software() const {
  return renderer_.find("llvmpipe") != std::string::npos || renderer_.find("softpipe") != std::string::npos;
}

}  // namespace mallow::view
