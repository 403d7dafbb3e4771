#include "render/renderer.h"

#include <gtest/gtest.h>
#include <png.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>

#include "files/file_fixture.h"
#include "mallow/errors.h"
#include "mallow/files.h"
#include "render/hdr.h"

namespace mallow::render {
namespace renderer_test {

// A ball of 2 n² quads.
Mesh ball(const Vec3& center, float radius, std::uint32_t n, std::uint32_t body) {
  Mesh mesh;
  for (std::uint32_t row = 0; row <= n; ++row) {
    for (std::uint32_t column = 0; column <= 2 * n; ++column) {
      const float polar = std::numbers::pi_v<float> * (1 - static_cast<float>(row) / static_cast<float>(n));
      const float around = std::numbers::pi_v<float> * static_cast<float>(column) / static_cast<float>(n);
      mesh.vertices.push_back(center + radius * Vec3(std::sin(polar) * std::cos(around),
                                                     std::sin(polar) * std::sin(around), std::cos(polar)));
      mesh.material_ids.push_back(body);
      if (row == n || column == 2 * n) continue;
      const std::uint32_t a = row * (2 * n + 1) + column;
      const std::uint32_t above = a + 2 * n + 1;
      mesh.triangles.push_back({a, a + 1, above + 1});
      mesh.triangles.push_back({a, above + 1, above});
    }
  }
  return mesh;
}

RenderConfig small() {
  return {.width = 160, .height = 90, .samples = 2, .eye = {}, .target = {}};
}

const std::vector<Appearance> k_palette{{{0.7f, 0.08f, 0.06f}}, {{0.06f, 0.25f, 0.6f}}};
const std::vector<Appearance> k_clay{{{0.7f, 0.08f, 0.06f}, Finish::clay}};
const std::vector<Collider> k_floor{{.shape = Plane{}}};
const Aabb k_bounds{{-3, -3, 0}, {3, 3, 6}};

std::array<int, 3> pixel(const Image& image, int x, int y) {
  const auto* p = &image.rgb[3 * static_cast<std::size_t>(y * image.width + x)];
  return {p[0], p[1], p[2]};
}

// Where the camera sees a point: x to the right, y up, the picture being [-1, 1] in both.
Eigen::Vector2f project(const Camera& camera, const RenderConfig& config, const Vec3& point) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  const Vec3 right = forward.cross(camera.up).normalized();
  const Vec3 offset = point - camera.eye;
  const float slope = std::tan(camera.field_of_view * std::numbers::pi_v<float> / 360) * offset.dot(forward);
  const float aspect = static_cast<float>(config.width) / static_cast<float>(config.height);
  return {offset.dot(right) / (slope * aspect), offset.dot(right.cross(forward)) / slope};
}

TEST(renderer, same_bits_for_any_thread_count) {
  Mesh mesh = ball({0, 0, 3}, 3, 40, 0);
  for (std::size_t v = 0; v < mesh.vertices.size(); v += 5) mesh.material_ids[v] = 1;  // seams everywhere
  const std::vector<Appearance> palette{k_palette[0], k_clay[0]};
  const std::vector<Collider> colliders{
      {.shape = Plane{}}, {.shape = Sphere{{4, 2, 1}, 1.5f}}, {.shape = Box{{-6, -6, 0}, {6, 6, 7}, true}}};
  const Camera camera = frame_camera(k_bounds, small());
  const Image one = Renderer(small(), 1).render(mesh, palette, colliders, camera);
  for (const int threads : {2, 3}) {
    Renderer renderer(small(), threads);
    EXPECT_EQ(renderer.render(mesh, palette, colliders, camera).rgb, one.rgb) << threads << " threads";
    EXPECT_EQ(renderer.render(mesh, palette, colliders, camera).rgb, one.rgb) << "second frame";
  }
}

TEST(renderer, a_picture_keeps_nothing_of_the_one_before) {
  const Camera camera = frame_camera(k_bounds, small());
  Renderer renderer(small(), 2);
  renderer.render(ball({-2, 1, 5}, 1, 40, 0), k_palette, k_floor, camera);
  const Mesh mesh = ball({1, 0, 1.5f}, 1.5f, 40, 0);
  EXPECT_EQ(renderer.render(mesh, k_palette, k_floor, camera).rgb,
            Renderer(small(), 2).render(mesh, k_palette, k_floor, camera).rgb);
  EXPECT_EQ(renderer.render({}, {}, k_floor, camera).rgb,
            Renderer(small(), 2).render({}, {}, k_floor, camera).rgb);
}

TEST(renderer, one_of_a_thousand_bodies_has_its_own_appearance) {
  const Camera camera = frame_camera(k_bounds, small());
  Renderer renderer(small(), 1);
  std::vector<Appearance> palette(1000, k_palette[0]);
  const std::vector<Vec3> center{{0, 0, 3}};
  for (const std::uint32_t body : std::array<std::uint32_t, 2>{256, 999}) {
    palette[body] = k_palette[1];
    const Image mesh = renderer.render(ball(center[0], 3, 40, body), palette, k_floor, camera);
    const Image points = renderer.render_points(center, 3, std::array{body}, palette, k_floor, camera);
    for (const Image* image : {&mesh, &points}) {
      const auto color = pixel(*image, 80, 50);
      EXPECT_GT(color[2], color[0] + 60);
    }
  }
  for (const std::uint32_t body : std::array<std::uint32_t, 2>{1000, 0xffffffff})
    EXPECT_THROW(renderer.render_points(center, 3, std::array{body}, palette, k_floor, camera), ConfigError);
}

TEST(renderer, bodies_have_the_hue_of_their_appearance) {
  const Camera camera = frame_camera(k_bounds, small());
  Renderer renderer(small(), 1);
  const std::vector<Vec3> center{{0, 0, 3}};
  for (const std::uint32_t body : std::array<std::uint32_t, 2>{0, 1}) {
    const std::size_t strong = body == 0 ? 0 : 2;
    const Image mesh = renderer.render(ball(center[0], 3, 40, body), k_palette, k_floor, camera);
    const Image points = renderer.render_points(center, 3, std::array{body}, k_palette, k_floor, camera);
    for (const Image* image : {&mesh, &points}) {
      const auto color = pixel(*image, 80, 50);
      EXPECT_GT(color[strong], 110);
      EXPECT_GT(color[strong], color[2 - strong] + 60);
      EXPECT_GE(color[strong], color[1] + 40);
    }
  }
}

double mean_difference(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(a.rgb[i] - b.rgb[i]);
  return sum / static_cast<double>(a.rgb.size());
}

TEST(renderer, points_and_a_fine_mesh_of_one_ball_look_the_same) {
  const Camera camera = frame_camera(k_bounds, small());
  Renderer renderer(small(), 1);
  for (const std::vector<Appearance>& palette : {k_palette, k_clay}) {
    const Image mesh = renderer.render(ball({0, 0, 3}, 3, 200, 0), palette, k_floor, camera);
    const Image points =
        renderer.render_points(std::vector<Vec3>{{0, 0, 3}}, 3, {}, palette, k_floor, camera);
    EXPECT_LT(mean_difference(mesh, points), 0.3);
  }
}

// A red ball: what it mirrors of the white light shows in green.
TEST(renderer, jelly_has_a_highlight_and_clay_has_none) {
  const Camera camera = frame_camera(k_bounds, small());
  Renderer renderer(small(), 1);
  const auto brightest_green = [&](std::span<const Appearance> palette) {
    const Image image = renderer.render(ball({0, 0, 3}, 3, 80, 0), palette, k_floor, camera);
    int brightest = 0;
    for (int y = 15; y < 60; ++y) {
      for (int x = 65; x < 95; ++x) brightest = std::max(brightest, pixel(image, x, y)[1]);
    }
    return brightest;
  };
  EXPECT_GT(brightest_green(k_palette), 140);
  EXPECT_LT(brightest_green(k_clay), 105);
}

TEST(renderer, light_shines_through_jelly_and_not_through_clay) {
  // A thin leaf below the key light, seen from underneath; the lid right above takes that light away.
  const Mesh leaf{.vertices = {{-4, -4, 3}, {4, -4, 3}, {4, 4, 3}, {-4, 4, 3}},
                  .triangles = {{0, 1, 2}, {0, 2, 3}},
                  .normals = {},
                  .velocities = {},
                  .material_ids = {}};
  const std::vector<Collider> lid{{.shape = Box{{-4, -4, 3.5f}, {4, 4, 4}}}};
  const Camera camera{.eye = {6, -4, -8}, .target = {0, 0, 3}};
  Renderer renderer(small(), 1);
  const auto red = [&](std::span<const Appearance> palette, std::span<const Collider> colliders) {
    return pixel(renderer.render(leaf, palette, colliders, camera), 80, 45)[0];
  };
  EXPECT_GT(red(k_palette, {}), red(k_palette, lid) + 30);
  EXPECT_EQ(red(k_clay, {}), red(k_clay, lid));
  EXPECT_LT(red(k_clay, {}), red(k_palette, {}) - 30);
}

// A box of six faces, each with corners of its own.
Mesh slab(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool far : {false, true}) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const auto& [along_u, along_v] :
           {std::array{false, false}, {true, false}, {true, true}, {false, true}}) {
        Vec3 corner = far ? high : low;
        corner[u] = along_u ? high[u] : low[u];
        corner[v] = along_v ? high[v] : low[v];
        mesh.vertices.push_back(corner);
        mesh.normals.push_back(Vec3::Unit(axis) * (far ? 1.0f : -1.0f));
        mesh.material_ids.push_back(0);
      }
      for (const auto& [b, c] : {std::array{1u, 2u}, {2u, 3u}})
        mesh.triangles.push_back({first, first + (far ? b : c), first + (far ? c : b)});
    }
  }
  return mesh;
}

// Surfaces dip a little into what they rest on, by less than a particle: that must not be seen.
TEST(renderer, a_clear_body_looks_the_same_a_little_above_and_a_little_below_its_ground) {
  const Camera camera = frame_camera(k_bounds, small());
  Renderer renderer(small(), 1);
  const std::vector<Collider> table{{.shape = Box{{-5, -5, -1}, {5, 5, 0}}}};
  for (const Finish finish : {Finish::syrup, Finish::jelly}) {
    const std::vector<Appearance> palette{{{0.9f, 0.5f, 0.1f}, finish}};
    for (const std::vector<Collider>& ground : {k_floor, table}) {
      const auto picture = [&](float underside) {
        return renderer.render(slab({-3, -3, underside}, {3, 3, 1}), palette, ground, camera);
      };
      const Image above = picture(0.03f);
      for (const float underside : {0.001f, 0.0f, -0.001f, -0.03f})
        EXPECT_LT(mean_difference(picture(underside), above), 1.0) << underside;
    }
  }
}

TEST(renderer, a_ball_within_a_clear_body_is_seen_from_its_lit_side) {
  const Camera camera{.eye = {0, -12, 6}, .target = {0, 0, 2}};
  const std::vector<Appearance> palette{{{1, 1, 1}, Finish::syrup}, {{0.06f, 0.25f, 0.6f}, Finish::clay}};
  Mesh mesh = slab({-3, -3, 0}, {3, 3, 4});
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const Mesh inner = ball({0, 0, 2}, 1.4f, 40, 1);
  for (const Vec3& x : inner.vertices) {
    mesh.vertices.push_back(x);
    mesh.normals.push_back((x - Vec3(0, 0, 2)).normalized());
    mesh.material_ids.push_back(1);
  }
  for (const auto& [a, b, c] : inner.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  const Image image = Renderer(small(), 1).render(mesh, palette, k_floor, camera);
  const auto top = pixel(image, 80, 40), bottom = pixel(image, 80, 57);
  EXPECT_GT(top[2], top[0]) << "blue";
  EXPECT_GT(top[2], bottom[2] + 15) << top[2] << " over " << bottom[2];
}

TEST(renderer, a_triangle_between_bodies_has_the_finish_of_the_nearer_corner) {
  const Camera camera{.eye = {0, -0.5f, 12}, .target = {0, 0, 0}};
  const Mesh quad{.vertices = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}},
                  .triangles = {{0, 1, 2}, {0, 2, 3}},
                  .normals = {},
                  .velocities = {},
                  .material_ids = {0, 1, 1, 0}};
  const Vec3 color = k_clay[0].color;
  Renderer renderer(small(), 1);
  const auto picture = [&](Finish left, Finish right) {
    return renderer.render(quad, std::vector<Appearance>{{color, left}, {color, right}}, {}, camera);
  };
  const Image both = picture(Finish::jelly, Finish::clay);
  const Image jelly = picture(Finish::jelly, Finish::jelly);
  const Image clay = picture(Finish::clay, Finish::clay);
  for (const float x : {-3.0f, -0.7f, 0.7f, 3.0f}) {
    const Eigen::Vector2f at = project(camera, small(), {x, 0.5f, 0});
    const int column = static_cast<int>(80 * (1 + at.x()));
    const int row = static_cast<int>(45 * (1 - at.y()));
    EXPECT_NE(pixel(jelly, column, row), pixel(clay, column, row)) << x;
    EXPECT_EQ(pixel(both, column, row), pixel(x < 0 ? jelly : clay, column, row)) << x;
  }
}

TEST(renderer, no_frame_means_an_empty_bright_studio) {
  const Camera camera = frame_camera(k_bounds, small());
  Renderer renderer(small(), 1);
  for (const std::vector<Collider>& colliders : {k_floor, std::vector<Collider>{}}) {
    const Image mesh = renderer.render({}, {}, colliders, camera);
    ASSERT_EQ(mesh.rgb.size(), 3u * 160 * 90);
    EXPECT_GT(*std::min_element(mesh.rgb.begin(), mesh.rgb.end()), 185);
    EXPECT_LT(*std::max_element(mesh.rgb.begin(), mesh.rgb.end()), 225) << "bodies cannot be brighter";
    EXPECT_LT(*std::max_element(mesh.rgb.begin(), mesh.rgb.end()), 255) << "burnt out";
    EXPECT_EQ(renderer.render_points({}, 1, {}, {}, colliders, camera).rgb, mesh.rgb);
  }
}

TEST(renderer, a_body_shades_the_floor_softly) {
  const Camera camera = frame_camera(k_bounds, small());
  Renderer renderer(small(), 1);
  const Image bare = renderer.render({}, {}, k_floor, camera);
  const Image with_ball = renderer.render(ball({0, 0, 1.5f}, 1.5f, 40, 0), k_palette, k_floor, camera);
  int shaded = 0;
  int dimmed = 0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 160; ++x) {
      const auto [r, g, b] = pixel(with_ball, x, y);
      if (r > b + 30) continue;  // the ball, or its glow
      const int loss = pixel(bare, x, y)[1] - g;
      shaded += loss > 40;
      dimmed += loss > 10 && loss <= 40;
    }
  }
  EXPECT_GT(shaded, 60);
  EXPECT_GT(dimmed, 60);
}

TEST(renderer, a_flat_lit_wall_has_no_acne) {
  const Camera camera = frame_camera(k_bounds, small());
  Mesh quad{.vertices = {{-4, -4, 0.5f}, {4, -4, 0.5f}, {4, 4, 0.5f}, {-4, 4, 0.5f}},
            .triangles = {{0, 1, 2}, {0, 2, 3}},
            .normals = {},
            .velocities = {},
            .material_ids = {}};
  const Image image = Renderer(small(), 1).render(quad, k_palette, {}, camera);
  int lowest = 255, highest = 0;
  for (int k = -6; k <= 6; ++k) {
    const Eigen::Vector2f at = project(camera, small(), {0.25f * static_cast<float>(k), 0, 0.5f});
    const int red = pixel(image, static_cast<int>(80 * (1 + at.x())), static_cast<int>(45 * (1 - at.y())))[0];
    lowest = std::min(lowest, red);
    highest = std::max(highest, red);
  }
  EXPECT_GT(lowest, 150);
  EXPECT_LE(highest - lowest, 12);
}

TEST(renderer, looks_into_kept_in_shapes_through_their_front) {
  const Camera camera = frame_camera(k_bounds, small());
  Renderer renderer(small(), 1);
  for (const Collider& shell :
       {Collider{.shape = Box{{-4, -4, 0}, {4, 4, 6}, true}}, Collider{.shape = Sphere{{0, 0, 3}, 5, true}},
        Collider{.shape = Capsule{{0, 0, 2}, {0, 0, 4}, 5, true}},
        Collider{.shape = Cylinder{{0, 0, 0}, {0, 0, 6}, 5, true}},
        Collider{.shape = Cone{{0, 0, 0}, {0, 0, 6}, 4, 6, true}}}) {
    const Image image = renderer.render(ball({0, 0, 3}, 2, 40, 0), k_palette, {&shell, 1}, camera);
    const auto color = pixel(image, 80, 50);
    EXPECT_GT(color[0], color[2] + 45);
  }
}

TEST(renderer, leaves_the_threads_of_others_alone) {
  const auto most_threads = [] {
    return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  };
  const std::size_t before = most_threads();
  Renderer renderer(small(), 1);
  renderer.render(ball({0, 0, 3}, 3, 8, 0), k_palette, {}, frame_camera(k_bounds, small()));
  EXPECT_EQ(most_threads(), before);
}

TEST(renderer, blurs_what_moves_along_its_way_alike_for_any_thread_count) {
  const Camera camera = frame_camera(k_bounds, small());
  Mesh mesh = ball({0, 0, 3}, 1.5f, 40, 0);
  Renderer still(small(), 1);
  const Image sharp = still.render(mesh, k_clay, k_floor, camera);
  mesh.velocities.assign(mesh.vertices.size(), Vec3(0, 2, 0));
  EXPECT_EQ(still.render(mesh, k_clay, k_floor, camera).rgb, sharp.rgb) << "without an exposure";
  std::vector<Image> images;
  for (const int threads : {1, 3}) {
    Renderer renderer(small(), threads);
    renderer.set_exposure(1);
    images.push_back(renderer.render(mesh, k_clay, k_floor, camera));
  }
  EXPECT_EQ(images[0].rgb, images[1].rgb);
  // Half a way of 2 m to either side: what the ball covers half of the time is half red.
  const auto redness = [&](const Image& image, const Vec3& point) {
    const Eigen::Vector2f at = project(camera, small(), point);
    const auto color = pixel(image, static_cast<int>(80 * (1 + at.x())), static_cast<int>(45 * (1 - at.y())));
    return color[0] - color[2];
  };
  const int inside = redness(sharp, {0, 0, 3});
  EXPECT_NEAR(redness(images[0], {0, 0, 3}), inside, 25);
  for (const float side : {-1.0f, 1.0f}) {
    const int half = redness(images[0], {0, 1.5f * side, 3});
    EXPECT_GT(half, inside / 5);
    EXPECT_LT(half, 4 * inside / 5);
    EXPECT_LT(redness(images[0], {0, 2.8f * side, 3}), inside / 10);
  }
}

TEST(renderer, refuses_what_it_cannot_draw) {
  EXPECT_THROW(Renderer({.width = 8, .height = 90, .samples = 300, .eye = {}, .target = {}}, 1), ConfigError);
  Renderer renderer(small(), 1);
  const Camera camera = frame_camera(k_bounds, small());
  EXPECT_THROW(renderer.render(ball({0, 0, 3}, 3, 8, 2), k_palette, {}, camera), ConfigError);
  EXPECT_THROW(renderer.render_points(std::vector<Vec3>{{0, 0, 0}}, 0, {}, k_palette, {}, camera),
               ConfigError);
  EXPECT_THROW(renderer.render({}, {}, {}, {.eye = {1, 1, 1}, .target = {1, 1, 1}}), ConfigError);
}

TEST(camera, has_all_corners_in_view_with_a_margin_and_fills_the_picture) {
  const std::array<Aabb, 4> boxes{k_bounds, Aabb{{-1, -1, 0}, {1, 1, 40}}, Aabb{{-30, -2, 0}, {30, 2, 1}},
                                  Aabb{{100, 100, 7}, {110, 104, 12}}};
  for (const Aabb& box : boxes) {
    for (RenderConfig config :
         {RenderConfig{}, RenderConfig{.width = 300, .height = 600, .eye = {}, .target = {}},
          RenderConfig{.eye = {}, .target = Vec3((box.min + box.max) / 2)}}) {
      for (const float angle : {20.0f, 35.0f, 60.0f}) {
        config.field_of_view = angle;
        const Camera camera = frame_camera(box, config);
        float reach = 0;
        for (int corner = 0; corner < 8; ++corner) {
          const Vec3 point(corner & 1 ? box.max.x() : box.min.x(), corner & 2 ? box.max.y() : box.min.y(),
                           corner & 4 ? box.max.z() : box.min.z());
          EXPECT_GT((point - camera.eye).dot(camera.target - camera.eye), 0);
          reach = std::max(reach, project(camera, config, point).cwiseAbs().maxCoeff());
        }
        EXPECT_LT(reach, 0.95f);
        EXPECT_GT(reach, 0.55f);
      }
    }
  }
}

TEST(camera, survives_bounds_without_size_and_keeps_what_the_config_gives) {
  const Camera point = frame_camera({{1, 2, 3}, {1, 2, 3}}, {});
  EXPECT_GT((point.eye - point.target).norm(), 0);
  EXPECT_TRUE(point.eye.allFinite());
  const Camera given = frame_camera(k_bounds, {.eye = Vec3(9, 8, 7), .target = Vec3(1, 2, 3)});
  EXPECT_EQ(given.eye, Vec3(9, 8, 7));
  EXPECT_EQ(given.target, Vec3(1, 2, 3));
}

TEST(camera, looks_at_ramps_from_their_free_side) {
  for (const Vec3& normal : {Vec3(-0.5f, 0, 1), Vec3(0.5f, 0, 1), Vec3(0, 1, 0.2f), Vec3(-1, -1, 0.5f)}) {
    const Collider ramp{.shape = Plane{normal, 0}};
    const Camera camera = frame_camera(k_bounds, {}, {&ramp, 1});
    EXPECT_GT(normal.dot(camera.eye - camera.target), 0) << normal.transpose();
  }
}

const std::string k_head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";

// A Radiance file of a size, of which pixel(x, y) gives the four bytes.
template <class Pixel>
std::string hdr_file(int width, int height, const Pixel& pixel) {
  std::string file = k_head + "-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const int byte : pixel(x, y)) file.push_back(static_cast<char>(byte));
  return file;
}

struct HdrFile {
  // Tests run beside each other, each in a process of its own.
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("mallow_render_test_" + std::to_string(getpid()) + ".hdr");
  explicit HdrFile(const std::string& bytes) { write_whole(path, std::string_view(bytes)); }
  ~HdrFile() { std::filesystem::remove(path); }
};

TEST(environment, lights_by_a_picture_whose_sun_casts_the_shadow) {
  // Grey all around, a sun at 45 degrees above +x or -x.
  const Camera camera{.eye = {0, -14, 5}, .target = {0, 0, 1}};
  RenderConfig config = small();
  const auto darkest_column = [&](int sun) {
    const HdrFile file(hdr_file(64, 32, [&](int x, int y) {
      return std::array<int, 4>{128, 128, 128, y == 8 && x == sun ? 140 : 128};
    }));
    config.environment = file.path;
    Renderer renderer(config, 1);
    const Image bare = renderer.render({}, {}, k_floor, camera);
    const Image image = renderer.render(ball({0, 0, 2}, 1, 40, 0), k_clay, k_floor, camera);
    EXPECT_LT(*std::max_element(bare.rgb.begin(), bare.rgb.end()), 255) << "burnt out";
    int darkest = 0, most = 0;
    for (int x = 0; x < 160; ++x) {
      int loss = 0;
      for (int y = 45; y < 90; ++y) loss += std::max(0, pixel(bare, x, y)[1] - pixel(image, x, y)[1]);
      if (loss > most) most = loss, darkest = x;
    }
    return darkest;
  };
  EXPECT_LT(darkest_column(0), 75) << "a sun on the right";
  EXPECT_GT(darkest_column(32), 85) << "a sun on the left";
}

TEST(environment, refuses_what_is_no_whole_picture) {
  const std::string good = hdr_file(8, 4, [](int, int) { return std::array<int, 4>{1, 2, 3, 128}; });
  EXPECT_EQ(read_hdr(HdrFile(good).path).radiance.size(), 32u);
  for (const std::string& bad :
       {std::string(), std::string("PNG"), std::string("#?RADIANCE\n"), good.substr(0, 20),
        k_head + "-Y 16000 +X 16000\n", k_head + "-Y -4 +X 8\n", k_head + "-Y 2000000000 +X 2000000000\n"})
    EXPECT_THROW(read_hdr(HdrFile(bad).path), IoError) << bad.substr(0, 60);
  EXPECT_THROW(read_hdr("/nowhere/at/all.hdr"), IoError);
  EXPECT_THROW(read_hdr(std::filesystem::temp_directory_path()), IoError);
  // Cut anywhere, it is refused; changed anywhere, it is read or refused, and every value is a number.
  std::string runs = k_head + "-Y 4 +X 8\n";
  for (int row = 0; row < 4; ++row)
    runs += std::string("\2\2\0\x8\x88\x40\x88\x40\4abcd\x84\x50\x88\x80", 17);
  EXPECT_EQ(read_hdr(HdrFile(runs).path).radiance.size(), 32u);
  for (const std::string& whole : {good, runs})
    for (std::size_t i = 0; i < whole.size(); ++i) {
      EXPECT_THROW(read_hdr(HdrFile(whole.substr(0, i)).path), IoError) << i;
      for (const char other : {'\xff', '\0'}) try {
          const std::string bytes = whole.substr(0, i) + other + whole.substr(i + 1);
          for (const Vec3& pixel : read_hdr(HdrFile(bytes).path).radiance) EXPECT_TRUE(pixel.allFinite());
        } catch (const IoError&) {
        }
    }
}

TEST(environment, lights_as_well_where_it_is_as_bright_as_numbers_go) {
  const HdrFile file(hdr_file(8, 4, [](int, int) { return std::array<int, 4>{255, 255, 255, 255}; }));
  RenderConfig config = small();
  config.environment = file.path;
  const Image image = Renderer(config, 1).render({}, {}, k_floor, {.eye = {0, -14, 5}, .target = {0, 0, 1}});
  EXPECT_GT(pixel(image, 80, 80)[1], 150);
}

TEST(png, reads_back_equal) {
  Image image{37, 19, {}};
  for (std::size_t i = 0; i < 3u * 37 * 19; ++i) image.rgb.push_back(static_cast<std::uint8_t>(i * i / 7));
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "image.png";
  write_png(file, image);

  png_image read{};
  read.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&read, file.c_str()), 0) << read.message;
  EXPECT_EQ(read.width, 37u);
  EXPECT_EQ(read.height, 19u);
  read.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(read));
  ASSERT_NE(png_image_finish_read(&read, nullptr, bytes.data(), 0, nullptr), 0) << read.message;
  EXPECT_EQ(bytes, image.rgb);
}

TEST(png, a_folder_that_is_not_there_is_an_io_error) {
  EXPECT_THROW(write_png("/nowhere/at/all/frame.png", {1, 1, {1, 2, 3}}), IoError);
}

}  // namespace renderer_test
}  // namespace mallow::render
