#include <charconv>
#include <cmath>
#include <string>
#include <system_error>

#include "files/byte_reader.h"
#include "files/byte_writer.h"
#include "files/ply.h"
#include "files/text_reader.h"
#include "files/valid_columns.h"
#include "mallow/files.h"

namespace mallow {
namespace {

constexpr std::string_view k_time_comment = "mallow time ";
constexpr std::string_view k_step_comment = "mallow step ";

std::string particle_header(const ParticleFrame& frame, std::size_t bytes_of_body) {
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment ";
  append_number(header += k_time_comment, frame.time, k_double_digits);
  header += "\ncomment ";
  header += k_step_comment;
  header += std::to_string(frame.step) + "\nelement vertex " + std::to_string(frame.positions.size()) + '\n';
  for (const char* name : {"x", "y", "z", "vx", "vy", "vz"})
    header += std::string("property float ") + name + '\n';
  header += std::string("property ") + ply_body_type(bytes_of_body) + " group\n";
  if (!frame.ids.empty()) header += "property uint id\nproperty uint generation\n";
  if (!frame.alphas.empty()) header += "property float alpha\n";
  if (!frame.temperatures.empty()) header += "property float temperature\n";
  return header + "end_header\n";
}

std::string_view require_comment(const PlyReader& ply, std::string_view begin) {
  for (const std::string_view comment : ply.header().comments) {
    if (comment.starts_with(begin)) return comment.substr(begin.size());
  }
  ply.fail("this is not a frame of particles: there is no 'comment " + std::string(begin) + "<number>'");
}

double read_time(const PlyReader& ply) {
  const std::string_view text = require_comment(ply, k_time_comment);
  const std::optional<double> time = parse_number(text);
  if (!time || !std::isfinite(*time))
    ply.fail("time " + in_quotes(text) + " is not allowed: a finite number");
  return *time;
}

std::int64_t read_step(const PlyReader& ply) {
  const std::string_view text = require_comment(ply, k_step_comment);
  std::int64_t step = -1;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, step);
  if (error != std::errc{} || stop != end || step < 0) {
    ply.fail("step " + in_quotes(text) + " is not allowed: a whole number from 0 on");
  }
  return step;
}

}  // namespace

void write_particles(const std::filesystem::path& file, const ParticleFrame& frame) {
  require_valid(frame);
  const std::size_t bytes_of_body = body_bytes(frame.bodies);
  std::string bytes = particle_header(frame, bytes_of_body);
  const std::size_t total =
      bytes.size() +
      frame.positions.size() * (24 + bytes_of_body + (frame.ids.empty() ? 0 : 8) +
                                (frame.alphas.empty() ? 0 : 4) + (frame.temperatures.empty() ? 0 : 4));
  require_readable_size(file, total);
  bytes.reserve(total);
  for (std::size_t i = 0; i < frame.positions.size(); ++i) {
    append_little_endian(bytes, frame.positions[i]);
    append_little_endian(bytes, frame.velocities[i]);
    append_body(bytes, frame.bodies[i], bytes_of_body);
    if (!frame.ids.empty()) append_little_endian(bytes, slot_of(frame.ids[i]));
    if (!frame.ids.empty()) append_little_endian(bytes, generation_of(frame.ids[i]));
    if (!frame.alphas.empty()) append_little_endian(bytes, frame.alphas[i]);
    if (!frame.temperatures.empty()) append_little_endian(bytes, frame.temperatures[i]);
  }
  write_whole(file, bytes);
}

ParticleFrame read_particles(const std::filesystem::path& file) {
  PlyReader ply(file);
  ParticleFrame frame;
  frame.time = read_time(ply);
  frame.step = read_step(ply);
  const PlyElement& vertex = ply.require("vertex");
  const auto position = ply.find_vector(vertex, {"x", "y", "z"}, true);
  const auto velocity = ply.find_vector(vertex, {"vx", "vy", "vz"}, true);
  const auto body = ply.find_scalar(vertex, "group");
  if (!body) ply.fail("element 'vertex' lacks 'group'");
  const auto alpha = ply.find_scalar(vertex, "alpha"), temperature = ply.find_scalar(vertex, "temperature");
  const auto id = ply.find_scalar(vertex, "id"), generation = ply.find_scalar(vertex, "generation");
  while (const PlyElement* element = ply.next_element()) {
    if (element != &vertex) continue;
    frame.positions.reserve(element->count);
    frame.velocities.reserve(element->count);
    frame.bodies.reserve(element->count);
    while (ply.next_row()) {
      frame.positions.push_back(ply.finite_vector(*position));
      frame.velocities.push_back(ply.finite_vector(*velocity));
      frame.bodies.push_back(ply.index(ply.value(*body), k_most_bodies, "group"));
      if (alpha) frame.alphas.push_back(static_cast<float>(ply.value(*alpha)));
      if (temperature) frame.temperatures.push_back(static_cast<float>(ply.value(*temperature)));
      if (!id || !generation) continue;
      constexpr std::uint64_t k_most = std::uint64_t{1} << 32;
      frame.ids.push_back(ParticleId{ply.index(ply.value(*generation), k_most, "generation")} << 32 |
                          ply.index(ply.value(*id), k_most, "id"));
    }
  }
  return frame;
}

void write_state_csv(const std::filesystem::path& file, const ParticleFrame& frame) {
  require_valid(frame);
  std::string text = "id,x,y,z,vx,vy,vz,body";
  if (!frame.alphas.empty()) text += ",alpha";
  if (!frame.temperatures.empty()) text += ",temperature";
  text += '\n';
  for (std::size_t i = 0; i < frame.positions.size(); ++i) {
    text += std::to_string(frame.ids.empty() ? i : frame.ids[i]);
    for (const Vec3* vector : {&frame.positions[i], &frame.velocities[i]}) {
      for (const float value : *vector) append_number(text += ',', value, k_float_digits);
    }
    text += ',' + std::to_string(frame.bodies[i]);
    for (const std::vector<float>* column : {&frame.alphas, &frame.temperatures})
      if (!column->empty()) append_number(text += ',', (*column)[i], k_float_digits);
    text += '\n';
  }
  require_readable_size(file, text.size());
  write_whole(file, text);
}

}  // namespace mallow
