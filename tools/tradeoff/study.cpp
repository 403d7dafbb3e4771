#include "tradeoff/study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "program/failure.h"
#include "program/film_bounds.h"
#include "program/machine.h"
#include "render/viewport.h"
#include "tradeoff/runner.h"

namespace mallow::tradeoff {
namespace {

constexpr double k_reference_share = 0.5;  ///< of the budget
constexpr double k_first_share = 0.06;     ///< that the scene as it is may take
constexpr double k_settings_share = 0.7;   ///< by which first runs of settings have begun
constexpr double k_search_share = 0.8;     ///< by which those that lead on from the best have begun
constexpr int k_most_rounds = 8;           ///< of turning knobs on
/// The reference is converged where its last halving moved particles by less than this share of what the
/// scene as it is is off.
constexpr double k_little = 0.1;
/// Part of the settings' errors from which on the last bit's is told.
constexpr double k_chaos = 0.5;
/// Below this order of convergence, halving the step leads nowhere.
constexpr double k_no_order = 0.5;
constexpr double k_grown = 1.25;  ///< see parts_again()
constexpr double k_late = 0.75;
constexpr float k_shortest_factor = 0.01f;

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// Whether the last halving moved particles farther than the one before, by more than chance.
bool parts_again(const std::vector<double>& differences) {
  const std::size_t n = differences.size();
  return n > 1 && differences[n - 1] > k_grown * differences[n - 2];
}

/// The pixels of the scene's camera.
PixelOf camera_of(const Scene& scene, const Motion& motion) {
  program::FilmBounds film(motion.spacings);
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
    find_reference();
    run_settings();
    run_last_bit();
    search();
    repeat();
    judge();
    study_.spent = wall_clock() - start_;
    return std::move(study_);
  }

 private:
  double left(double share = 1) const { return share * options_.budget - (wall_clock() - start_); }
  void say(const std::string& what) const {
    if (options_.progress) options_.progress(what);
  }

  /// Begins with all frames; where they would take too long, as many as were reached are all.
  void run_plain() {
    say("the scene as it is");
    std::vector<std::function<double(Simulation&)>> measures;
    {
      Simulation simulation = build(scene_, program::resolve_threads(options_.threads));
      simulation.prepare();
      const SimulationInfo info = simulation.info();
      traits_ = traits(info);
      study_.frame_time = frame_time(scene_, info);
      for (const std::string& text : options_.measures) {
        measures.push_back(parse_measure(text, simulation).value);
        study_.measures.push_back(text);
      }
    }
    study_.scene = scene_.file.string();
    study_.all_frames = std::max(1, scene_.run.frames);
    runner_.emplace(options_, study_.all_frames, study_.frame_time);
    runner_->plan().measures = std::move(measures);
    study_.threads = runner_->threads();
    const double begin = wall_clock();
    Motion motion = runner_->run(scene_, begin + k_first_share * options_.budget, options_.surface);
    if (!motion.failure.empty()) throw program::RunFailure(motion.failure);
    study_.frames = static_cast<int>(motion.frame_seconds.size());
    if (study_.frames == 0)
      throw program::RunFailure("the budget is too small: one frame takes longer than " +
                                std::to_string(k_first_share * options_.budget) +
                                " s; give more by --budget");
    if (study_.frames < study_.all_frames) {
      runner_->plan().frames = study_.frames;
      motion =
          runner_->run(scene_, wall_clock() + options_.budget, options_.surface);  // with moments at its end
    }
    plain_cost_ = wall_clock() - begin;
    if (study_.frames < study_.all_frames) plain_cost_ *= 0.5;
    add_row({.name = "as it is", .scene = scene_}, std::move(motion));
  }

  void add_row(const Setting& setting, Motion motion) {
    Row row{.setting = setting, .motion = std::move(motion)};
    row.seconds.push_back(row.motion.seconds_per_frame());
    row.drawing.push_back(row.motion.draw_seconds_per_frame());
    study_.rows.push_back(std::move(row));
  }

  /// Halves the step until that changes little. Steps alone cost more, not drawing.
  void find_reference() {
    Reference& reference = study_.reference;
    const bool is_finest = print_scene(finest(scene_, 1)) == print_scene(scene_);
    const double begin = wall_clock();
    double factor = 1, cost = plain_cost_;
    Motion before = is_finest ? study_.rows.front().motion : run_finest(1);
    if (!is_finest) cost = wall_clock() - begin;
    reference.factors.push_back(1);
    reference.motion = before;
    while (static_cast<float>(factor) * scene_.solver.time_step_factor > 2 * k_shortest_factor &&
           2 * cost < left(k_reference_share)) {
      factor /= 2;
      const double started = wall_clock();
      say("reference, steps of 1/" + std::to_string(static_cast<int>(1 / factor)));
      Motion motion = run_finest(factor);
      cost = wall_clock() - started;
      if (!motion.failure.empty() || motion.moments.size() != before.moments.size()) break;
      reference.factors.push_back(factor);
      reference.differences.push_back(motion_error(before, motion).rms);
      reference.late_shape = motion_error(before, motion, k_late).shape();
      // The one before stays the reference: in still shorter steps rounding counts more than the step.
      reference.parts_again = parts_again(reference.differences);
      if (reference.parts_again) break;
      reference.factor = factor;
      reference.motion = motion;
      before = std::move(motion);
      const double off = motion_error(study_.rows.front().motion, reference.motion).rms;
      reference.converged = reference.differences.back() < k_little * off;
      if (reference.converged) break;
    }
    reference.order = convergence_order(reference.differences);
    if (reference.parts_again) {
      reference.error = reference.differences.back();
    } else if (!reference.differences.empty()) {
      // What is left of a geometric series; with no order known, as much as the last difference.
      const double ratio = reference.order && *reference.order > 0.2 ? std::exp2(*reference.order) : 2;
      reference.error = reference.differences.back() / (ratio - 1);
    }
  }

  Motion run_finest(double factor) {
    return runner_->run(finest(scene_, static_cast<float>(factor)), start_ + options_.budget, false);
  }

  void run_settings() {
    std::vector<Setting> settings = options_.extra;
    for (Setting& setting : settings_around(scene_, traits_)) settings.push_back(std::move(setting));
    for (const Setting& setting : settings) {
      // The last bit is still to come, which is one more run.
      if (setting.cost * plain_cost_ + plain_cost_ > left(k_settings_share))
        study_.left_out.push_back(setting.name);
      else
        run_setting(setting);
    }
    listed_ = study_.rows.size();
  }

  void run_setting(const Setting& setting) {
    say(setting.name);
    Motion motion = runner_->run(setting.scene, start_ + options_.budget, options_.surface);
    if (motion.failure.empty() && static_cast<int>(motion.frame_seconds.size()) == study_.frames)
      add_row(setting, std::move(motion));
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
        if (setting.cost * plain_cost_ < left(k_search_share) &&
            known.insert(print_scene(setting.scene)).second)
          run_setting(setting);
    }
  }

  void run_last_bit() {
    if (plain_cost_ > left()) return;
    say("one position moved by its last bit");
    const Motion& plain = study_.rows.front().motion;
    const Motion moved = runner_->run(scene_, start_ + options_.budget, false, true);
    if (!moved.failure.empty() || moved.moments.size() != plain.moments.size()) return;
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
        const Motion motion = runner_->run(row.setting.scene, start_ + options_.budget, options_.surface);
        if (static_cast<int>(motion.frame_seconds.size()) != study_.frames) continue;
        row.seconds.push_back(motion.seconds_per_frame());
        row.drawing.push_back(motion.draw_seconds_per_frame());
      }
    }
  }

  void judge() {
    const Motion& reference = study_.reference.motion;
    const PixelOf pixel = camera_of(scene_, study_.rows.front().motion);
    std::vector<double> errors;  // of the settings that any study has, wherever a search led
    for (Row& row : study_.rows) {
      row.error = motion_error(row.motion, reference, 0, pixel);
      row.late = motion_error(row.motion, reference, k_late, pixel);
      row.on_front = false;
      if (errors.size() < listed_) errors.push_back(row.error.rms);
    }
    const double typical = k_chaos * median(errors);
    const Reference& found = study_.reference;
    const bool converges =
        found.differences.size() < 2 || found.order.value_or(1) > k_no_order || found.error < typical;
    study_.parts = study_.last_bit && study_.last_bit->rms >= typical;
    study_.chaotic = typical > 0 && (study_.parts || !converges);
    for (const std::size_t i : pareto_front(study_.trades())) study_.rows[i].on_front = true;
  }

  const Scene& scene_;
  const StudyOptions& options_;
  double start_;
  std::optional<Runner> runner_;
  SceneTraits traits_;
  std::size_t listed_ = 0;  ///< rows before any search
  double plain_cost_ = 0;   ///< wall time of a run as it is [s]
  Study study_;
};

}  // namespace

double Row::median_seconds() const {
  return median(seconds);
}
double Row::median_drawing() const {
  return median(drawing);
}

double Row::least_frame_seconds() const {
  return std::ranges::min(seconds) + std::ranges::min(drawing);
}

std::vector<Trade> Study::trades() const {
  std::vector<Trade> trades;
  for (const Row& row : rows) trades.push_back({row.least_frame_seconds(), error(row)});
  return trades;
}

Study study(const Scene& scene, const StudyOptions& options) {
  return Maker(scene, options).make();
}

Row run_again(const Study& study, const Setting& setting, const StudyOptions& options) {
  Runner runner(options, study.frames, study.frame_time);
  Row row{.setting = setting,
          .motion = runner.run(setting.scene, std::numeric_limits<double>::infinity(), options.surface)};
  row.seconds.push_back(row.motion.seconds_per_frame());
  row.drawing.push_back(row.motion.draw_seconds_per_frame());
  row.error = motion_error(row.motion, study.reference.motion);
  row.late = motion_error(row.motion, study.reference.motion, k_late);
  return row;
}

}  // namespace mallow::tradeoff
