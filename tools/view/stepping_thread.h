#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "mallow/scene.h"
#include "view/command_queue.h"
#include "view/frame.h"
#include "view/session.h"
#include "view/triple_buffer.h"

namespace mallow::view {

/// Steps a session on a thread of its own. The window tells it what to do by commands, and gets finished
/// frames: it never waits for a step, nor a step for the window. Nothing else is shared: the session is this
/// thread's alone, a frame belongs to one side at a time (TripleBuffer), and commands carry copies.
class SteppingThread {
 public:
  /// on_frame: called by the stepping thread when a frame was published, to wake the window; may be empty.
  SteppingThread(const SessionOptions& options, std::function<void()> on_frame);
  /// Ends after the step that is being taken.
  ~SteppingThread();
  SteppingThread(const SteppingThread&) = delete;
  SteppingThread& operator=(const SteppingThread&) = delete;

  /// Runs before the next step.
  void send(std::function<void(Session&)> command) { commands_.add(std::move(command)); }
  /// Builds a scene and shows that it does; the folder of a run goes on where it stood. What was there before
  /// is gone.
  void open(const Scene& scene);
  /// Builds it anew with other settings. Where they are refused the scene goes on as it was.
  void rebuild(const Scene& scene);
  void open_run(const std::string& folder);

  /// Takes the newest frame; false where there is none since the last time.
  bool take_frame() { return frames_.take(); }
  bool has_frame() const { return !frames_.is_taken(); }
  /// The one that was taken last.
  const Frame& frame() { return frames_.front(); }

 private:
  void work(const SessionOptions& options);
  void announce_building();
  void publish();

  CommandQueue<std::function<void(Session&)>> commands_;
  TripleBuffer<Frame> frames_;
  std::function<void()> on_frame_;
  std::atomic<bool> ends_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace mallow::view
