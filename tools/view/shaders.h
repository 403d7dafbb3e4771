#pragma once

/// GLSL 3.30. Light is that of tools/render: a key light with a shadow, a sky around, finishes.
namespace mallow::view::shaders {

/// Declarations and light that fragment shaders share; comes before their own text.
extern const char* const k_light;
extern const char* const k_mesh_vertex;
extern const char* const k_mesh_fragment;
extern const char* const k_particle_vertex;
extern const char* const k_particle_fragment;
extern const char* const k_obstacle_vertex;
extern const char* const k_obstacle_fragment;
extern const char* const k_studio_vertex;
extern const char* const k_studio_light;  ///< before the text of the studio
extern const char* const k_studio_fragment;
extern const char* const k_floor_vertex;
extern const char* const k_floor_light;  ///< before the text of the floor
extern const char* const k_floor_fragment;
extern const char* const k_nothing_fragment;  ///< of shadow maps

// Where no graphics card draws: see plain_shaders.cpp.
extern const char* const k_plain_mesh_vertex;
extern const char* const k_plain_obstacle_vertex;
extern const char* const k_plain_grid;  ///< before the text of grids
extern const char* const k_plain_studio_vertex;
extern const char* const k_plain_floor_vertex;
extern const char* const k_plain_lit_fragment;   ///< between light and shadow
extern const char* const k_plain_open_fragment;  ///< where no shadow falls

}  // namespace mallow::view::shaders
