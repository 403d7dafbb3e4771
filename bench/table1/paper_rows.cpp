#include "table1/paper_rows.h"

namespace mallow::bench {

std::span<const PaperRow> paper_rows() {
  static const std::array<PaperRow, 12> k_rows = {{
      {"bar_sigma8", "Fig. 2 Bar", 3600, 755.3, 0.0, 8.0, {96, 96, 128}, 1.8, 1.3},
      {"bar_sigma5", "Fig. 2 Bar", 3600, 256.5, 0.0, 8.0, {96, 96, 128}, 4.7, 2.4},
      {"bar_sigma3", "Fig. 2 Bar", 3600, 64.3, 0.0, 8.0, {96, 96, 128}, 14.2, 3.8},
      {"cube_10648", "Fig. 3 Cube", 10648, 80.7, 0.7, 12.0, {128, 128, 128}, 4.1, 0.35},
      {"cube_3375", "Fig. 3 Cube", 3375, 23.6, 0.7, 12.0, {128, 128, 128}, 25.1, 1.2},
      {"moai_3764", "Fig. 5(a) Moai", 3764, 85.3, 0.0, 6.0, {160, 160, 192}, 8.7, 0.56},
      {"moai_2015", "Fig. 5(a) Moai", 2015, 43.1, 0.0, 6.0, {64, 64, 96}, 26.6, 5.4},
      {"armadillo_4157", "Fig. 5(b) Armadillo", 4157, 27.1, 0.8, 6.0, {160, 160, 192}, 21.9, 0.68},
      {"armadillo_2680", "Fig. 5(b) Armadillo", 2680, 16.6, 0.8, 6.0, {64, 64, 96}, 42.2, 6.3},
      {"bunny_4185", "Fig. 5(c) Bunny", 4185, 35.1, 0.85, 6.0, {160, 160, 192}, 17.4, 0.42},
      {"bunny_1328", "Fig. 5(c) Bunny", 1328, 26.7, 0.85, 6.0, {32, 32, 48}, 64.6, 36.8},
      {"balls_8264", "Fig. 5(d) Balls", 8264, 28.3, 0.9, 10.0, {160, 160, 224}, 11.3, 0.20},
  }};
  return k_rows;
}

}  // namespace mallow::bench
