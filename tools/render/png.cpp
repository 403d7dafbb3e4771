#include <png.h>
#include <zlib.h>

#include <string>
#include <string_view>

#include "mallow/errors.h"
#include "mallow/files.h"
#include "render/renderer.h"

namespace mallow::render {
namespace {

[[noreturn]] void fail(png_structp png, png_const_charp message) {
  throw IoError({.file = *static_cast<const std::string*>(png_get_error_ptr(png)),
                 .field = {},
                 .message = std::string("cannot encode PNG: ") + message});
}

void append(png_structp png, png_bytep bytes, png_size_t size) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(bytes), size);
}

// Frees libpng's memory on every way out.
struct Writer {
  png_structp png;
  png_infop info = nullptr;
  explicit Writer(std::string* file)
      : png(png_create_write_struct(PNG_LIBPNG_VER_STRING, file, fail, nullptr)) {
    if (png != nullptr) info = png_create_info_struct(png);
    if (info == nullptr) throw Error("libpng cannot allocate memory");
  }
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
};

}  // namespace

void write_png(const std::filesystem::path& file, const Image& image) {
  std::string name = file.string();
  std::string content;
  Writer writer(&name);
  png_set_write_fn(writer.png, &content, append, nullptr);
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  // One filter and no search for what came before: dithered gradients hardly repeat. A picture is a tenth
  // larger than by libpng's own choice, in a seventh of its time.
  png_set_filter(writer.png, 0, PNG_FILTER_SUB);
  png_set_compression_level(writer.png, 1);
  png_set_compression_strategy(writer.png, Z_HUFFMAN_ONLY);
  png_write_info(writer.png, writer.info);
  const std::size_t stride = 3 * static_cast<std::size_t>(image.width);
  for (std::size_t row = 0; row < static_cast<std::size_t>(image.height); ++row) {
    png_write_row(writer.png, image.rgb.data() + row * stride);
  }
  png_write_end(writer.png, nullptr);
  write_whole(file, std::string_view(content));
}

}  // namespace mallow::render
