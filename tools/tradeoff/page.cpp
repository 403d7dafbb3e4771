#include "tradeoff/page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "program/html.h"
#include "tradeoff/tables.h"

namespace mallow::tradeoff {
namespace {

using program::html_text;

constexpr double k_width = 860, k_height = 420, k_margin = 60;  ///< [pixels]

/// A logarithmic axis over some values, from one side of the plot to the other.
class Axis {
 public:
  Axis(const std::vector<double>& values, double first, double last) : first_(first), last_(last) {
    for (const double value : values)
      if (value > 0 && std::isfinite(value)) {
        low_ = std::min(low_, std::log10(value));
        high_ = std::max(high_, std::log10(value));
      }
    if (low_ > high_) low_ = -1, high_ = 0;
    const double more = 0.05 * (high_ - low_) + 0.05;
    low_ -= more;
    high_ += more;
  }
  double place(double value) const {
    const double share = value > 0 ? (std::log10(value) - low_) / (high_ - low_) : 0;
    return first_ + std::max(0.0, share) * (last_ - first_);
  }
  /// 1, 2 and 5 of every power of ten.
  std::vector<double> ticks() const {
    std::vector<double> ticks;
    for (double power = std::floor(low_); power <= high_; ++power)
      for (const double digit : {1.0, 2.0, 5.0})
        if (const double tick = digit * std::pow(10, power);
            std::log10(tick) >= low_ && std::log10(tick) <= high_)
          ticks.push_back(tick);
    return ticks;
  }

 private:
  double first_, last_;
  double low_ = 1e300, high_ = -1e300;
};

std::string text_at(double x, double y, const std::string& anchor, const std::string& text) {
  return "<text x=\"" + number(x, 5) + "\" y=\"" + number(y, 5) + "\" text-anchor=\"" + anchor + "\">" +
         html_text(text) + "</text>\n";
}

std::string line(double x0, double y0, double x1, double y1, const char* kind) {
  return "<line class=\"" + std::string(kind) + "\" x1=\"" + number(x0, 5) + "\" y1=\"" + number(y0, 5) +
         "\" x2=\"" + number(x1, 5) + "\" y2=\"" + number(y1, 5) + "\"/>\n";
}

std::string plot(const Study& study) {
  std::vector<double> costs, errors;
  for (const Row& row : study.rows) {
    costs.push_back(1e3 * row.frame_seconds());
    errors.push_back(study.error(row));
  }
  const Axis x(costs, k_margin, k_width - 20), y(errors, k_height - k_margin, 20);
  std::string svg = "<svg viewBox=\"0 0 " + number(k_width) + " " + number(k_height) + "\" role=\"img\">\n";
  for (const double tick : x.ticks()) {
    svg += line(x.place(tick), 20, x.place(tick), k_height - k_margin, "grid");
    svg += text_at(x.place(tick), k_height - k_margin + 18, "middle", number(tick));
  }
  for (const double tick : y.ticks()) {
    svg += line(k_margin, y.place(tick), k_width - 20, y.place(tick), "grid");
    svg += text_at(k_margin - 6, y.place(tick) + 4, "end", number(tick));
  }
  svg += text_at(k_width / 2, k_height - 12, "middle", "time of a frame [ms]");
  svg += text_at(6, 14, "start",
                 study.chaotic ? "error [h]: of shape in the last quarter, or of the surface"
                               : "error [h]: RMS of positions, or of the surface");
  std::string front;
  for (const std::size_t i : by_cost(study))
    if (study.rows[i].on_front)
      front += number(x.place(costs[i]), 5) + "," + number(y.place(errors[i]), 5) + " ";
  svg += "<polyline points=\"" + front + "\"/>\n";
  for (const std::size_t i : by_cost(study)) {
    const double px = x.place(costs[i]), py = y.place(errors[i]);
    svg += "<circle class=\"" + std::string(study.rows[i].on_front ? "front" : "other") + "\" cx=\"" +
           number(px, 5) + "\" cy=\"" + number(py, 5) + "\" r=\"5\"><title>" +
           html_text(study.rows[i].setting.name) + "</title></circle>\n";
    const bool at_right = px > 0.7 * k_width;
    svg +=
        text_at(at_right ? px - 8 : px + 8, py - 6, at_right ? "end" : "start", study.rows[i].setting.name);
  }
  return svg + "</svg>\n";
}

std::string cell(const std::string& text) {
  return "<td>" + html_text(text) + "</td>";
}

std::string table(const Study& study, std::optional<std::size_t> picked) {
  std::string html =
      "<table><tr><th>setting</th><th>steps [ms]</th><th>surface [ms]</th><th>error [h]</th><th>surface "
      "[h]</th><th>median "
      "[h]</th><th>worst [h]</th><th>worst [px]</th><th>height [h]</th><th>volume</th><th>energy</th>";
  for (const std::string& measure : study.measures) html += "<th>" + html_text(measure) + "</th>";
  html += "<th>to paste</th></tr>\n";
  for (const std::size_t i : by_cost(study)) {
    const Row& row = study.rows[i];
    const auto [least, most] = std::ranges::minmax(row.seconds);
    html += std::string("<tr") +
            (picked == i    ? " class=\"picked\""
             : row.on_front ? " class=\"front\""
                            : "") +
            ">" + cell(row.setting.name) +
            cell(number(1e3 * row.median_seconds()) + " (" + number(1e3 * least) + " to " +
                 number(1e3 * most) + ", " + std::to_string(row.seconds.size()) + " runs)") +
            cell(number(1e3 * row.median_drawing())) + cell(number(study.error(row))) +
            cell(row.surface ? number(*row.surface) : "") + cell(number(row.error.median)) +
            cell(number(row.error.worst)) +
            cell(row.error.worst_pixels ? number(*row.error.worst_pixels) : "") +
            cell(number(row.error.height)) + cell(number(row.error.volume)) + cell(number(row.error.energy));
    for (const double measure : row.error.measures) html += cell(number(measure));
    html += "<td><pre>" + html_text(lines_to_paste(study.rows.front().setting.scene, row.setting.scene)) +
            "</pre></td></tr>\n";
  }
  return html + "</table>\n";
}

/// Both at once: one film holds them, so they stay in step.
std::string side_by_side(const Study& study, const SideBySide& film) {
  if (film.file.empty()) return "<p>" + html_text(film.why) + "</p>\n";
  const auto caption = [&](std::size_t row) {
    return "<td>" + html_text(study.rows[row].setting.name) + ": " +
           number(1e3 * study.rows[row].frame_seconds()) + " ms a frame, " +
           number(study.error(study.rows[row])) + " h off</td>";
  };
  return "<h2>Side by side</h2>\n<video src=\"" + html_text(film.file) +
         "\" controls loop muted autoplay></video>\n<table class=\"captions\"><tr>" + caption(0) +
         caption(film.row) + "</tr></table>\n";
}

}  // namespace

std::string to_page(const Study& study, std::optional<std::size_t> picked,
                    const std::optional<SideBySide>& film) {
  const std::string name = std::filesystem::path(study.scene).filename().string();
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + html_text(name) +
      ": speed against accuracy</title>\n<style>\n"
      "body { font: 15px sans-serif; margin: 2em auto; max-width: 1200px; color: #222; }\n"
      "svg { width: 100%; font-size: 11px; } .grid { stroke: #ddd; }\n"
      "polyline { fill: none; stroke: #c33; stroke-width: 2; }\n"
      ".front { fill: #c33; } .other { fill: #888; }\n"
      "table { border-collapse: collapse; font-size: 13px; } td, th { padding: 3px 8px; "
      "text-align: left; border-bottom: 1px solid #ddd; vertical-align: top; }\n"
      "tr.front { background: #fdf0ee; } tr.picked { background: #e6f4e6; } pre { margin: 0; }\n"
      "video, .captions { width: 100%; max-width: 968px; } .captions td { width: 50%; border: 0; }\n"
      "</style></head><body>\n<h1>" +
      html_text(name) + ": speed against accuracy</h1>\n";
  html += plot(study) + "<ul>\n";
  for (const std::string& remark : remarks(study)) html += "<li>" + html_text(remark) + "</li>\n";
  html += "</ul>\n" + (film ? side_by_side(study, *film) : "") + table(study, picked) +
          "<h2>What the columns mean</h2>\n<ul>\n";
  for (const std::string& line : column_help()) html += "<li>" + html_text(line) + "</li>\n";
  return html +
         "</ul>\n<p>In brackets: names in tradeoff.csv. Rows in red are on the front, the green one is the "
         "pick.</p>\n</body></html>\n";
}

}  // namespace mallow::tradeoff
