#include "stability/stability_map.h"

#include <algorithm>
#include <optional>
#include <sstream>
#include <vector>

#include "mallow/files.h"
#include "stability/hypercube.h"
#include "stability/panels.h"

namespace mallow::bench {
namespace {

constexpr int k_field = 9, k_gap = 8, k_left = 90, k_top = 70;

const char* color(Verdict verdict) {
  constexpr const char* k_colors[] = {"#3a9d5d", "#9ccf7c", "#e3b23c", "#c8342b"};
  return k_colors[static_cast<std::size_t>(verdict)];
}

class Drawing {
 public:
  void text(int x, int y, const std::string& words, const char* anchor = "middle") {
    body_ << "<text x='" << x << "' y='" << y << "' text-anchor='" << anchor << "'>" << words << "</text>\n";
  }
  void field(int x, int y, int width, const char* color) {
    body_ << "<rect x='" << x << "' y='" << y << "' width='" << width << "' height='" << k_field << "' fill='"
          << color << "'/>\n";
  }
  /// The points of one verdict on a line of them.
  void strip(int x, int y, Verdict verdict, const std::vector<std::optional<Verdict>>& points) {
    body_ << "<path stroke-width='" << k_field << "' stroke='" << color(verdict) << "' d='";
    for (std::size_t at = 0, end = 0; at < points.size(); at = end + 1) {
      end = at;
      while (end < points.size() && points[end] == verdict) ++end;
      if (end > at) body_ << 'M' << x + static_cast<int>(at) << ' ' << y << 'h' << end - at;
    }
    body_ << "'/>\n";
  }
  std::string svg(int width, int height) const {
    std::ostringstream all;
    all << "<svg xmlns='http://www.w3.org/2000/svg' width='" << width << "' height='" << height
        << "' font-family='Helvetica' font-size='13'>\n<rect width='100%' height='100%' fill='white'/>\n"
        << body_.str() << "</svg>\n";
    return all.str();
  }

 private:
  std::ostringstream body_;
};

std::string number(float value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// What the colours mean, from x on.
void draw_legend(Drawing& drawing, int x) {
  for (const Verdict verdict : {Verdict::stable, Verdict::limited, Verdict::refused, Verdict::unstable}) {
    drawing.field(x, 30, 2 * k_field, color(verdict));
    drawing.text(x + 25, 39, name(verdict), "start");
    x += 110;
  }
}

}  // namespace

void write_map(const std::filesystem::path& svg, const StabilityGrid& grid,
               const std::vector<Outcome>& outcomes) {
  const int across = static_cast<int>(grid.viscosities.size()),
            down = static_cast<int>(grid.pressures.size());
  const int panel_x = across * k_field + k_gap, panel_y = down * k_field + k_gap;
  const int width = k_left + static_cast<int>(grid.alphas.size()) * panel_x + 20;
  const int height = k_top + static_cast<int>(grid.time_steps.size()) * panel_y + 50;
  Drawing drawing;
  drawing.text(width / 2, 20,
               "A cube that falls: stable, held by the limit on the step, refused with an error, unstable");
  draw_legend(drawing, width / 2 - 200);
  for (std::size_t a = 0; a < grid.alphas.size(); ++a)
    drawing.text(k_left + static_cast<int>(a) * panel_x + panel_x / 2, k_top - 8,
                 "&#945; " + number(grid.alphas[a]));
  for (std::size_t t = 0; t < grid.time_steps.size(); ++t)
    drawing.text(k_left - 8, k_top + static_cast<int>(t) * panel_y + panel_y / 2,
                 number(grid.time_steps[t]) + " &#916;t0", "end");
  drawing.text(width / 2, height - 30,
               "in each panel: k from " + number(grid.pressures.front()) + " (top) to " +
                   number(grid.pressures.back()) + ", &#956; from " + number(grid.viscosities.front()) +
                   " (left) to " + number(grid.viscosities.back()));
  // Verdicts are in the order from the best to the worst.
  const std::size_t restitutions = grid.restitutions.size();
  const auto worst = [&](std::size_t field) {
    Verdict verdict = Verdict::stable;
    for (std::size_t e = 0; e < restitutions; ++e)
      verdict = std::max(verdict, outcomes[field * restitutions + e].verdict);
    return verdict;
  };
  // Fields of one colour in a row are one, which makes the file a quarter as large.
  std::size_t index = 0;
  for (std::size_t a = 0; a < grid.alphas.size(); ++a) {
    for (std::size_t t = 0; t < grid.time_steps.size(); ++t) {
      for (int k = 0; k < down; ++k) {
        for (int m = 0, run = 1; m < across; m += run, run = 1) {
          const Verdict verdict = worst(index + static_cast<std::size_t>(m));
          while (m + run < across && worst(index + static_cast<std::size_t>(m + run)) == verdict) ++run;
          drawing.field(k_left + static_cast<int>(a) * panel_x + m * k_field,
                        k_top + static_cast<int>(t) * panel_y + k * k_field, run * k_field, color(verdict));
        }
        index += static_cast<std::size_t>(across);
      }
    }
  }
  write_whole(svg, drawing.svg(width, height));
}

void write_panels(const std::filesystem::path& svg, const std::vector<Panel>& panels,
                  const std::vector<float>& alphas, const std::vector<Outcome>& outcomes) {
  constexpr int k_name = 260, k_across = 60, k_width = 760;
  const int panel_y = static_cast<int>(alphas.size()) * k_field + 4 * k_gap;
  Drawing drawing;
  drawing.text(k_width / 2, 20,
               "Bodies that touch, rest, come and are pushed; in each row alpha from " +
                   number(alphas.front()) + " (top) to " + number(alphas.back()));
  draw_legend(drawing, k_width / 2 - 200);
  int y = k_top;
  const Outcome* outcome = outcomes.data();
  for (const Panel& panel : panels) {
    drawing.text(k_name - k_gap, y + panel_y / 2 - k_gap, panel.name, "end");
    int x = k_name;
    for (const float value : panel.values) {
      for (std::size_t a = 0; a < alphas.size(); ++a)
        drawing.field(x, y + static_cast<int>(a) * k_field, k_across, color((outcome++)->verdict));
      drawing.text(x + k_across / 2, y + panel_y - 2 * k_gap, number(value));
      x += k_across + 2;
    }
    y += panel_y;
  }
  write_whole(svg, drawing.svg(k_width, y + k_gap));
}

void write_hypercube(const std::filesystem::path& svg, const std::vector<Mixture>& mixtures,
                     const std::vector<Outcome>& outcomes) {
  constexpr int k_strip = 600, k_margin = 20, k_strip_y = 34;
  const int n = static_cast<int>(mixtures.size()), k_width = k_strip + 2 * k_margin;
  Drawing drawing;
  drawing.text(k_width / 2, 20, "All knobs turned together, " + std::to_string(n) + " times at random");
  draw_legend(drawing, k_width / 2 - 200);
  int y = k_top;
  for (std::size_t k = 0; k < mixtures.front().knobs.size(); ++k) {
    drawing.text(k_margin, y, mixtures.front().knobs[k].name, "start");
    // The worst of those that fall on a point, and points of one colour that lie side by side as one.
    std::vector<std::optional<Verdict>> worst(k_strip);
    for (std::size_t i = 0; i < mixtures.size(); ++i) {
      const int wide = std::max(1, k_strip / n), x = static_cast<int>(k_strip * mixtures[i].knobs[k].turn);
      for (int at = x; at < std::min(x + wide, k_strip); ++at) {
        std::optional<Verdict>& here = worst[static_cast<std::size_t>(at)];
        here = std::max(here.value_or(Verdict::stable), outcomes[i].verdict);
      }
    }
    for (const Verdict verdict : {Verdict::stable, Verdict::limited, Verdict::refused, Verdict::unstable})
      drawing.strip(k_margin, y + 9, verdict, worst);
    y += k_strip_y;
  }
  write_whole(svg, drawing.svg(k_width, y));
}

}  // namespace mallow::bench
