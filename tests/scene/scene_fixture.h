#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "mallow/errors.h"
#include "mallow/scene.h"

namespace mallow {

/// A folder of its own for every test, and scenes written into it.
class SceneFixture : public testing::Test {
 protected:
  SceneFixture() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("mallow_scene_") + test->name() + '_' + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~SceneFixture() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }

  Scene read(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    return read_scene(write("scene.toml", text), overrides);
  }

  /// What is wrong with a scene, each as a user sees it but without the folder.
  std::vector<std::string> problems(const std::string& text,
                                    const std::vector<std::string>& overrides = {}) const {
    try {
      read(text, overrides);
    } catch (const ConfigError& error) {
      return shown(error);
    }
    return {};
  }

  std::vector<std::string> shown(const ConfigError& error) const {
    std::vector<std::string> texts;
    const std::string prefix = folder_.string() + '/';
    for (const Problem& problem : error.problems()) {
      std::string text = to_string(problem);
      for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
        text.erase(at, prefix.size());
      texts.push_back(text);
    }
    return texts;
  }

  std::filesystem::path folder_;
};

/// The shortest scene there is; tests put lines before or after it.
inline const std::string k_small_scene = R"([solver]
support_radius = 2.0
[[material]]
name = "jelly"
[[body]]
material = "jelly"
box = { count = [2, 2, 2], spacing = 1.0 }
)";

}  // namespace mallow
