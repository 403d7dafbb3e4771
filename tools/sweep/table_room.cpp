#include "sweep/table_room.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "mallow/errors.h"
#include "sweep/sweep_points.h"
#include "sweep/sweep_table.h"

namespace mallow::sweep {
namespace fs = std::filesystem;
namespace {

/// Generous: numbers of 16 characters, and a message of 256 in each row, as a CSV and as a database.
off_t bytes_of_table(const SweepFolder& sweep) {
  constexpr std::size_t k_cell = 16, k_message = 256, k_formats = 2, k_least = 64 * 1024;
  const std::size_t row = table_columns(sweep).size() * k_cell + k_message;
  return static_cast<off_t>(k_least + k_formats * row * sweep.points().size());
}

}  // namespace

TableRoom::TableRoom(const SweepFolder& sweep) : file_(sweep.folder() / ".room") {
  const int descriptor = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
  const int error = descriptor < 0 ? errno : ::posix_fallocate(descriptor, 0, bytes_of_table(sweep));
  if (descriptor >= 0) ::close(descriptor);
  if (error == 0 || error == EINVAL || error == EOPNOTSUPP) return;  // a disk that cannot say so
  release();
  throw IoError({sweep.folder().string(), 0, 0, "--out",
                 "has no room for the table: " + std::system_category().message(error)});
}

void TableRoom::release() {
  std::error_code ignored;
  fs::remove(file_, ignored);
}

}  // namespace mallow::sweep
