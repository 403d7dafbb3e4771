#include "tradeoff/films.h"

#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "mallow/errors.h"
#include "program/cache.h"
#include "program/failure.h"
#include "program/film.h"
#include "program/film_bounds.h"
#include "program/stills.h"
#include "tradeoff/runner.h"
#include "tradeoff/tables.h"

namespace mallow::tradeoff {
namespace {
namespace fs = std::filesystem;

constexpr int k_width = 240;         ///< of a picture, of two beside each other [pixels]
constexpr int k_gap = 4;             ///< between them [pixels]
constexpr int k_most_pictures = 48;  ///< of each
constexpr int k_fewest_pictures = 6;
/// Of the time of a picture of balls: surfaces take more.
constexpr double k_picture_cost = 1.5;

/// A folder that is gone when this is.
class PictureFolder {
 public:
  PictureFolder() {
    std::string name = (fs::temp_directory_path() / "mallow-film-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw IoError({name, 0, 0, "", "cannot be made"});
    path_ = name;
  }
  ~PictureFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  PictureFolder(const PictureFolder&) = delete;
  PictureFolder& operator=(const PictureFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// A scene as it is seen in a small picture.
Scene small(Scene scene) {
  const double ratio = static_cast<double>(scene.render.height) / scene.render.width;
  scene.render.width = k_width;
  scene.render.height = std::max(16, 2 * static_cast<int>(std::lround(k_width * ratio / 2)));
  scene.render.shutter = 0;
  return scene;
}

render::Image beside(const render::Image& left, const render::Image& right) {
  render::Image both{.width = left.width + k_gap + right.width, .height = left.height, .rgb = {}};
  both.rgb.reserve(3 * static_cast<std::size_t>(both.width) * static_cast<std::size_t>(both.height));
  const auto row_of = [&](const render::Image& image, int y) {
    const auto begin = image.rgb.begin() + 3 * static_cast<std::ptrdiff_t>(image.width) * y;
    both.rgb.insert(both.rgb.end(), begin, begin + 3 * static_cast<std::ptrdiff_t>(image.width));
  };
  for (int y = 0; y < both.height; ++y) {
    row_of(left, y);
    both.rgb.insert(both.rgb.end(), 3 * k_gap, std::uint8_t{255});
    row_of(right, y);
  }
  return both;
}

/// Films of a study under way.
class Filmer {
 public:
  Filmer(const Study& study, const StudyOptions& options, double deadline)
      : study_(study),
        runner_(options, study.frames, study.frame_time),
        deadline_(deadline),
        film_(study.rows.front().motion.spacings, study.rows.front().setting.scene.emitters) {
    for (const MotionMoment& moment : study.rows.front().motion.moments) film_.add(moment.particles);
  }

  /// How many pictures of each there is time for.
  int pictures(std::size_t row) const {
    const Scene scene = small(study_.rows.front().setting.scene);
    program::Stills camera = stills(scene);
    const ParticleFrame& last = study_.rows.front().motion.moments.back().particles;
    camera.take(last, {});  // once for what all pictures share
    const double begin = wall_clock();
    camera.take(last, {});
    const double picture = wall_clock() - begin;
    double steps = 0, drawing = 0;
    for (const std::size_t r : {std::size_t{0}, row}) {
      const Row& one = study_.rows[r];
      steps += one.motion.other_seconds + one.median_seconds() * study_.frames;
      drawing += one.median_drawing() + k_picture_cost * picture;
    }
    const double fit = std::floor((deadline_ - wall_clock() - steps) / drawing);
    return static_cast<int>(std::clamp<double>(fit, 0, std::min(k_most_pictures, study_.frames)));
  }

  std::vector<render::Image> take(std::size_t row, int pictures) {
    const Scene scene = small(study_.rows[row].setting.scene);
    program::Stills camera = stills(scene);
    std::vector<render::Image> images;
    runner_.plan().moments = pictures;
    runner_.run(scene, {.deadline = deadline_,
                        .drawn = true,
                        .last_bit = nullptr,
                        .show = [&](const Simulation& simulation, const Mesh& surface) {
                          images.push_back(camera.take(snapshot(simulation), surface));
                        }});
    return images;
  }

 private:
  /// The camera that both are seen by.
  program::Stills stills(const Scene& scene) const {
    return {scene, film_, study_.rows.front().motion.spacings, runner_.threads()};
  }

  const Study& study_;
  Runner runner_;
  double deadline_;
  program::FilmBounds film_;
};

/// As fast as the motion is, as far as films are.
int frames_per_second(const Study& study, std::size_t pictures) {
  return static_cast<int>(
      std::clamp(std::round(static_cast<double>(pictures) / (study.frames * study.frame_time)), 4.0, 30.0));
}

void write_film(const Study& study, const std::vector<render::Image>& left,
                const std::vector<render::Image>& right, SideBySide& film, const fs::path& file) {
  const PictureFolder folder;
  film.pictures = std::min(left.size(), right.size());
  for (std::size_t i = 0; i < film.pictures; ++i)
    render::write_png(folder.path() / program::frame_name(static_cast<int>(i), "png"),
                      beside(left[i], right[i]));
  program::make_film(folder.path(), 0, file, frames_per_second(study, film.pictures));
  film.file = file.filename().string();
}

}  // namespace

std::optional<std::size_t> row_to_show(const Study& study, std::optional<std::size_t> picked) {
  if (picked && *picked > 0) return picked;
  for (const std::size_t i : by_cost(study))
    if (i > 0 && study.rows[i].on_front) return i;
  return study.rows.size() > 1 ? std::optional<std::size_t>(1) : std::nullopt;
}

SideBySide film_side_by_side(const Study& study, std::size_t row, const StudyOptions& options,
                             double deadline, const fs::path& file) {
  SideBySide film{.row = row};
  const std::string too_late = "the budget left no time for a film";
  if (!program::can_make_films())
    film.why = "no film, as the program ffmpeg is not installed";
  else if (study.rows.front().motion.spacings.empty())
    film.why = "no film, as there is nothing to be seen";
  if (!film.why.empty()) return film;
  try {
    Filmer filmer(study, options, deadline);
    const int pictures = filmer.pictures(row);
    if (pictures < std::min(k_fewest_pictures, study.frames)) {
      film.why = too_late;
      return film;
    }
    const std::vector<render::Image> left = filmer.take(0, pictures), right = filmer.take(row, pictures);
    if (std::min(left.size(), right.size()) == 0)
      film.why = too_late;
    else
      write_film(study, left, right, film, file);
  } catch (const ConfigError& error) {
    film.why = std::string("no film: ") + error.what();
  } catch (const program::RunFailure& failure) {
    film.why = std::string("no film: ") + failure.what();
  }
  return film;
}

}  // namespace mallow::tradeoff
