#include "tradeoff/study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "program/failure.h"
#include "program/film_bounds.h"
#include "program/machine.h"
#include "render/viewport.h"
#include "tradeoff/reference.h"
#include "tradeoff/runner.h"
#include "tradeoff/tables.h"

namespace mallow::tradeoff {
namespace {

constexpr double k_first_share = 0.06;   ///< that the scene as it is may take, once it is built
constexpr int k_handful = 4;             ///< frames that are worth to be judged by
constexpr double k_handful_share = 0.1;  ///< that they may take
/// Of the frames that the budget carries, where an error is to be held that needs a reference in shorter
/// steps.
constexpr double k_judged_share = 0.4;
constexpr double k_fewest_builds = 12;    ///< of the scene that a study needs
constexpr double k_settings_share = 0.7;  ///< by which first runs of settings have begun
constexpr std::size_t k_few = 5;          ///< rows that are worth more than times of several runs
constexpr double k_few_share = 0.95;      ///< by which first runs of so few have begun
constexpr double k_search_share = 0.8;    ///< by which those that lead on from the best have begun
constexpr int k_most_rounds = 8;          ///< of turning knobs on
/// Part of the settings' errors from which on the last bit's is told.
constexpr double k_chaos = 0.5;
/// Below this order of convergence, halving the step leads nowhere.
constexpr double k_no_order = 0.5;
constexpr float k_fine_voxels = 2;  ///< of the surface that others are compared with: so many times as many

/// The pixels of the scene's camera.
PixelOf camera_of(const Scene& scene, const Motion& motion) {
  program::FilmBounds film(motion.spacings, scene.emitters);
  for (const MotionMoment& moment : motion.moments) film.add(moment.particles);
  const auto camera =
      render::frame_camera(film.boxes(scene), scene.render, program::visible_colliders(scene));
  return [viewport = render::Viewport(camera, scene.render.width, scene.render.height)](
             const Vec3& x) -> std::optional<Eigen::Vector2d> {
    const auto pixel = viewport.pixel(x);
    if (!pixel) return std::nullopt;
    return Eigen::Vector2d(pixel->cast<double>());
  };
}

/// A study under way.
class Maker {
 public:
  Maker(const Scene& scene, const StudyOptions& options)
      : scene_(scene), options_(options), start_(wall_clock()) {}

  Study make() {
    run_plain();
    study_.reference = find_reference({.scene = scene_,
                                       .plain = study_.rows.front().motion,
                                       .plain_cost = plain_cost_,
                                       .enough = k_reference_part * most_error(),
                                       .until = start_ + k_reference_share * budget(),
                                       .end = end(),
                                       .say = [this](const std::string& what) { say(what); }},
                                      *runner_);
    run_settings();
    run_last_bit();
    search();
    repeat();
    judge();
    study_.spent = wall_clock() - start_;
    return std::move(study_);
  }

 private:
  /// That a setting may have [h].
  double most_error() const {
    return options_.limit && !options_.limit->is_time ? options_.limit->most
                                                      : std::numeric_limits<double>::infinity();
  }
  double budget() const { return options_.budget * (1 - options_.kept); }
  double end() const { return start_ + budget(); }
  double left(double share = 1) const { return share * budget() - (wall_clock() - start_); }
  /// What a run takes whose steps cost so many times those of the scene as it is: building costs the same
  /// [s].
  double expected(double cost) const {
    const double building = std::min(plain_cost_, study_.rows.front().motion.other_seconds);
    return building + cost * (plain_cost_ - building);
  }
  void say(const std::string& what) const {
    if (options_.progress) options_.progress(what);
  }

  /// What the scene has, and what is to be measured of it.
  void look() {
    const double begin = wall_clock();
    Simulation simulation = build(scene_, program::resolve_threads(options_.threads));
    simulation.prepare();
    building_ = wall_clock() - begin;
    const SimulationInfo info = simulation.info();
    traits_ = traits(info);
    traits_.surface = options_.surface;
    study_.fine_surface = at_voxels(scene_.surface, k_fine_voxels);
    study_.fine_surface.adaptivity = 0;
    study_.scene = scene_.file.string();
    study_.all_frames = std::max(1, scene_.run.frames);
    study_.frame_time = frame_time(scene_, info);
    steps_of_frame_ = std::max(1.0, study_.frame_time / static_cast<double>(info.longest_step));
    runner_.emplace(options_, study_.all_frames, study_.frame_time);
    for (const std::string& text : options_.measures) {
      runner_->plan().measures.push_back(parse_measure(text, simulation).value);
      study_.measures.push_back(text);
    }
    study_.threads = runner_->threads();
  }

  /// Begins with all frames; where they would take too long, as many as were reached are all.
  void run_plain() {
    say("the scene as it is");
    look();
    SurfaceCheck surface;
    const auto run = [&](double share) {
      const double begin = wall_clock();
      surface = {study_.fine_surface};
      Motion motion =
          runner_->run(scene_, {.running = share * budget(), .drawn = options_.surface, .surface = &surface});
      plain_cost_ = wall_clock() - begin;
      if (!motion.failure.empty()) throw program::RunFailure(motion.failure);
      study_.frames = static_cast<int>(motion.frame_seconds.size());
      return motion;
    };
    Motion motion = run(k_first_share);
    const int fewest = std::min(k_handful, study_.all_frames);
    if (study_.frames < fewest) {
      if (plain_cost_ > left()) throw too_small(motion, fewest);
      runner_->plan().frames = fewest;
      motion = run(k_handful_share);
      if (study_.frames < fewest) throw too_small(motion, fewest);
    } else if (study_.frames < study_.all_frames) {
      const bool is_error = options_.limit && !options_.limit->is_time;
      const int reached =
          is_error ? std::max(fewest, static_cast<int>(k_judged_share * study_.frames)) : study_.frames;
      runner_->plan().frames = reached;
      motion = run(1);  // with moments at its end
      if (study_.frames < reached) throw too_small(motion, fewest);
    }
    add_row({.name = "as it is", .scene = scene_}, std::move(motion), surface.error);
  }

  /// What to say where not even `fewest` frames were reached.
  program::RunFailure too_small(const Motion& motion, int fewest) const {
    // The frame that was not ended is in no time of the motion.
    const double running = std::max(plain_cost_ - building_, k_first_share * budget());
    const double step = running / static_cast<double>(std::max<std::int64_t>(1, motion.steps));
    const double frame = step * steps_of_frame_;
    const double needed = std::max(fewest * frame / k_handful_share, k_fewest_builds * (building_ + frame)) /
                          (1 - options_.kept);
    return program::RunFailure("the budget is too small: a frame takes about " + number(frame, 2) +
                               " s, and building the scene " + number(building_, 2) +
                               " s; to be judged by its first " + std::to_string(fewest) +
                               " frames this scene needs about " + budget_option(needed));
  }

  void add_row(const Setting& setting, Motion motion, std::optional<double> surface) {
    Row row{.setting = setting, .motion = std::move(motion), .surface = surface};
    row.seconds.push_back(row.motion.seconds_per_frame());
    row.drawing.push_back(row.motion.draw_seconds_per_frame());
    study_.rows.push_back(std::move(row));
  }

  void run_settings() {
    std::vector<Setting> settings = options_.extra;
    for (Setting& setting : settings_around(scene_, traits_)) settings.push_back(std::move(setting));
    for (const Setting& setting : settings) {
      // The last bit is still to come, which is one more run.
      const bool few = study_.rows.size() < k_few || options_.repeats == 1;
      if (expected(setting.cost) + expected(1) > left(few ? k_few_share : k_settings_share))
        study_.left_out.push_back(setting.name);
      else
        run_setting(setting);
    }
    listed_ = study_.rows.size();
  }

  void run_setting(const Setting& setting) {
    say(setting.name);
    SurfaceCheck surface{study_.fine_surface};
    Motion motion =
        runner_->run(setting.scene, {.deadline = end(), .drawn = options_.surface, .surface = &surface});
    if (motion.failure.empty() && static_cast<int>(motion.frame_seconds.size()) == study_.frames)
      add_row(setting, std::move(motion), surface.error);
    else if (motion.failure.empty())
      study_.left_out.push_back(setting.name);
    else
      study_.failed.push_back(setting.name + ": " + motion.failure);
  }

  /// Turns knobs of the setting that is best by the limit, as long as that leads to a better one: so knobs
  /// come together that no list has.
  void search() {
    if (!options_.limit) return;
    std::set<std::string> known;
    for (const Row& row : study_.rows) known.insert(print_scene(row.setting.scene));
    std::set<std::size_t> turned;
    for (int round = 0; round < k_most_rounds; ++round) {
      judge();
      const auto best = options_.limit->pick(study_.trades());
      if (!best || !turned.insert(best->index).second) return;
      const Setting from = study_.rows[best->index].setting;
      for (const Setting& setting : settings_from(from, traits_))
        if (expected(setting.cost) < left(k_search_share) && known.insert(print_scene(setting.scene)).second)
          run_setting(setting);
    }
  }

  void run_last_bit() {
    study_.no_last_bit = "the budget was too small to move one position by its last bit";
    if (plain_cost_ > left()) return;
    say("one position moved by its last bit");
    const Motion& plain = study_.rows.front().motion;
    LastBit last_bit;
    const Motion moved = runner_->run(scene_, {.deadline = end(), .last_bit = &last_bit});
    if (!moved.failure.empty() || moved.moments.size() != plain.moments.size()) return;
    if (!last_bit.begin() || *last_bit.begin() > k_late * study_.frames * study_.frame_time) {
      study_.no_last_bit = last_bit.begin() ? "there was nothing to be moved by its last bit before " +
                                                  number(*last_bit.begin()) + " s"
                                            : "there was nothing to be moved by its last bit";
      return;
    }
    study_.last_bit = motion_error(moved, plain);
    study_.last_bit_late = motion_error(moved, plain, k_late);
  }

  /// Timed runs, of all settings in turn that may be picked, until the budget or their number is reached.
  void repeat() {
    judge();
    const std::optional<Limit>& limit = options_.limit;
    for (int repeat = 1; repeat < options_.repeats; ++repeat) {
      say("run " + std::to_string(repeat + 1) + " of every setting");
      for (Row& row : study_.rows) {
        if (limit && !limit->is_time && study_.error(row) > limit->most) continue;
        const double cost = row.motion.other_seconds + row.seconds.front() * study_.frames +
                            row.drawing.front() * static_cast<double>(row.motion.draw_seconds.size());
        if (1.2 * cost > left()) continue;
        const Motion motion = runner_->run(row.setting.scene, {.deadline = end(), .drawn = options_.surface});
        if (static_cast<int>(motion.frame_seconds.size()) != study_.frames) continue;
        row.seconds.push_back(motion.seconds_per_frame());
        row.drawing.push_back(motion.draw_seconds_per_frame());
      }
    }
  }

  /// The errors of rows that have none yet: those of others stay, as the reference does.
  void compare() {
    const Motion& reference = study_.reference.motion;
    if (!pixel_) pixel_ = camera_of(scene_, study_.rows.front().motion);
    for (; compared_ < study_.rows.size(); ++compared_) {
      Row& row = study_.rows[compared_];
      row.error = motion_error(row.motion, reference, 0, pixel_);
      row.late = motion_error(row.motion, reference, k_late, pixel_);
    }
  }

  void judge() {
    compare();
    std::vector<double> errors;  // of the settings that any study has, wherever a search led
    for (const Row& row : study_.rows)
      if (errors.size() < listed_) errors.push_back(row.error.rms);
    const double typical = k_chaos * median(errors);
    const Reference& found = study_.reference;
    const bool converges =
        found.differences.size() < 2 || found.order.value_or(1) > k_no_order || found.error < typical;
    study_.parts = study_.last_bit && study_.last_bit->rms >= typical;
    study_.chaotic = typical > 0 && (study_.parts || !converges);
    mark_front(study_);
  }

  const Scene& scene_;
  const StudyOptions& options_;
  double start_;
  std::optional<Runner> runner_;
  SceneTraits traits_;
  std::size_t listed_ = 0;  ///< rows before any search
  double plain_cost_ = 0;   ///< wall time of a run as it is [s]
  double steps_of_frame_ = 1;
  double building_ = 0;  ///< wall time [s]
  PixelOf pixel_;
  std::size_t compared_ = 0;  ///< rows that have their errors
  Study study_;
};

}  // namespace

Study study(const Scene& scene, const StudyOptions& options) {
  return Maker(scene, options).make();
}

}  // namespace mallow::tradeoff
