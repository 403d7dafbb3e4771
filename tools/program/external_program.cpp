#include "program/external_program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "program/failure.h"
#include "program/interrupt.h"

namespace mallow::program {

bool is_installed(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (::access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

namespace {

/// Starts a program; `actions` is given up.
pid_t start(std::vector<std::string>& arguments, posix_spawn_file_actions_t& actions) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw RunFailure(arguments[0] + " cannot be started: " + std::strerror(error));
  return child;
}

int exit_status(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Waits for a little while, at most, for a process to end.
class EndOf {
 public:
  explicit EndOf(pid_t process) : descriptor_(static_cast<int>(::syscall(SYS_pidfd_open, process, 0))) {}
  ~EndOf() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  EndOf(const EndOf&) = delete;
  EndOf& operator=(const EndOf&) = delete;

  void wait_a_little() const {
    constexpr int k_milliseconds = 20;  // in which a signal to this process is seen
    pollfd end{.fd = descriptor_, .events = POLLIN, .revents = 0};
    if (descriptor_ < 0)  // a kernel before Linux 5.3
      ::usleep(2000);
    else
      ::poll(&end, 1, k_milliseconds);
  }

 private:
  int descriptor_;
};

}  // namespace

int run_program(std::vector<std::string> arguments, const std::filesystem::path& folder) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addchdir_np(&actions, folder.empty() ? "." : folder.c_str());
  const pid_t child = start(arguments, actions);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return exit_status(status);
}

int run_logged(std::vector<std::string> arguments, const std::filesystem::path& log, AtEnd at_end,
               std::optional<int> kept) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  ::posix_spawn_file_actions_adddup2(&actions, 1, 2);
  // Onto itself: it is not closed then as the program starts, and not given to others that start meanwhile.
  if (kept) ::posix_spawn_file_actions_adddup2(&actions, *kept, *kept);
  const pid_t child = start(arguments, actions);
  const EndOf end(child);
  int status = 0;
  for (bool asked = false; ::waitpid(child, &status, asked ? 0 : WNOHANG) == 0;) {
    end.wait_a_little();
    if (interrupted() == 0 || at_end == AtEnd::wait) continue;
    ::kill(child, SIGTERM);
    if (at_end == AtEnd::end_tasks) {
      constexpr int k_microseconds = 200'000;  // two signals that come together are one
      ::usleep(k_microseconds);
      ::kill(child, SIGTERM);
    }
    asked = true;
  }
  return exit_status(status);
}

}  // namespace mallow::program
