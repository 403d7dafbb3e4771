#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "files/file_fixture.h"

namespace mallow {
namespace write_whole_test {

TEST(write_whole, replaces_the_old_content_and_leaves_nothing_beside) {
  const TemporaryFolder folder;
  write_whole(folder / "a.txt", "old and long");
  write_whole(folder / "a.txt", "new");
  EXPECT_EQ(content_of(folder / "a.txt"), "new");
  write_whole(folder / "a.txt", std::string_view());
  EXPECT_EQ(content_of(folder / "a.txt"), "");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(write_whole, the_writer_gets_a_name_in_the_same_folder) {
  const TemporaryFolder folder;
  write_whole(folder / "a.png", [&](const std::filesystem::path& beside) {
    EXPECT_EQ(beside, folder / ".a.png.partial");
    std::ofstream(beside) << "picture";
  });
  EXPECT_EQ(content_of(folder / "a.png"), "picture");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(write_whole, keeps_the_old_content_when_the_writer_throws) {
  const TemporaryFolder folder;
  write_whole(folder / "a.txt", "old");
  EXPECT_THROW(write_whole(folder / "a.txt",
                           [](const std::filesystem::path& beside) {
                             std::ofstream(beside) << "half";
                             throw std::runtime_error("stopped");
                           }),
               std::runtime_error);
  EXPECT_EQ(content_of(folder / "a.txt"), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(write_whole, a_stale_partial_file_is_no_hindrance) {
  const TemporaryFolder folder;
  folder.file(".a.txt.partial", "left by a run that was killed, and longer");
  write_whole(folder / "a.txt", "new");
  EXPECT_EQ(content_of(folder / "a.txt"), "new");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(write_whole, a_name_without_folder_is_written_in_the_current_one) {
  const TemporaryFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  write_whole("a.txt", "here");
  std::filesystem::current_path(before);
  EXPECT_EQ(content_of(folder / "a.txt"), "here");
}

TEST(write_whole, says_why_it_cannot_write) {
  const TemporaryFolder folder;
  const auto message = [](const std::filesystem::path& file) {
    const Problem problem = io_problem([&] { write_whole(file, "x"); });
    EXPECT_EQ(problem.file, file.string());
    return problem.message;
  };
  EXPECT_EQ(message(folder / "missing/a.txt"), "cannot be written: No such file or directory");
  EXPECT_EQ(message(folder.path()), "cannot be written: Is a directory");
  EXPECT_EQ(message(folder.path() / ""), "cannot be written: it has no file name");
  folder.file("plain", "");
  EXPECT_EQ(message(folder / "plain/a.txt"), "cannot be written: Not a directory");
  EXPECT_EQ(io_problem([&] { write_whole(folder / "b.txt", [](const auto&) {}); }).message,
            "cannot be written: No such file or directory");
}

TEST(write_whole, an_unwritable_folder_is_refused_with_the_reason) {
  if (::getuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const TemporaryFolder folder;
  std::filesystem::permissions(folder.path(),
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_EQ(io_problem([&] { write_whole(folder / "a.txt", "x"); }).message,
            "cannot be written: Permission denied");
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
}

TEST(write_whole, a_device_takes_the_content_and_stays_a_device) {
  const std::filesystem::path full = "/dev/full";
  if (!std::filesystem::is_character_file(full)) GTEST_SKIP() << "there is no /dev/full";
  EXPECT_EQ(io_problem([&] { write_whole(full, "x"); }).message,
            "cannot be written: No space left on device");
  EXPECT_TRUE(std::filesystem::is_character_file(full));
}

TEST(write_whole, a_full_disk_keeps_the_old_file_and_leaves_no_partial_one) {
  const TemporaryFolder folder;
  if (::mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=64k") != 0) {
    GTEST_SKIP() << "a small file system cannot be mounted: " << std::strerror(errno);
  }
  ParticleFrame frame = three_particles();
  write_particles(folder / "a.ply", frame);
  const std::string before = content_of(folder / "a.ply");
  frame.positions.resize(10000, Vec3::Zero());
  frame.velocities.resize(10000, Vec3::Zero());
  frame.bodies.resize(10000);
  EXPECT_EQ(io_problem([&] { write_particles(folder / "a.ply", frame); }).message,
            "cannot be written: No space left on device");
  EXPECT_EQ(content_of(folder / "a.ply"), before);
  EXPECT_EQ(folder.entries(), 1u);
  EXPECT_EQ(::umount(folder.path().c_str()), 0);
}

}  // namespace write_whole_test
}  // namespace mallow
