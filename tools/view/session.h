#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mallow/scene.h"
#include "mallow/simulation.h"
#include "mallow/skin.h"
#include "program/frame_surface.h"
#include "view/frame.h"
#include "view/frame_governor.h"
#include "view/grab.h"
#include "view/marks.h"
#include "view/pace.h"
#include "view/particle_values.h"
#include "view/rates.h"
#include "view/rewind_ring.h"
#include "view/thread_governor.h"
#include "view/verbs.h"

namespace mallow::view {

struct SessionOptions {
  int threads = 1;              ///< >= 1
  bool lowers_threads = false;  ///< beside other programs, see ThreadGovernor
  std::size_t rewind_bytes = std::size_t{384} << 20;
};

/// A scene in motion, as somebody plays with it: what the stepping thread owns, and nobody else touches. As
/// long as nothing is changed it moves as `mallow run` does, bit by bit: each step is one on the way to the
/// end of a frame of the scene.
class Session {
 public:
  explicit Session(const SessionOptions& options)
      : options_(options), threads_(options.threads), ring_(options.rewind_bytes) {}

  /// Builds a scene and begins at its start. Throws ConfigError or IoError; then all stands as it stood.
  void open(const Scene& scene);
  /// Has no scene from now on, and its place between realtime and accurate is as the next one says.
  void close();
  /// Goes on where a run in a folder stood: what save_run() wrote, or `mallow run`. Throws IoError.
  void open_run(const std::string& folder);
  bool has_scene() const { return simulation_.has_value(); }

  /// Takes a step where the pace allows one. wall: [s], of any clock. Returns whether anything moved. A step
  /// that cannot be taken stops the session: see Frame::message.
  bool advance(double wall);
  /// What has changed since the last frame, for whoever asks whether to fill one.
  bool has_changed() const { return changed_; }
  /// The number of the next one.
  std::uint64_t next_frame() const { return frames_filled_ + 1; }
  /// A film waits for every frame of the scene to be taken.
  bool waits_for_film() const { return recording_ && finished_; }
  /// Draws the surface and fills all that the window shows.
  void fill(double wall, Frame& frame);

  /// Runs a command; what it throws becomes the message.
  void run(const std::function<void(Session&)>& command);
  void say(const std::string& message) {
    message_ = message;
    ++message_number_;
    changed_ = true;
  }

  // Time.
  void set_paused(bool paused);
  bool is_paused() const { return paused_; }
  void step_once() {
    set_paused(true);
    single_steps_ = 1;
  }
  /// Of the pace of a film; infinite: as fast as it goes.
  void set_speed(double speed);
  /// To the last saved state at or before a time [s]; it stands there.
  void go_to(double time);
  void go_back();
  void reset();
  void set_recording(bool recording);

  // What the window shows.
  void show(Drawn drawn, Shown shown);
  void show_marks(const Marks& marks);
  /// Shows the region of the particle that the ray meets first.
  void choose(const Ray& ray);
  void ask_for_hash() {
    hash_asked_ = true;
    changed_ = true;
  }

  // Settings, as a scene holds them. What cannot change while it runs waits for rebuild().
  void set_solver(const SolverConfig& solver);
  void set_material(std::size_t index, const SceneMaterial& material);
  /// A material by name, with all of its numbers. What a running scene cannot take waits for it to be built
  /// anew, and is shown meanwhile.
  void take_preset(std::size_t index, const SceneMaterial& material);
  void set_surface(const SurfaceConfig& surface);
  /// How the scene is looked at; the rest is for pictures of `mallow run`.
  void set_render(const RenderConfig& render);
  void set_run(const RunConfig& run);
  void set_rung(int rung);
  void set_target(std::optional<double> frames_per_second) { governor_.set_target(frames_per_second); }
  /// Goes on with as many threads as others leave processors, where that is another number: the same bits.
  void look_at_processors(double free);

  // The mouse.
  void grab(const Vec3& at, float strength);
  void pull_to(const Vec3& target) {
    if (grab_) grab_->pull_to(target);
  }
  void release();
  void throw_ball(const Ray& ray, float speed);
  void act(const std::function<std::string(Simulation&)>& verb);
  void pin(const Ray& ray, float radius);
  /// Of all that pin() has pinned; those of the scene stay.
  void release_pins();

  const Scene& scene() const { return scene_; }
  Simulation& simulation() { return *simulation_; }
  const RewindRing& ring() const { return ring_; }
  /// A step could not be taken, and it stands at its last good state.
  bool has_failed() const { return failed_; }
  /// Writes a folder that `mallow run --resume` and `mallow view` go on from. Throws IoError.
  void save_run(const std::string& folder);

 private:
  void take_over(Simulation simulation, std::vector<Skin> skins, int frame);
  void begin(Scene scene);
  void take_step(double wall);
  void keep_moment(double wall);
  void restore(const Moment& moment);
  Settings settings() const;
  void take_settings(const Settings& settings);
  void apply_rung();
  /// What the scene says, no finer than moving pictures show; for a film, or above what the scene says, as it
  /// says.
  SurfaceConfig surface_to_play() const;
  void make_surface();
  void draw_mesh(Mesh& mesh);
  void fill_particles(Frame& frame);
  void fill_colliders(Frame& frame) const;
  void fill_stats(double wall, FrameStats& stats);
  void add_sample(double wall);
  std::vector<Appearance> palette();
  void report_contacts();
  MaterialId material_id(std::size_t index) const;
  /// Frames of the scene that have ended by then.
  int frames_until(double time) const;
  double frame_end() const { return (frame_ + 1) * frame_time_; }

  SessionOptions options_;
  ThreadGovernor threads_;
  ProcessorLoad processors_;
  double last_look_ = 0;                  ///< at them [s] of wall time
  Scene scene_;                           ///< as it is set now, without the rung
  std::optional<Simulation> simulation_;  ///< at one place while there is one: the grab's force refers to it
  std::vector<BodyInfo> bodies_;          ///< by their slots, as palette() knows them
  std::vector<std::optional<MaterialId>> materials_;  ///< of the scene's, where bodies have them
  std::optional<MaterialId> ball_material_;
  std::map<std::size_t, SceneMaterial> wishes_;  ///< materials that wait for the scene to be built anew
  std::vector<Skin> skins_;
  std::optional<program::FrameSurface> surface_;
  ParticleValues values_;

  render::Camera camera_;
  Aabb bounds_{{0, 0, 0}, {1, 1, 1}};

  // Where it stands.
  double frame_time_ = 1;  ///< [s]
  int frame_ = 0;          ///< of the scene, finished
  int first_frame_ = 0;    ///< with which it was opened
  int scene_number_ = 0, settings_number_ = 0, message_number_ = 0, camera_number_ = 0;
  bool paused_ = false, failed_ = false, finished_ = false, recording_ = false, touched_ = false;
  int single_steps_ = 0;
  double speed_ = 1;
  Pace pace_;
  RewindRing ring_;
  double last_save_ = -1e9;  ///< [s] of wall time
  std::string message_;

  std::optional<Grab> grab_;
  FrameGovernor governor_;
  int rung_ = k_as_written;  ///< that is in force
  std::string given_up_;

  // What it shows.
  Drawn drawn_ = Drawn::surface;
  Shown shown_ = Shown::appearance;
  bool changed_ = true, hash_asked_ = false;
  std::uint64_t frames_filled_ = 0;
  Marks marks_;
  std::vector<ParticleId> pinned_;  ///< by the scene and by the mouse
  std::vector<HandPin> hand_pins_;
  std::optional<ParticleId> chosen_;
  StepReport last_;
  Rate steps_rate_, frames_rate_, time_rate_, surface_time_, save_time_;
  MeanPhases phases_;
  double frame_seconds_ = 0;  ///< that the frame of the scene has taken so far to step and draw
  std::vector<Sample> samples_;
};

/// A surface of `factor` times as many voxels along an edge, as far as allowed.
SurfaceConfig with_voxels(const SurfaceConfig& config, float factor);

}  // namespace mallow::view
