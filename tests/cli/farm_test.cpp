// The demo's 240 frames on four slots of this machine, all of them killed twice on the way: what is there at
// the end is what one process makes.
#include <csignal>
#include <functional>
#include <memory>
#include <thread>

#include "cli/program.h"
#include "program/external_program.h"

namespace mallow::test {
namespace farm_test {

namespace fs = std::filesystem;

constexpr std::size_t k_slots = 4;

class cli_farm : public CliTest {
 protected:
  using Slots = std::vector<std::unique_ptr<Running>>;

  static Slots start(const std::vector<std::string>& share) {
    Slots slots;
    for (std::size_t k = 0; k < k_slots; ++k) slots.push_back(std::make_unique<Running>(share));
    return slots;
  }
  /// Once so many files are there; false where that does not come.
  static bool kill_all_at(std::size_t files, const fs::path& folder, Slots& slots) {
    for (int k = 0; k < 1'000'000; ++k) {
      if (names_in(folder).size() >= files) {
        for (auto& slot : slots) slot->send(SIGKILL);
        for (auto& slot : slots) EXPECT_EQ(slot->wait().exit_code, -1) << "it was still at work";
        return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  /// Shares a command, kills all slots at 60 and at 150 files, and lets the third four end.
  void finish_after_two_kills(const std::vector<std::string>& share, const fs::path& folder) const {
    for (const std::size_t files : {60u, 150u}) {
      Slots slots = start(share);
      ASSERT_TRUE(kill_all_at(files, folder, slots)) << folder;
      ASSERT_LT(names_in(folder).size(), 241u);
    }
    for (auto& slot : start(share)) {
      const Outcome outcome = slot->wait();
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    }
  }
  void expect_same_files(const std::string& part) const {
    const std::vector<std::string> names = names_in(folder_ / "one" / part);
    EXPECT_EQ(names_in(folder_ / "many" / part), names);
    EXPECT_EQ(names.size(), 241u);
    for (const std::string& name : names)
      EXPECT_TRUE(read_text(folder_ / "one" / part / name) == read_text(folder_ / "many" / part / name))
          << name;
  }
};

TEST_F(cli_farm, frames_of_the_demo_on_four_slots_that_are_killed_twice_are_those_of_one_process) {
  const fs::path data = MALLOW_DATA_DIR;
  if (!fs::exists(data / "meshes/bunny00.off")) GTEST_SKIP() << "its mesh is not there: tools/fetch_meshes";
  const std::string out = at("one");
  Outcome outcome =
      run_mallow({"run", (data / "scenes/demo.toml").string(), "--out", out, "--no-surface", "--no-images"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  fs::copy(out, at("many"), fs::copy_options::recursive);
  const auto command = [&](const std::string& verb, const std::string& folder) {
    std::vector<std::string> words = {verb, at(folder)};
    if (verb == "render")
      words.insert(words.end(),
                   {"--set", "render.width=160", "--set", "render.height=90", "--set", "render.samples=1"});
    return words;
  };
  for (const std::string verb : {"surface", "render"}) {
    outcome = run_mallow(command(verb, "one"));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    std::vector<std::string> share = command(verb, "many");
    share.insert(share.end(), {"--threads", "1", "--share"});
    finish_after_two_kills(share, folder_ / "many" / (verb == "surface" ? "surface" : "images"));
  }
  outcome = run_mallow({"compare", out, at("many")});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "same bits: 241 frames, 241 surfaces\n");
  expect_same_files("images");
  if (program::is_installed("ffmpeg")) {
    EXPECT_TRUE(read_text(folder_ / "one/film.mp4") == read_text(folder_ / "many/film.mp4"));
  }
}

}  // namespace farm_test
}  // namespace mallow::test
