#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace mallow {

/// What a script with another program's reader prints of a file, or nothing where that program is not
/// installed.
inline std::optional<nlohmann::json> read_with(const std::string& command,
                                               const std::filesystem::path& file) {
  const std::string whole = command + " '" + file.string() + "'";
  std::FILE* const pipe = ::popen(whole.c_str(), "r");
  std::string text;
  std::array<char, 4096> part{};
  while (const std::size_t got = std::fread(part.data(), 1, part.size(), pipe)) text.append(part.data(), got);
  const int status = ::pclose(pipe);
  if (WEXITSTATUS(status) == 77 || WEXITSTATUS(status) == 127) return std::nullopt;
  EXPECT_EQ(status, 0) << whole;
  return nlohmann::json::parse(text);
}

#define READ_WITH_VTK(name, file)                                                                \
  const auto name##_or_none = read_with("'" MALLOW_PYTHON "' '" MALLOW_READ_WITH_VTK "'", file); \
  if (!name##_or_none)                                                                           \
    GTEST_SKIP() << "SKIPPED: there is no VTK that reads it; tools/setup --vtk installs one";    \
  const nlohmann::json& name = *name##_or_none;                                                  \
  EXPECT_EQ(name.at("messages"), "")

#define READ_WITH_TINYUSDZ(name, file)                                                                 \
  const auto name##_or_none =                                                                          \
      read_with("'" MALLOW_NODE "' '" MALLOW_READ_WITH_TINYUSDZ "' '" MALLOW_TINYUSDZ "'", file);      \
  if (!name##_or_none) GTEST_SKIP() << "SKIPPED: there is no TinyUSDZ; tools/setup --usd installs it"; \
  const nlohmann::json& name = *name##_or_none

#define READ_WITH_GLTF_VALIDATOR(name, file)                                                        \
  const auto name##_or_none = read_with(                                                            \
      "'" MALLOW_NODE "' '" MALLOW_READ_WITH_GLTF_VALIDATOR "' '" MALLOW_GLTF_VALIDATOR "'", file); \
  if (!name##_or_none)                                                                              \
    GTEST_SKIP() << "SKIPPED: there is no glTF validator; tools/setup --gltf installs it";          \
  const nlohmann::json& name = *name##_or_none

/// times: of the animation [s], a string with commas between.
#define PLAY_WITH_THREE(name, times, file)                                                              \
  const auto name##_or_none = read_with(                                                                \
      "'" MALLOW_NODE "' '" MALLOW_READ_WITH_THREE "' '" MALLOW_THREE "' " + std::string(times), file); \
  if (!name##_or_none) GTEST_SKIP() << "SKIPPED: there is no three.js; tools/setup --gltf installs it"; \
  const nlohmann::json& name = *name##_or_none

}  // namespace mallow
