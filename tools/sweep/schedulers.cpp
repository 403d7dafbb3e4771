#include "sweep/schedulers.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "mallow/files.h"
#include "program/external_program.h"
#include "program/failure.h"
#include "program/interrupt.h"
#include "program/shell_word.h"
#include "sweep/text.h"

namespace mallow::sweep {
namespace fs = std::filesystem;
namespace {

/// What Slurm's MaxArraySize is where nobody set it.
constexpr std::size_t k_slurm_default_array = 1001;

fs::path write_tasks(const Tasks& tasks, const Elsewhere& where) {
  fs::create_directories(where.folder);
  std::string text;
  for (const std::string& word : tasks.words) text += word + '\n';
  const fs::path file = fs::absolute(where.folder / "tasks.txt");
  write_whole(file, text);
  return file;
}

void require(const char* program, const char* package) {
  if (!program::is_installed(program))
    throw program::RunFailure(std::string(program) + " is not installed (Debian's package " + package + ")");
}

/// What ssh and GNU parallel say themselves, the first lines of it, each once; tasks say the rest.
std::string said_of_hosts(const fs::path& log) {
  constexpr int k_most_lines = 6;
  std::istringstream lines(text_of(log));
  std::string said;
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    const bool theirs = line.starts_with("ssh: ") || line.starts_with("parallel: ") ||
                        line.starts_with("bash: ") || line.starts_with("sh: ") ||
                        line.find("Permission denied") != line.npos || line.find("Host key") != line.npos;
    if (!theirs || said.find(line) != said.npos) continue;
    if (++count <= k_most_lines) said += (said.empty() ? "" : "\n  ") + line;
  }
  return said;
}

[[noreturn]] void end_by_signal(const std::string& what) {
  throw program::Interrupted("ended by a signal; " + what + "the same command goes on with what is left",
                             program::interrupted());
}

/// A job that Slurm has taken.
struct SlurmJob {
  std::string number, cluster;  ///< cluster: empty where it is the only one

  std::vector<std::string> arguments(std::vector<std::string> command) const {
    if (!cluster.empty()) command.push_back("--clusters=" + cluster);
    command.push_back(number);
    return command;
  }
};

/// From what sbatch said: "Submitted batch job 3", or "3" and "3;cluster" where it is asked for --parsable,
/// with warnings before it. Its number is empty where the job was not taken.
SlurmJob submitted_job(const std::string& said) {
  constexpr std::string_view k_before = "Submitted batch job ", k_digits = "0123456789";
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    const bool told = line.starts_with(k_before);
    const std::string rest = told ? line.substr(k_before.size()) : line;
    const std::string number = rest.substr(0, rest.find_first_not_of(k_digits));
    const std::string behind = rest.substr(number.size());
    if (number.empty() || (!told && !behind.empty() && behind.front() != ';')) continue;
    constexpr std::string_view k_on_cluster = " on cluster ";
    if (behind.starts_with(';')) return {number, behind.substr(1)};
    if (behind.starts_with(k_on_cluster)) return {number, behind.substr(k_on_cluster.size())};
    return {number, ""};
  }
  return {};
}

/// Whether it still waits or runs, by the numbers that squeue printed, one a line.
bool is_listed(const SlurmJob& job, const std::string& said) {
  std::istringstream numbers(said);
  for (std::string number; numbers >> number;)
    if (number == job.number) return true;
  return false;
}

[[noreturn]] void cancel(const SlurmJob& job) {
  const bool is_cancelled = program::run_program(job.arguments({"scancel"}), "") == 0;
  end_by_signal(is_cancelled ? "Slurm's job " + job.number + " is cancelled; "
                             : "Slurm's job " + job.number + " could not be cancelled, and may still run; ");
}

/// Asks for the job now and then, and less often the longer it takes: sbatch --wait sees the end of a short
/// one ten seconds late, and leaves the job running where it is told to end.
void wait_for(const SlurmJob& job, const fs::path& log) {
  using Clock = std::chrono::steady_clock;
  using namespace std::chrono_literals;
  constexpr auto k_longest_pause = 5s;
  constexpr auto k_longest_silence = 10min;
  auto pause = Clock::duration(200ms);
  auto last_answer = Clock::now();
  for (;;) {
    for (const auto until = Clock::now() + pause; Clock::now() < until; std::this_thread::sleep_for(20ms))
      if (program::interrupted()) cancel(job);
    pause = std::min<Clock::duration>(pause * 3 / 2, k_longest_pause);
    const int code =
        program::run_logged(job.arguments({"squeue", "--noheader", "--format=%F", "--jobs"}), log);
    if (program::interrupted()) cancel(job);
    const std::string said = text_of(log);
    if (code == 0 && !is_listed(job, said)) return;
    if (said.find("Invalid job id") != said.npos) return;  // it is over, and Slurm has forgotten it
    if (code == 0) last_answer = Clock::now();
    if (Clock::now() - last_answer > k_longest_silence)
      throw program::RunFailure("squeue does not answer any more: " + said + "; Slurm's job " + job.number +
                                " may still run");
  }
}

}  // namespace

std::size_t most_slurm_tasks(const Elsewhere& where) {
  require("scontrol", "slurm-client");
  fs::create_directories(where.folder);
  const fs::path file = where.folder / "slurm.txt";
  program::run_logged({"scontrol", "show", "config"}, file);
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("MaxArraySize")) continue;
    const std::size_t most = std::strtoull(line.c_str() + line.find('=') + 1, nullptr, 10);
    if (most > 1) return most - 1;
  }
  return k_slurm_default_array - 1;
}

std::string run_by_parallel(const Tasks& tasks, const Elsewhere& where) {
  require("parallel", "parallel");
  const fs::path list = write_tasks(tasks, where);
  // Tasks that are told to end have ten seconds for the step that they are at.
  std::vector<std::string> all{"parallel",  "--will-cite",       "--workdir", fs::current_path().string(),
                               "--termseq", "TERM,10000,KILL,25"};
  if (where.jobs > 0) all.insert(all.end(), {"--jobs", std::to_string(where.jobs)});
  if (!where.hosts.empty()) all.insert(all.end(), {"--sshloginfile", where.hosts});
  all.insert(all.end(), {program::shell_line(tasks.command) + " {}", "::::", list.string()});
  const fs::path log = where.folder / "parallel.txt";
  program::run_logged(all, log, program::AtEnd::end_tasks);
  if (program::interrupted()) end_by_signal("");
  return said_of_hosts(log);
}

void run_by_slurm(const Tasks& tasks, const Elsewhere& where) {
  require("sbatch", "slurm-client");
  const fs::path list = write_tasks(tasks, where);
  const std::string script = "#!/bin/sh\n# One task of many: the word of its line.\nexec " +
                             program::shell_line(tasks.command) + " \"$(sed -n \"${SLURM_ARRAY_TASK_ID}p\" " +
                             program::shell_word(list.string()) + ")\"\n";
  const fs::path file = fs::absolute(where.folder / "task.sh");
  write_whole(file, script);
  std::string array = "--array=1-" + std::to_string(tasks.words.size());
  if (where.jobs > 0) array += '%' + std::to_string(where.jobs);
  fs::create_directories(where.folder / "slurm");
  std::vector<std::string> all{"sbatch", array, "--job-name=" + where.name,
                               "--chdir=" + fs::current_path().string(),
                               "--output=" + fs::absolute(where.folder / "slurm").string() + "/%a.txt"};
  all.insert(all.end(), where.slurm_options.begin(), where.slurm_options.end());
  all.push_back(file.string());
  const fs::path log = where.folder / "slurm.txt";
  // It is not told to end with this program: a job that it has sent would be one of which nobody knows.
  const int code = program::run_logged(all, log, program::AtEnd::wait);
  const SlurmJob job = submitted_job(text_of(log));
  if (job.number.empty() && program::interrupted()) end_by_signal("");
  if (code != 0 || job.number.empty()) {
    const std::string said = text_of(log);
    throw program::RunFailure("sbatch: " + (said.empty() ? "exit code " + std::to_string(code) : said));
  }
  wait_for(job, where.folder / "queue.txt");
}

}  // namespace mallow::sweep
