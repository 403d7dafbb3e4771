#include "core/threads.h"

namespace mallow {

Threads::Threads(int requested) {
  static const std::shared_ptr<Executor> team = team_executor();
  *this = Threads(requested, team);
}

Threads::Threads(int requested, const std::shared_ptr<Executor>& executor)
    : executor_(executor.get()), count_(requested) {
  if (!executor_) *this = Threads(requested);
  if (requested == 0) count_ = std::max(1, executor_->concurrency());
}

}  // namespace mallow
