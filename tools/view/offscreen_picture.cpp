#include "view/offscreen_picture.h"

#include <algorithm>

namespace mallow::view {
namespace {

render::Image read_bound(int width, int height) {
  render::Image image{.width = width, .height = height, .rgb = {}};
  const auto row = static_cast<std::size_t>(3 * width);
  image.rgb.resize(row * static_cast<std::size_t>(height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, image.rgb.data());
  for (int y = 0; y < height / 2; ++y)
    std::swap_ranges(image.rgb.begin() + static_cast<std::ptrdiff_t>(row) * y,
                     image.rgb.begin() + static_cast<std::ptrdiff_t>(row) * (y + 1),
                     image.rgb.begin() + static_cast<std::ptrdiff_t>(row) * (height - 1 - y));
  return image;
}

GLuint renderbuffer(GLenum format, int width, int height, int samples) {
  GLuint buffer = 0;
  glGenRenderbuffers(1, &buffer);
  glBindRenderbuffer(GL_RENDERBUFFER, buffer);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples > 1 ? samples : 0, format, width, height);
  return buffer;
}

}  // namespace

void OffscreenPicture::resize(int width, int height, int samples) {
  GLint most = 1;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  samples = std::clamp(samples, 1, std::max(1, most));
  if (width == width_ && height == height_ && samples == samples_ && framebuffer_ != 0) return;
  release();
  width_ = width;
  height_ = height;
  samples_ = samples;
  color_ = renderbuffer(GL_RGBA8, width, height, samples);
  depth_ = renderbuffer(GL_DEPTH_COMPONENT24, width, height, samples);
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  if (samples == 1) return;
  plain_color_ = renderbuffer(GL_RGBA8, width, height, 1);
  glGenFramebuffers(1, &plain_framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, plain_framebuffer_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, plain_color_);
}

void OffscreenPicture::release() {
  for (const GLuint buffer : {color_, depth_, plain_color_})
    if (buffer != 0) glDeleteRenderbuffers(1, &buffer);
  for (const GLuint buffer : {framebuffer_, plain_framebuffer_})
    if (buffer != 0) glDeleteFramebuffers(1, &buffer);
  color_ = depth_ = plain_color_ = framebuffer_ = plain_framebuffer_ = 0;
}

void OffscreenPicture::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, width_, height_);
}

GLuint OffscreenPicture::resolved() const {
  if (samples_ == 1) return framebuffer_;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, plain_framebuffer_);
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  return plain_framebuffer_;
}

void OffscreenPicture::show(int left, int bottom) const {
  const GLuint plain = resolved();
  glBindFramebuffer(GL_READ_FRAMEBUFFER, plain);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, width_, height_, left, bottom, left + width_, bottom + height_, GL_COLOR_BUFFER_BIT,
                    GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

render::Image OffscreenPicture::read() const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved());
  return read_bound(width_, height_);
}

render::Image read_window(int width, int height) {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  return read_bound(width, height);
}

}  // namespace mallow::view
