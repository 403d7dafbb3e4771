#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "mallow/level_set.h"
#include "mallow/surface.h"

namespace mallow {
namespace level_set_vdb_test {

TEST(level_set_vdb, opens_in_the_python_module_of_openvdb_with_the_distances_it_was_drawn_with) {
  const Vec3 center(1, 2, 3);
  const std::vector<Vec3> positions{center};
  Surfacer surfacer({.voxel_size = 0.1f, .kind = SurfaceKind::spheres});
  surfacer.draw({.positions = positions, .bodies = {{.spacing = 2}}});
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("mallow-" + std::to_string(::getpid()) + ".vdb");
  std::ofstream(file, std::ios::binary) << level_set_vdb(surfacer);

  std::ostringstream command;
  command << "'" MALLOW_PYTHON "' '" MALLOW_READ_LEVEL_SET "' '" << file.string() << "'";
  const double radius = 1.1, distances[] = {-0.25, -0.1, 0, 0.1, 0.25, -1, 30};
  for (const double d : distances) command << ' ' << 1 + radius + d << " 2 3";
  std::FILE* const pipe = ::popen(command.str().c_str(), "r");
  std::string text;
  char part[256];
  while (const std::size_t got = std::fread(part, 1, sizeof part, pipe)) text.append(part, got);
  const int status = ::pclose(pipe);
  std::filesystem::remove(file);
  if (WEXITSTATUS(status) == 77 || WEXITSTATUS(status) == 127)
    GTEST_SKIP() << "SKIPPED: there is no python3-openvdb; tools/setup installs it";
  ASSERT_EQ(status, 0);

  std::istringstream lines(text);
  std::string name, kind;
  double background = 0, value = 0;
  lines >> name >> kind >> background;
  EXPECT_EQ(name, "surface");
  EXPECT_EQ(kind, "level_set");
  EXPECT_NEAR(background, 0.3, 1e-6);
  for (const double d : distances) {
    ASSERT_TRUE(lines >> value);
    EXPECT_NEAR(value, std::clamp(d, -0.3, 0.3), 0.003) << d;
  }
}

}  // namespace level_set_vdb_test
}  // namespace mallow
