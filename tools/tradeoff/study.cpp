#include "tradeoff/study.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <map>

#include "mallow/files.h"
#include "program/machine.h"
#include "program/view_bounds.h"
#include "render/viewport.h"
#include "tradeoff/measures.h"
#include "tradeoff/text.h"

namespace mallow::tradeoff {

Study run_study(const Scene& scene, const StudyOptions& options) {
  SceneKnobOptions knob_options = options.knobs;
  knob_options.threads = program::resolve_threads(knob_options.threads);
  Study study{SceneKnobs(scene, knob_options), {}, {}, {}, knob_options.threads};
  TuningConfig& config = study.config;
  config.frame_time = frame_time(scene, study.knobs.info());
  config.frames = std::max(1, options.frames ? std::min(*options.frames, scene.run.frames) : scene.run.frames);
  config.budget = options.budget;
  config.repeats = options.repeats;
  config.combinations = options.combinations;
  config.stop = options.stop;
  config.progress = options.progress;
  const Simulation simulation = build(scene, study.threads);
  config.measures = make_measures(options.measures, simulation, scene, study.threads);
  study.view = program::view_bounds(scene, snapshot(simulation));
  const render::Camera camera =
      render::frame_camera(study.view, scene.render, program::visible_colliders(scene));
  const render::Viewport viewport(camera, scene.render.width, scene.render.height);
  config.pixel = [viewport](const Vec3& x) { return viewport.pixel(x); };
  study.result = measure_tradeoff(study.knobs, config);
  return study;
}

std::vector<program::SceneChange> changes_of(const Study& study, const TuningChoice& choice) {
  const TuningChoice own(choice.size(), -1);
  return program::scene_changes(study.knobs.at(own), study.knobs.at(choice));
}

std::string lines_to_paste(const Study& study, const TuningChoice& choice) {
  std::string lines, section;
  for (const program::SceneChange& change : changes_of(study, choice)) {
    const std::size_t dot = change.key.rfind('.');
    std::string here = change.key.substr(0, dot);
    if (here != section) {
      lines += lines.empty() ? "" : "\n";
      const std::size_t bracket = here.find('[');
      const std::string note = bracket == here.npos ? "" : "  # " + here;
      lines += bracket == here.npos ? "[" + here + "]" : "[[" + here.substr(0, bracket) + "]]";
      lines += note + "\n";
      section = std::move(here);
    }
    const std::string key = change.key.substr(dot + 1);
    lines += change.now.empty() ? "# leave out " + key + "\n" : key + " = " + change.now + "\n";
  }
  return lines.empty() ? "# nothing to change\n" : lines;
}

double parse_duration(const std::string& text, const std::string& field) {
  static const std::map<std::string, double> k_units = {
      {"", 1}, {"s", 1}, {"ms", 1e-3}, {"m", 60}, {"min", 60}, {"h", 3600}};
  double value = 0;
  std::size_t used = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const auto unit = k_units.find(text.substr(used));
  if (used == 0 || unit == k_units.end() || !(value > 0) || !std::isfinite(value))
    throw ConfigError(field, "'" + text + "' is no time above 0: 60s, 5m, 1h, 250ms");
  return value * unit->second;
}

namespace {

std::string chaos_of(const TuningResult& result) {
  if (!result.chaotic)
    return format("Two runs that differ in the last bit of some places part by %.3g h: places can be compared.",
                  result.twin);
  std::string text = format(
      "The motion is chaotic: two runs that differ in the last bit of some places part by %.3g h, as much as "
      "the settings do",
      result.twin);
  if (result.parted_at) text += format(", from frame %d on", *result.parted_at);
  return text +
         format(
             ". So means over the last third of the frames are compared in place of places: height, spread and "
             "centre of mass, the largest of them. Those two runs differ by %.3g h in that; less tells nothing.",
             result.twin_statistic);
}

std::string convergence_of(const TuningResult& result) {
  if (result.levels.empty()) return "There was no time for a reference.";
  const TuningLevel& finest = result.levels.back();
  std::string text = format("The reference takes %lld steps of %.4g s in the mean",
                            static_cast<long long>(finest.steps), finest.time_step);
  if (result.order) text += format("; in ever shorter steps it converges with order %.2f", *result.order);
  text += format(", and is about %.2g h from its limit", result.reference_error);
  if (!result.converged)
    text += result.order && *result.order < 0.3
                ? ". Differences do not shrink: it has not converged, and errors below their size tell nothing"
                : ". That is not far below the errors themselves: a longer budget finds a finer one";
  return text + ".";
}

}  // namespace

std::vector<std::string> findings(const Study& study) {
  const TuningResult& result = study.result;
  std::vector<std::string> lines;
  lines.push_back(format("%d frame%s of %.4g s, %zu settings, %d thread%s, %.1f s in all%s.", result.frames,
                         result.frames == 1 ? "" : "s", study.config.frame_time, result.rows.size(),
                         study.threads, study.threads == 1 ? "" : "s", result.seconds,
                         result.interrupted ? "; it was interrupted" : ""));
  if (result.rows.empty()) return lines;
  lines.push_back(convergence_of(result));
  lines.push_back(chaos_of(result));
  if (!result.left_out.empty()) {
    std::string text = "The budget had no time for: ";
    for (std::size_t i = 0; i < result.left_out.size(); ++i)
      text += (i == 0 ? "" : "; ") + result.left_out[i];
    lines.push_back(text + ".");
  }
  return lines;
}

}  // namespace mallow::tradeoff
