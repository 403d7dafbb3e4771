#include "cli/sweep_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/elsewhere_options.h"
#include "cli/messages.h"
#include "mallow/errors.h"
#include "mallow/scene.h"
#include "program/failure.h"
#include "program/interrupt.h"
#include "program/machine.h"
#include "program/shared_frames.h"
#include "program/threads_option.h"
#include "sweep/point_runs.h"
#include "sweep/schedulers.h"
#include "sweep/sweep_table.h"
#include "sweep/table_room.h"

namespace mallow::cli {
namespace {

namespace fs = std::filesystem;
using sweep::Outcome;
using sweep::SweepFolder;

struct SweepOptions {
  std::string spec, out, point;
  ElsewhereOptions elsewhere;
  bool dry_run = false;
  int threads = 0, points_per_task = 1;
};

/// The folder is for this process alone while that lives, but for those that run points of it. Null on a disk
/// without locks.
std::unique_ptr<program::FileLock> lock_folder(const fs::path& folder) {
  std::unique_ptr<program::FileLock> lock;
  try {
    lock = program::FileLock::try_lock(folder / sweep::k_sweep_lock);
  } catch (const IoError& error) {
    print_warning(error.what());
    return nullptr;
  }
  if (!lock)
    throw ConfigError("--out",
                      folder.string() +
                          " is in use by another mallow sweep; wait until that one has ended, or give "
                          "another folder");
  return lock;
}

/// Only a folder that is empty, or holds this sweep, is written into. Returns the lock on it: none for those
/// that run points for another.
std::unique_ptr<program::FileLock> take_folder(const SweepOptions& options) {
  const fs::path folder = options.out, mark = folder / "sweep.toml";
  if (fs::exists(folder) && !fs::exists(mark))
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().filename() != sweep::k_sweep_lock)
        throw ConfigError("--out", options.out + " is not empty, and holds no sweep; give another folder");
  fs::create_directories(folder);
  auto lock = options.point.empty() ? lock_folder(folder) : nullptr;
  if (!fs::equivalent(fs::absolute(options.spec).parent_path(), folder) ||
      fs::path(options.spec).filename() != "sweep.toml")
    fs::copy_file(options.spec, mark, fs::copy_options::overwrite_existing);
  return lock;
}

struct Slots {
  int jobs, threads;
};

/// Every run takes the threads of its slot: small ones gain little from a second thread.
Slots slots(const SweepOptions& options, std::size_t points) {
  const int cores = program::resolve_threads(0);
  const int jobs = options.elsewhere.jobs > 0
                       ? options.elsewhere.jobs
                       : std::min(cores, static_cast<int>(std::min<std::size_t>(points, 4096)));
  return {std::max(1, jobs), options.threads > 0 ? options.threads : std::max(1, cores / std::max(1, jobs))};
}

void print_points(const SweepFolder& sweep) {
  for (std::size_t point = 0; point < sweep.points().size(); ++point) {
    std::printf("%zu", point);
    for (std::size_t k = 0; k < sweep.points()[point].size(); ++k)
      std::printf(" %s=%s", sweep.spec().vary[k].key.c_str(), sweep.points()[point][k].c_str());
    std::printf("\n");
  }
}

/// A few frames of the first point that runs tell what all take.
void print_estimate(const SweepFolder& sweep, const Slots& slots) {
  const int frames = sweep.spec().frames.value_or(read_scene(sweep.spec().scene, {}, {}).run.frames);
  const int few = std::max(1, frames / 20), more = 2 * few;
  constexpr std::size_t k_most_tries = 16;
  const std::size_t tries = std::min(sweep.points().size(), k_most_tries);
  std::optional<double> start;
  std::size_t point = 0;
  while (!(start = sweep.probe(point, slots.threads, few)) && point + 1 < tries) ++point;
  const auto longer = start ? sweep.probe(point, slots.threads, more) : std::nullopt;
  if (!longer) {
    std::printf("estimate none: of the first %zu points none runs\n", tries);
    return;
  }
  const double frame = std::max(0.0, (*longer - *start) / few),
               each = std::max(0.0, *start - frame * few) + frame * frames;
  std::printf("points %zu\nestimate %.3g s a point, %.3g s in all, %d at a time\n", sweep.points().size(),
              each, each * static_cast<double>(sweep.points().size()) / slots.jobs, slots.jobs);
  if (sweep.spec().images) std::printf("a picture of each comes on top\n");
}

/// The command of a worker, but for its points.
std::vector<std::string> worker(const SweepOptions& options) {
  return {own_program(),
          "sweep",
          fs::absolute(options.spec).string(),
          "--out",
          fs::absolute(options.out).string(),
          "--jobs",
          "1",
          "--threads",
          std::to_string(threads_of_task(options.elsewhere, options.threads))};
}

/// By a scheduler; what it could not run stays open. Returns what was said of hosts that could not be
/// reached.
std::string run_by_scheduler(const SweepOptions& options, const std::vector<std::size_t>& points) {
  const sweep::Elsewhere where = elsewhere(options.elsewhere, options.out, "mallow-sweep");
  auto each = static_cast<std::size_t>(options.points_per_task);
  if (options.elsewhere.on == "slurm") {
    const std::size_t most = sweep::most_slurm_tasks(where);
    each = std::max(each, (points.size() + most - 1) / most);
  }
  return run_elsewhere(options.elsewhere, {worker(options), sweep::point_words(points, each)}, where);
}

/// Folders that a longer sweep left are no part of this one.
void warn_of_left_over(const SweepFolder& sweep) {
  const std::vector<std::size_t> numbers = sweep.left_over();
  if (numbers.empty()) return;
  std::string names;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    names += (names.empty() ? "" : ", ") + std::to_string(numbers[i]);
    if (last > i) names += " to " + std::to_string(numbers[last]);
    i = last;
  }
  print_warning((sweep.folder() / "points").string() + " still has points " + names +
                " of an earlier, longer sweep, which the spec no longer names; the table, plots and sheet "
                "are without them");
}

void say(std::size_t point, const Outcome& outcome) {
  std::fprintf(stderr, "point %zu %s, %.3g s%s%s\n", point, name(outcome.status), outcome.seconds,
               outcome.message.empty() ? "" : ": ", outcome.message.c_str());
}

/// All outcomes, the table and its pictures; what is still open is a failure. ran: of those that could not
/// even keep what became of them. said: of hosts that could not be reached.
void finish(const SweepFolder& sweep, const std::map<std::size_t, Outcome>& ran, sweep::TableRoom& room,
            const std::string& said) {
  warn_of_left_over(sweep);
  std::vector<Outcome> outcomes;
  std::array<std::size_t, 4> counts{};
  for (std::size_t point = 0; point < sweep.points().size(); ++point) {
    outcomes.push_back(sweep.outcome(point));
    const auto known = ran.find(point);
    // One that was done, and is open now, is of another scene than the table: somebody changed it meanwhile.
    if (outcomes.back().status == Outcome::Status::open && known != ran.end() &&
        known->second.status != Outcome::Status::done)
      outcomes.back() = known->second;
    ++counts[static_cast<std::size_t>(outcomes.back().status)];
  }
  room.release();
  write_table(sweep, outcomes);
  draw_plots(sweep, outcomes);
  make_sheet(sweep, outcomes);
  const auto count = [&](Outcome::Status status) { return counts[static_cast<std::size_t>(status)]; };
  std::printf("points %zu\ndone %zu\nrefused %zu\nfailed %zu\ntable %s\n", outcomes.size(),
              count(Outcome::Status::done), count(Outcome::Status::refused), count(Outcome::Status::failed),
              (sweep.folder() / "table.csv").c_str());
  if (const std::size_t open = count(Outcome::Status::open))
    throw program::RunFailure(std::to_string(open) +
                              " points were not run, or with a scene that was changed meanwhile; the same "
                              "command goes on with them" +
                              (said.empty() ? "" : "; GNU parallel said:\n  " + said));
}

/// A command for each point that is not done.
void print_list(const SweepFolder& sweep, const SweepOptions& options) {
  for (std::size_t point = 0; point < sweep.points().size(); ++point)
    if (sweep.outcome(point).status != Outcome::Status::done)
      std::printf("%s\n", sweep.worker(worker(options), point).c_str());
}

std::map<std::size_t, Outcome> run_points(const SweepFolder& sweep, const SweepOptions& options,
                                          const std::vector<std::size_t>& points) {
  const Slots room = slots(options, points.size());
  std::map<std::size_t, Outcome> ran;
  run_here(sweep, points, room.jobs, room.threads, [&](std::size_t point, const Outcome& outcome) {
    say(point, outcome);
    ran[point] = outcome;
  });
  return ran;
}

/// All points that are not done, and the table.
void run_all(const SweepFolder& sweep, const SweepOptions& options) {
  std::vector<std::size_t> points;
  for (std::size_t point = 0; point < sweep.points().size(); ++point)
    if (sweep.outcome(point).status != Outcome::Status::done) points.push_back(point);
  if (!points.empty()) {
    sweep.check_measures();
    // The table would be that of before, where this is cut off.
    for (const char* table : {"table.csv", "table.sqlite"}) fs::remove(sweep.folder() / table);
  }
  sweep::TableRoom room(sweep);
  std::map<std::size_t, Outcome> ran;
  std::string said;
  if (options.elsewhere.by_scheduler() && !points.empty())
    said = run_by_scheduler(options, points);
  else
    ran = run_points(sweep, options, points);
  finish(sweep, ran, room, said);
}

void run_sweep(const SweepOptions& options) {
  check(options.elsewhere);
  SweepFolder sweep(sweep::read_spec(options.spec), options.out, own_program());
  check_table(sweep);
  if (options.dry_run) {
    sweep.check_measures();
    print_points(sweep);
    return print_estimate(sweep, slots(options, sweep.points().size()));
  }
  if (options.out.empty()) throw ConfigError("--out", "is missing: the folder of the sweep");
  if (options.elsewhere.on == "list") return print_list(sweep, options);
  std::vector<std::size_t> named;
  if (!options.point.empty()) named = sweep::point_list(options.point, sweep.points().size());
  const auto lock = take_folder(options);
  program::watch_for_interrupt();
  if (named.empty())
    run_all(sweep, options);
  else
    run_points(sweep, options, named);
}

}  // namespace

void add_sweep_command(CLI::App& app) {
  const auto options = std::make_shared<SweepOptions>();
  CLI::App* command =
      app.add_subcommand("sweep", "Run one scene many times with other values; make a table of it");
  command->add_option("SPEC", options->spec, "What is turned, and measured (TOML), see below")->required();
  command->add_option("--out", options->out, "Folder of the sweep; what is done there is not run again");
  command->add_flag("--dry-run", options->dry_run, "Print the points and an estimate of the time");
  add_elsewhere_options(*command, options->elsewhere, "points", {"local", "parallel", "slurm", "list"});
  program::add_threads_option(*command, options->threads, "Threads of each run; 0: those of its slot");
  command->add_option("--point", options->point,
                      "Run these points alone, and make no table: 7, or 3,7,10:20");
  command
      ->add_option("--points-per-task", options->points_per_task,
                   "For --on parallel and slurm: points of one task")
      ->check(CLI::Range(1, 1'000'000));
  command->footer(
      "A spec: scene = \"drop.toml\"; method = \"grid\", \"random\", \"latin_hypercube\" or \"sobol\", with "
      "points = 100 and seed = 1\n"
      "for all but a grid; [[vary]] tables with key = \"material[0].alpha\" and values = [0, 0.3], or from, "
      "to above it, scale = \"linear\" or\n"
      "\"log\", and count in a grid; or points_file = \"points.csv\", whose header has keys; frames; images; "
      "measures, columns of\n"
      "`mallow run --series` with .last, .min, .max or .mean; [[plot]] tables with x, y and color, columns "
      "of the table.\n"
      "key may be a list of keys that get the same value. images = true takes a picture of each point's last "
      "frame; DIR/sheet.html\n"
      "shows them beside each other, under their numbers and values.\n"
      "DIR/table.csv and table.sqlite have a row for each point, points/00007 its scene, series, report and "
      "what it said.");
  command->callback([options] { run_sweep(*options); });
}

}  // namespace mallow::cli
