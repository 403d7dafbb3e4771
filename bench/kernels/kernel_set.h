#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/isa.h"
#include "harness/results.h"

namespace mallow::bench {

/// A kernel on its data, ready to be called again and again.
struct Timed {
  std::function<void()> run;
  double items = 0;                    ///< that one call works through
  std::function<void()> restore = {};  ///< puts back what a call overwrites; not timed
  Json about = Json::object();         ///< what else is worth a column
};

/// What a row of the command `kernels` says first.
struct KernelCase {
  std::string kernel;  ///< "region_sums"
  std::string scene;   ///< "cube_22"
  int threads = 1;
  std::string level = "";  ///< instruction level; empty: not compiled per level
  std::string item = "";   ///< "neighbor": what the time is given for
  std::string compare_to =
      {};  ///< kernel whose time, in the same scene, threads and level, this one's is divided by
};

/// For which threads and levels kernels are timed.
struct KernelVariants {
  std::vector<int> threads;
  std::vector<InstructionLevel> levels;
};

/// How long kernels are timed.
struct KernelTiming {
  std::string filter;   ///< regular expression that is looked for in "kernel/scene/threads/level"
  double min_time = 0;  ///< of each repeat [s]
  int repeats = 1;
};

/// The kernels that a command times, with Google Benchmark, in the order in which they were added.
class KernelSet {
 public:
  /// prepare: makes the data; called when the kernel's turn comes, and what it made is freed behind it.
  void add(KernelCase about, std::function<Timed()> prepare);
  /// Throws ConfigError where the filter is none, or names no kernel.
  void check(const KernelTiming& timing) const;
  /// Times all that the filter names; a row each. Throws RunFailure where Ctrl-C ends it.
  void run(const KernelTiming& timing, Results& results);

 private:
  struct Entry;
  std::vector<std::shared_ptr<Entry>> entries_;
};

// What there is to be timed, by subject.
void add_region_sums(const KernelVariants& variants, KernelSet& set);
void add_rotations(const KernelVariants& variants, KernelSet& set);
void add_neighbors(const KernelVariants& variants, KernelSet& set);
void add_sph(const KernelVariants& variants, KernelSet& set);
void add_surface(const KernelVariants& variants, KernelSet& set);
void add_skin(const KernelVariants& variants, KernelSet& set);

}  // namespace mallow::bench
