#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "view/frame.h"
#include "view/frame_governor.h"

namespace mallow::view {

/// What the left button does.
enum class Tool : std::uint8_t { grab, throw_ball, poke, cut, heat, pin, choose };
inline constexpr std::array<const char*, 7> k_tool_names = {"grab", "throw", "poke",  "cut",
                                                            "heat", "pin",   "choose"};
inline constexpr std::array<const char*, 7> k_tool_docs = {
    "take hold of matter and pull it",
    "throw a ball of rubber from where you are",
    "hit what is under the mouse",
    "draw a line: a layer two spacings thick is cut out along it",
    "warm what is under the mouse: it melts where it carries no heat",
    "hold what is under the mouse in place",
    "show the region of the particle under the mouse"};

/// What panels and hand have set, and what they ask the viewer for.
struct ViewState {
  Drawn drawn = Drawn::surface;
  Shown shown = Shown::appearance;
  Tool tool = Tool::grab;
  Marks marks;
  float strength = 1;  ///< of what tools do
  double speed = 1;    ///< of the pace of a film
  bool as_fast_as_possible = false;
  bool panels = true, help = false;
  int time_height = 68;     ///< of the bar at the bottom, which has more lines in a narrow window [pixels]
  float time_bar_end = 0;   ///< where its farthest thing ends [pixels from the left]
  int plots = 0;            ///< that the bar at the top has room for
  int rung = k_as_written;  ///< that the hand drags to
  bool drags_rung = false;
  bool keeps_rate = false;  ///< the governor holds target
  float target = 30;        ///< frames a second
  std::string notice;       ///< a line at the bottom, for some seconds
  double notice_since = -1e9,
         message_since = -1e9;  ///< when it was said, and Frame::message [s of wall time]

  // Asked for in this picture; the viewer clears them.
  bool pause = false, step = false, reset = false, back = false, film = false, save = false, copy = false,
       rebuild = false, gallery = false, camera = false, release_pins = false;
  std::optional<double> go_to;  ///< [s]
};

}  // namespace mallow::view
