#include "core/parallel.h"

#include <omp.h>

#include "core/governor.h"

namespace mallow {
namespace {

class OpenMp final : public Executor {
 public:
  int concurrency() const override { return omp_get_num_procs(); }

  void run(int threads, LoopTask task) override {
    // OpenMP has a team for each thread that opens parallel regions, so what is learned holds for that one.
    thread_local Governor governor(2);
    const Governor::Clock::time_point begin = Governor::Clock::now();
    if (!governor.allows(begin)) {
      task(0);
      return;
    }
    // GNU's OpenMP waits for its threads at the beginning, too, for those that have not left the last loop.
    Governor::Clock::time_point started, done;
#pragma omp parallel num_threads(threads)
    {
      const auto place = static_cast<std::size_t>(omp_get_thread_num());
      if (place == 0) started = Governor::Clock::now();
      task(place);
      if (place == 0) done = Governor::Clock::now();
    }
    const Governor::Clock::time_point end = Governor::Clock::now();
    governor.ended(done - started, (started - begin) + (end - done), end);
  }
};

}  // namespace

std::shared_ptr<Executor> openmp_executor() {
  static const auto executor = std::make_shared<OpenMp>();
  return executor;
}

void run_loop(const Threads& threads, LoopTask task) {
  threads.run(task);
  task(0);  // what an executor left, which may be all
}

}  // namespace mallow
