#include "view/shaders.h"

namespace mallow::view::shaders {

const char* const k_light = R"(
uniform vec3 eye;
uniform vec3 to_key, key_color;
uniform vec3 ambient_sides[6];               // mean light on faces +x -x +y -y +z -z
uniform vec3 sky_horizon, sky_zenith, open_floor, wall;
uniform sampler2DShadow shadow_map;
uniform mat4 to_shadow;
uniform float shadow_texel;                  // of the map, in [0, 1]
uniform float shadow_bias;                   // along the normal [m]
uniform float floor_height, floor_fade;      // [m]
uniform vec3 middle;                         // of what is seen [m]

vec3 ambient(vec3 n) {
  vec3 s = n * n;
  return s.x * ambient_sides[n.x > 0.0 ? 0 : 1] + s.y * ambient_sides[n.y > 0.0 ? 2 : 3] +
         s.z * ambient_sides[n.z > 0.0 ? 4 : 5];
}
vec3 sky(vec3 d) {
  return mix(open_floor, mix(sky_horizon, sky_zenith, max(d.z, 0.0)), smoothstep(-0.4, 0.4, d.z));
}
vec3 backdrop(vec3 d) { return mix(open_floor, wall, smoothstep(-0.22, 0.45, d.z)); }

vec3 on_shadow_map(vec3 x, vec3 n) {
  vec3 p = (to_shadow * vec4(x + shadow_bias * n, 1.0)).xyz;
  return vec3(p.xy, min(p.z, 0.9999));  // what is beyond the map is in the light
}
float lit(vec3 x, vec3 n) { return texture(shadow_map, on_shadow_map(x, n)); }
float lit_softly(vec3 x, vec3 n, float spread) {
  vec3 p = on_shadow_map(x, n);
#ifdef PLAIN
  return texture(shadow_map, p);
#endif
  vec2 step = spread * shadow_texel * vec2(1.0, 0.41);
  float sum = texture(shadow_map, vec3(p.xy + step, p.z));
  sum += texture(shadow_map, vec3(p.xy - step, p.z));
  sum += texture(shadow_map, vec3(p.xy + vec2(step.y, -step.x), p.z));
  sum += texture(shadow_map, vec3(p.xy + vec2(-step.y, step.x), p.z));
  return 0.25 * sum;
}

// Tone curve and sRGB, by roots: powers would take half of the time of a picture where no graphics card draws.
// Fitted to the curve of tools/render, within 0.005 above 0.01.
vec3 develop(vec3 c) {
  vec3 over = max(c - 0.7, 0.0) / 0.3, square = over * over;
  c = min(c, 0.7) + 0.3 * min(over * (27.0 + square) / (27.0 + 9.0 * square), 1.0);
  vec3 root = sqrt(max(c, 0.0)), fourth = sqrt(root);
  return 0.65378 * root + 0.64017 * fourth - 0.29055 * sqrt(fourth);
}

// Near the floor what looks down gets less light than in the open.
float openness(vec3 x, vec3 n) {
  float high = clamp((x.z - floor_height) / (0.35 * floor_fade), 0.0, 1.0);
  return mix(1.0, mix(0.45, 1.0, sqrt(high)), clamp(0.65 - 0.6 * n.z, 0.0, 1.0));
}

// Finishes: jelly, clay, cream, gloss, syrup.
const float k_index[5] = float[](1.35, 1.0, 1.4, 1.5, 1.45);
const float k_wrap[5] = float[](0.25, 0.0, 0.5, 0.0, 0.25);
const float k_satin[5] = float[](0.0, 8.0, 20.0, 0.0, 0.0);
const float k_clear[5] = float[](1.0, 0.0, 0.0, 0.0, 1.3);

// albedo: with that of thin and of deep places, where light goes through.
struct Look {
  vec3 albedo, thin, deep;
};
vec3 shade(Look look, int finish, vec3 x, vec3 n, float light) {
#ifdef FINISH
  finish = FINISH;
#endif
  vec3 albedo = look.albedo;
  vec3 v = normalize(eye - x);
  float facing = max(dot(n, v), 0.0);
  float cosine = dot(n, to_key);
  vec3 wrap = k_wrap[finish] * vec3(1.0, 0.75, 0.6);
  vec3 direct = max((vec3(cosine) + wrap) / (1.0 + wrap), 0.0);
  vec3 around = ambient(n) * openness(x, n);
  float clear = k_clear[finish];
  if (clear > 0.0) {
    // The edge is thin and lets light through, the middle is deep and has the colour.
    direct += 0.35 * max(-cosine, 0.0);
    albedo = mix(look.thin, look.deep, facing);
    around = mix(around, 0.5 * (sky_horizon + open_floor), 0.25);
    around += 0.16 * clear * open_floor * (1.0 - facing);
    light = mix(0.35, 1.0, light);
  }
  vec3 color = albedo * (key_color * direct * light + around);
  if (finish == 1) return color;
  float head_on = (k_index[finish] - 1.0) / (k_index[finish] + 1.0);
  float level = head_on * head_on, miss = 1.0 - facing;
  float share = level + (0.6 - level) * miss * miss * miss * miss * miss;
  vec3 half_way = normalize(to_key + v);
  float across = max(dot(n, half_way), 0.0);
  if (k_satin[finish] > 0.0)
    return color + key_color * light * max(cosine, 0.0) * level * (k_satin[finish] + 2.0) / 8.0 *
                       pow(across, k_satin[finish]);
  vec3 mirrored = reflect(-v, n);
  float box = smoothstep(0.955, 0.985, dot(mirrored, to_key)) * light * step(0.0, cosine);
  return (1.0 - share) * color + share * (sky(mirrored) + 14.0 * box * key_color);
}
)";

const char* const k_mesh_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal_in;
layout(location = 2) in uint body;
uniform mat4 projection_view;
uniform sampler2D palette;
out vec3 x, normal;
flat out vec4 look;
flat out vec3 thin, deep;
void main() {
  x = position;
  normal = normal_in;
  ivec2 at = ivec2(4 * int(body % 256u), int(body / 256u));
  look = texelFetch(palette, at, 0);
  thin = texelFetch(palette, at + ivec2(2, 0), 0).rgb;
  deep = texelFetch(palette, at + ivec2(3, 0), 0).rgb;
  gl_Position = projection_view * vec4(position, 1.0);
}
)";

const char* const k_mesh_fragment = R"(
in vec3 x, normal;
flat in vec4 look;
flat in vec3 thin, deep;
out vec4 color;
void main() {
  vec3 n = normalize(normal);
  if (!gl_FrontFacing) n = -n;
  color = vec4(develop(shade(Look(look.rgb, thin, deep), int(look.a), x, n, lit(x, n))), 1.0);
}
)";

const char* const k_particle_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 2) in uint body;
layout(location = 3) in float value;
uniform mat4 projection_view;
uniform float pixels;           // of a length of 1 at a distance of 1
uniform sampler2D palette;
uniform vec2 value_range;
uniform int shown;              // 0: appearances; 1: values; 2: numbers, those below 0 of nothing
out vec3 center;
flat out vec4 look;
flat out float radius;
const vec3 k_stops[5] = vec3[](vec3(0.030, 0.035, 0.19), vec3(0.02, 0.19, 0.42), vec3(0.10, 0.50, 0.32),
                               vec3(0.78, 0.62, 0.07), vec3(0.70, 0.06, 0.02));
vec3 color_of(float share) {
  float place = clamp(share, 0.0, 1.0) * 3.999;
  int k = int(place);
  return mix(k_stops[k], k_stops[k + 1], place - float(k));
}
void main() {
  ivec2 at = ivec2(4 * int(body % 256u), int(body / 256u));
  look = texelFetch(palette, at, 0);
  radius = texelFetch(palette, at + ivec2(1, 0), 0).r;
  if (shown == 1) look = vec4(color_of((value - value_range.x) / (value_range.y - value_range.x)), 1.0);
  if (shown == 2) look = vec4(0.5 + 0.4 * cos(6.2832 * (0.618034 * value + vec3(0.0, 0.33, 0.67))), 1.0);
  if (shown == 2 && value < 0.0) look = vec4(vec3(0.3), 1.0);
  center = position;
  gl_Position = projection_view * vec4(position, 1.0);
  gl_PointSize = max(1.0, 2.0 * radius * pixels / gl_Position.w);
}
)";

const char* const k_particle_fragment = R"(
in vec3 center;
flat in vec4 look;
flat in float radius;
uniform mat4 projection_view;
uniform vec3 right, up;
out vec4 color;
void main() {
  vec2 p = 2.0 * gl_PointCoord - 1.0;
  float square = dot(p, p);
  if (square > 1.0) discard;
  vec3 back = cross(right, up);
  vec3 n = normalize(right * p.x - up * p.y + back * sqrt(1.0 - square));
  vec3 x = center + radius * n;
  vec4 clip = projection_view * vec4(x, 1.0);
  gl_FragDepth = 0.5 * clip.z / clip.w + 0.5;
  color = vec4(develop(shade(Look(look.rgb, look.rgb, look.rgb), 2, x, n, lit(x, n))), 1.0);
}
)";

const char* const k_obstacle_vertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal_in;
uniform mat4 projection_view, pose;
out vec3 x, normal;
void main() {
  vec4 at = pose * vec4(position, 1.0);
  x = at.xyz;
  normal = mat3(pose) * normal_in;
  gl_Position = projection_view * at;
}
)";

const char* const k_obstacle_fragment = R"(
in vec3 x, normal;
uniform float side;             // -1: it is looked into
uniform vec3 albedo;
out vec4 color;
void main() {
  vec3 n = side * normalize(normal);
  vec3 light = key_color * max(dot(n, to_key), 0.0) * lit_softly(x, n, 1.5) + ambient(n) * openness(x, n);
  color = vec4(develop(albedo * light), 1.0);
}
)";

const char* const k_studio_vertex = R"(#version 330 core
uniform mat4 from_clip;
out vec3 far;
void main() {
  vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  vec4 at = from_clip * vec4(p, 1.0, 1.0);
  far = at.xyz / at.w;
  gl_Position = vec4(p, 1.0, 1.0);
}
)";

const char* const k_studio_light = R"(
uniform int has_floor;
vec3 studio(vec3 far) {
  vec3 d = normalize(far - eye);
  vec3 light = backdrop(d);
  if (has_floor == 1) {
    float t = (floor_height - eye.z) / min(d.z, -1e-6);
    vec2 away = (eye.xy + t * d.xy - middle.xy) / floor_fade;
    light = mix(open_floor, light, smoothstep(1.5, 6.0, d.z < 0.0 ? length(away) : 6.0));
  }
  return light;
}
)";

const char* const k_studio_fragment = R"(
in vec3 far;
out vec4 color;
void main() { color = vec4(develop(studio(far)), 1.0); }
)";

const char* const k_floor_vertex = R"(#version 330 core
uniform mat4 projection_view;
uniform float floor_height, floor_fade;
uniform vec3 middle;
out vec3 x;
void main() {
  vec2 corner = vec2(gl_VertexID % 2 == 0 ? -1.0 : 1.0, gl_VertexID < 2 ? -1.0 : 1.0);
  x = vec3(middle.xy + 1.7 * floor_fade * corner, floor_height);
  gl_Position = projection_view * vec4(x, 1.0);
}
)";

// Near the bodies, where there are shadows; farther away the studio draws it.
const char* const k_floor_light = R"(
vec3 floor_light(vec3 x, float shadow) {
  float key_share = key_color.g * to_key.z / (key_color.g * to_key.z + ambient_sides[4].g);
  vec3 light = open_floor * (1.0 - key_share * (1.0 - shadow) * vec3(1.0, 0.97, 0.92));
  float away = length(x.xy - middle.xy) / floor_fade;
  return mix(light, backdrop(normalize(x - eye)), smoothstep(1.5, 6.0, away));
}
)";

const char* const k_floor_fragment = R"(
in vec3 x;
out vec4 color;
void main() {
  vec3 n = vec3(0.0, 0.0, 1.0);
  float shadow = 0.5 * (lit(x, n) + lit_softly(x, n, 3.5));
  color = vec4(develop(floor_light(x, shadow)), 1.0);
}
)";

const char* const k_nothing_fragment = R"(#version 330 core
void main() {}
)";

}  // namespace mallow::view::shaders
