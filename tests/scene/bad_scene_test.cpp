#include <ctime>

#include "files/text_reader.h"
#include "scene/scene_fixture.h"

namespace mallow {
namespace bad_scene_test {

using bad_scene = SceneFixture;

/// A scene of the minimal sections, each of which a case can replace.
struct Parts {
  std::string solver = "support_radius = 2.0";
  std::string material = "name = \"jelly\"";
  std::string body = "material = \"jelly\"";
  std::string source = "box = { count = [2, 2, 2], spacing = 1.0 }";
  std::string rest{};

  /// Line 2: solver, 4: material, 6: body, 7: source, 8: rest.
  std::string text() const {
    return "[solver]\n" + solver + "\n[[material]]\n" + material + "\n[[body]]\n" + body + "\n" + source +
           "\n" + rest + "\n";
  }
};

struct Case {
  Parts scene;
  std::string problem;
};

const Case k_cases[] = {
    // Keys.
    {{.solver = "suport_radius = 2.0\nsupport_radius = 2.0"},
     "scene.toml:2:1: solver: unknown key 'suport_radius'; did you mean 'support_radius'?"},
    {{.solver = "support_radius = 2.0\nfoo = 1"},
     "scene.toml:3:1: solver: unknown key 'foo'; known are time_step, time_step_factor, support_radius, "
     "gravity, "
     "update_period, update_interval, formulation, acoustic_limit, contact, contact_offset, "
     "wall_pressure, volume_iterations, volume_tolerance, sleep_speed, sleep_time, air_temperature, "
     "rotation_iterations, "
     "neighbor_slack, arithmetic, instruction_level and memory_limit"},
    {{.solver = "support_radius = 2.0\nupdate_interval = 10\nupdate_period = 1"},
     "scene.toml:3:19: solver.update_interval: is not allowed beside update_period: give one of the two"},
    {{.solver = "support_radius = 2.0\ntime_step_factor = 5"},
     "scene.toml:3:20: solver.time_step_factor: 5 is not allowed: a number in [0.01, 4]"},
    {{.rest = "[colider]"}, "scene.toml:8:2: unknown key 'colider'; did you mean 'collider'?"},
    {{.rest = "[[bodies]]\nmaterial = \"jelly\""},
     "scene.toml:8:3: unknown key 'bodies'; did you mean 'body'?"},
    {{.rest = "[[colliders]]\nplane = {}"},
     "scene.toml:8:3: unknown key 'colliders'; did you mean 'collider'?"},
    {{.material = "name = \"jelly\"\nmodulus = 1e4"},
     "scene.toml:5:1: material[0]: unknown key 'modulus'; did you mean 'youngs_modulus'?"},
    {{.source = "bax = { count = [2, 2, 2], spacing = 1.0 }\nbox = { count = [2, 2, 2], spacing = 1.0 }"},
     "scene.toml:7:1: body[0]: unknown key 'bax'; did you mean 'box'?"},
    {{.source = "box = { count = [2, 2, 2], spacing = 1.0, cornr = [0, 0, 0] }"},
     "scene.toml:7:43: body[0].box: unknown key 'cornr'; did you mean 'corner'?"},
    {{.source = "box = { spacing = 1.0 }"},
     "scene.toml:7:7: body[0].box.count: is missing: 3 whole numbers in [1, 100000000]"},
    // Types.
    {{.solver = "support_radius = \"wide\""},
     "scene.toml:2:18: solver.support_radius: \"wide\" (a string) is not allowed: a number > 0"},
    {{.solver = "support_radius = 2.0\nupdate_interval = 10.0"},
     "scene.toml:3:19: solver.update_interval: 10.0 is not allowed: a whole number in [1, 2147483647]"},
    {{.solver = "support_radius = 2.0\nacoustic_limit = 1"},
     "scene.toml:3:18: solver.acoustic_limit: 1 is not allowed: true or false"},
    {{.solver = "support_radius = 2.0\ngravity = [0, -1]"},
     "scene.toml:3:11: solver.gravity: an array of 2 is not allowed: 3 finite numbers [x, y, z]"},
    {{.solver = "support_radius = 2.0\nformulation = \"print\""},
     "scene.toml:3:15: solver.formulation: \"print\" (a string) is not allowed: \"conservative\" or "
     "\"printed\""},
    {{.rest = "[surface]\nkind = \"balls\""},
     "scene.toml:9:8: surface.kind: \"balls\" (a string) is not allowed: \"blended\", \"anisotropic\" or "
     "\"spheres\""},
    {{.material = "name = 3\nalpha = 0.5", .body = "material = \"jelly\""},
     "scene.toml:4:8: material[0].name: 3 is not allowed: a string"},
    {{.material = "name = \"jelly\"\nalpha = 2024-01-01"},
     "scene.toml:5:9: material[0].alpha: a date or time is not allowed: a number in [0, 1], or [[time, "
     "number], ...] "
     "with times that increase and numbers in [0, 1]"},
    {{.source = "box = 3"}, "scene.toml:7:7: body[0].box: 3 is not allowed: a table"},
    {{.rest = "[collider]\nplane = {}"},
     "scene.toml:8:1: collider: a table is not allowed: a list of tables, each under [[collider]]"},
    // Ranges.
    {{.solver = "support_radius = 0"},
     "scene.toml:2:18: solver.support_radius: 0 is not allowed: a number > 0"},
    {{.solver = "support_radius = nan"},
     "scene.toml:2:18: solver.support_radius: nan is not allowed: a number > 0"},
    {{.solver = "support_radius = inf"},
     "scene.toml:2:18: solver.support_radius: inf is not allowed: a number > 0"},
    {{.solver = "support_radius = 1e39"},
     "scene.toml:2:18: solver.support_radius: 1e+39 is not allowed: a number of single precision, at most "
     "3.4028235e+38"},
    {{.solver = "support_radius = 1e-60"},
     "scene.toml:2:18: solver.support_radius: 1e-60 is not allowed: a number of single precision, at least "
     "1e-45"},
    {{.solver = "support_radius = 2.0\ngravity = [0, 0, -inf]"},
     "scene.toml:3:18: solver.gravity[2]: -inf is not allowed: a finite number"},
    {{.solver = "support_radius = 2.0\nupdate_interval = 3000000000"},
     "scene.toml:3:19: solver.update_interval: 3000000000 is not allowed: a whole number in [1, 2147483647]"},
    {{.material = "name = \"jelly\"\nalpha = 1.5"},
     "scene.toml:5:9: material[0].alpha: 1.5 is not allowed: a number in [0, 1]"},
    {{.material = "name = \"jelly\"\nalpha = [[0.0, 0.5], [1.0, -0.25]]"},
     "scene.toml:5:28: material[0].alpha[1][1]: -0.25 is not allowed: a number in [0, 1]"},
    {{.material = "name = \"jelly\"\nalpha = [[1.0, 0.5], [1.0, 0.25]]"},
     "scene.toml:5:22: material[0].alpha[1]: time 1.0 is not allowed: a time after 1.0, that of the key "
     "before"},
    {{.material = "name = \"jelly\"\nalpha = [[1.0, 0.5], 0.5]"},
     "scene.toml:5:22: material[0].alpha[1]: 0.5 is not allowed: two numbers [time, number]"},
    {{.material = "name = \"jelly\"\nalpha = []"},
     "scene.toml:5:9: material[0].alpha: an array of 0 is not allowed: a number in [0, 1], or [[time, "
     "number], ...] "
     "with times that increase and numbers in [0, 1]"},
    {{.solver = "support_radius = 2.0\nrotation_iterations = 9"},
     "scene.toml:3:23: solver.rotation_iterations: 9 is not allowed: a whole number in [0, 8]"},
    {{.solver = "support_radius = 2.0\nneighbor_slack = 1.5"},
     "scene.toml:3:18: solver.neighbor_slack: 1.5 is not allowed: a number in [0, 1]"},
    {{.solver = "support_radius = 2.0\ninstruction_level = \"avx\""},
     "scene.toml:3:21: solver.instruction_level: \"avx\" (a string) is not allowed: \"" +
         std::string(name(InstructionLevel::baseline)) + "\", \"x86-64-v3\" or \"x86-64-v4\""},
    {{.material = "name = \"jelly\"\nregion_stride = 0"},
     "scene.toml:5:17: material[0].region_stride: 0 is not allowed: a whole number in [1, 2147483647]"},
    {{.material = "name = \"jelly\"\ncolor = [0, 0, 1.5]"},
     "scene.toml:5:16: material[0].color[2]: 1.5 is not allowed: a number in [0, 1]"},
    {{.material = "name = \"jelly\"\nfinish = \"glass\""},
     "scene.toml:5:10: material[0].finish: \"glass\" (a string) is not allowed: \"jelly\", \"clay\", "
     "\"cream\", \"gloss\" or "
     "\"syrup\""},
    {{.rest = "[surface]\nvoxels = 4"},
     "scene.toml:9:10: surface.voxels: 4 is not allowed: a whole number in [8, 1024]"},
    {{.rest = "[run]\nframes = -1"},
     "scene.toml:9:10: run.frames: -1 is not allowed: a whole number in [0, 2147483647]"},
    // Bodies.
    {{.source = ""},
     "scene.toml:5:1: body[0]: has no shape: exactly one of box, sphere, mesh, points, implicit is needed"},
    {{.source = "box = { count = [2, 2, 2], spacing = 1.0 }\nimplicit = \"moai\""},
     "scene.toml:8:1: body[0].implicit: is not allowed beside box: exactly one of box, sphere, mesh, points, "
     "implicit"},
    {{.source = "box = { count = [2, 0, 2], spacing = 1.0 }"},
     "scene.toml:7:21: body[0].box.count[1]: 0 is not allowed: a whole number in [1, 100000000]"},
    {{.source = "box = { count = [1000, 1000, 1000], spacing = 1.0 }"},
     "scene.toml:7:17: body[0].box.count: 1e+09 particles is not allowed: at most 100000000"},
    {{.source = "sphere = { radius = 1.0 }"},
     "scene.toml:7:10: body[0].sphere: has neither spacing nor count: exactly one of the two is needed"},
    {{.source = "sphere = { radius = 1.0, spacing = 0.5, count = 9 }"},
     "scene.toml:7:49: body[0].sphere.count: is not allowed beside spacing: exactly one of the two"},
    {{.source = "sphere = { radius = 1000.0, spacing = 0.5 }"},
     "scene.toml:7:39: body[0].sphere.spacing: 0.5, for about 3.35103e+10 particles, is not allowed: at "
     "most "
     "100000000"},
    {{.source = "sphere = { radius = 1.0, count = 9, jitter = 0.75 }"},
     "scene.toml:7:46: body[0].sphere.jitter: 0.75 is not allowed: a number in [0, 0.45]"},
    {{.source = "mesh = { file = \"none.off\", count = 9 }"},
     "scene.toml:7:17: body[0].mesh.file: \"none.off\" is not allowed: there is no file none.off"},
    {{.source = "points = { file = \".\", spacing = 1.0 }"},
     "scene.toml:7:19: body[0].points.file: \".\" is not allowed: . is not a file"},
    {{.source = "points = { file = \"a\\u0000b\", spacing = 1.0 }"},
     "scene.toml:7:19: body[0].points.file: \"a\\u0000b\" (a string) is not allowed: the name of a file, a "
     "string "
     "without a zero byte"},
    {{.source = "implicit = \"maoi\""},
     "scene.toml:7:12: body[0].implicit: unknown shape 'maoi'; did you mean 'moai'?"},
    {{.source = "implicit = { shape = \"maoi\", count = 9 }"},
     "scene.toml:7:22: body[0].implicit.shape: unknown shape 'maoi'; did you mean 'moai'?"},
    // References.
    {{.rest = "[[body]]\nmaterial = \"jely\"\nbox = { count = [2, 2, 2], spacing = 1.0 }"},
     "scene.toml:9:12: body[1].material: unknown material 'jely'; did you mean 'jelly'?"},
    {{.rest = "[[body]]\nmaterial = \"cream\"\nbox = { count = [2, 2, 2], spacing = 1.0 }"},
     "scene.toml:9:12: body[1].material: unknown material 'cream'; did you mean 'shaving_cream'?"},
    {{.rest = "[[body]]\nmaterial = \"sand\"\nbox = { count = [2, 2, 2], spacing = 1.0 }"},
     "scene.toml:9:12: body[1].material: unknown material 'sand'; known are jelly, rubber, gelatin, "
     "plasticine, clay, dough, butter, chocolate, toothpaste, shaving_cream, mayonnaise, "
     "ketchup, honey and water"},
    {{.rest = "[[material]]\nname = \"cream\""},
     "scene.toml:9:8: material[1]: material 'cream' is not used by any body"},
    {{.rest = "[[material]]\nname = \"jelly\""},
     "scene.toml:9:8: material[1].name: 'jelly' is not allowed: material[0] has that name"},
    {{.body = "material = \"jelly\"\ngroup = \"g\"",
      .rest = "[[material]]\nname = \"cream\"\n[[body]]\nmaterial = \"cream\"\ngroup = \"g\"\n"
              "box = { count = [2, 2, 2], spacing = 1.0 }"},
     "scene.toml:12:12: body[1].material: 'cream' is not allowed: group 'g' has material 'jelly', given by "
     "body[0]"},
    // Colliders and pins.
    {{.rest = "[[collider]]\nfriction = 0.1"},
     "scene.toml:8:1: collider[0]: has no shape: exactly one of plane, sphere, box, capsule, cylinder, cone, "
     "hull, mesh, "
     "union is needed"},
    {{.rest = "[[collider]]\nplane = { normal = [0, 0, 0] }"},
     "scene.toml:9:20: collider[0].plane.normal: [0.0, 0.0, 0.0] is not allowed: a direction, of length in "
     "[1e-15, 1e15]"},
    {{.rest = "[[collider]]\nbox = { min = [0, 0, 0], max = [1, 1, 0] }"},
     "scene.toml:9:32: collider[0].box.max: [1.0, 1.0, 0.0] is not allowed: above min along every "
     "axis"},
    {{.rest = "[[collider]]\ncapsule = { end = [0, 0, 0], radius = 1 }"},
     "scene.toml:9:19: collider[0].capsule.end: [0.0, 0.0, 0.0] is not allowed: a point that is [1e-15, "
     "1e15] "
     "away from start"},
    {{.rest = "[[collider]]\ncone = { end = [0, 0, 1], start_radius = 0 }"},
     "scene.toml:9:42: collider[0].cone.start_radius: 0.0 is not allowed: above 0 where end_radius is 0"},
    {{.rest = "[[collider]]\nhull = { inside = true }"},
     "scene.toml:9:8: collider[0].hull: has neither file nor points: exactly one of the two is needed"},
    {{.rest = "[[collider]]\nhull = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]] }"},
     "scene.toml:9:1: collider[0].hull: hull.points: enclose nothing: all are in one plane"},
    {{.rest = "[[collider]]\nmesh = { file = \"none.off\" }"},
     "scene.toml:9:17: collider[0].mesh.file: \"none.off\" is not allowed: there is no file none.off"},
    {{.rest = "[[collider]]\nplane = {}\nkeyframes = [{ time = 1 }, { time = 1 }]"},
     "scene.toml:10:28: collider[0].keyframes[1]: time 1.0 is not allowed: a time after that of the keyframe "
     "before"},
    {{.rest = "[[collider]]\nplane = {}\nvelocity = [0, 0, 1]\nkeyframes = [{ time = 1 }]"},
     "scene.toml:10:12: collider[0].velocity: is not allowed beside keyframes"},
    {{.rest =
          "[[emitter]]\nmaterial = \"jelly\"\nradius = 1\nspacing = 1\nvelocity = [0, 0, 1]\nkeyframes = [{ "
          "time = 1 }]"},
     "scene.toml:12:12: emitter[0].velocity: is not allowed beside keyframes"},
    {{.rest = "[[emitter]]\nmaterial = \"jelly\"\nspacing = 1\npoints = [[0, 0, 0], [1, 0]]"},
     "scene.toml:11:22: emitter[0].points[1]: an array of 2 is not allowed: 3 finite numbers [x, y, z]"},
    {{.rest = "[[emitter]]\nmaterial = \"jelly\"\nspacing = 1\nradius = 2\npoints = [[0, 0, 0], [1, 0, 0]]"},
     "scene.toml:8:1: emitter[0].radius: is not allowed beside width, height or points: a nozzle is round, "
     "or "
     "has corners, or points of its own"},
    {{.rest = "[[emitter]]\nmaterial = \"jelly\"\nradius = 1\nspacing = 1\nspeed = [[0, 1], [1, -1]]"},
     "scene.toml:12:22: emitter[0].speed[1][1]: -1 is not allowed: a number >= 0"},
    {{.rest = "[[collider]]\nunion = []"},
     "scene.toml:9:9: collider[0].union: an array of 0 is not allowed: a list of 1 to 10000 tables, each "
     "with one of "
     "plane, sphere, box, capsule, cylinder, cone, hull, mesh"},
    {{.rest = "[[collider]]\nunion = [{ sphere = { radius = 0 } }]"},
     "scene.toml:9:32: collider[0].union[0].sphere.radius: 0 is not allowed: a number > 0"},
    {{.rest = "[[collider]]\nunion = [{ sphere = { radius = 1 }, plane = {} }]"},
     "scene.toml:9:37: collider[0].union[0].plane: is not allowed beside sphere: exactly one of plane, "
     "sphere, box, capsule, cylinder, cone, hull, mesh"},
    {{.rest = "[[collider]]\nplane = {}\nrestitution = 1.5"},
     "scene.toml:10:15: collider[0].restitution: 1.5 is not allowed: a number in [0, 1]"},
    {{.rest = "[[pin]]\nvelocity = [0, 0, 1]"},
     "scene.toml:8:1: pin[0].box: is missing: { min = [...], max = [...] }"},
    {{.rest = "[[pin]]\nbox = { min = [0, 0, 0], max = [1, -1, 0] }"},
     "scene.toml:9:32: pin[0].box.max: [1.0, -1.0, 0.0] is not allowed: at least min, [0.0, 0.0, 0.0], along "
     "every "
     "axis"},
};

TEST_F(bad_scene, names_place_field_value_and_what_is_allowed) {
  for (const Case& bad : k_cases) {
    std::vector<std::string> found = problems(bad.scene.text());
    // A wrong name leaves the body's material unknown, which is said as well.
    if (bad.scene.material.starts_with("name = 3")) found.resize(1);
    EXPECT_EQ(found, std::vector<std::string>{bad.problem}) << bad.scene.text();
  }
}

TEST_F(bad_scene, shows_all_problems_in_the_order_of_lines) {
  const std::vector<std::string> found = problems(R"([run]
frames = "many"
[[body]]
material = "chalk"
box = { count = [2, 2, 2], spacing = -1.0 }
[[material]]
name = "jelly"
alfa = 0.5
[solver]
time_step = 0
)");
  const std::vector<std::string> expected{
      "scene.toml:2:10: run.frames: \"many\" (a string) is not allowed: a whole number in [0, 2147483647]",
      "scene.toml:4:12: body[0].material: unknown material 'chalk'; known are jelly, rubber, gelatin, "
      "plasticine, clay, dough, butter, chocolate, toothpaste, shaving_cream, mayonnaise, "
      "ketchup, honey and water",
      "scene.toml:5:38: body[0].box.spacing: -1.0 is not allowed: a number > 0",
      "scene.toml:7:8: material[0]: material 'jelly' is not used by any body",
      "scene.toml:8:1: material[0]: unknown key 'alfa'; did you mean 'alpha'?",
      "scene.toml:10:13: solver.time_step: 0 is not allowed: a number > 0",
  };
  EXPECT_EQ(found, expected);
}

TEST_F(bad_scene, misses_what_every_scene_needs) {
  const std::vector<std::string> expected{
      "scene.toml: body: is missing: at least one [[body]] is needed",
  };
  EXPECT_EQ(problems(""), expected);
}

TEST_F(bad_scene, refuses_duplicate_keys_and_broken_toml_with_line_and_column) {
  const auto duplicate = problems("[solver]\nsupport_radius = 2.0\nsupport_radius = 3.0\n");
  ASSERT_EQ(duplicate.size(), 1u);
  EXPECT_TRUE(duplicate[0].starts_with("scene.toml:3:")) << duplicate[0];
  EXPECT_NE(duplicate[0].find("support_radius"), std::string::npos) << duplicate[0];

  const auto broken = problems("[solver]\nsupport_radius = 2.0.0\n");
  ASSERT_EQ(broken.size(), 1u);
  EXPECT_TRUE(broken[0].starts_with("scene.toml:2:")) << broken[0];

  const auto keyless = problems("[solver]\n[= 3]\n");
  ASSERT_EQ(keyless.size(), 1u);
  EXPECT_TRUE(keyless[0].starts_with("scene.toml:2:")) << keyless[0];
}

TEST_F(bad_scene, keeps_letters_beyond_ascii_to_comments_and_strings) {
  const std::string message =
      "a character beyond ASCII is not allowed here, only in comments and in strings of one line that "
      "follow white space";
  EXPECT_EQ(problems("# \"γ\n[solver] # 'ρ\nσ = 2.0\n"),
            std::vector<std::string>{"scene.toml:3:1: " + message});
  EXPECT_EQ(problems("a = \"γ\\\"γ\" γ"), std::vector<std::string>{"scene.toml:1:12: " + message});
  EXPECT_EQ(problems("a = \"\"\"\n'\"\" γ"), std::vector<std::string>{"scene.toml:2:5: " + message});
  // What the parser takes for the end of a number.
  EXPECT_EQ(problems("\na = 6\"σ\"\n"), std::vector<std::string>{"scene.toml:2:7: " + message});
  EXPECT_EQ(problems("a = 0.\"σ"), std::vector<std::string>{"scene.toml:1:8: " + message});
  EXPECT_EQ(problems("a = [1, 6='σ']"), std::vector<std::string>{"scene.toml:1:12: " + message});

  std::string text = k_small_scene;
  for (std::size_t at = text.find("jelly"); at != std::string::npos; at = text.find("jelly"))
    text.replace(at, 5, "gelée");
  EXPECT_EQ(read("\xEF\xBB\xBF# σ\n" + text).materials[0].name, "gelée");
}

TEST_F(bad_scene, limits_the_size_of_what_is_read) {
  const auto large = problems("# " + std::string(std::size_t{17} << 20, 'x') + "\n");
  EXPECT_EQ(large,
            std::vector<std::string>{"scene.toml: is too large for a scene: at most 16 MiB are allowed"});

  std::string many = k_small_scene;
  for (int i = 0; i < 10'000; ++i) many += "[[body]]\n";
  EXPECT_EQ(problems(many),
            std::vector<std::string>{
                "scene.toml:5:1: body: an array of 10001 is not allowed: a list of 1 to 10000"});
}

TEST_F(bad_scene, limits_what_is_within_what) {
  const auto keys = [](std::size_t count) {
    std::string text = "a";
    for (std::size_t i = 1; i < count; ++i) text += ".a";
    return text;
  };
  const std::string too_many_keys = "keys are nested too deeply here: at most 9 levels are allowed";
  // So many that what goes into them by recursion would leave no stack.
  for (const std::size_t count : {std::size_t{10}, std::size_t{400'000}}) {
    EXPECT_EQ(problems(keys(count) + " = 1\n"),
              std::vector<std::string>{"scene.toml:1:18: " + too_many_keys});
    EXPECT_EQ(problems("[" + keys(count) + "]\n"),
              std::vector<std::string>{"scene.toml:1:19: " + too_many_keys});
    // The last quotes belong to the string, which ends with the three that stand before the comma.
    EXPECT_EQ(problems("x = { k = \"\"\"k\"\"\"\"\", " + keys(count) + " = 1 }\n"),
              std::vector<std::string>{"scene.toml:1:39: " + too_many_keys});
    EXPECT_EQ(
        problems("x = " + std::string(7 + count, '[')),
        std::vector<std::string>{
            "scene.toml:1:21: tables and lists are nested too deeply here: at most 16 levels are allowed"});
  }
  EXPECT_EQ(problems(keys(9) + " = 1\n").back(),
            "scene.toml:1:1: unknown key 'a'; known are solver, material, body, collider, pin, emitter, "
            "sink, surface, run and "
            "render");
  EXPECT_EQ(problems("a = '" + std::string(k_max_line_bytes, 'a') + "'\n"),
            std::vector<std::string>{"scene.toml:1:1048578: the line is too long: at most 1048576 bytes are "
                                     "allowed"});
  std::string many = "a = [";
  for (int i = 0; i < 1'000'000; ++i) many += i % 1000 == 0 ? "0,\n" : "0,";
  EXPECT_EQ(problems(many + "]\n").back().substr(0, 40), "scene.toml:1001:1996: the file has too m");
}

TEST_F(bad_scene, limits_names_and_paths) {
  const std::string name(257, 'n'), path(4097, 'p');
  const auto found =
      problems("[solver]\nsupport_radius = 2.0\n[[material]]\nname = \"" + name +
               "\"\n[[body]]\nmaterial = \"" + name + "\"\nmesh = { file = \"" + path + "\", count = 9 }\n");
  ASSERT_EQ(found.size(), 3u);
  EXPECT_TRUE(found[0].ends_with(" (a string) is not allowed: a string of at most 256 bytes")) << found[0];
  EXPECT_TRUE(found[2].ends_with(" is not allowed: the name of a file, a string of at most 4096 bytes"))
      << found[2];
}

TEST_F(bad_scene, has_at_most_100_million_particles) {
  const std::string body =
      "[[body]]\nmaterial = \"jelly\"\nbox = { count = [1000, 1000, 50], spacing = 1.0 }\n";
  EXPECT_EQ(problems(k_small_scene + body), std::vector<std::string>{});
  EXPECT_EQ(
      problems(k_small_scene + body + body),
      std::vector<std::string>{"scene.toml:11:1: body[2]: is one body too many: with it there are more than "
                               "100000000 particles in the scene"});
}

/// Each of these once took minutes, or gigabytes, or both.
TEST_F(bad_scene, costs_little_however_much_is_wrong) {
  const std::clock_t begin = std::clock();
  const std::string solver = "[solver]\nsupport_radius = 2.0\n";
  const std::string box = "box = { count = [2, 2, 2], spacing = 1.0 }\n";
  std::string unknown = solver;
  for (int i = 0; i < 10'000; ++i)
    unknown += "[[material]]\nname = \"" + std::string(50, 'm') + std::to_string(i) + "\"\n";
  for (int i = 0; i < 10'000; ++i)
    unknown += "[[body]]\nmaterial = \"" + std::string(50, 'n') + std::to_string(i) + "\"\n" + box;
  EXPECT_EQ(problems(unknown).size(), 1001u);

  std::string before;
  for (int i = 0; i < 200'000; ++i) before += "key_" + std::to_string(i) + " = 1\n";
  before += solver + "[[material]]\nname = \"jelly\"\n";
  for (int i = 0; i < 10'000; ++i) before += "[[body]]\nmaterial = \"x\"\n" + box;
  EXPECT_EQ(problems(before).size(), 1001u);
  EXPECT_LT(std::clock() - begin, 60 * CLOCKS_PER_SEC);
}

TEST_F(bad_scene, writes_no_control_characters_to_a_terminal) {
  EXPECT_EQ(problems("\"\\u001b[31m\" = 1\n").back().substr(0, 37), "scene.toml:1:1: unknown key '?[31m'; ");
}

TEST_F(bad_scene, lists_no_more_problems_than_anyone_reads) {
  std::string text = k_small_scene + "[render]\n";
  for (int i = 0; i < 1500; ++i) text += "unknown_" + std::to_string(i) + " = 1\n";
  const auto found = problems(text);
  ASSERT_EQ(found.size(), 1001u);
  EXPECT_EQ(found.back(), "scene.toml: and 500 more problems");
}

TEST_F(bad_scene, cannot_be_a_folder_or_a_missing_file) {
  try {
    read_scene(folder_);
    FAIL() << "a folder was read";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("cannot be read: it is a folder, not a scene file"),
              std::string::npos);
  }
  try {
    read_scene(folder_ / "none.toml");
    FAIL() << "a missing file was read";
  } catch (const ConfigError& error) {
    EXPECT_EQ(shown(error), std::vector<std::string>{"none.toml: cannot be read: No such file or directory"});
  }
}

}  // namespace bad_scene_test
}  // namespace mallow
