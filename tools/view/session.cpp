#include "view/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "mallow/files.h"
#include "program/film_bounds.h"

namespace mallow::view {
namespace {

/// Saving states may take this share of wall time.
constexpr double k_save_share = 0.04;

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Where a state was saved with skins they are chunks of their own.
std::string skin_chunk(std::size_t number) {
  return "view.skin." + std::to_string(number);
}

std::string advice(const Error& error) {
  std::string text = error.what();
  if (dynamic_cast<const StepError*>(&error) != nullptr)
    text +=
        "\nThe scene stands where it was before this step. Go back (Backspace) or start again (R), "
        "let go of what is held, or take shorter steps (Speed and accuracy).";
  return text;
}

}  // namespace

void Session::open(const Scene& scene) {
  // All that may refuse the scene comes first: until then what was there stands as it stood.
  Simulation built = build(scene, threads_.threads());
  std::vector<Skin> followers = skins(scene, built, threads_.threads());
  std::vector<ParticleId> pinned = pinned_by(scene, built);
  built.prepare();
  take_over(std::move(built), std::move(followers), 0);
  pinned_ = std::move(pinned);
  begin(scene);
}

void Session::take_over(Simulation simulation, std::vector<Skin> skins, int frame) {
  grab_.reset();  // its force refers to the simulation that goes
  surface_.reset();
  pinned_.clear();
  hand_pins_.clear();
  simulation_.emplace(std::move(simulation));
  bodies_.clear();
  skins_ = std::move(skins);
  frame_ = first_frame_ = frame;
}

void Session::close() {
  grab_.reset();
  surface_.reset();
  simulation_.reset();
  skins_.clear();
  ring_.clear();
  governor_.set_rung(k_as_written);
  failed_ = finished_ = false;
  message_.clear();
  changed_ = true;
}

void Session::begin(Scene scene) {
  scene_ = std::move(scene);
  simulation_->prepare();
  materials_.assign(scene_.materials.size(), std::nullopt);
  const std::vector<std::size_t> of_body = body_materials(scene_);
  for (const BodyId body : simulation_->bodies())
    if (slot_of(body) < of_body.size()) materials_[of_body[slot_of(body)]] = simulation_->material(body);
  ball_material_.reset();
  frame_time_ = frame_time(scene_, simulation_->info());
  bounds_ = program::bounds_now(scene_, *simulation_);
  camera_ = render::frame_camera(bounds_, scene_.render, program::visible_colliders(scene_));
  values_ = {};
  chosen_.reset();
  report_contacts();
  ring_.clear();
  samples_.clear();
  steps_rate_.clear();
  frames_rate_.clear();
  time_rate_.clear();
  phases_.clear();
  wishes_.clear();
  message_.clear();
  failed_ = finished_ = touched_ = false;
  single_steps_ = 0;
  last_ = {};
  ++scene_number_;
  ++settings_number_;
  rung_ = k_as_written;
  given_up_.clear();
  apply_rung();
  set_speed(speed_);
  pace_.restart(simulation_->time());
  last_save_ = -1e9;
  keep_moment(0);
  changed_ = true;
}

void Session::run(const std::function<void(Session&)>& command) {
  try {
    command(*this);
  } catch (const std::exception& error) {
    say(error.what());
    ++settings_number_;  // a setting that was refused is what it was
  }
  changed_ = true;
}

void Session::set_paused(bool paused) {
  paused_ = paused;
  if (!paused) failed_ = false;
  if (simulation_) pace_.restart(simulation_->time());
  changed_ = true;
}

void Session::set_recording(bool recording) {
  recording_ = recording;
  finished_ = false;  // that one ended before
  if (simulation_) make_surface();
}

void Session::set_speed(double speed) {
  speed_ = speed;
  pace_.set_rate(speed * frame_time_ * scene_.render.frames_per_second);
}

bool Session::advance(double wall) {
  if (!simulation_ || failed_ || waits_for_film()) return false;
  if (single_steps_ == 0) {
    if (paused_) return false;
    pace_.add_wall(wall, simulation_->time(), 1.5 * frame_time_);
    if (!recording_ && !pace_.allows(simulation_->time())) return false;
  }
  try {
    take_step(wall);
  } catch (const Error& error) {
    failed_ = paused_ = true;
    say(advice(error));
  }
  single_steps_ = std::max(0, single_steps_ - 1);
  changed_ = true;
  return true;
}

void Session::take_step(double wall) {
  const double before = simulation_->time();
  const auto started = Clock::now();
  last_ = simulation_->step_towards(frame_end());
  frame_seconds_ += seconds_since(started);
  steps_rate_.add(wall);
  time_rate_.add(wall, simulation_->time() - before);
  phases_.add(last_.seconds);
  if (simulation_->time() < frame_end()) return;
  ++frame_;
  finished_ = true;
  frames_rate_.add(wall);
  keep_moment(wall);
  if (governor_.add_frame(frame_seconds_)) apply_rung();
  constexpr double k_looks = 1;  // [s]
  if (options_.lowers_threads && wall - last_look_ >= k_looks) {
    last_look_ = wall;
    look_at_processors(processors_.look());
  }
  frame_seconds_ = 0;
}

void Session::keep_moment(double wall) {
  if (wall - last_save_ < save_time_.mean() / k_save_share) return;
  const auto started = Clock::now();
  Moment moment{.time = simulation_->time(),
                .step = simulation_->step_count(),
                .frame = frame_,
                .frame_time = frame_time_,
                .settings = settings(),
                .state = simulation_->save(),
                .pinned = pinned_,
                .hand_pins = hand_pins_,
                .ball_material = ball_material_,
                .touched = touched_};
  for (std::size_t k = 0; k < skins_.size(); ++k)
    moment.state.chunks.push_back({skin_chunk(k), skins_[k].save()});
  ring_.add(std::move(moment));
  save_time_.add(wall, seconds_since(started));
  last_save_ = wall;
}

Settings Session::settings() const {
  Settings settings{scene_.solver, {}, governor_.rung()};
  for (const SceneMaterial& material : scene_.materials) settings.materials.push_back(material.material);
  return settings;
}

/// What a restored simulation has already.
void Session::take_settings(const Settings& settings) {
  scene_.solver = settings.solver;
  for (std::size_t k = 0; k < settings.materials.size(); ++k)
    scene_.materials[k].material = settings.materials[k];
  governor_.set_rung(settings.rung);
  rung_ = settings.rung;
  given_up_ = describe(rungs()[static_cast<std::size_t>(rung_)]);
  ++settings_number_;
}

void Session::restore(const Moment& moment) {
  simulation_.emplace(Simulation::restore(moment.state, threads_.threads()));
  bodies_.clear();
  surface_.reset();
  skins_.clear();
  while (const std::string* bytes = moment.state.find(skin_chunk(skins_.size())))
    skins_.push_back(Skin::restore(*bytes, threads_.threads()));
  frame_ = moment.frame_time == frame_time_ ? moment.frame : frames_until(moment.time);
  take_settings(moment.settings);
  make_surface();
  values_ = {};
  pinned_ = moment.pinned;
  hand_pins_ = moment.hand_pins;
  ball_material_ = moment.ball_material;
  touched_ = moment.touched;
  last_ = {};
  report_contacts();
  samples_.clear();
  failed_ = finished_ = false;
  frame_seconds_ = 0;
  if (grab_) grab_->act_on(*simulation_);
  pace_.restart(simulation_->time());
  message_.clear();
  changed_ = true;
}

void Session::look_at_processors(double free) {
  if (!threads_.add_look(free) || !simulation_) return;
  simulation_.emplace(Simulation::restore(simulation_->save(), threads_.threads()));
  for (Skin& skin : skins_) skin = Skin::restore(skin.save(), threads_.threads());
  make_surface();
  report_contacts();
  if (grab_) grab_->act_on(*simulation_);
}

void Session::go_to(double time) {
  if (!simulation_ || ring_.empty()) return;
  paused_ = true;
  restore(ring_[ring_.find(time)]);
}

void Session::go_back() {
  if (!simulation_ || ring_.empty()) return;
  std::size_t place = ring_.find(simulation_->time());
  if (ring_[place].step >= simulation_->step_count() && place > 0) --place;
  paused_ = true;
  restore(ring_[place]);
}

void Session::reset() {
  if (!simulation_ || ring_.empty()) return;
  // Settings of now are kept: they are what somebody wants to see from the start.
  const Scene settings = scene_;
  const int rung = governor_.rung();
  const auto wishes = wishes_;
  const Moment start = ring_[0];
  restore(start);
  ring_.clear();
  touched_ = false;
  last_save_ = -1e9;
  for (std::size_t k = 0; k < settings.materials.size(); ++k) set_material(k, settings.materials[k]);
  set_solver(settings.solver);
  set_rung(rung);
  wishes_ = wishes;
  keep_moment(0);
}

void Session::show(Drawn drawn, Shown shown) {
  drawn_ = drawn;
  shown_ = shown;
  changed_ = true;
}

void Session::report_contacts() {
  simulation_->report_contacts(marks_.contacts ? std::optional(0.0) : std::nullopt);
}

void Session::show_marks(const Marks& marks) {
  const bool others = marks.contacts != marks_.contacts;
  marks_ = marks;
  if (simulation_ && others) report_contacts();
  changed_ = true;
}

}  // namespace mallow::view
