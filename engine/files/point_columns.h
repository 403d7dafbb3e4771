#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

/// The columns that a file of points may hold, whatever its format, and what is said of others.
namespace mallow {

/// In the order of a row's numbers.
inline constexpr std::array<const char*, 10> k_point_columns = {
    "x", "y", "z", "vx", "vy", "vz", "alpha", "stiffness", "plastic_yield", "temperature"};
/// Where those begin that particles have of their own.
inline constexpr std::size_t k_first_own_column = 6;
/// Which of them a file has.
using FoundColumns = std::array<bool, k_point_columns.size()>;

/// What a column takes where it does not take this value, "0 to 1"; null where it does.
const char* why_not_in_column(std::size_t column, double value);

/// Where a column that nothing reads was probably meant as one that the file lacks: what to say, else
/// nothing. `name` is in small letters.
std::string misnamed_column(std::string_view name, const FoundColumns& found);

/// A body's note of the columns that nothing reads, but for those that mallow writes itself; empty where
/// there are none.
std::string note_of_columns(std::span<const std::string> names);

/// "'a', 'b'", the first of many.
std::string listed_columns(std::span<const std::string> names);

}  // namespace mallow
