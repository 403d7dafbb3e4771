#pragma once

#include "config/field.h"
#include "mallow/scene.h"

/// The settings of runs and pictures, see config/field_tables.h.
namespace mallow {

template <>
struct FieldTable<RunConfig> {
  static constexpr std::tuple k_fields{
      Field{"frames", &RunConfig::frames, at_least(0), "", "frames that are written"},
      Field{"frame_time", &RunConfig::frame_time, k_positive, "s",
            "simulated time from one frame to the next", "solver.time_step"},
  };
};

template <>
struct FieldTable<RenderConfig> {
  using Config = RenderConfig;
  static constexpr std::tuple k_fields{
      Field{"width", &Config::width, between(16, 8192), "pixels", "of a picture"},
      Field{"height", &Config::height, between(16, 8192), "pixels", "of a picture"},
      Field{"samples", &Config::samples, between(1, 256), "", "most rays per pixel to each light"},
      Field{"noise", &Config::noise, between(0, 1), "",
            "of white: where light is known this well, a pixel takes fewer rays; 0: none does"},
      Field{"eye", &Config::eye, k_finite, "m", "where the camera is", "chosen to show the scene"},
      Field{"target", &Config::target, k_finite, "m", "what it looks at", "chosen to show the scene"},
      Field{"field_of_view", &Config::field_of_view, between(1, 120), "degrees", "vertical"},
      Field{"frames_per_second", &Config::frames_per_second, between(1, 120), "", "of the film"},
      Field{"shutter", &Config::shutter, between(0, 1), "",
            "share of a frame's time that it is open: what moves is blurred"},
  };
};

}  // namespace mallow
