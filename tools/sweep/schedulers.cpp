#include "sweep/schedulers.h"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <exception>
#include <fstream>
#include <mutex>
#include <sstream>
#include <thread>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "program/external_program.h"
#include "program/failure.h"
#include "program/interrupt.h"
#include "program/shell_word.h"

namespace mallow::sweep {
namespace fs = std::filesystem;
namespace {

/// What Slurm's MaxArraySize is where nobody set it.
constexpr std::size_t k_slurm_default_array = 1001;

/// A line of --point for each task of so many points.
std::vector<std::string> task_lines(std::span<const std::size_t> points, std::size_t each) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % each == 0) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : ",") + std::to_string(points[i]);
  }
  return lines;
}

fs::path write_tasks(const SweepFolder& sweep, const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  const fs::path file = sweep.folder() / "tasks.txt";
  write_whole(file, text);
  return file;
}

void require(const char* program, const char* package) {
  if (!program::is_installed(program))
    throw program::RunFailure(std::string(program) + " is not installed (Debian's package " + package + ")");
}

/// MaxArraySize of the cluster: indices are below it.
std::size_t most_tasks(const SweepFolder& sweep) {
  const fs::path file = sweep.folder() / "slurm.txt";
  program::run_logged({"scontrol", "show", "config"}, file);
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("MaxArraySize")) continue;
    const std::size_t most = std::strtoull(line.c_str() + line.find('=') + 1, nullptr, 10);
    if (most > 1) return most - 1;
  }
  return k_slurm_default_array - 1;
}

}  // namespace

std::vector<std::size_t> point_list(const std::string& text, std::size_t count) {
  const auto refuse = [&] {
    throw ConfigError("--point", "'" + text + "' is not allowed: points below " + std::to_string(count) +
                                     " as in 3 or 3,7,10:20");
  };
  const auto number = [&](const std::string& part) {
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (part.empty() || error != std::errc() || end != part.data() + part.size()) refuse();
    return value;
  };
  std::vector<std::size_t> points;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t colon = part.find(':');
    const std::size_t begin = number(part.substr(0, colon));
    const std::size_t end = colon == std::string::npos ? begin + 1 : number(part.substr(colon + 1));
    if (begin >= end || end > count) refuse();
    for (std::size_t point = begin; point < end; ++point) points.push_back(point);
  }
  if (points.empty()) refuse();
  return points;
}

void run_here(const SweepFolder& sweep, std::span<const std::size_t> points, int jobs, int threads,
              const std::function<void(std::size_t, const Outcome&)>& ran) {
  std::atomic<std::size_t> next = 0;
  std::mutex one_at_a_time;
  std::exception_ptr error;
  const auto work = [&] {
    for (std::size_t i = next++; i < points.size(); i = next++) {
      try {
        const Outcome outcome = sweep.run(points[i], threads);
        const std::lock_guard lock(one_at_a_time);
        ran(points[i], outcome);
      } catch (...) {
        const std::lock_guard lock(one_at_a_time);
        if (!error) error = std::current_exception();
        next = points.size();
      }
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int k = 1; k < jobs; ++k) workers.emplace_back(work);
    work();
  }
  if (error) std::rethrow_exception(error);
}

void run_by_parallel(const SweepFolder& sweep, std::span<const std::size_t> points, const Elsewhere& where) {
  require("parallel", "parallel");
  const fs::path tasks =
      write_tasks(sweep, task_lines(points, static_cast<std::size_t>(where.points_per_task)));
  std::vector<std::string> all{"parallel", "--will-cite", "--workdir", fs::current_path().string()};
  if (where.jobs > 0) all.insert(all.end(), {"--jobs", std::to_string(where.jobs)});
  if (!where.hosts.empty()) all.insert(all.end(), {"--sshloginfile", where.hosts});
  all.insert(all.end(), {program::shell_line(where.command) + " --point {}", "::::", tasks.string()});
  program::run_logged(all, sweep.folder() / "parallel.txt");
  if (const int signal = program::interrupted())
    throw program::Interrupted("ended by a signal; the same command goes on with what is left", signal);
}

void run_by_slurm(const SweepFolder& sweep, std::span<const std::size_t> points, const Elsewhere& where) {
  require("sbatch", "slurm-client");
  const std::size_t least = (points.size() + most_tasks(sweep) - 1) / most_tasks(sweep);
  const std::size_t each = std::max(static_cast<std::size_t>(where.points_per_task), least);
  const std::vector<std::string> lines = task_lines(points, each);
  const fs::path tasks = fs::absolute(write_tasks(sweep, lines));
  std::string script = "#!/bin/sh\n# One task of a sweep: the points of its line.\n";
  script += program::shell_line(where.command) + " --point \"$(sed -n \"${SLURM_ARRAY_TASK_ID}p\" " +
            program::shell_word(tasks.string()) + ")\"\n";
  const fs::path file = fs::absolute(sweep.folder() / "task.sh");
  write_whole(file, script);
  std::string array = "--array=1-" + std::to_string(lines.size());
  if (where.jobs > 0) array += '%' + std::to_string(where.jobs);
  fs::create_directories(sweep.folder() / "slurm");
  std::vector<std::string> all{"sbatch",
                               "--wait",
                               array,
                               "--job-name=mallow-sweep",
                               "--chdir=" + fs::current_path().string(),
                               "--output=" + fs::absolute(sweep.folder() / "slurm").string() + "/%a.txt"};
  all.insert(all.end(), where.slurm_options.begin(), where.slurm_options.end());
  all.push_back(file.string());
  const fs::path log = sweep.folder() / "slurm.txt";
  program::run_logged(all, log);
  if (const int signal = program::interrupted())
    throw program::Interrupted("ended by a signal; the same command goes on with what is left", signal);
  std::ifstream in(log);
  std::string word;
  std::getline(in, word);
  if (!word.starts_with("Submitted")) throw program::RunFailure("sbatch: " + word);
}

}  // namespace mallow::sweep
