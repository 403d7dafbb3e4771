#include <algorithm>

#include "tradeoff/runner.h"
#include "tradeoff/study.h"

namespace mallow::tradeoff {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

double Row::median_seconds() const {
  return median(seconds);
}
double Row::median_drawing() const {
  return median(drawing);
}

double Row::least_frame_seconds() const {
  return std::ranges::min(seconds) + std::ranges::min(drawing);
}
double Row::most_frame_seconds() const {
  return std::ranges::max(seconds) + std::ranges::max(drawing);
}

std::vector<Trade> Study::trades() const {
  std::vector<Trade> trades;
  for (const Row& row : rows) trades.push_back({row.frame_seconds(), error(row)});
  return trades;
}

void mark_front(Study& study) {
  for (Row& row : study.rows) row.on_front = false;
  for (const std::size_t i : pareto_front(study.trades())) study.rows[i].on_front = true;
}

std::optional<Row> run_again(const Study& study, const Setting& setting, const StudyOptions& options,
                             double deadline) {
  Runner runner(options, study.frames, study.frame_time);
  SurfaceCheck check{study.fine_surface};
  Row row{.setting = setting,
          .motion =
              runner.run(setting.scene, {.deadline = deadline, .drawn = options.surface, .surface = &check})};
  row.surface = check.error;
  if (static_cast<int>(row.motion.frame_seconds.size()) != study.frames) return std::nullopt;
  row.seconds.push_back(row.motion.seconds_per_frame());
  row.drawing.push_back(row.motion.draw_seconds_per_frame());
  row.error = motion_error(row.motion, study.reference.motion);
  row.late = motion_error(row.motion, study.reference.motion, k_late);
  return row;
}

std::string stretch(const Study& study) {
  return study.frames == study.all_frames ? ""
                                          : "the first " + std::to_string(study.frames) + " of " +
                                                std::to_string(study.all_frames) + " frames";
}

}  // namespace mallow::tradeoff
