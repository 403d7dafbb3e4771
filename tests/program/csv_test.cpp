#include "program/csv.h"

#include <gtest/gtest.h>

namespace mallow::program {
namespace csv_test {

TEST(csv, cells_come_back_as_they_were) {
  const std::vector<std::string> cells{"plain", "a,b", "say \"so\"", "", "[0, 1]", "\"", ",\","};
  std::string line = csv_line(cells);
  EXPECT_EQ(line.back(), '\n');
  line.pop_back();
  EXPECT_EQ(csv_cells(line), cells);
  EXPECT_EQ(csv_cell("plain"), "plain");
}

TEST(csv, blanks_around_cells_and_an_ending_of_windows_are_no_part_of_them) {
  EXPECT_EQ(csv_cells(" a , \"b, c\" ,\r"), (std::vector<std::string>{"a", "b, c", ""}));
}

}  // namespace csv_test
}  // namespace mallow::program
