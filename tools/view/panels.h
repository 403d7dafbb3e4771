#pragma once

#include <functional>
#include <string>

#include "view/session.h"
#include "view/settings_model.h"
#include "view/view_state.h"

/// What lies around the picture. Panels change the state and send commands; they hold nothing.
namespace mallow::view {

/// Pixels that panels take at the edges of the window.
inline constexpr int k_top_height = 52, k_least_time_height = 68, k_settings_width = 320;

using Send = std::function<void(std::function<void(Session&)>)>;

/// Rates, phases, counts, plots. drawn_per_second: pictures of the window.
void draw_top_bar(const Frame& frame, ViewState& state, double drawn_per_second);
/// Play, step, back, speed; tools.
void draw_time_bar(const Frame& frame, ViewState& state, bool recording, const Send& send);
/// Alpha first, presets, speed and accuracy, then every setting.
void draw_settings(const Frame& frame, SettingsModel& settings, ViewState& state, const Send& send);
/// Boxes that ask for marks.
void draw_marks_panel(ViewState& state, const Send& send);
/// How long a message is seen that is no error [s].
inline constexpr double k_message_seconds = 8;
/// What is said now of the session's message and the viewer's notice: the newer one; an error stays.
std::string message_shown(const Frame& frame, const ViewState& state, double wall);
/// Messages of the session, and of the viewer.
void draw_message(const Frame& frame, const ViewState& state, double wall);
void draw_help(ViewState& state);
/// Colours of what particles show.
void draw_legend(const Frame& frame, const ViewState& state);

}  // namespace mallow::view
