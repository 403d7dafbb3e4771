// A program of its own, because it counts what the whole program allocates.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <ostream>
#include <string>

#include "allocation_counter.h"
#include "mallow/mallow.h"

namespace mallow {
namespace allocation_test {

using test::Allocations;

#define SKIP_IF_NOT_COUNTED()      \
  if (!test::k_counts_allocations) \
  GTEST_SKIP() << "allocations are counted with glibc and without sanitizers only: nothing was checked"

template <class F>
Allocations allocations_of(const F& f) {
  test::start_counting();
  f();
  return test::stop_counting();
}

struct alignas(128) Aligned {
  char bytes[128];
};

TEST(allocation_counter, sees_every_way_to_allocate) {
  SKIP_IF_NOT_COUNTED();
  // Through volatile, or the compiler may take new and delete away together.
  const auto counts = [](const auto& make, const auto& free) {
    void* volatile memory = nullptr;
    const Allocations seen = allocations_of([&] { memory = make(); });
    free(memory);
    return seen.count;
  };
  const auto free_new = [](void* p) { ::operator delete(p); };
  const auto free_aligned = [](void* p) { ::operator delete (p, std::align_val_t{128}); };
  const auto free_malloc = [](void* p) { std::free(p); };
  EXPECT_EQ(counts([] { return ::operator new(40); }, free_new), 1u);
  EXPECT_EQ(counts([] { return ::operator new[](40); }, free_new), 1u);
  EXPECT_EQ(counts([] { return ::operator new(40, std::nothrow); }, free_new), 1u);
  EXPECT_EQ(counts([] { return ::operator new (128, std::align_val_t{128}); }, free_aligned), 1u);
  EXPECT_EQ(counts([] { return ::operator new[](128, std::align_val_t{128}, std::nothrow); }, free_aligned),
            1u);
  EXPECT_EQ(counts([] { return std::malloc(40); }, free_malloc), 1u);
  EXPECT_EQ(counts([] { return std::calloc(4, 10); }, free_malloc), 1u);
  EXPECT_EQ(counts([] { return std::realloc(nullptr, 40); }, free_malloc), 1u);
  EXPECT_EQ(counts([] { return std::aligned_alloc(64, 128); }, free_malloc), 1u);
  EXPECT_EQ(counts([] { return nullptr; }, free_malloc), 0u);
}

/// What bodies do beside what each of them does.
enum class Also { nothing, keeps_volume, yields, painted, heated, all };

struct Setup {
  int threads;
  float alpha;
  float neighbor_slack;
  Also also = Also::nothing;
  bool does(Also what) const { return also == what || also == Also::all; }
  friend void PrintTo(const Setup& setup, std::ostream* out) {
    *out << setup.threads << " threads, alpha " << setup.alpha << ", slack " << setup.neighbor_slack
         << ", also " << static_cast<int>(setup.also);
  }
};

/// Two groups that lie on each other in a box, with a pin, a force and a collider that moves. The box is
/// there because the cell grid grows with what it spans, and a body that slides away spans ever more.
/// Reference shapes are never updated. Contacts are told of on two threads.
Simulation scene(const Setup& setup) {
  Simulation s({.support_radius = 2.1f,
                .update_interval = 7,
                .volume_iterations = setup.does(Also::keeps_volume) ? 2 : 0,
                .neighbor_slack = setup.neighbor_slack,
                .threads = setup.threads});
  const auto cube = [](int side, const Vec3& corner) {
    return sample(Lattice{.count = {side, side, side}, .corner = corner, .jitter = 0.1f});
  };
  Material material{.alpha = setup.alpha, .update_threshold = 1e6f, .viscosity = 0.5f};
  if (setup.does(Also::yields)) {
    material.plastic_yield = 0.3f;
    material.merge_flow = 1e6f;  // they stay two
  }
  if (setup.does(Also::heated)) {
    material.temperature = 300.0f;
    material.conductivity = 1;
    material.heat_transfer = 1;
    material.alpha_by_temperature = Schedule{{280, 0}, {320, setup.alpha}};
    material.viscosity_by_temperature = Schedule{{280, 1}, {320, 0.5f}};
  }
  const MaterialId id = s.add_material(material);
  for (Body body : {cube(9, {0, 0, 0.5f}), cube(7, {1, 1, 10.5f})}) {
    for (const Vec3& x : body.positions) {
      if (!setup.does(Also::painted)) break;
      body.stiffness.push_back(x.y() < 4 ? 1.0f : 0.5f);
      if (!setup.does(Also::heated)) body.alpha.push_back(x.x() < 4 ? 0.0f : setup.alpha);
    }
    body.merges = setup.does(Also::yields);
    s.add_body(body, id);
  }
  s.add_collider({.shape = Plane{}, .friction = 0.3f});
  s.add_collider({.shape = Box{{-2, -2, -2}, {11, 11, 40}, true}, .friction = 0.3f});
  s.add_collider(
      {.shape = Union{{Box{{-4, -4, 0}, {-3, -3, 1}}, Sphere{{11, 4, 0}, 1}}}, .velocity = {0.001f, 0, 0}});
  if (setup.threads > 1) s.report_contacts(0.0);
  s.pin(Aabb{{0, 0, 0}, {1, 1, 2}});
  s.set_force([](const ForceInput& in, VectorSpan a) {
    for (std::size_t i = 0; i < in.positions.size(); ++i) a.x()[i] += -0.001f * in.positions.x()[i];
  });
  return s;
}

class steady_step : public testing::TestWithParam<Setup> {};

TEST_P(steady_step, allocates_nothing) {
  SKIP_IF_NOT_COUNTED();
  Simulation s = scene(GetParam());
  // The bodies fall, meet and come to rest, fluids spread: grid, lists and scratch grow to what that takes.
  for (int k = 0; k < 2000; ++k) s.step();
  for (int k = 0; k < 100; ++k) {
    const std::int64_t number = s.step_count();
    StepReport report;
    const Allocations seen = allocations_of([&] { report = s.step(); });
    ASSERT_EQ(report.updated_references, 0);
    EXPECT_EQ(seen.count, 0u) << "step " << number << ": " << seen.bytes << " bytes, " << seen.largest
                              << " at once at the most";
  }
}

std::string setup_name(const testing::TestParamInfo<Setup>& test) {
  constexpr const char* k_also[] = {"", "_keeps_volume", "_yields", "_painted", "_heated", "_all"};
  const Setup& s = test.param;
  return std::to_string(s.threads) + "_threads_alpha_" + std::to_string(static_cast<int>(10 * s.alpha)) +
         "_tenths" + (s.neighbor_slack > 0 ? "_with_slack" : "") + k_also[static_cast<int>(s.also)];
}

INSTANTIATE_TEST_SUITE_P(, steady_step,
                         testing::Values(Setup{1, 0.5f, 0}, Setup{2, 0.5f, 0}, Setup{2, 0.5f, 0.2f},
                                         Setup{2, 0, 0}, Setup{2, 1, 0}, Setup{2, 1, 0.2f},
                                         Setup{2, 0, 0, Also::keeps_volume},
                                         Setup{2, 0.5f, 0, Also::keeps_volume}, Setup{2, 0, 0, Also::yields},
                                         Setup{2, 0.5f, 0, Also::painted}, Setup{2, 0.5f, 0, Also::heated},
                                         Setup{2, 0.5f, 0, Also::all}, Setup{2, 0.5f, 0.2f, Also::all}),
                         setup_name);

}  // namespace allocation_test
}  // namespace mallow
