// Fig. 5(c) and (d) of Takamatsu & Kanai: bodies that split and bodies that merge.
#include <algorithm>

#include "core/disjoint_sets.h"
#include "figures/connected_parts.h"
#include "figures/figure.h"
#include "figures/measures.h"
#include "harness/statistics.h"

namespace mallow::bench {
namespace {

// ---- (c) bunny: "an object is once collided with a hemisphere and is split into several parts. They are
// finally merged on the floor."

/// The demo and Table 1's, or small: the demo five times.
std::vector<Take> bunny_takes(bool small) {
  // Of Table 1 in all but k and cohesion, which the paper does not print: at a quarter of the stiffness and
  // without cohesion the sheet over the hemisphere thins out and hardly tears.
  if (!small)
    return {{"demo", "demo.toml"},
            {"Table 1",
             "table1/bunny_4185.toml",
             {"material[0].pressure_coefficient=60", "material[0].cohesion=0.5"}}};
  // Splitting needs particles to split: of 1,300 no more than one comes off. With as many neighbours as all
  // have. Of fourteen such runs two ended with the ring on the floor open at two places, so the middle one of
  // several counts.
  std::vector<Take> takes;
  for (const char* const count : {"2900", "2950", "3000", "3050", "3100"})
    takes.push_back({"demo of " + std::string(count),
                     "demo.toml",
                     {"body[0].mesh.count=" + std::string(count), "solver.support_radius=2.459"}});
  return takes;
}

std::vector<double> measure_bunny(const FrameView& frame) {
  // Particles that no chain of forces joins are parts, so the link is the reach of the forces. k_touching
  // would take the thin sheet that runs down the hemisphere for torn before any force lets go: it counts
  // twice the parts.
  const auto parts = connected_parts(frame.now, static_cast<float>(frame.support_radius), frame.threads);
  return {static_cast<double>(count_parts(parts)), static_cast<double>(parts.size()), largest_share(parts)};
}

std::vector<Claim> judge_bunny(std::span<const Recording> recordings) {
  std::vector<double> most, least_share, merged_share;
  for (const Recording& bunny : recordings) {
    most.push_back(highest(bunny["parts"]));
    least_share.push_back(lowest(bunny["largest_share"]));
    merged_share.push_back(highest(last_of(bunny["largest_share"], 0.2)));
  }
  const bool with_table1 = recordings.size() == 2;
  const auto of_demo = [&](std::vector<double> values) {
    if (with_table1) values.pop_back();
    return median(values);
  };
  // How a splash falls is chaotic: limits are set by seven runs of the demo, six with a slightly other
  // jitter, size, place or gravity (small: six runs).
  std::vector<Claim> claims = {
      // 45 to 58 (24 to 31).
      {.name = "splits_into_several_parts",
       .sentence = "the bunny is split into several parts by the hemisphere",
       .measure = "most parts of at least 4 particles at one time",
       .measured = of_demo(most),
       .bound = Bound::at_least,
       .limit = 10,
       .values = most},
      // 0.79 to 0.82 (0.47 to 0.83).
      {.name = "parts_are_not_crumbs",
       .sentence = "what splits off the bunny is more than crumbs",
       .measure = "share of particles in the largest part, least",
       .measured = of_demo(least_share),
       .bound = Bound::at_most,
       .limit = 0.9,
       .values = least_share},
      // 0.940 to 1.000: in about every second run a lump of 2% to 6% comes to rest just out of reach of the
      // rest, whatever k, cohesion and friction (0.987 to 1.000 in twelve runs, 0.53 in two of later
      // fourteen). Not at the end: the
      // ring on the floor closes by a
      // hair, and in two of the twelve it had opened again by then, 1.06 σ wide.
      {.name = "merges_on_the_floor",
       .sentence = "the parts of the bunny merge on the floor",
       .measure = "share of particles in the largest part, largest in the last fifth of the run",
       .measured = of_demo(merged_share),
       .bound = Bound::at_least,
       .limit = 0.9,
       .values = merged_share},
  };
  if (with_table1) {
    // 0.843; 0.935 with Table 1's own k and cohesion.
    claims.push_back({.name = "table_1_splits_too",
                      .sentence = "the bunny of Table 1 is split as well",
                      .measure = "share of particles in the largest part, least",
                      .measured = least_share.back(),
                      .bound = Bound::at_most,
                      .limit = 0.9,
                      .values = least_share});
    // 0.959
    claims.push_back(
        {.name = "table_1_merges_too",
         .sentence = "the parts of the bunny of Table 1 merge on the floor",
         .measure = "share of particles in the largest part, largest in the last fifth of the run",
         .measured = merged_share.back(),
         .bound = Bound::at_least,
         .limit = 0.9,
         .values = merged_share});
  }
  return claims;
}

// ---- (d) balls: "a ball is dropped and is merged into the pool water".

std::vector<Take> balls_takes(bool small) {
  Take take{"balls", "table1/balls_8264.toml"};
  if (small) {  // an eighth of the particles, with as many neighbours
    take.overrides = {"body[0].box.count=[12, 12, 5]", "body[0].box.spacing=2", "solver.support_radius=4.13"};
    for (const char* ball : {"1", "2", "3", "4"})
      take.overrides.push_back("body[" + std::string(ball) + "].sphere.spacing=2");
  }
  return {take};
}

std::vector<double> measure_balls(const FrameView& frame) {
  // The balls start within the reach of each other's forces, so it is touching that tells them apart.
  const auto parts =
      connected_parts(frame.now, static_cast<float>(k_touching * frame.spacing), frame.threads);
  // Columns two spacings wide hold about four particles a layer, so that none is empty.
  return {static_cast<double>(count_parts(parts)), largest_share(parts),
          unevenness(frame.now, 2 * frame.spacing)};
}

std::vector<Claim> judge_balls(std::span<const Recording> recordings) {
  const Recording& pool = recordings[0];
  const double unevenness = mean_of_last(pool["unevenness"], 0.25) / pool.spacing;
  return {
      {.name = "four_balls_and_a_pool",
       .sentence = "there are four balls and a pool",
       .measure = "parts at the start",
       .measured = pool["parts"].front(),
       .bound = Bound::at_least,
       .limit = 5,
       .values = {pool["parts"].front()}},
      {.name = "balls_merge_with_the_pool",
       .sentence = "the balls merge with the pool",
       .measure = "parts at the end",
       .measured = pool["parts"].back(),
       .bound = Bound::at_most,
       .limit = 1,
       .values = {pool["parts"].back()}},
      // 1 in every run; what is left is for a drop on the rim.
      {.name = "all_particles_merge",
       .sentence = "nothing of the balls stays apart",
       .measure = "share of particles in the largest part at the end",
       .measured = pool["largest_share"].back(),
       .bound = Bound::at_least,
       .limit = 0.99,
       .values = {pool["largest_share"].back()}},
      // Measured 0.32 (small: 0.34). The tops of a disordered layer vary by 0.29, as of a number that is
      // evenly spread over a spacing; a ball that lies on the pool makes it 2 and more.
      {.name = "surface_is_level",
       .sentence = "the pool ends level",
       .measure = "standard deviation of the height of its surface, mean over the last quarter of the run",
       .measured = unevenness,
       .bound = Bound::at_most,
       .limit = 0.75,
       .unit = "h",
       .values = {unevenness}},
  };
}

}  // namespace

Figure fig5c() {
  return {.name = "fig5c",
          .title = "Fig. 5(c): bunny",
          .moments = {0, 80, 100, 128, 240},
          .quantities = {{"parts", "parts of at least 4 particles"},
                         {"parts_and_crumbs", "parts of any size"},
                         {"largest_share", "share of particles in the largest part"}},
          .takes = bunny_takes,
          .measure = measure_bunny,
          .judge = judge_bunny};
}

Figure fig5d() {
  return {.name = "fig5d",
          .title = "Fig. 5(d): balls",
          .moments = {0, 45, 65, 90, 200},
          .quantities = {{"parts", "parts of at least 4 particles"},
                         {"largest_share", "share of particles in the largest part"},
                         {"unevenness", "standard deviation of the surface's height [m]"}},
          .takes = balls_takes,
          .measure = measure_balls,
          .judge = judge_balls};
}

}  // namespace mallow::bench
