#define XXH_INLINE_ALL
#include <sys/mount.h>
#include <sys/resource.h>
#include <xxhash.h>

#include <csignal>
#include <cstring>
#include <random>

#include "files/file_fixture.h"
#include "mallow/mallow.h"

namespace mallow {
namespace checkpoint_file_test {

namespace fs = std::filesystem;

SavedState small_state() {
  return {{{"clock", std::string("\0\1\2 seven", 9)}, {"empty", ""}, {"positions", std::string(200, 'x')}}};
}

/// 216 particles under way.
SavedState simulation_state() {
  Simulation s({.support_radius = 2.0f});
  s.add_body(sample(Lattice{.count = {6, 6, 6}, .corner = {0, 0, 1}}), {.alpha = 0.5f});
  s.add_collider({});
  for (int step = 0; step < 12; ++step) s.step();
  return s.save();
}

void expect_equal(const SavedState& a, const SavedState& b) {
  ASSERT_EQ(a.chunks.size(), b.chunks.size());
  for (std::size_t k = 0; k < a.chunks.size(); ++k) {
    EXPECT_EQ(a.chunks[k].name, b.chunks[k].name);
    EXPECT_EQ(a.chunks[k].bytes, b.chunks[k].bytes);
  }
}

std::string checkpoint_bytes(const SavedState& state) {
  const TemporaryFolder folder;
  write_checkpoint(folder / "checkpoint", state);
  return content_of(folder / "checkpoint");
}

/// Refused, with a message that names the file; returns it.
std::string why_refused(const TemporaryFolder& folder, const std::string& bytes) {
  const fs::path file = folder.file("checkpoint", bytes);
  const Problem problem = io_problem([&] { read_checkpoint(file); });
  EXPECT_EQ(problem.file, file.string());
  EXPECT_FALSE(problem.message.empty());
  return problem.message;
}

TEST(checkpoint_file, gives_back_what_was_written) {
  const TemporaryFolder folder;
  for (const SavedState& state : {SavedState{}, small_state(), simulation_state()}) {
    write_checkpoint(folder / "checkpoint", state);
    expect_equal(read_checkpoint(folder / "checkpoint"), state);
  }
}

TEST(checkpoint_file, keeps_the_one_before) {
  const TemporaryFolder folder;
  const fs::path file = folder / "checkpoint";
  for (const char* content : {"first", "second", "third"}) write_checkpoint(file, {{{"a", content}}});
  EXPECT_EQ(*read_checkpoint(file).find("a"), "third");
  EXPECT_EQ(previous_checkpoint(file), folder / "checkpoint.previous");
  EXPECT_EQ(*read_checkpoint(previous_checkpoint(file)).find("a"), "second");
  EXPECT_EQ(folder.entries(), 2u);
}

TEST(checkpoint_file, cut_off_anywhere_is_refused) {
  const TemporaryFolder folder;
  const std::string bytes = checkpoint_bytes(small_state());
  EXPECT_EQ(why_refused(folder, ""), "is empty");
  for (std::size_t size = 1; size < bytes.size(); ++size)
    EXPECT_NE(why_refused(folder, bytes.substr(0, size)).find("is cut off"), std::string::npos) << size;
  EXPECT_NE(why_refused(folder, bytes + '\0').find("after its end"), std::string::npos);
}

TEST(checkpoint_file, any_flipped_bit_is_found) {
  const TemporaryFolder folder;
  const std::string good = checkpoint_bytes(small_state());
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << bit % 8));
    why_refused(folder, bad);
    ASSERT_FALSE(testing::Test::HasFailure()) << "bit " << bit % 8 << " of byte " << bit / 8;
  }
}

TEST(checkpoint_file, of_a_simulation_never_gives_another_one_back) {
  const TemporaryFolder folder;
  const std::string good = checkpoint_bytes(simulation_state());
  std::mt19937 random(20240607);
  for (int k = 0; k < 500; ++k) {
    std::string bad = good;
    bad[random() % bad.size()] ^= static_cast<char>(1 << random() % 8);
    if (k % 5 == 0) bad[random() % bad.size()] ^= static_cast<char>(1 + random() % 255);
    if (k % 5 == 1) bad.erase(random() % bad.size(), 1 + random() % 64);
    if (k % 5 == 2) bad.insert(random() % bad.size(), std::string(1 + random() % 64, '\0'));
    if (k % 5 == 3) std::swap_ranges(bad.begin(), bad.begin() + 64, bad.end() - 64);
    why_refused(folder, bad);
  }
}

TEST(checkpoint_file, names_the_chunk_and_both_hashes) {
  const TemporaryFolder folder;
  std::string bytes = checkpoint_bytes({{{"positions", std::string(50, 'x')}}});
  bytes[bytes.size() - 20] ^= 1;
  const std::string why = why_refused(folder, bytes);
  EXPECT_TRUE(why.starts_with("chunk 'positions' is damaged: its hash is 0x")) << why;
  EXPECT_NE(why.find(", expected 0x"), std::string::npos) << why;
}

TEST(checkpoint_file, of_another_version_or_byte_order_is_refused) {
  const TemporaryFolder folder;
  std::string newer = checkpoint_bytes(small_state()), turned = newer;
  newer[8] = 2;
  EXPECT_EQ(why_refused(folder, newer), "is of version 2 of the format; this build of mallow reads 1");
  std::reverse(turned.begin() + 12, turned.begin() + 16);
  EXPECT_NE(why_refused(folder, turned).find("other byte order"), std::string::npos);
  EXPECT_NE(why_refused(folder, "ply\nformat ascii 1.0\n").find("is not a checkpoint"), std::string::npos);
}

/// One that was made to do harm: its hashes are right.
std::string forged(std::uint64_t size, std::uint64_t stored, const std::string& payload) {
  std::string bytes = checkpoint_bytes({}).substr(0, 16);
  append_raw(bytes, std::uint32_t{1});
  append_raw(bytes, std::uint32_t{1});
  bytes += 'a';
  append_raw(bytes, size);
  append_raw(bytes, stored);
  append_raw(bytes, static_cast<std::uint64_t>(XXH3_64bits(payload.data(), payload.size())));
  append_raw(bytes, static_cast<std::uint64_t>(XXH3_64bits(bytes.data(), bytes.size())));
  bytes += payload;
  append_raw(bytes, static_cast<std::uint64_t>(bytes.size() + 16));
  return bytes + bytes.substr(0, 8);
}

TEST(checkpoint_file, sizes_are_not_believed) {
  const TemporaryFolder folder;
  const std::string payload = "no frame of zstd";
  EXPECT_NE(why_refused(folder, forged(1u << 31, payload.size(), payload)).find("sizes differ"),
            std::string::npos);
  EXPECT_NE(why_refused(folder, forged(16, ~std::uint64_t{0}, payload)).find("is cut off"),
            std::string::npos);
  EXPECT_NE(why_refused(folder, forged(~std::uint64_t{0}, 16, payload)).find("at most"), std::string::npos);
}

/// Files of this process do not grow beyond so many bytes, as on a disk that is full.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileLimit() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit old_{};
  void (*old_handler_)(int) = nullptr;
};

std::string noise(std::size_t size) {
  std::mt19937 random(1);
  std::string bytes(size, '\0');
  for (char& c : bytes) c = static_cast<char>(random());
  return bytes;
}

void expect_both_kept_where_writing_fails(const fs::path& file, const std::function<void()>& write) {
  write_checkpoint(file, {{{"a", "first"}}});
  write_checkpoint(file, {{{"a", "second"}}});
  const Problem problem = io_problem(write);
  EXPECT_NE(problem.message.find("cannot be written"), std::string::npos) << problem.message;
  EXPECT_EQ(*read_checkpoint(file).find("a"), "second");
  EXPECT_EQ(*read_checkpoint(previous_checkpoint(file)).find("a"), "first");
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), {}), 2);
}

TEST(checkpoint_file, that_cannot_grow_leaves_both_earlier_ones) {
  const TemporaryFolder folder;
  expect_both_kept_where_writing_fails(folder / "checkpoint", [&] {
    const FileLimit limit(50000);
    write_checkpoint(folder / "checkpoint", {{{"a", noise(100000)}}});
  });
}

TEST(checkpoint_file, on_a_full_disk_leaves_both_earlier_ones) {
  const TemporaryFolder folder;
  if (::mount("none", folder.path().c_str(), "tmpfs", 0, "size=256k") != 0)
    GTEST_SKIP() << "only root can mount a small disk";
  expect_both_kept_where_writing_fails(folder / "checkpoint", [&] {
    write_checkpoint(folder / "checkpoint", {{{"a", noise(400000)}}});
  });
  ::umount(folder.path().c_str());
}

}  // namespace checkpoint_file_test
}  // namespace mallow
