#pragma once

namespace mallow {

/// A budget that is far more than a study takes which ends by itself [s]: it does so on a slow machine too.
inline constexpr double k_enough = 120;

/// A jelly cube that swings under gravity beside nothing: as smooth as motions are.
inline constexpr const char* k_swinging = R"(
[solver]
time_step = 0.15
[[material]]
name = "jelly"
elastic_time_step = 0.3
[[body]]
material = "jelly"
box = { count = [4, 4, 4], spacing = 1.0, corner = [0.0, 0.0, 0.0] }
[[pin]]
box = { min = [0.0, 0.0, 3.0], max = [4.0, 4.0, 4.0] }
[run]
frames = 10
frame_time = 0.6
)";

}  // namespace mallow
