#include "core/threads.h"

namespace mallow {

Threads::Threads(int requested) : Threads(requested, nullptr) {}

Threads::Threads(int requested, const std::shared_ptr<Executor>& executor)
    : executor_(executor ? executor.get() : team_executor().get()),
      count_(requested > 0 ? requested : std::max(1, executor_->concurrency())) {}

}  // namespace mallow
