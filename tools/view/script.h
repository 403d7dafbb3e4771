#pragma once

#include <atomic>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "view/viewer.h"

namespace mallow::view {

/// Plays a viewer by a text, for tests: a command a line, each begun after a picture was drawn.
///
///   frames N             until N frames of the scene have ended since this line
///   filmed N             until the film has N pictures: frames that end before its key is read are in none
///   pictures N           until N pictures were drawn
///   settled              until what was done before is drawn: what the session was told too
///   said WORD            until the window says it; prints what it says
///   ready                until a scene is built and drawn
///   screenshot FILE      the window, a PNG; scene FILE: without panels
///   key NAME             "space", "r", "." and so on
///   move X Y             shares of the picture of the scene, in [0, 1] from the upper left corner
///   press K, release K   buttons: 0 left, 1 right, 2 middle
///   wheel CLICKS
///   resize W H, minimise, restore, close, open FILE
///   set KEY SHARE        a setting's slider, as "material[0].alpha"
///   sweep                every slider once through its range, and back
///   measure N            draws N pictures and prints what one takes
///   center               prints the middle of what is seen of bodies
///   mark NAME            a box of marks: pins, region or contacts; marks: prints how many are shown
///   status               prints time, frame, message
///   thumbnails           until all pictures of the gallery are made
///   rebuild              builds the scene anew
///   rung K               a place between accurate (0) and realtime
///   preset NAME          a material of data/materials in place of the first one
///   message              prints what the window says; copied: what the clipboard holds
///   bars                 prints the end and height of the lower one, and how many plots the upper one has
///   hand                 from here on the window draws as for a hand, where something has changed
///   film                 prints how many pictures a film has so far, and of which frames of the scene
///   joined               until films are written
class Script {
 public:
  explicit Script(const std::filesystem::path& file);
  /// Goes on; false after the last line. Throws ConfigError at a line that is none.
  bool advance(Viewer& viewer);
  /// Whether the window is to wait as for a hand.
  bool may_wait() const { return may_wait_; }

 private:
  void begin(Viewer& viewer, std::vector<std::string> words);
  void begin_other(Viewer& viewer, const std::vector<std::string>& words);
  bool is_done(Viewer& viewer);
  bool is_settled(Viewer& viewer);
  void sweep_next(Viewer& viewer);

  std::deque<std::string> lines_;
  bool may_wait_ = false;
  std::string waiting_;  ///< the command that is not done yet
  std::string said_;
  std::uint64_t goal_ = 0;
  std::shared_ptr<std::atomic<std::uint64_t>> settles_with_;  ///< a frame's number; 0: not known yet
  double started_ = 0;
  std::size_t swept_section_ = 0, swept_field_ = 0;
  int swept_place_ = 0;
  std::function<void()> put_back_;  ///< what the swept setting was
};

}  // namespace mallow::view
