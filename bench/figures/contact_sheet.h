#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "mallow/files.h"
#include "mallow/scene.h"
#include "mallow/surface.h"
#include "program/stills.h"

namespace mallow::bench {

/// Small pictures of a figure's takes as one PNG: a row per take, a column per moment.
class ContactSheet {
 public:
  /// Pictures lie beside `file` until close() joins them.
  ContactSheet(std::filesystem::path file, int threads) : file_(std::move(file)), threads_(threads) {}

  /// A new row. first: frame 0 of the take, which places the camera.
  void begin_take(const Scene& scene, const ParticleFrame& first, std::span<const float> spacings);
  void add(const ParticleFrame& frame);
  /// Joins the pictures with the program ffmpeg; where that is not installed they stay as they are.
  void close();

 private:
  std::filesystem::path picture(std::size_t number) const;

  std::filesystem::path file_;
  int threads_;
  Scene scene_;  ///< of the take at hand, with the sheet's size of pictures
  std::optional<Surfacer> surfacer_;
  std::optional<program::Stills> stills_;
  std::vector<float> spacings_;
  std::size_t takes_ = 0, pictures_ = 0;
};

}  // namespace mallow::bench
