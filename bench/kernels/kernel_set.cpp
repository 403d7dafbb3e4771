#include "kernels/kernel_set.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <regex>

#include "harness/command.h"
#include "harness/statistics.h"
#include "mallow/errors.h"

namespace mallow::bench {

struct KernelSet::Entry {
  KernelCase about;
  std::function<Timed()> prepare;
  std::string name;
  std::optional<Timed> timed = {};  ///< while its turn lasts

  /// Called several times by Google Benchmark, which looks for the number of iterations first.
  void run(benchmark::State& state) {
    if (!timed) timed = prepare();
    for (auto _ : state) {
      if (timed->restore) {
        state.PauseTiming();
        timed->restore();
        state.ResumeTiming();
      }
      timed->run();
    }
  }
};

namespace {

std::string name_of(const KernelCase& about) {
  return about.kernel + "/" + about.scene + "/" + std::to_string(about.threads) +
         (about.level.empty() ? "" : "/" + about.level);
}

/// The row of another kernel in the same scene, with the same threads and level.
const Json* find_row(const Json& rows, const std::string& kernel, const KernelCase& about) {
  for (const Json& row : rows)
    if (row["kernel"] == kernel && row["scene"] == about.scene && row["threads"] == about.threads &&
        row["level"] == about.level)
      return &row;
  return nullptr;
}

Json make_row(const KernelCase& about, const Timed& timed, const std::vector<double>& seconds,
              const Json& rows) {
  const double ns = 1e9 * minimum(seconds) / timed.items;
  const auto times = [&](double scale) -> Json {
    return {{"min", scale * minimum(seconds)},
            {"median", scale * median(seconds)},
            {"max", scale * maximum(seconds)}};
  };
  Json row = {{"kernel", about.kernel},
              {"scene", about.scene},
              {"threads", about.threads},
              {"level", about.level},
              {"item", about.item},
              {"items", timed.items},
              {"repeats", seconds.size()},
              {"ms", times(1e3)},
              {"ns_per_item", times(1e9 / timed.items)},
              {"core_ns_per_item", about.threads * ns}};
  if (const Json* other = find_row(rows, about.compare_to, about)) {
    row["compared_to"] = about.compare_to;
    row["times_as_long"] = ns / (*other)["ns_per_item"]["min"].get<double>();
  }
  row["about"] = timed.about;
  return row;
}

}  // namespace

void KernelSet::add(KernelCase about, std::function<Timed()> prepare) {
  const std::string name = name_of(about);
  entries_.push_back(std::make_shared<Entry>(Entry{std::move(about), std::move(prepare), name}));
}

void KernelSet::check(const KernelTiming& timing) const {
  std::regex filter;
  try {
    filter = timing.filter;
  } catch (const std::regex_error&) {
    throw ConfigError("--filter", "\"" + timing.filter + "\" is not a regular expression");
  }
  std::string all;
  for (const auto& entry : entries_) {
    if (std::regex_search(entry->name, filter)) return;
    all += "\n  " + entry->name;
  }
  throw ConfigError("--filter", "\"" + timing.filter + "\" names no kernel; there are" + all);
}

void KernelSet::run(const KernelTiming& timing, Results& results) {
  class RowReporter : public benchmark::BenchmarkReporter {
   public:
    RowReporter(const std::vector<std::shared_ptr<Entry>>& entries, Results& results)
        : entries_(entries), results_(results) {}
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>& runs) override {
      const auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const auto& e) {
        return e->name == runs.front().run_name.function_name;
      });
      std::vector<double> seconds;
      for (const Run& run : runs)
        if (run.run_type == Run::RT_Iteration && run.iterations > 0)
          seconds.push_back(run.real_accumulated_time / static_cast<double>(run.iterations));
      if (entry == entries_.end() || !(*entry)->timed || seconds.empty()) return;
      results_.add(make_row((*entry)->about, *(*entry)->timed, seconds, results_.rows()));
      std::fprintf(stderr, "kernels: %s: %.3f ns per %s\n", (*entry)->name.c_str(),
                   results_.rows().back()["ns_per_item"]["min"].get<double>(), (*entry)->about.item.c_str());
      (*entry)->timed.reset();
    }

   private:
    const std::vector<std::shared_ptr<Entry>>& entries_;
    Results& results_;
  };

  const std::regex filter(timing.filter);
  for (const auto& entry : entries_)
    if (std::regex_search(entry->name, filter))
      benchmark::RegisterBenchmark(entry->name.c_str(),
                                   [entry, &results](benchmark::State& state) {
                                     stop_if_interrupted(results);
                                     entry->run(state);
                                   })
          ->UseRealTime()
          ->MinTime(timing.min_time)
          ->Repetitions(timing.repeats);
  RowReporter reporter(entries_, results);
  benchmark::RunSpecifiedBenchmarks(&reporter, "all");
  benchmark::ClearRegisteredBenchmarks();
}

}  // namespace mallow::bench
