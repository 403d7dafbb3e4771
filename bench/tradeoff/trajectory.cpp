#include "tradeoff/trajectory.h"

#include <algorithm>
#include <cmath>

#include "harness/statistics.h"
#include "textbook/from_scene.h"

namespace mallow::bench {
namespace {

Moment::Rows rows(const std::vector<Vec3>& values) {
  Moment::Rows result(static_cast<Eigen::Index>(values.size()), 3);
  for (std::size_t i = 0; i < values.size(); ++i)
    result.row(static_cast<Eigen::Index>(i)) = values[i].cast<double>().transpose();
  return result;
}

Moment::Rows rows(const std::vector<Eigen::Vector3d>& values) {
  Moment::Rows result(static_cast<Eigen::Index>(values.size()), 3);
  for (std::size_t i = 0; i < values.size(); ++i)
    result.row(static_cast<Eigen::Index>(i)) = values[i].transpose();
  return result;
}

/// step() moves on; moment() tells where; time() when.
Trajectory record(double interval, std::size_t count, const std::function<void()>& step,
                  const std::function<Moment()>& moment, const std::function<double()>& time) {
  Trajectory trajectory{.interval = interval, .moments = {}};
  Moment last = moment();
  double last_time = time();
  trajectory.moments.push_back(last);
  try {
    while (trajectory.moments.size() < count) {
      step();
      const double now = time();
      Moment next = moment();
      while (trajectory.moments.size() < count) {
        const double due = interval * static_cast<double>(trajectory.moments.size());
        if (due > now * (1 + 1e-12)) break;
        const double share = std::clamp((due - last_time) / (now - last_time), 0.0, 1.0);
        trajectory.moments.push_back(
            {last.x + share * (next.x - last.x), last.v + share * (next.v - last.v)});
      }
      last = std::move(next);
      last_time = now;
    }
  } catch (const StepError& error) {
    trajectory.failure = error.what();
  }
  return trajectory;
}

}  // namespace

Trajectory run_engine(const Scene& scene, double interval, std::size_t count, int threads) {
  Simulation simulation = build(scene, threads);
  Trajectory trajectory = record(
      interval, count, [&] { simulation.step(); },
      [&] {
        return Moment{rows(simulation.positions_by_id()), rows(simulation.velocities_by_id())};
      },
      [&] { return simulation.time(); });
  trajectory.state_hash = simulation.state_hash();
  return trajectory;
}

Trajectory run_textbook(const Scene& scene, double interval, std::size_t count, int threads) {
  textbook::Textbook textbook = textbook::from_scene(scene, threads);
  return record(
      interval, count, [&] { textbook.step(); },
      [&] {
        return Moment{rows(textbook.positions()), rows(textbook.velocities())};
      },
      [&] { return textbook.time(); });
}

double milliseconds_per_second(const Scene& scene, double duration, int threads) {
  Simulation simulation = build(scene, threads);
  simulation.prepare();
  simulation.step();
  const double start = simulation.time();
  const double spent = milliseconds([&] {
    while (simulation.time() < duration) simulation.step();
  });
  return spent / (simulation.time() - start);
}

Trajectory resampled(const Trajectory& trajectory, const Lattice& from, const Lattice& to) {
  // Corners of the cell of `from` around every particle of `to`, and their weights.
  const Eigen::Index n = Eigen::Index{1} * to.count[0] * to.count[1] * to.count[2];
  Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 8> corners(n, 8);
  Eigen::Matrix<double, Eigen::Dynamic, 8> weights(n, 8);
  Eigen::Index row = 0;
  for (int z = 0; z < to.count[2]; ++z) {
    for (int y = 0; y < to.count[1]; ++y) {
      for (int x = 0; x < to.count[0]; ++x, ++row) {
        const std::array<int, 3> place = {x, y, z};
        std::array<int, 3> base;
        std::array<double, 3> share;
        for (std::size_t a = 0; a < 3; ++a) {
          const auto axis = static_cast<Eigen::Index>(a);
          const double at =
              static_cast<double>(to.corner[axis]) + (place[a] + 0.5) * static_cast<double>(to.spacing);
          const double u =
              (at - static_cast<double>(from.corner[axis])) / static_cast<double>(from.spacing) - 0.5;
          base[a] = std::clamp(static_cast<int>(std::floor(u)), 0, from.count[a] - 2);
          share[a] = u - base[a];
        }
        for (int c = 0; c < 8; ++c) {
          const std::array<int, 3> bit = {c & 1, c >> 1 & 1, c >> 2};
          double weight = 1;
          for (std::size_t a = 0; a < 3; ++a) weight *= bit[a] == 1 ? share[a] : 1 - share[a];
          corners(row, c) =
              ((base[2] + bit[2]) * from.count[1] + base[1] + bit[1]) * from.count[0] + base[0] + bit[0];
          weights(row, c) = weight;
        }
      }
    }
  }
  Trajectory result{.interval = trajectory.interval, .moments = {}};
  for (const Moment& moment : trajectory.moments) {
    Moment there{Moment::Rows::Zero(n, 3), Moment::Rows::Zero(n, 3)};
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index c = 0; c < 8; ++c) {
        there.x.row(i) += weights(i, c) * moment.x.row(corners(i, c));
        there.v.row(i) += weights(i, c) * moment.v.row(corners(i, c));
      }
    }
    result.moments.push_back(std::move(there));
  }
  return result;
}

}  // namespace mallow::bench
