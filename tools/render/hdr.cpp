#include "render/hdr.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>
#include <string>
#include <system_error>

// Its other readers are not built: they are what hostile files aim at.
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wsign-compare"
#endif
#include <stb_image.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include "mallow/errors.h"
#include "mallow/files.h"

namespace mallow::render {
namespace {

constexpr std::size_t k_most_bytes = std::size_t{1} << 29;
constexpr std::size_t k_most_pixels = std::size_t{1} << 26;
constexpr float k_brightest = 1e6f;
constexpr float k_pi = std::numbers::pi_v<float>;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& why) {
  throw IoError({.file = file.string(), .field = {}, .message = why});
}

std::vector<unsigned char> read_bytes(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) fail(file, "is a folder, not a Radiance picture");
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail(file, "cannot be read: " + std::generic_category().message(errno));
  const auto size = std::filesystem::file_size(file, error);
  if (error || size > k_most_bytes)
    fail(file, "is too large for a Radiance picture: at most 512 MiB are allowed");
  std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) fail(file, "cannot be read: " + std::generic_category().message(errno));
  return bytes;
}

/// Where rows begin: behind the empty line and the line of sizes after it.
std::size_t begin_of_rows(const std::vector<unsigned char>& bytes) {
  std::size_t at = 0;
  const auto line = [&] {
    const std::size_t begin = at;
    while (at < bytes.size() && bytes[at] != '\n') ++at;
    const std::size_t length = at - begin;
    if (at < bytes.size()) ++at;
    return length;
  };
  while (at < bytes.size() && line() > 0) {
  }
  line();
  return at;
}

/// Throws where a row is cut off or broken: stb_image takes what is missing for black, and a run of nothing
/// keeps it for ever.
void require_whole_rows(const std::filesystem::path& file, const std::vector<unsigned char>& bytes, int width,
                        int height) {
  std::size_t at = begin_of_rows(bytes);
  const auto left = [&] { return bytes.size() - at; };
  const auto require = [&](std::size_t count) {
    if (left() < count) fail(file, "ends early: it is too short for its pixels");
  };
  const auto is_run_length = [&] {
    return width >= 8 && width < 32768 && left() >= 4 && bytes[at] == 2 && bytes[at + 1] == 2 &&
           bytes[at + 2] < 128;
  };
  if (!is_run_length())
    return require(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int row = 0; row < height; ++row) {
    require(4);
    if (!is_run_length() || bytes[at + 2] * 256 + bytes[at + 3] != width)
      fail(file, "is no whole Radiance picture: row " + std::to_string(row) + " does not begin as one");
    at += 4;
    for (int channel = 0; channel < 4; ++channel)
      for (int column = 0; column < width;) {
        require(1);
        const int code = bytes[at++], count = code > 128 ? code - 128 : code;
        if (count == 0 || count > width - column)
          fail(file,
               "is no whole Radiance picture: row " + std::to_string(row) + " has a run that does not fit");
        const std::size_t values = code > 128 ? 1 : static_cast<std::size_t>(count);
        require(values);
        at += values;
        column += count;
      }
  }
}

}  // namespace

Vec3 HdrPicture::direction(int x, int y) const {
  const float polar = k_pi * (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
  const float around = 2 * k_pi * (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
  return {std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)};
}

float HdrPicture::solid_angle(int y) const {
  const auto ring = [&](int row) {
    return std::cos(k_pi * static_cast<float>(row) / static_cast<float>(height));
  };
  return 2 * k_pi * (ring(y) - ring(y + 1)) / static_cast<float>(width);
}

Vec3 HdrPicture::at(const Vec3& direction) const {
  const float polar = std::acos(std::clamp(direction.z(), -1.0f, 1.0f)) / k_pi;
  const float around = std::atan2(direction.y(), direction.x()) / (2 * k_pi);
  const float x = (around - std::floor(around)) * static_cast<float>(width) - 0.5f;
  const float y = polar * static_cast<float>(height) - 0.5f;
  const float left = std::floor(x), top = std::floor(y);
  const auto pixel = [&](int column, int row) -> const Vec3& {
    column = (column % width + width) % width;
    row = std::clamp(row, 0, height - 1);
    return radiance[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(column)];
  };
  const int column = static_cast<int>(left), row = static_cast<int>(top);
  const Vec3 above = pixel(column, row) + (x - left) * (pixel(column + 1, row) - pixel(column, row));
  const Vec3 below =
      pixel(column, row + 1) + (x - left) * (pixel(column + 1, row + 1) - pixel(column, row + 1));
  return above + (y - top) * (below - above);
}

HdrPicture HdrPicture::shrunk(int most_width, int most_height) const {
  HdrPicture small{std::min(width, most_width), std::min(height, most_height), {}};
  for (int y = 0; y < small.height; ++y) {
    const int top = static_cast<int>(std::int64_t{height} * y / small.height);
    const int bottom = static_cast<int>(std::int64_t{height} * (y + 1) / small.height);
    for (int x = 0; x < small.width; ++x) {
      const int left = static_cast<int>(std::int64_t{width} * x / small.width);
      const int right = static_cast<int>(std::int64_t{width} * (x + 1) / small.width);
      Vec3 sum = Vec3::Zero();
      for (int row = top; row < bottom; ++row)
        for (int column = left; column < right; ++column)
          sum += radiance[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                          static_cast<std::size_t>(column)];
      small.radiance.push_back(sum / static_cast<float>((bottom - top) * (right - left)));
    }
  }
  return small;
}

HdrPicture read_hdr(const std::filesystem::path& file) {
  const std::vector<unsigned char> bytes = read_bytes(file);
  const auto* data = bytes.data();
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (stbi_is_hdr_from_memory(data, size) == 0 ||
      stbi_info_from_memory(data, size, &width, &height, &channels) == 0)
    fail(file,
         "is no Radiance picture (.hdr) with FORMAT=32-bit_rle_rgbe and rows from top left, -Y HEIGHT +X "
         "WIDTH");
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (width < 2 || height < 2 || width > STBI_MAX_DIMENSIONS || height > STBI_MAX_DIMENSIONS ||
      pixels > k_most_pixels)
    fail(file, "has " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels: 2 to 16384 a side are allowed, and 67 million in all");
  require_whole_rows(file, bytes, width, height);
  const std::unique_ptr<float, decltype(&stbi_image_free)> read(
      stbi_loadf_from_memory(data, size, &width, &height, &channels, 3), &stbi_image_free);
  if (!read) fail(file, std::string("is no whole Radiance picture: ") + stbi_failure_reason());

  HdrPicture picture{width, height, std::vector<Vec3>(pixels)};
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = read.get()[3 * i + c];
      picture.radiance[i][static_cast<Eigen::Index>(c)] = std::isfinite(value) ? std::max(0.0f, value) : 0.0f;
    }
  // Sums over bright pixels must be finite. How bright all is together is for the exposure to say.
  float brightest = 0;
  for (const Vec3& radiance : picture.radiance) brightest = std::max(brightest, radiance.maxCoeff());
  if (brightest > k_brightest)
    for (Vec3& radiance : picture.radiance) radiance *= k_brightest / brightest;
  return picture;
}

}  // namespace mallow::render
