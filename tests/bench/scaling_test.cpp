#include <filesystem>
#include <fstream>
#include <set>

#include "bench_fixture.h"

namespace mallow::test {
namespace scaling_test {

using bench_scaling = BenchTest;

TEST_F(bench_scaling, rows_follow_the_schema_and_states_do_not_depend_on_threads) {
  const nlohmann::json document = run_command("scaling", {"--max-particles", "4000", "--repeats", "1",
                                                          "--threads", "2", "--material", "paste", "fluid"});
  expect_valid("scaling");
  std::set<std::string> states;
  for (const nlohmann::json& row : document.at("rows")) states.insert(row.at("state_hash"));
  EXPECT_EQ(document.at("rows").size(), 12u);  // two materials, three sizes, two numbers of threads
  EXPECT_EQ(states.size(), 6u);
  for (const nlohmann::json& row : document.at("rows")) {
    const bool several = row.at("threads") == 2;
    EXPECT_EQ(row.at("speedup").is_number(), several);
    EXPECT_EQ(row.at("weak_efficiency").is_number(), several && row.at("particles") > 1000);
    EXPECT_GT(row.at("bytes_per_particle").at("held"), 150);  // fluid: 191
  }
  EXPECT_EQ(document.at("extrapolation").at("measured"), false);
  EXPECT_EQ(document.at("extrapolation").at("rows").size(), 4u);  // two materials, two numbers of cores
}

TEST_F(bench_scaling, one_thread_has_nothing_to_compare_with) {
  const nlohmann::json document =
      run_command("scaling", {"--max-particles", "2000", "--steps", "2", "--repeats", "1", "--threads", "1"});
  expect_valid("scaling");
  EXPECT_EQ(document.at("rows").size(), 2u);
  EXPECT_EQ(document.at("extrapolation").at("rows").size(), 0u);
}

TEST_F(bench_scaling, bodies_share_the_particles) {
  const nlohmann::json document =
      run_command("scaling", {"--max-particles", "1000", "--steps", "2", "--repeats", "1", "--threads", "2",
                              "--bodies", "125", "--between", "touching"});
  expect_valid("scaling");
  for (const nlohmann::json& row : document.at("rows")) {
    EXPECT_EQ(row.at("particles"), 1000);
    EXPECT_EQ(row.at("bodies"), 125);
    EXPECT_EQ(row.at("box"), "2x2x2");
    EXPECT_EQ(row.at("between"), "touching");
  }
}

TEST_F(bench_scaling, of_bodies_in_a_heap_tells_what_contact_takes_and_that_asleep_it_takes_nothing) {
  double moving = 0;
  for (const std::string between : {"heap", "asleep"}) {
    const nlohmann::json document = run_command(
        "scaling", {"--material", "elastic", "--bodies", "8", "--between", between, "--max-particles", "1000",
                    "--steps", "20", "--repeats", "7", "--threads", "1"});
    expect_valid("scaling");
    const nlohmann::json& row = document["rows"].at(0);
    EXPECT_EQ(row["between"], between);
    EXPECT_EQ(row["bodies"], 8);
    EXPECT_EQ(row["contact_share"].get<double>() > 0.1, between == "heap");
    // Moving, a step of these takes about 0.2 ms, asleep 0.003.
    const double least = row["ms_per_step"]["min"].get<double>();
    if (between == "heap")
      moving = least;
    else
      EXPECT_LT(least, 0.25 * moving);
  }
}

TEST_F(bench_scaling, too_many_particles_are_refused_before_anything_runs) {
  // What is needed, what there is, and what fits.
  expect_refused("scaling", {"--max-particles", "10000000000000", "--threads", "1"},
                 {"--max-particles", "particles need", "GiB", "available", "fits"});
}

TEST_F(bench_scaling, a_file_of_someone_else_is_not_overwritten) {
  const std::filesystem::path notes = folder_ / "notes.json";
  std::ofstream(notes) << "{\"mine\": 1}\n";
  expect_refused("scaling", {"--json", notes.string()},
                 {"--json", "notes.json", "no results of mallow-bench"});
  EXPECT_EQ(read_text(notes), "{\"mine\": 1}\n");
}

TEST_F(bench_scaling, what_makes_no_sense_is_refused) {
  expect_refused("scaling", {"--material", "jelly"}, {"jelly", "elastic, gel, paste, fluid"});
  expect_refused("scaling", {"--max-particles", "0"}, {"--max-particles"});
  expect_refused("scaling", {"--max-particles", "many"}, {"--max-particles"});
  expect_refused("scaling", {"--max-particles", "500"}, {"--max-particles", "--min-particles", "1000"});
  expect_refused("scaling", {"--steps", "0"}, {"--steps"});
  expect_refused("scaling", {"--repeats", "-1"}, {"--repeats"});
}

}  // namespace scaling_test
}  // namespace mallow::test
