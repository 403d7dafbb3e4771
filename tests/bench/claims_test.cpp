// Claims of the paper's figures against motions that lack what they claim.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "figures/figure.h"

namespace mallow::bench {
namespace claims_test {

/// From `first` to `last` in equal steps.
Curve ramp(double first, double last, std::size_t count = 101) {
  Curve curve;
  for (std::size_t i = 0; i < count; ++i)
    curve.push_back(first + (last - first) * static_cast<double>(i) / static_cast<double>(count - 1));
  return curve;
}

Curve joined(Curve first, const Curve& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// Names of the claims that do not hold, in order.
std::vector<std::string> refuted(const Figure& figure, const std::vector<Recording>& recordings) {
  std::vector<std::string> names;
  for (const Claim& claim : figure.judge(recordings))
    if (!holds(claim)) names.push_back(claim.name);
  return names;
}

using Names = std::vector<std::string>;

Recording bar(double tip) {
  return {.spacing = 1, .curves = {{"tip_height", joined(ramp(25, tip), ramp(tip, 25))}}};
}

TEST(fig2_claims, hold_of_bars_that_sag_less_with_the_radius) {
  EXPECT_EQ(refuted(fig2(), {bar(-15), bar(-10), bar(-1)}), Names{});
}

TEST(fig2_claims, fail_of_swapped_or_equal_bars) {
  const Names both = {"wider_regions_are_stiffer", "wider_regions_sag_less_on_average"};
  EXPECT_EQ(refuted(fig2(), {bar(-10), bar(-15), bar(-1)}), both);
  EXPECT_EQ(refuted(fig2(), {bar(-15), bar(-1), bar(-10)}), both);
  EXPECT_EQ(refuted(fig2(), {bar(-10), bar(-10), bar(-10)}), both);
  EXPECT_EQ(refuted(fig2(), {bar(25), bar(25), bar(25)}), both) << "bars that nothing bends";
}

/// Falls, is flattened to `flattest` of its side, ends at `last`; widens to `widest`.
Recording cube(double flattest, double last, double widest) {
  return {.spacing = 1,
          .curves = {{"height",
                      joined(ramp(1, flattest, 50), joined(ramp(flattest, last, 25), ramp(last, last, 75)))},
                     {"spread", joined(ramp(1, 1, 25), ramp(1, widest, 125))}}};
}

std::vector<Recording> cubes() {
  return {cube(0.64, 0.96, 1), cube(0.58, 0.95, 1.03), cube(0.44, 0.75, 1.14), cube(0.31, 0.6, 1.34),
          cube(0.05, 0.1, 3.9)};
}

TEST(fig3_claims, hold_of_cubes_that_flow_more_with_alpha) {
  EXPECT_EQ(refuted(fig3(), cubes()), Names{});
}

TEST(fig3_claims, fail_in_another_order_of_alphas) {
  std::vector<Recording> swapped = cubes();
  std::swap(swapped[2], swapped[3]);
  EXPECT_EQ(refuted(fig3(), swapped),
            (Names{"more_fluid_is_flattened_more", "more_fluid_stays_lower", "more_fluid_spreads_wider"}));
  std::vector<Recording> reversed = cubes();
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_EQ(refuted(fig3(), reversed).size(), 6u) << "all but the toothpaste in the middle";
}

TEST(fig3_claims, fail_where_alpha_does_nothing) {
  const std::vector<Recording> same(5, cube(0.3, 0.6, 1.3));
  EXPECT_EQ(refuted(fig3(), same),
            (Names{"more_fluid_is_flattened_more", "elastic_and_jelly_keep_their_height", "fluid_flows_apart",
                   "more_fluid_spreads_wider", "elastic_and_jelly_do_not_spread"}));
}

TEST(fig3_claims, fail_of_an_elastic_cube_that_keeps_its_dent) {
  std::vector<Recording> dented = cubes();
  dented[0] = cube(0.64, 0.64, 1);
  EXPECT_EQ(refuted(fig3(), dented),
            (Names{"more_fluid_stays_lower", "elastic_and_jelly_keep_their_height"}));
}

TEST(fig3_claims, fail_of_a_toothpaste_that_comes_back) {
  std::vector<Recording> springy = cubes();
  springy[2] = cube(0.44, 0.95, 1.14);
  EXPECT_EQ(refuted(fig3(), springy), Names{"toothpaste_keeps_the_dent"});
}

/// Falls on the floor and rises to `bounce`, dented by `dent`, of which `rest` stays [m].
Recording moai(double bounce, double dent, double rest) {
  return {.spacing = 1.25,
          .curves = {{"bottom", joined(ramp(7, 0.6), ramp(0.6, bounce))},
                     {"distance", joined(ramp(0, dent), ramp(dent, rest))}}};
}

TEST(fig5a_claims, hold_of_a_body_that_bounces_and_comes_back) {
  EXPECT_EQ(refuted(fig5a(), {moai(7, 2.7, 0.5)}), Names{});
}

TEST(fig5a_claims, fail_of_bodies_that_stay_down_melt_or_keep_a_dent) {
  EXPECT_EQ(refuted(fig5a(), {moai(0.6, 2.7, 0.5)}), Names{"bounces"});
  Recording floating = moai(7, 2.7, 0.5);
  floating.curves["bottom"] = ramp(7, 7);
  EXPECT_EQ(refuted(fig5a(), {floating}), Names{"bounces"});
  EXPECT_EQ(refuted(fig5a(), {moai(7, 9, 9)}),
            (Names{"gives_way_little", "comes_back_to_its_shape", "keeps_its_shape"}));
  EXPECT_EQ(refuted(fig5a(), {moai(7, 4, 2)}), Names{"comes_back_to_its_shape"});
}

Recording armadillo(double height, double spread, double distance, double share) {
  return {.spacing = 1,
          .curves = {{"height", ramp(40, height)},
                     {"spread", ramp(7.5, spread)},
                     {"distance", ramp(0, distance)},
                     {"largest_share", ramp(1, share)}}};
}

TEST(fig5b_claims, hold_of_a_body_between_solid_and_fluid) {
  EXPECT_EQ(refuted(fig5b(), {armadillo(6, 10.5, 9, 1), armadillo(0.8, 39, 34, 0.35)}), Names{});
}

TEST(fig5b_claims, fail_of_a_solid_of_a_fluid_and_of_one_that_tips_over) {
  const Recording fluid = armadillo(0.8, 39, 34, 0.35);
  EXPECT_EQ(refuted(fig5b(), {armadillo(39, 7.5, 1, 1), fluid}), (Names{"spreads", "spreads_by_giving_way"}));
  EXPECT_EQ(refuted(fig5b(), {armadillo(15, 12, 0.5, 1), fluid}), Names{"spreads_by_giving_way"});
  EXPECT_EQ(refuted(fig5b(), {fluid, fluid}), (Names{"does_not_collapse", "is_higher_than_the_fluid",
                                                     "is_narrower_than_the_fluid", "stays_in_one_piece"}));
  EXPECT_EQ(refuted(fig5b(), {armadillo(6, 10.5, 9, 0.8), fluid}), Names{"stays_in_one_piece"});
}

/// One part, then `parts` of which the largest has `share`, then `last` in the largest.
Recording bunny(double parts, double share, double last) {
  return {.spacing = 1,
          .curves = {{"parts", joined(ramp(1, parts), ramp(parts, 1))},
                     {"parts_and_crumbs", joined(ramp(1, parts), ramp(parts, 1))},
                     {"largest_share", joined(ramp(1, share), ramp(share, last))}}};
}

TEST(fig5c_claims, hold_of_a_bunny_that_splits_and_merges) {
  EXPECT_EQ(refuted(fig5c(), {bunny(50, 0.8, 1)}), Names{});
  EXPECT_EQ(refuted(fig5c(), {bunny(50, 0.8, 1), bunny(50, 0.8, 1)}), Names{});
}

TEST(fig5c_claims, fail_of_one_that_never_splits_sheds_crumbs_or_stays_split) {
  EXPECT_EQ(refuted(fig5c(), {bunny(1, 1, 1)}), (Names{"splits_into_several_parts", "parts_are_not_crumbs"}));
  EXPECT_EQ(refuted(fig5c(), {bunny(50, 0.95, 1)}), Names{"parts_are_not_crumbs"});
  EXPECT_EQ(refuted(fig5c(), {bunny(50, 0.4, 0.5)}), Names{"merges_on_the_floor"});
}

TEST(fig5c_claims, fail_of_table_1_where_it_hardly_splits) {
  EXPECT_EQ(refuted(fig5c(), {bunny(50, 0.8, 1), bunny(10, 0.95, 0.97)}), Names{"table_1_splits_too"});
}

Recording pool(double first, double last, double share, double unevenness) {
  return {.spacing = 2,
          .curves = {{"parts", ramp(first, last)},
                     {"largest_share", ramp(0.7, share)},
                     {"unevenness", joined(ramp(10, unevenness), ramp(unevenness, unevenness))}}};
}

TEST(fig5d_claims, hold_of_balls_that_merge) {
  EXPECT_EQ(refuted(fig5d(), {pool(5, 1, 1, 0.7)}), Names{});
}

TEST(fig5d_claims, fail_of_balls_that_float_that_pile_up_or_that_were_never_apart) {
  EXPECT_EQ(refuted(fig5d(), {pool(5, 2, 0.92, 0.7)}),
            (Names{"balls_merge_with_the_pool", "all_particles_merge"}));
  EXPECT_EQ(refuted(fig5d(), {pool(5, 1, 1, 4)}), Names{"surface_is_level"});
  EXPECT_EQ(refuted(fig5d(), {pool(1, 1, 1, 0.7)}), Names{"four_balls_and_a_pool"});
}

TEST(claims, a_number_that_is_none_holds_nothing) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(holds(
      {.name = "", .sentence = "", .measure = "", .measured = none, .bound = Bound::at_least, .limit = 0}));
  EXPECT_FALSE(holds(
      {.name = "", .sentence = "", .measure = "", .measured = none, .bound = Bound::at_most, .limit = 0}));
}

}  // namespace claims_test
}  // namespace mallow::bench
