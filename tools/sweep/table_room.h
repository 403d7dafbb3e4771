#pragma once

#include <filesystem>

namespace mallow::sweep {

class SweepFolder;

/// Room on the disk for a sweep's table, kept while points are run: where they fill the disk, those that were
/// done still get their table. It is a file, given up by release().
class TableRoom {
 public:
  /// Throws IoError where there is no room already.
  explicit TableRoom(const SweepFolder& sweep);
  ~TableRoom() { release(); }
  TableRoom(const TableRoom&) = delete;
  TableRoom& operator=(const TableRoom&) = delete;
  void release();

 private:
  std::filesystem::path file_;
};

}  // namespace mallow::sweep
