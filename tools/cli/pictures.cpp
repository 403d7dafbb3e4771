#include "cli/pictures.h"

#include <algorithm>
#include <filesystem>
#include <future>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "program/body_appearances.h"
#include "program/film_bounds.h"

namespace mallow::cli {
namespace {

/// Reads the frames one after another, each while the picture of the one before is taken.
class FrameReader {
 public:
  struct Frame {
    ParticleFrame particles;
    Mesh surface;
  };
  FrameReader(const program::Cache& cache, const std::vector<int>& frames)
      : cache_(cache), frames_(frames), with_surfaces_(!cache.surface_frames().empty()) {
    start_next();
  }
  Frame next() {
    Frame frame = coming_.get();
    start_next();
    return frame;
  }

 private:
  void start_next() {
    if (next_ == frames_.size()) return;
    coming_ = std::async(std::launch::async, [this, number = frames_[next_++]]() -> Frame {
      return {read_particles(cache_.particles_file(number)),
              with_surfaces_ ? read_mesh(cache_.surface_file(number)) : Mesh{}};
    });
  }
  const program::Cache& cache_;
  const std::vector<int>& frames_;
  bool with_surfaces_;
  std::size_t next_ = 0;
  std::future<Frame> coming_;
};

std::vector<program::SlotBody> bodies_at(int frame, const PictureRun& run) {
  return program::slot_bodies_at(frame, run.bodies, run.past);
}

/// The camera has what the run shows in view, by up to so many of its frames, whichever pictures are taken.
program::Stills stills_of(const Scene& scene, const program::Cache& cache, const PictureRun& run) {
  constexpr std::size_t k_looks = 128;
  const std::vector<int> frames = cache.particle_frames();
  const std::size_t looks = scene.render.eye ? 1 : std::min(k_looks, frames.size());
  const std::vector<float> spacings = program::spacings_of(run.bodies, run.past);
  program::FilmBounds bounds(spacings, scene.emitters);
  for (std::size_t k = 0; k < looks; ++k) {
    const int frame = frames[looks > 1 ? k * (frames.size() - 1) / (looks - 1) : 0];
    bounds.add(read_particles(cache.particles_file(frame)), program::spacings_of(bodies_at(frame, run)));
  }
  return {scene, bounds, spacings, run.threads};
}

/// What makes a picture what it is, beside the files that it is taken of.
std::string job_of(Scene scene, const program::Cache& cache, const PictureRun& run,
                   const program::Stills& stills) {
  const render::Camera& camera = stills.camera();
  scene.run.frames = 0;  // a film that gets longer has the same pictures, as long as it is seen from there
  std::ostringstream job;
  job.precision(std::numeric_limits<float>::max_digits10);
  job << print_scene(cache.moved_here(std::move(scene))) << run.frame_time << '\n'
      << camera.eye.transpose() << ", " << camera.target.transpose() << ", " << camera.field_of_view << '\n'
      << stills.ball_radius();
  return job.str();
}

}  // namespace

std::vector<int> frames_to_show(const program::Cache& cache) {
  const std::vector<int> surfaces = cache.surface_frames();
  return surfaces.empty() ? cache.particle_frames() : surfaces;
}

PictureTaker::PictureTaker(const Scene& scene, const program::Cache& cache, const PictureRun& run)
    : scene_(scene),
      cache_(cache),
      run_(run),
      stills_(stills_of(scene, cache, run)),
      taken_(cache.folder(), "render", job_of(scene, cache, run, stills_),
             [&scene, &cache](int frame) -> program::SharedFrames::Files {
               std::vector<std::filesystem::path> read = {cache.particles_file(frame),
                                                          cache.surface_file(frame)};
               if (!scene.render.environment.empty()) read.push_back(program::environment_file(scene));
               return {std::move(read), {cache.image_file(frame)}};
             }) {
  stills_.set_frame_time(run.frame_time);
  std::filesystem::create_directories(cache.images_folder());
  cache.remove_images_but(frames_to_show(cache));
}

void PictureTaker::write(int number, const ParticleFrame& particles, const Mesh& surface,
                         const FrameClaim& claim, program::BackgroundWriter& files) {
  stills_.set_appearances(
      program::body_appearances(scene_, program::material_names(bodies_at(number, run_))));
  auto picture = std::make_shared<const render::Image>(stills_.take(particles, surface));
  files.add([this, number, picture, claim] {
    render::write_png(cache_.image_file(number), *picture);
    if (claim)
      claim->done();
    else
      taken_.note(number);
  });
}

std::size_t PictureTaker::share(const std::vector<int>& chosen, bool share, program::StageTimes& seconds) {
  const bool with_surfaces = !cache_.surface_frames().empty();
  program::BackgroundWriter files;
  const std::size_t count =
      for_each_frame(chosen, &taken_, share, "rendering", [&](int number, const FrameClaim& claim) {
        const program::StageTimer timer(seconds, program::Stage::pictures);
        const ParticleFrame particles = read_particles(cache_.particles_file(number));
        write(number, particles, with_surfaces ? read_mesh(cache_.surface_file(number)) : Mesh{}, claim,
              files);
      });
  const program::StageTimer timer(seconds, program::Stage::pictures);
  files.finish();
  return count;
}

std::size_t PictureTaker::take_all(Existing existing, program::StageTimes& seconds) {
  std::vector<int> frames = frames_to_show(cache_);
  if (existing == Existing::keep) std::erase_if(frames, [&](int frame) { return taken_.is_done(frame); });
  FrameReader reader(cache_, frames);
  program::BackgroundWriter files;
  for_each_frame(frames, "rendering", [&](int number) {
    const program::StageTimer timer(seconds, program::Stage::pictures);
    const FrameReader::Frame frame = reader.next();
    write(number, frame.particles, frame.surface, nullptr, files);
  });
  const program::StageTimer timer(seconds, program::Stage::pictures);
  files.finish();
  return frames.size();
}

}  // namespace mallow::cli
