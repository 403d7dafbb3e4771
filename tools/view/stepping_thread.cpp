#include "view/stepping_thread.h"

#include <chrono>
#include <utility>

namespace mallow::view {
namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

SteppingThread::SteppingThread(const SessionOptions& options, std::function<void()> on_frame)
    : on_frame_(std::move(on_frame)), thread_([this, options] { work(options); }) {}

SteppingThread::~SteppingThread() {
  ends_ = true;
  commands_.add([](Session&) {});
  thread_.join();
}

void SteppingThread::publish() {
  frames_.publish();
  if (on_frame_) on_frame_();
}

void SteppingThread::announce_building() {
  frames_.back().building = true;
  frames_.back().finished = false;
  frames_.back().message.clear();
  publish();
}

void SteppingThread::open(const Scene& scene) {
  send([this, scene](Session& session) {
    announce_building();
    session.close();
    session.open(scene);
  });
}

void SteppingThread::rebuild(const Scene& scene) {
  send([this, scene](Session& session) {
    announce_building();
    session.open(scene);
  });
}

void SteppingThread::open_run(const std::string& folder) {
  send([this, folder](Session& session) {
    announce_building();
    session.close();
    session.open_run(folder);
  });
}

void SteppingThread::work(const SessionOptions& options) {
  Session session(options);
  while (!ends_) {
    for (const auto& command : commands_.take()) session.run(command);
    const bool moved = session.advance(wall_seconds());
    // The surface costs as much as a step: it is drawn as often as somebody looks, and for every frame of a
    // film.
    if (session.has_changed() && frames_.is_taken()) {
      session.fill(wall_seconds(), frames_.back());
      publish();
    } else if (!moved) {
      commands_.wait_for(std::chrono::milliseconds(2));
    }
  }
}

}  // namespace mallow::view
