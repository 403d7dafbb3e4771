#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "files/byte_reader.h"
#include "files/byte_writer.h"
#include "files/glb_series_frame.h"
#include "files/mesh_materials.h"
#include "files/meshopt.h"
#include "files/valid_columns.h"
#include "mallow/errors.h"
#include "mallow/files.h"

/// Frames of meshes that keep no vertex from one to the next, as one glTF: a node a frame, which is shown by
/// a scale that steps between 0 and 1. [Khronos, glTF 2.0 specification, 3.5.3; KHR_mesh_quantization;
/// EXT_meshopt_compression]
namespace mallow {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* k_meshopt = "EXT_meshopt_compression";
constexpr int k_short = 5122, k_byte = 5120, k_unsigned_short = 5123, k_unsigned_int = 5125, k_float = 5126;

Json material_json(const NamedMaterial& material) {
  const Vec3& color = material.appearance.color;
  return {{"name", material.name},
          {"pbrMetallicRoughness",
           {{"baseColorFactor", {color.x(), color.y(), color.z(), 1}},
            {"metallicFactor", 0},
            {"roughnessFactor", roughness(material.appearance.finish)}}}};
}

/// Adds to a list and gives the index.
std::size_t push(Json& list, Json value) {
  list.push_back(std::move(value));
  return list.size() - 1;
}

}  // namespace

struct GlbSeries::Work {
  NamedBodies named;
  std::vector<MeshBody> bodies;
  bool compress = false;
  std::vector<double> times;
  std::vector<std::size_t> frame_nodes;  ///< of each frame that has triangles
  std::vector<std::size_t> node_frames;  ///< the frame of each of these
  Json nodes = Json::array(), meshes = Json::array(), accessors = Json::array(), views = Json::array();
  std::string bytes;           ///< of the buffer
  std::uint64_t unpacked = 0;  ///< bytes of the buffer that programs unpack into

  void append(const std::string& more) {
    bytes += more;
    bytes.resize((bytes.size() + 3) / 4 * 4);
  }
  /// A column of a frame. stride: bytes of one of `count`.
  std::size_t add_view(const std::string& content, std::size_t count, std::size_t stride, const char* mode,
                       const char* filter) {
    const bool is_corners = std::string_view(mode) == "TRIANGLES";
    Json view = {{"buffer", compress ? 1 : 0}, {"byteOffset", compress ? unpacked : bytes.size()}};
    view["byteLength"] = count * stride;
    if (!is_corners) view["byteStride"] = stride;
    view["target"] = is_corners ? 34963 : 34962;
    if (compress) {
      Json packed = {{"buffer", 0},
                     {"byteOffset", bytes.size()},
                     {"byteLength", content.size()},
                     {"byteStride", stride},
                     {"count", count},
                     {"mode", mode}};
      if (*filter != '\0') packed["filter"] = filter;
      view["extensions"] = {{k_meshopt, std::move(packed)}};
      unpacked += (count * stride + 3) / 4 * 4;
    }
    append(content);
    return push(views, std::move(view));
  }
  /// Times or scales.
  std::size_t add_keys(const std::vector<float>& numbers, const char* type, std::size_t count) {
    Json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", numbers.size() * sizeof(float)}};
    for (const float number : numbers) append_little_endian(bytes, number);
    Json accessor = {{"bufferView", push(views, std::move(view))},
                     {"componentType", k_float},
                     {"count", count},
                     {"type", type}};
    if (count == numbers.size()) {
      accessor["min"] = {numbers.front()};
      accessor["max"] = {numbers.back()};
    }
    return push(accessors, std::move(accessor));
  }
  void add_frame(const PackedFrame& frame, std::size_t number);
  Json animation();
  std::string finish();
};

void GlbSeries::Work::add_frame(const PackedFrame& frame, std::size_t number) {
  const std::size_t positions = add_view(frame.position_bytes, frame.vertices, 8, "ATTRIBUTES", "");
  const bool any_normals = !frame.normal_bytes.empty();
  const std::size_t normals =
      any_normals ? add_view(frame.normal_bytes, frame.vertices, 4, "ATTRIBUTES", "OCTAHEDRAL") : 0;
  const std::size_t corners =
      add_view(frame.corner_numbers, frame.corners, frame.corner_bytes, "TRIANGLES", "");
  Json children = Json::array();
  for (const PackedPart& part : frame.parts) {
    Json attributes;
    attributes["POSITION"] = push(accessors, {{"bufferView", positions},
                                              {"byteOffset", 8 * part.first_vertex},
                                              {"componentType", k_short},
                                              {"count", part.vertices},
                                              {"type", "VEC3"},
                                              {"min", part.min},
                                              {"max", part.max}});
    if (any_normals)
      attributes["NORMAL"] = push(accessors, {{"bufferView", normals},
                                              {"byteOffset", 4 * part.first_vertex},
                                              {"componentType", k_byte},
                                              {"normalized", true},
                                              {"count", part.vertices},
                                              {"type", "VEC3"}});
    const std::size_t indices =
        push(accessors, {{"bufferView", corners},
                         {"byteOffset", frame.corner_bytes * part.first_corner},
                         {"componentType", frame.corner_bytes == 2 ? k_unsigned_short : k_unsigned_int},
                         {"count", part.corners},
                         {"type", "SCALAR"}});
    const std::string& name = named.names[part.body];
    Json primitive = {{"attributes", attributes}, {"indices", indices}};
    primitive["material"] = named.material_of[part.body];
    const std::size_t mesh =
        push(meshes, {{"name", name}, {"primitives", Json::array({std::move(primitive)})}});
    children.push_back(push(nodes, {{"name", name},
                                    {"mesh", mesh},
                                    {"translation", frame.origin},
                                    {"scale", {frame.scale, frame.scale, frame.scale}}}));
  }
  const int shown = number == 0 ? 1 : 0;
  frame_nodes.push_back(push(nodes, {{"name", "frame " + std::to_string(number)},
                                     {"scale", {shown, shown, shown}},
                                     {"children", std::move(children)}}));
  node_frames.push_back(number);
}

/// A frame is shown from its time to that of the next, the last as long as the one before it.
Json GlbSeries::Work::animation() {
  Json samplers = Json::array(), channels = Json::array();
  const std::size_t n = times.size();
  const auto scales = [&](std::initializer_list<float> shown) {
    std::vector<float> numbers;
    for (const float scale : shown) numbers.insert(numbers.end(), 3, scale);
    return add_keys(numbers, "VEC3", shown.size());
  };
  const std::size_t first = scales({1, 0}), inner = scales({0, 1, 0}), last = scales({0, 1, 1});
  for (std::size_t i = 0; i < frame_nodes.size(); ++i) {
    const std::size_t f = node_frames[i];
    std::vector<float> keys;
    if (f > 0) keys.push_back(static_cast<float>(times[0]));
    keys.push_back(static_cast<float>(times[f]));
    keys.push_back(static_cast<float>(f + 1 < n ? times[f + 1] : 2 * times[f] - times[f - 1]));
    const std::size_t sampler = push(samplers, {{"input", add_keys(keys, "SCALAR", keys.size())},
                                                {"interpolation", "STEP"},
                                                {"output", f == 0      ? first
                                                           : f + 1 < n ? inner
                                                                       : last}});
    channels.push_back({{"sampler", sampler}, {"target", {{"node", frame_nodes[i]}, {"path", "scale"}}}});
  }
  return {{"name", "frames"}, {"samplers", std::move(samplers)}, {"channels", std::move(channels)}};
}

/// Gives the JSON; `bytes` is whole then.
std::string GlbSeries::Work::finish() {
  Json gltf = {{"asset", {{"version", "2.0"}, {"generator", "mallow"}}}};
  if (!frame_nodes.empty()) {
    Json extensions = {"KHR_mesh_quantization"};
    if (compress) extensions.push_back(k_meshopt);
    gltf["extensionsUsed"] = extensions;
    gltf["extensionsRequired"] = extensions;
  }
  constexpr double k_half = 0.5 * std::numbers::sqrt2;
  Json root = {{"name", "surface"}, {"rotation", {-k_half, 0, 0, k_half}}};  // a quarter turn about x
  if (!frame_nodes.empty()) root["children"] = frame_nodes;
  Json all_nodes = nodes;
  const std::size_t top = push(all_nodes, std::move(root));
  gltf["scene"] = 0;
  gltf["scenes"] = Json::array({{{"nodes", {top}}}});
  gltf["nodes"] = std::move(all_nodes);
  if (frame_nodes.empty()) return gltf.dump();
  Json materials = Json::array();
  for (const NamedMaterial& material : named.materials) materials.push_back(material_json(material));
  gltf["materials"] = std::move(materials);
  gltf["meshes"] = meshes;
  if (times.size() > 1) gltf["animations"] = Json::array({animation()});
  gltf["accessors"] = accessors;
  gltf["bufferViews"] = views;
  Json buffers = Json::array({{{"byteLength", bytes.size()}}});
  if (compress)
    buffers.push_back({{"byteLength", unpacked}, {"extensions", {{k_meshopt, {{"fallback", true}}}}}});
  gltf["buffers"] = std::move(buffers);
  return gltf.dump();
}

bool can_compress_glb() {
  return has_meshopt();
}

GlbSeries::GlbSeries(std::span<const MeshBody> bodies, GlbPacking packing) : work_(std::make_unique<Work>()) {
  require_bodies(bodies);
  work_->compress = packing == GlbPacking::meshopt;
  if (work_->compress && !has_meshopt())
    throw ConfigError("packing",
                      "meshopt is not allowed: this build is without meshoptimizer; install "
                      "libmeshoptimizer-dev and configure again");
  work_->named = name_bodies(bodies, [](const std::string& name) { return name; });
  work_->bodies.assign(bodies.begin(), bodies.end());
}
GlbSeries::~GlbSeries() = default;
GlbSeries::GlbSeries(GlbSeries&&) noexcept = default;
GlbSeries& GlbSeries::operator=(GlbSeries&&) noexcept = default;

void GlbSeries::add(const Mesh& mesh, double time) {
  require_valid(mesh);
  require_finite(mesh);
  require_bodies(mesh, work_->bodies);
  const double before = work_->times.empty() ? -1 : work_->times.back();
  // Times are floats in the file, and must ascend there too.
  if (!std::isfinite(time) || time < 0 || static_cast<float>(time) <= static_cast<float>(before))
    throw ConfigError(
        "time", std::to_string(time) + " is not allowed: a number >= 0, above that of the frame before");
  const std::size_t number = work_->times.size();
  if (!mesh.triangles.empty()) work_->add_frame(pack_frame(mesh, work_->compress), number);
  work_->times.push_back(time);
}

std::size_t GlbSeries::frames() const {
  return work_->times.size();
}

void GlbSeries::write(const std::filesystem::path& file) && {
  std::string json = work_->finish();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::string& bytes = work_->bytes;
  const std::uint64_t size = 12 + 8 + std::uint64_t{json.size()} + (bytes.empty() ? 0 : 8 + bytes.size());
  require_readable_size(file, size);
  std::string head = "glTF";
  const auto append_word = [](std::string& text, std::uint64_t word) {
    append_little_endian(text, static_cast<std::uint32_t>(word));
  };
  append_word(head, 2);
  append_word(head, size);
  append_word(head, json.size());
  head += "JSON" + json;
  if (!bytes.empty()) {
    append_word(head, bytes.size());
    head += std::string("BIN\0", 4);
  }
  // A film takes as much memory as its file: there is no second copy of it.
  write_whole(file, [&](const std::filesystem::path& beside) {
    std::ofstream out(beside, std::ios::binary);
    out.write(head.data(), static_cast<std::streamsize>(head.size()));
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) fail_file(file, "cannot be written: the disk may be full");
  });
  *this = GlbSeries({});
}

}  // namespace mallow
