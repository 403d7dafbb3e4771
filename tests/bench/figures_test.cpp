#include <set>

#include "bench_fixture.h"

namespace mallow::test {
namespace figures_test {

using bench_figures = BenchTest;

#ifdef NDEBUG
const std::set<std::string> k_figures = {"fig2", "fig3", "fig5a", "fig5b", "fig5c", "fig5d"};
#else  // not optimised: those that take minutes are left out
const std::set<std::string> k_figures = {"fig2", "fig5a", "fig5d"};
#endif

TEST_F(bench_figures, all_of_them_hold_small) {
  std::vector<std::string> arguments = {"--small", "--no-pictures", "--threads", "1", "--only"};
  arguments.insert(arguments.end(), k_figures.begin(), k_figures.end());
  const nlohmann::json document = run_command("figures", arguments);
  expect_valid("figures");
  std::set<std::string> figures;
  for (const nlohmann::json& row : document.at("rows")) {
    figures.insert(row.at("figure"));
    EXPECT_TRUE(row.at("holds")) << row;
  }
  EXPECT_EQ(figures, k_figures);
  for (const nlohmann::json& run : document.at("runs")) {
    const nlohmann::json& curves = document.at("curves").at(run.at("figure")).at(run.at("take"));
    for (const nlohmann::json& curve : curves)
      EXPECT_EQ(curve.size(), run.at("steps").get<std::size_t>() + 1) << run;
  }
}

TEST_F(bench_figures, one_comes_with_its_picture_and_no_other) {
  const nlohmann::json document = run_command("figures", {"--only", "fig5a", "--small"});
  expect_valid("figures");
  EXPECT_EQ(document.at("runs").size(), 1u);
  for (const nlohmann::json& row : document.at("rows")) EXPECT_EQ(row.at("figure"), "fig5a");
  std::vector<std::string> pictures = names_in(folder_ / "out");
  std::erase_if(pictures, [](const std::string& name) { return !name.ends_with(".png"); });
  EXPECT_EQ(pictures, std::vector<std::string>{"figures_fig5a.png"}) << "those it is made of are gone";
  EXPECT_EQ(read_text(at("out/figures_fig5a.png")).substr(1, 3), "PNG");
}

TEST_F(bench_figures, what_is_not_known_is_refused) {
  expect_refused("figures", {"--only", "fig4"}, {"fig4", "fig2, fig3, fig5a, fig5b, fig5c, fig5d"});
}

}  // namespace figures_test
}  // namespace mallow::test
