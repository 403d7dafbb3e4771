#include "view/frame_governor.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace mallow::view {

std::span<const Rung> rungs() {
  static constexpr std::array<Rung, 9> k_rungs{{{0.5f, 1, 1.5f},
                                                {0.75f, 1, 1.25f},
                                                {1, 1, 1},
                                                {1.25f, 1, 1},
                                                {1.5f, 1, 1},
                                                {1.5f, 2, 1},
                                                {1.5f, 3, 1},
                                                {1.5f, 3, 0.7f},
                                                {1.5f, 3, 0.5f}}};
  return k_rungs;
}

std::string describe(const Rung& rung) {
  std::string text;
  const auto add = [&](const char* format, double number) {
    char part[80];
    std::snprintf(part, sizeof part, format, number);
    text += (text.empty() ? "" : ", ") + std::string(part);
  };
  if (rung.time_step != 1) add("steps %.2g times as long", static_cast<double>(rung.time_step));
  if (rung.region_stride != 1) add("one region for %.0f times the particles", rung.region_stride);
  if (rung.voxels != 1) add("voxels %.2g times as wide", 1 / static_cast<double>(rung.voxels));
  return text;
}

void FrameGovernor::set_rung(int rung) {
  rung_ = std::clamp(rung, 0, static_cast<int>(rungs().size()) - 1);
  frames_ = looks_with_room_ = 0;
  seconds_ = 0;
}

bool FrameGovernor::add_frame(double seconds) {
  if (!target_) return false;
  seconds_ += seconds;
  if (++frames_ < k_frames) return false;
  const double mean = seconds_ / frames_, allowed = 1 / *target_;
  const int looks = mean < k_room * allowed ? looks_with_room_ + 1 : 0;
  const int before = rung_;
  if (mean > allowed)
    set_rung(rung_ + 1);
  else if (looks >= k_patience && rung_ > k_as_written)
    set_rung(rung_ - 1);
  else
    looks_with_room_ = looks;
  frames_ = 0;
  seconds_ = 0;
  return rung_ != before;
}

}  // namespace mallow::view
