#include "view/gl_program.h"

#include <vector>

#include "program/failure.h"

namespace mallow::view {
namespace {

GLuint compiled(GLenum kind, const std::string& text) {
  const GLuint shader = glCreateShader(kind);
  const char* const lines = text.c_str();
  glShaderSource(shader, 1, &lines, nullptr);
  glCompileShader(shader);
  GLint done = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  if (done) return shader;
  std::vector<char> said(4096);
  glGetShaderInfoLog(shader, static_cast<GLsizei>(said.size()), nullptr, said.data());
  throw program::RunFailure(std::string("a shader does not compile here: ") + said.data());
}

}  // namespace

GlProgram::GlProgram(const std::string& vertex, const std::string& fragment) : program_(glCreateProgram()) {
  const GLuint parts[] = {compiled(GL_VERTEX_SHADER, vertex), compiled(GL_FRAGMENT_SHADER, fragment)};
  for (const GLuint part : parts) glAttachShader(program_, part);
  glLinkProgram(program_);
  for (const GLuint part : parts) glDeleteShader(part);
  GLint done = 0;
  glGetProgramiv(program_, GL_LINK_STATUS, &done);
  if (done) return;
  std::vector<char> said(4096);
  glGetProgramInfoLog(program_, static_cast<GLsizei>(said.size()), nullptr, said.data());
  throw program::RunFailure(std::string("shaders do not link here: ") + said.data());
}

GLint GlProgram::place(const char* name) {
  const auto [found, is_new] = places_.emplace(name, -1);
  if (is_new) found->second = glGetUniformLocation(program_, name);
  return found->second;
}

}  // namespace mallow::view
