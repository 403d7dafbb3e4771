#include "view/backdrop.h"

#include "view/shaders.h"

namespace mallow::view {
namespace {

// Cells along an edge where the backdrop is drawn as a grid: what lies between is told apart by no eye.
constexpr int k_studio_cells = 12, k_floor_cells = 16;

std::string on_grid(const char* light, const char* vertex) {
  return with_light(true, std::string(light) + shaders::k_plain_grid + vertex);
}

void draw_cells(GlProgram& program, int cells) {
  program.set("cells", cells);
  glDrawArrays(GL_TRIANGLES, 0, 6 * cells * cells);
}

}  // namespace

std::string with_light(bool plain, const std::string& text, int finish) {
  const std::string one = finish < 0 ? "" : "#define FINISH " + std::to_string(finish) + "\n";
  return std::string("#version 330 core\n") + (plain ? "#define PLAIN\n" : "") + one + shaders::k_light +
         text;
}

Backdrop::Backdrop(bool plain)
    : plain_(plain),
      studio_(
          plain ? on_grid(shaders::k_studio_light, shaders::k_plain_studio_vertex) : shaders::k_studio_vertex,
          plain ? shaders::k_plain_open_fragment
                : with_light(false, std::string(shaders::k_studio_light) + shaders::k_studio_fragment)),
      floor_(plain ? on_grid(shaders::k_floor_light, shaders::k_plain_floor_vertex) : shaders::k_floor_vertex,
             plain ? shaders::k_plain_lit_fragment
                   : with_light(false, std::string(shaders::k_floor_light) + shaders::k_floor_fragment)) {
  if (plain)
    open_floor_ = std::make_unique<GlProgram>(on_grid(shaders::k_floor_light, shaders::k_plain_floor_vertex),
                                              shaders::k_plain_open_fragment);
}

void Backdrop::draw(const View& view, const std::function<void(GlProgram&)>& set_light) {
  if (view.sees_floor) {
    for (GlProgram* program : {&floor_, open_floor_.get()}) {
      if (program == nullptr) continue;
      set_light(*program);
      program->set("shadow_low", view.shadows.min);
      program->set("shadow_high", view.shadows.max);
      program->set("in_shadow", program == &floor_ ? 1 : 0);
      if (plain_)
        draw_cells(*program, k_floor_cells);
      else
        glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    }
  }
  set_light(studio_);
  studio_.set("from_clip", view.from_clip);
  studio_.set("has_floor", view.sees_floor ? 1 : 0);
  if (plain_)
    draw_cells(studio_, k_studio_cells);
  else
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace mallow::view
