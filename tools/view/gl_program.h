#pragma once

#include <epoxy/gl.h>

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <span>
#include <string>

#include "mallow/vec3.h"

namespace mallow::view {

/// A vertex and a fragment shader, linked. Throws RunFailure with what the driver says.
class GlProgram {
 public:
  GlProgram(const std::string& vertex, const std::string& fragment);
  ~GlProgram() { glDeleteProgram(program_); }
  GlProgram(const GlProgram&) = delete;
  GlProgram& operator=(const GlProgram&) = delete;

  void use() const { glUseProgram(program_); }
  // Of the program in use; names that the driver dropped are passed over.
  void set(const char* name, int value) { glUniform1i(place(name), value); }
  void set(const char* name, float value) { glUniform1f(place(name), value); }
  void set(const char* name, const Vec3& value) { glUniform3fv(place(name), 1, value.data()); }
  void set(const char* name, float x, float y) { glUniform2f(place(name), x, y); }
  void set(const char* name, const Eigen::Matrix4f& value) {
    glUniformMatrix4fv(place(name), 1, GL_FALSE, value.data());
  }
  void set(const char* name, std::span<const Vec3> values) {
    glUniform3fv(place(name), static_cast<GLsizei>(values.size()), values.front().data());
  }

 private:
  GLint place(const char* name);

  GLuint program_ = 0;
  std::map<std::string, GLint> places_;
};

/// A buffer of vertices that is filled again and again.
class GlBuffer {
 public:
  GlBuffer() { glGenBuffers(1, &buffer_); }
  ~GlBuffer() { glDeleteBuffers(1, &buffer_); }
  GlBuffer(const GlBuffer&) = delete;
  GlBuffer& operator=(const GlBuffer&) = delete;

  /// target: GL_ARRAY_BUFFER or GL_ELEMENT_ARRAY_BUFFER. What was in it is let go of, so that a picture that
  /// is still being drawn is not waited for.
  template <class T>
  void fill(GLenum target, std::span<const T> values) {
    glBindBuffer(target, buffer_);
    glBufferData(target, static_cast<GLsizeiptr>(values.size_bytes()), values.data(), GL_STREAM_DRAW);
  }
  void bind(GLenum target) const { glBindBuffer(target, buffer_); }

 private:
  GLuint buffer_ = 0;
};

}  // namespace mallow::view
