#include "fuzz/formats.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "fuzz/checkpoints.h"
#include "mallow/errors.h"
#include "mallow/files.h"
#include "mallow/scene.h"

namespace mallow::fuzz {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

bool all_finite(const std::vector<Vec3>& vectors) {
  return std::all_of(vectors.begin(), vectors.end(), [](const Vec3& v) { return v.allFinite(); });
}

template <class T>
bool one_each_or_none(const std::vector<T>& values, std::size_t count) {
  return values.empty() || values.size() == count;
}

void read_as_mesh(const std::filesystem::path& file) {
  const Mesh mesh = read_mesh(file);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle)
      require(vertex < mesh.vertices.size(), "a triangle has a corner that is no vertex");
  require(all_finite(mesh.vertices) && all_finite(mesh.normals) && all_finite(mesh.velocities),
          "a mesh has numbers that are not finite");
  require(one_each_or_none(mesh.normals, mesh.vertices.size()) &&
              one_each_or_none(mesh.velocities, mesh.vertices.size()) &&
              one_each_or_none(mesh.material_ids, mesh.vertices.size()),
          "a column of a mesh is not as long as its vertices");
}

void read_as_points(const std::filesystem::path& file) {
  const Body body = read_points(file, 1.0f);
  require(!body.positions.empty(), "there are no points");
  require(all_finite(body.positions) && all_finite(body.velocities), "points are not finite");
  require(one_each_or_none(body.velocities, body.positions.size()), "velocities are not one each");
}

void read_as_particles(const std::filesystem::path& file) {
  const ParticleFrame frame = read_particles(file);
  require(all_finite(frame.positions) && all_finite(frame.velocities), "particles are not finite");
  require(frame.velocities.size() == frame.positions.size() && frame.bodies.size() == frame.positions.size(),
          "a column of particles is not as long as their positions");
}

/// What was read must come back from what is printed, to the letter.
void read_as_scene(const std::filesystem::path& file) {
  const std::string printed = print_scene(read_scene(file));
  const std::filesystem::path copy = file.parent_path() / "printed.toml";
  std::ofstream(copy, std::ios::binary) << printed;
  try {
    require(print_scene(read_scene(copy)) == printed, "a printed scene reads as another one");
  } catch (const Error& error) {
    throw std::logic_error(std::string("a printed scene is refused: ") + error.what());
  }
}

/// A line for each --set of a small scene.
void read_as_overrides(const std::filesystem::path& file) {
  std::ifstream lines(file, std::ios::binary);
  std::vector<std::string> overrides;
  for (std::string line; std::getline(lines, line);) overrides.push_back(line);
  const std::filesystem::path scene = file.parent_path() / "overrides.txt.toml";
  if (!std::filesystem::exists(scene))
    std::ofstream(scene) << "[solver]\nsupport_radius = 2.0\n[[material]]\nname = \"jelly\"\n[[body]]\n"
                            "material = \"jelly\"\nbox = { count = [2, 2, 2], spacing = 1.0 }\n"
                            "[[collider]]\nunion = [{ sphere = { radius = 1.0 } }]\n";
  read_scene(scene, overrides);
}

constexpr Format k_formats[] = {{"obj", "input.obj", read_as_mesh},
                                {"ply", "input.ply", read_as_mesh},
                                {"stl", "input.stl", read_as_mesh},
                                {"off", "input.off", read_as_mesh},
                                {"csv", "input.csv", read_as_points},
                                {"ply_points", "input.ply", read_as_points},
                                {"particles", "input.ply", read_as_particles},
                                {"scene", "input.toml", read_as_scene},
                                {"overrides", "input.txt", read_as_overrides, "--set"},
                                {"checkpoint", "input", read_as_checkpoint},
                                // Of its chunks, settings and particles there is no more to say than names.
                                {"saved_state", "input", read_as_saved_state, ""}};

}  // namespace

std::span<const Format> formats() {
  return k_formats;
}

const Format& format(std::string_view name) {
  for (const Format& one : k_formats)
    if (name == one.name) return one;
  throw std::out_of_range("there is no format " + std::string(name));
}

Input::Input(const Format& format) : format_(format) {
  std::string folder = (std::filesystem::temp_directory_path() / "mallow_fuzz_XXXXXX").string();
  if (!::mkdtemp(folder.data())) throw std::system_error(errno, std::generic_category(), folder);
  folder_ = folder;
  file_ = folder_ / format.file_name;
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), file_.string());
  // What the seeds of scenes name.
  std::ofstream(folder_ / "mesh.off") << "OFF\n4 4 0\n0 0 0\n4 0 0\n0 4 0\n0 0 4\n"
                                         "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  std::ofstream(folder_ / "points.csv") << "x,y,z\n1,2,3\n";
}

Input::~Input() {
  ::close(descriptor_);
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

Verdict Input::read(std::string_view content) {
  if (::ftruncate(descriptor_, 0) != 0 ||
      ::pwrite(descriptor_, content.data(), content.size(), 0) != static_cast<ssize_t>(content.size()))
    throw std::system_error(errno, std::generic_category(), file_.string());
  message_.clear();
  try {
    format_.read(file_);
    return Verdict::read;
  } catch (const Error& error) {
    message_ = error.what();
  }
  const std::string place = format_.place ? format_.place : file_.string();
  require(message_.find(place) != std::string::npos, "a message does not say what it is about");
  return Verdict::refused;
}

}  // namespace mallow::fuzz
