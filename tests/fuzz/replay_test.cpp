#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <iterator>
#include <vector>

#include "files/file_fixture.h"
#include "fuzz/checkpoints.h"
#include "fuzz/formats.h"

namespace mallow::fuzz {

void PrintTo(const Format& format, std::ostream* out) {
  *out << format.name;
}

namespace replay_test {

namespace fs = std::filesystem;

std::string content_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

class replay : public testing::TestWithParam<Format> {};

TEST_P(replay, reads_every_seed) {
  Input input(GetParam());
  const TemporaryFolder temporary;
  fs::path seeds = fs::path(MALLOW_FUZZ_DIR) / "seeds";
  if (!fs::exists(seeds / GetParam().name)) {
    seeds = temporary.path();
    write_checkpoint_seeds(seeds);
  }
  const auto files = files_below(seeds / GetParam().name);
  EXPECT_GE(files.size(), 1u);
  for (const fs::path& file : files)
    EXPECT_EQ(input.read(content_of(file)), Verdict::read) << file << ": " << input.message();
}

TEST_P(replay, reads_or_refuses_by_name_what_was_a_finding) {
  Input input(GetParam());
  const auto files = files_below(fs::path(MALLOW_FUZZ_DIR) / "regressions" / GetParam().name);
  EXPECT_GE(files.size(), 1u);
  for (const fs::path& file : files) EXPECT_NO_THROW(input.read(content_of(file))) << file;
}

INSTANTIATE_TEST_SUITE_P(files, replay, testing::ValuesIn(formats().begin(), formats().end()),
                         [](const auto& format) { return std::string(format.param.name); });

/// Models of many programs, and broken ones, that Assimp tests its readers with.
TEST(replay_assimp, reads_or_refuses_by_name_every_test_model) {
  const fs::path folder = "/usr/share/assimp/models";
  if (!fs::exists(folder))
    GTEST_SKIP() << "SKIPPED: no " << folder << "; tools/setup --fuzz installs assimp-testmodels";
  std::size_t read = 0, refused = 0;
  for (const Format& format : formats()) {
    const std::string ending = std::string(".") + format.name;
    Input input(format);
    for (const fs::path& file : files_below(folder)) {
      std::string lower = file.extension().string();
      std::transform(lower.begin(), lower.end(), lower.begin(),
                     [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
      if (lower != ending) continue;
      Verdict verdict{};
      EXPECT_NO_THROW(verdict = input.read(content_of(file))) << file;
      ++(verdict == Verdict::read ? read : refused);
      if (verdict == Verdict::refused)
        std::cout << fs::relative(file, folder).string() << " is refused: " << input.message() << '\n';
    }
  }
  std::cout << read << " files are read, " << refused << " refused\n";
  EXPECT_GT(read, refused);
}

}  // namespace replay_test
}  // namespace mallow::fuzz
