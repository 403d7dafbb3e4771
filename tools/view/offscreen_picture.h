#pragma once

#include <epoxy/gl.h>

#include "render/renderer.h"

namespace mallow::view {

/// A picture of its own that is drawn into, with several samples a pixel where asked for, and then shown in
/// the window or read.
class OffscreenPicture {
 public:
  OffscreenPicture() = default;
  ~OffscreenPicture() { release(); }
  OffscreenPicture(const OffscreenPicture&) = delete;
  OffscreenPicture& operator=(const OffscreenPicture&) = delete;

  /// samples: a pixel, 1 for none.
  void resize(int width, int height, int samples);
  int width() const { return width_; }
  int height() const { return height_; }
  /// What is drawn from now on goes here.
  void bind() const;
  /// To the window, with its lower left corner there.
  void show(int left, int bottom) const;
  render::Image read() const;

 private:
  void release();
  /// One sample a pixel of what was drawn, in the framebuffer that is returned.
  GLuint resolved() const;

  int width_ = 0, height_ = 0, samples_ = 1;
  GLuint framebuffer_ = 0, color_ = 0, depth_ = 0;
  GLuint plain_framebuffer_ = 0, plain_color_ = 0;
};

/// What the window shows now, panels and all.
render::Image read_window(int width, int height);

}  // namespace mallow::view
