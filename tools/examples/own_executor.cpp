// The engine's loops on threads of the application's own. Results do not depend on them.
#include <mallow/mallow.h>

#include <condition_variable>
#include <iostream>
#include <mutex>
#include <thread>

/// Two helpers that wait for the next loop and join it; one that comes late finds it over.
class Pool : public mallow::Executor {
 public:
  int concurrency() const override { return 3; }
  void run(int threads, mallow::LoopTask task) override {
    const std::lock_guard one_loop_at_a_time(loop_);
    std::unique_lock lock(mutex_);
    task_ = &task, open_ = threads - 1, ++count_;
    wake_.notify_all();
    lock.unlock();
    task(0);
    lock.lock();
    task_ = nullptr;  // from here on nobody joins
    done_.wait(lock, [this] { return working_ == 0; });
  }

 private:
  void help(std::size_t place, const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    for (int last = 0; wake_.wait(lock, stop, [&] { return task_ && open_ > 0 && count_ != last; });
         last = count_) {
      const mallow::LoopTask task = *task_;
      --open_, ++working_;
      lock.unlock();
      task(place);
      lock.lock();
      if (--working_ == 0) done_.notify_all();
    }
  }

  std::mutex loop_, mutex_;
  std::condition_variable_any wake_, done_;
  const mallow::LoopTask* task_ = nullptr;
  int open_ = 0, working_ = 0, count_ = 0;  // threads that may still join, that are at work; loops so far
  std::jthread first_{[this](const std::stop_token& stop) { help(1, stop); }};
  std::jthread second_{[this](const std::stop_token& stop) { help(2, stop); }};
};

std::uint64_t fall(std::shared_ptr<mallow::Executor> executor) {
  mallow::Simulation simulation({.support_radius = 2.0f, .executor = std::move(executor)});
  simulation.add_body(sample(mallow::Lattice{.count = {12, 12, 12}, .corner = {0, 0, 1}}), {.alpha = 0.5f});
  simulation.add_collider({.shape = mallow::Plane{}});
  simulation.advance(3);
  return simulation.state_hash();
}

int main() {
  const std::uint64_t engine = fall(mallow::team_executor()), own = fall(std::make_shared<Pool>());
  std::cout << std::hex << "on the engine's threads " << engine << ", on ours " << own << '\n';
  return engine == own ? 0 : 1;
}
