#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>

#include "mallow/executor.h"
#include "mallow/export.h"

namespace mallow {

/// Who runs the blocks of loops: an executor, and how many of its threads at most. The executor has to
/// outlive this.
class MALLOW_EXPORT Threads {
 public:
  /// `requested` of the engine's own threads; 0 takes all that the machine has.
  Threads(int requested);  // NOLINT(google-explicit-constructor): a count alone is the usual case
  /// executor: null for the engine's own.
  Threads(int requested, const std::shared_ptr<Executor>& executor);

  int count() const { return count_; }
  void run(LoopTask task) const { executor_->run(count_, task); }
  /// The same executor with fewer threads, where there are only so many blocks.
  Threads at_most(std::size_t blocks) const {
    Threads fewer = *this;
    fewer.count_ = static_cast<int>(std::min(static_cast<std::size_t>(count_), blocks));
    return fewer;
  }

 private:
  Executor* executor_;
  int count_;
};

}  // namespace mallow
