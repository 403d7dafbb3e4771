// Shaders where no graphics card draws: what changes slowly over a picture is found at corners of a grid or
// of the mesh, and pixels are left with a mixture of two colours. Pixels are many more than corners.
#include "view/shaders.h"

namespace mallow::view::shaders {

const char* const k_plain_mesh_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal_in;
layout(location = 2) in uint body;
uniform mat4 projection_view;
uniform sampler2D palette;
uniform int has_insides;        // that are seen
out vec3 bright, dark;          // in the light of the key and in its shadow
out vec3 on_map;
void main() {
  ivec2 at = ivec2(4 * int(body % 256u), int(body / 256u));
  vec4 look = texelFetch(palette, at, 0);
  Look all = Look(look.rgb, texelFetch(palette, at + ivec2(2, 0), 0).rgb,
                  texelFetch(palette, at + ivec2(3, 0), 0).rgb);
  vec3 n = normalize(normal_in);
  if (has_insides == 1 && dot(n, eye - position) < 0.0) n = -n;
  bright = develop(shade(all, int(look.a), position, n, 1.0));
  dark = develop(shade(all, int(look.a), position, n, 0.0));
  on_map = on_shadow_map(position, n);
  gl_Position = projection_view * vec4(position, 1.0);
}
)";

const char* const k_plain_obstacle_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal_in;
uniform mat4 projection_view, pose;
uniform float side;             // -1: it is looked into
uniform vec3 albedo;
out vec3 bright, dark;
out vec3 on_map;
void main() {
  vec4 at = pose * vec4(position, 1.0);
  vec3 n = side * normalize(mat3(pose) * normal_in);
  vec3 around = ambient(n) * openness(at.xyz, n);
  bright = develop(albedo * (key_color * max(dot(n, to_key), 0.0) + around));
  dark = develop(albedo * around);
  on_map = on_shadow_map(at.xyz, n);
  gl_Position = projection_view * at;
}
)";

const char* const k_plain_lit_fragment = R"(#version 330 core
in vec3 bright, dark;
in vec3 on_map;
uniform sampler2DShadow shadow_map;
out vec4 color;
void main() { color = vec4(mix(dark, bright, texture(shadow_map, on_map)), 1.0); }
)";

const char* const k_plain_open_fragment = R"(#version 330 core
in vec3 bright;
out vec4 color;
void main() { color = vec4(bright, 1.0); }
)";

// Two triangles a cell: the corner of vertex k of a grid of so many cells, in [0, 1].
const char* const k_plain_grid = R"(
uniform int cells;              // along an edge
ivec2 cell_of(int vertex) { return ivec2((vertex / 6) % cells, vertex / (6 * cells)); }
vec2 corner_of(int vertex) {
  int corner = vertex % 6;
  ivec2 more = ivec2(corner == 1 || corner == 2 || corner == 4, corner == 2 || corner == 4 || corner == 5);
  return vec2(cell_of(vertex) + more) / float(cells);
}
)";

const char* const k_plain_studio_vertex = R"(
uniform mat4 from_clip;
out vec3 bright;
void main() {
  vec2 p = 2.0 * corner_of(gl_VertexID) - 1.0;
  vec4 at = from_clip * vec4(p, 1.0, 1.0);
  bright = develop(studio(at.xyz / at.w));
  gl_Position = vec4(p, 1.0, 1.0);
}
)";

// Cells that a shadow may fall on are drawn by a program of their own: to look a shadow up costs more than
// all else of a pixel of the floor.
const char* const k_plain_floor_vertex = R"(
uniform mat4 projection_view;
uniform vec3 shadow_low, shadow_high;  // of what throws shadows, on their map
uniform int in_shadow;
out vec3 bright, dark;
out vec3 on_map;
vec3 on_floor(vec2 share) { return vec3(middle.xy + 1.7 * floor_fade * (2.0 * share - 1.0), floor_height); }
void main() {
  vec3 n = vec3(0.0, 0.0, 1.0);
  vec3 low = on_shadow_map(on_floor(vec2(cell_of(gl_VertexID)) / float(cells)), n), high = low;
  for (int k = 1; k < 4; ++k) {
    vec3 corner = on_shadow_map(on_floor(vec2(cell_of(gl_VertexID) + ivec2(k & 1, k >> 1)) / float(cells)), n);
    low = min(low, corner);
    high = max(high, corner);
  }
  bool meets = all(lessThan(low.xy, shadow_high.xy)) && all(greaterThan(high.xy, shadow_low.xy));
  vec3 x = on_floor(corner_of(gl_VertexID));
  bright = develop(floor_light(x, 1.0));
  dark = develop(floor_light(x, 0.0));
  on_map = on_shadow_map(x, n);
  gl_Position = meets == (in_shadow == 1) ? projection_view * vec4(x, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}
)";

}  // namespace mallow::view::shaders
