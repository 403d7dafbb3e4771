// Runs against small ones that are kept in golden/, by the command that a user has for it after an update.
#include <algorithm>

#include "cli/program.h"
#include "levels.h"

namespace mallow::test {
namespace golden_test {

namespace fs = std::filesystem;

const fs::path k_golden = fs::path(MALLOW_GOLDEN_DIR);

class cli_golden : public CliTest, public testing::WithParamInterface<std::string> {
 protected:
  Outcome run_anew(int threads, const std::string& level) const {
    return run_mallow({"run", (k_golden / (GetParam() + ".toml")).string(), "--out", at("anew"),
                       "--overwrite", "--no-images", "--threads", std::to_string(threads), "--set",
                       "solver.instruction_level=" + level});
  }
  Outcome compare(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"compare", (k_golden / GetParam()).string(), at("anew")});
    return run_mallow(more);
  }
};

/// One binary gives the same bits at every instruction level and number of threads; gcc and clang for x86-64,
/// with and without optimisation, were found to give the same. On other machines, where nobody has looked, to
/// come near is enough.
#ifdef __x86_64__
const std::vector<std::string> k_allowed = {};
#else
const std::vector<std::string> k_allowed = {"--tolerance", "0.001h"};
#endif

TEST_P(cli_golden, run_is_that_which_is_kept) {
  for (const InstructionLevel level : levels())
    for (const int threads : {1, 3}) {
      const Outcome outcome = run_anew(threads, name(level));
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
      const Outcome compared = compare(k_allowed);
      EXPECT_EQ(compared.exit_code, 0)
          << threads << " threads, " << name(level) << ":\n"
          << compared.out << compared.err
          << "where motion is meant to change: .github/CONTRIBUTING.md, \"Golden states\"";
      if (k_allowed.empty()) {
        EXPECT_EQ(compared.out, "same bits: 3 frames, 3 surfaces\n");
      }
    }
}

TEST_P(cli_golden, other_motion_is_found_in_the_frame_where_it_begins) {
  const Outcome outcome =
      run_mallow({"run", (k_golden / (GetParam() + ".toml")).string(), "--out", at("anew"), "--no-images",
                  "--set", "solver.gravity=[0.0, 0.0, -0.3001]"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Outcome compared = compare();
  EXPECT_EQ(compared.exit_code, 1);
  EXPECT_NE(compared.out.find("first frame that differs: 1\nlargest distance: "), std::string::npos)
      << compared.out;
}

INSTANTIATE_TEST_SUITE_P(kept, cli_golden, testing::Values("touching", "melting"),
                         [](const auto& scene) { return scene.param; });

}  // namespace golden_test
}  // namespace mallow::test
