#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "mallow/errors.h"
#include "sweep/sweep_spec.h"

namespace mallow::sweep {
namespace samples_test {

/// A spec file of its own.
class sweep_spec : public testing::Test {
 protected:
  sweep_spec()
      : file_(std::filesystem::temp_directory_path() /
              ("mallow_spec_" + std::to_string(::getpid()) + ".toml")) {}
  ~sweep_spec() override { std::filesystem::remove(file_); }
  SweepSpec read(const std::string& text) const {
    std::ofstream(file_) << text;
    return read_spec(file_);
  }
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "none";
  }
  std::vector<std::vector<std::string>> points(const std::string& text) const {
    SweepSpec spec = read(text);
    return sample_points(spec);
  }
  std::filesystem::path file_;
};

const std::string k_two_keys =
    "[[vary]]\nkey = \"a\"\nfrom = 0.0\nto = 1.0\n[[vary]]\nkey = \"b\"\nfrom = 1\nto = 1000.0\nscale = "
    "\"log\"\n";

TEST_F(sweep_spec, grid_has_every_combination_with_the_ends_of_ranges) {
  const auto all = points(
      "scene = \"s.toml\"\n[[vary]]\nkey = \"a\"\nvalues = [\"x\", true, 2]\n[[vary]]\nkey = \"b\"\nfrom = "
      "1.0\nto = 100.0\n"
      "count = 3\nscale = \"log\"\n");
  ASSERT_EQ(all.size(), 9u);
  EXPECT_EQ(std::set(all.begin(), all.end()).size(), 9u);
  EXPECT_EQ(all.front(), (std::vector<std::string>{"'x'", "1"}));
  EXPECT_EQ(all[1][1], "10");
  EXPECT_EQ(all.back(), (std::vector<std::string>{"2", "100"}));
}

TEST_F(sweep_spec, latin_hypercube_has_one_point_in_each_part_of_each_key) {
  const auto all = points("scene = \"s.toml\"\nmethod = \"latin_hypercube\"\npoints = 50\n" + k_two_keys);
  std::set<int> a, b;
  for (const auto& point : all) {
    a.insert(static_cast<int>(std::stod(point[0]) * 50));
    b.insert(static_cast<int>(std::log10(std::stod(point[1])) / 3 * 50));
  }
  EXPECT_EQ(a.size(), 50u);
  EXPECT_EQ(b.size(), 50u);
}

TEST_F(sweep_spec, sobol_begins_with_its_known_points) {
  const auto all = points(
      "scene = \"s.toml\"\nmethod = \"sobol\"\npoints = 3\n[[vary]]\nkey = \"a\"\nfrom = 0.0\nto = "
      "1.0\n[[vary]]\nkey = "
      "\"b\"\nfrom = 0.0\nto = 1.0\n");
  const std::vector<std::vector<std::string>> known{{"0.5", "0.5"}, {"0.75", "0.25"}, {"0.25", "0.75"}};
  EXPECT_EQ(all, known);
}

TEST_F(sweep_spec, same_seed_gives_the_same_points_and_another_gives_others) {
  const std::string random = "scene = \"s.toml\"\nmethod = \"random\"\npoints = 20\nseed = ";
  EXPECT_EQ(points(random + "3\n" + k_two_keys), points(random + "3\n" + k_two_keys));
  EXPECT_NE(points(random + "3\n" + k_two_keys), points(random + "4\n" + k_two_keys));
}

TEST_F(sweep_spec, whole_numbers_stay_whole_and_all_of_a_range_come) {
  std::set<std::string> seen;
  for (const auto& point : points("scene = \"s.toml\"\nmethod = \"random\"\npoints = 200\n[[vary]]\nkey = "
                                  "\"n\"\nfrom = 1\nto = 4\n"))
    seen.insert(point[0]);
  EXPECT_EQ(seen, (std::set<std::string>{"1", "2", "3", "4"}));
}

TEST_F(sweep_spec, logarithmic_ranges_between_whole_numbers_are_logarithmic) {
  int below = 0;
  for (const auto& point : points("scene = \"s.toml\"\nmethod = \"latin_hypercube\"\npoints = "
                                  "40\n[[vary]]\nkey = \"a\"\nfrom = 1\nto = 10000\n"
                                  "scale = \"log\"\n"))
    below += std::stod(point[0]) < 100 ? 1 : 0;
  EXPECT_NEAR(below, 20, 1);
}

TEST_F(sweep_spec, values_are_as_short_as_they_come_also_inside_of_lists) {
  const auto all = points(
      "scene = \"s.toml\"\n[[vary]]\nkey = \"a\"\nvalues = [0.3, 2.0, [0.1, [1e-9, 3]], {size = 0.7}]\n");
  const std::vector<std::vector<std::string>> known{
      {"0.3"}, {"2.0"}, {"[0.1, [1e-09, 3]]"}, {"{size = 0.7}"}};
  EXPECT_EQ(all, known);
}

TEST_F(sweep_spec, ranges_that_fall_or_have_one_value_are_refused) {
  const auto range = [&](const std::string& from, const std::string& to) {
    return refusal("scene = \"s.toml\"\n[[vary]]\nkey = \"a\"\nfrom = " + from + "\nto = " + to +
                   "\ncount = 2\n");
  };
  EXPECT_EQ(range("1", "2"), "none");
  EXPECT_NE(range("0.5", "0.5").find(":5:"), std::string::npos) << range("0.5", "0.5");
  EXPECT_NE(range("2", "-1.5").find("vary[0].to: -1.5 is not allowed: above from, which is 2"),
            std::string::npos)
      << range("2", "-1.5");
}

TEST_F(sweep_spec, all_that_is_wrong_is_told_by_line_and_with_what_is_allowed) {
  const std::string said = refusal(
      "scene = \"s.toml\"\nmethod = \"sobl\"\nframes = 0\nmeasure = []\n[[vary]]\nkey = \"a\"\nfrom = "
      "-1.0\nto = 2.0\nscale = "
      "\"log\"\n");
  for (const char* part : {":2:", "\"sobol\"", ":3:", "[1, 100000000]", ":4:", "unknown key", "above 0"})
    EXPECT_NE(said.find(part), std::string::npos) << part << " in " << said;
  EXPECT_NE(refusal("scene = \"s.toml\"\nmethod = \"random\"\n" + k_two_keys).find("points: is missing"),
            std::string::npos);
  EXPECT_NE(refusal("scene = \"s.toml\"\n").find("[[vary]]"), std::string::npos);
  EXPECT_NE(refusal("scene = \"s.toml\"\n[[vary]]\nkey = [\"a\", \"b\"]\nvalues = [1]\n[[vary]]\nkey = "
                    "\"b\"\nvalues = [1]\n")
                .find("'b' twice"),
            std::string::npos);
  EXPECT_NE(refusal("scene = ").find(":1:"), std::string::npos);
  EXPECT_THROW(read_spec("no such file.toml"), IoError);
}

}  // namespace samples_test
}  // namespace mallow::sweep
