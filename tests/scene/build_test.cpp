#include "scene/scene_fixture.h"

#include <sstream>

namespace mallow {
namespace build_test {

using build_scene = SceneFixture;

const std::string k_two_groups = R"([solver]
support_radius = 2.1
[[material]]
name = "jelly"
alpha = 0.5
[[material]]
name = "cream"
alpha = 1.0
[[body]]
material = "cream"
box = { count = [2, 2, 2], spacing = 1.0, corner = [0, 0, 1], jitter = 0.0 }
velocity = [1, 0, 0]
[[body]]
material = "jelly"
group = "pair"
box = { count = [3, 1, 1], spacing = 1.0, corner = [10, 0, 1] }
[[body]]
material = "jelly"
group = "pair"
points = { file = "points.csv", spacing = 1.0 }
velocity = [0, 0, 1]
[[collider]]
plane = { normal = [0, 0, 1], offset = 0 }
[[pin]]
box = { min = [0, 0, 0], max = [1, 1, 2] }
)";

std::string build_error(const Scene& scene) {
  try {
    build(scene, 1);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(build_scene, puts_bodies_into_groups_in_the_order_of_the_file) {
  write("points.csv", "x,y,z,vx,vy,vz\n20,0,1,0.5,0,0\n21,0,1,0,0.5,0\n");
  const Scene scene = read(k_two_groups);
  Simulation simulation = build(scene, 1);
  EXPECT_EQ(simulation.particle_count(), 13u);
  EXPECT_EQ(simulation.config().threads, 1);
  EXPECT_EQ(simulation.colliders().size(), 1u);
  const std::vector<std::uint32_t> expected{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1};
  EXPECT_EQ(simulation.bodies_by_id(), expected);
  EXPECT_EQ(body_materials(scene), (std::vector<std::size_t>{1, 0}));

  const SimulationInfo info = simulation.info();
  ASSERT_EQ(info.bodies.size(), 2u);
  EXPECT_EQ(info.bodies[0].name, "body[0]");
  EXPECT_EQ(info.bodies[1].name, "pair");

  const std::vector<Vec3> positions = simulation.positions_by_id();
  EXPECT_EQ(positions[0], Vec3(0.5f, 0.5f, 1.5f));
  EXPECT_EQ(positions[11], Vec3(20, 0, 1));
  const std::vector<Vec3> velocities = simulation.velocities_by_id();
  EXPECT_EQ(velocities[7], Vec3(1, 0, 0));
  EXPECT_EQ(velocities[8], Vec3(0, 0, 0));
  EXPECT_EQ(velocities[11], Vec3(0.5f, 0, 1));
  EXPECT_EQ(velocities[12], Vec3(0, 0.5f, 1));
}

TEST_F(build_scene, says_what_its_parts_are_called_in_the_order_of_the_file) {
  write("points.csv", "x,y,z,vx,vy,vz\n20,0,1,0.5,0,0\n21,0,1,0,0.5,0\n");
  const Scene scene = read(k_two_groups + R"([[pin]]
box = { min = [10, 0, 0], max = [12, 1, 2] }
[[collider]]
sphere = { center = [50, 0, 0], radius = 2.0 }
[[emitter]]
material = "jelly"
points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
spacing = 1.0
translate = [30, 0, 9]
[[sink]]
box = { min = [0, 0, -9], max = [1, 1, -5] }
)");
  SceneIds ids;
  Simulation s = build(scene, 1, nullptr, &ids);
  ASSERT_EQ(ids.bodies.size(), 3u);
  EXPECT_EQ(s.name(ids.bodies[0]), "body[0]");
  EXPECT_EQ(s.name(ids.bodies[1]), "pair");
  EXPECT_EQ(ids.bodies[2], ids.bodies[1]) << "one piece";
  EXPECT_EQ(ids.colliders, s.collider_ids());
  EXPECT_EQ(std::get<Sphere>(s.collider(ids.colliders.at(1)).shape).radius, 2.0f);
  ASSERT_EQ(ids.emitters.size(), 1u);
  EXPECT_EQ(s.body(ids.emitters[0]), s.find_body("emitter[0]"));
  EXPECT_EQ(s.emitter(ids.emitters[0]).points.size(), 3u);
  const Simulation::Rows strand = s.rows(s.body(ids.emitters[0]));
  EXPECT_EQ((strand.end - strand.begin) % 3, 0u) << "layers of three points";
  ASSERT_EQ(ids.pins.size(), 2u);
  s.set_velocity(ids.pins[1], {0, 2, 0});
  s.step();
  EXPECT_EQ(s.velocities()[s.rows(ids.bodies[1]).begin], Vec3(0, 2, 0));
  s.remove_sink(ids.sinks.at(0));
  s.remove_emitter(ids.emitters[0]);
  s.step();
}

TEST_F(build_scene, samples_every_source) {
  write("tetra.off", "OFF\n4 4 0\n0 0 0\n4 0 0\n0 4 0\n0 0 4\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  const auto points = [&](const BodySource& source) {
    return sample(SceneBody{.material = {}, .group = {}, .source = source}, folder_ / "scene.toml", 1);
  };
  EXPECT_EQ(points(Lattice{{2, 3, 4}, 1.0f, {0, 0, 0}, 0.0f}).positions.size(), 24u);
  const Body ball = points(SphereSource{{1, 2, 3}, 4.0f, {.spacing = {}, .count = 2000}});
  EXPECT_NEAR(static_cast<double>(ball.positions.size()), 2000, 20);
  for (const Vec3& x : ball.positions) ASSERT_LE((x - Vec3(1, 2, 3)).norm(), 4.0f);
  const Body mesh = points(MeshSource{
      "tetra.off", {.spacing = {}, .count = 1000}, {.rotate = {10, 20, 30}, .size = {}, .center = {}}});
  EXPECT_NEAR(static_cast<double>(mesh.positions.size()), 1000, 10);
  const Body moai = points(ImplicitSource{"moai", {.spacing = {}, .count = 3764}, {}});
  EXPECT_NEAR(static_cast<double>(moai.positions.size()), 3764, 37);
}

TEST_F(build_scene, says_which_body_has_a_file_that_cannot_be_read) {
  write("points.csv", "x,y,z\n1,2,abc\n");
  write("open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const Scene scene =
      read(k_two_groups + "[[body]]\nmaterial = \"jelly\"\nmesh = { file = \"open.off\", spacing = 0.1 }\n");
  const std::string error = build_error(scene);
  EXPECT_NE(error.find("scene.toml:17: body[2].points: "), std::string::npos) << error;
  EXPECT_NE(error.find("points.csv:2"), std::string::npos) << error;
  EXPECT_NE(error.find("scene.toml:26: body[3].mesh: "), std::string::npos) << error;
}

TEST_F(build_scene, names_file_and_coordinates_of_an_open_edge) {
  write("open.off", "OFF\n4 3 0\n0 0 0\n4 0 0\n0 4 0\n0 0 4\n3 0 2 1\n3 0 1 3\n3 0 3 2\n");
  const std::string error = build_error(read(
      k_small_scene + "[[body]]\nmaterial = \"jelly\"\nmesh = { file = \"open.off\", spacing = 0.1 }\n"));
  EXPECT_NE(error.find("body[1].mesh: " + (folder_ / "open.off").string() +
                       ": mesh: does not enclose a volume: "
                       "3 open edges, the first from (4 0 0) to (0 4 0)"),
            std::string::npos)
      << error;
}

constexpr const char* k_mapped_cube =
    "v 500000.25 4500000.125 100\nv 500002.25 4500000.125 100\nv 500002.25 4500002.125 100\n"
    "v 500000.25 4500002.125 100\nv 500000.25 4500000.125 102\nv 500002.25 4500000.125 102\n"
    "v 500002.25 4500002.125 102\nv 500000.25 4500002.125 102\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST_F(build_scene, a_mesh_in_the_coordinates_of_a_map_is_moved_near_exactly_or_refused) {
  write("map.obj", k_mapped_cube);
  const auto scene = [&](const std::string& mesh) {
    return read(
        "[solver]\nsupport_radius = 0.21\n[[material]]\nname = \"a\"\n[[body]]\nmaterial = \"a\"\n"
        "mesh = { file = \"map.obj\", jitter = 0.0, " +
        mesh + " }\n");
  };
  const std::vector<Vec3> near = build(scene("spacing = 0.1, center = [0, 0, 1]"), 1).positions_by_id();
  ASSERT_EQ(near.size(), 8000u);
  Vec3 low = near[0], high = near[0];
  for (const Vec3& x : near) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
    const Vec3 cell = (x - Vec3(0, 0, 1)) / 0.1f - Vec3::Constant(0.5f);
    ASSERT_LT((cell - cell.array().round().matrix()).norm(), 1e-4f);
  }
  EXPECT_LT((low - Vec3(-0.95f, -0.95f, 0.05f)).norm(), 1e-6f);
  EXPECT_LT((high - Vec3(0.95f, 0.95f, 1.95f)).norm(), 1e-6f);
  const std::string error = build_error(scene("spacing = 0.1"));
  for (const char* word :
       {"body[0].mesh: ", "map.obj: center: is not given", "4500000", "floats are steps of 0.5 there"})
    EXPECT_NE(error.find(word), std::string::npos) << error;
}

TEST_F(build_scene, refuses_points_that_are_given_twice) {
  const std::string box =
      "[[body]]\nmaterial = \"jelly\"\ngroup = \"g\"\n"
      "box = { count = [2, 2, 2], spacing = 1.0, corner = [5, 0, 0], jitter = 0.0 }\n";
  const std::string twice = build_error(read(k_small_scene + box + box));
  EXPECT_NE(twice.find("scene.toml:12: body[2].box: body: body 'g' overlaps itself at (5.5 0.5 0.5): "
                       "particles 8 and 16 are 0 m apart"),
            std::string::npos)
      << twice;
  write("points.csv", "x,y,z\n5,0,0\n6,0,0\n7,0,0\n6,0,0\n");
  const std::string points = build_error(read(
      k_small_scene + "[[body]]\nmaterial = \"jelly\"\npoints = { file = \"points.csv\", spacing = 1.0 }\n"));
  EXPECT_NE(points.find("body[1].points: body: body 'body[1]' overlaps itself at (6 0 0): particles 9 and "
                        "11 are 0 m apart"),
            std::string::npos)
      << points;
}

TEST_F(build_scene, hands_on_what_is_worth_knowing_about_its_bodies) {
  write("cube.off",
        "OFF\n8 6 0\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n0 0 2\n2 0 2\n2 2 2\n0 2 2\n"
        "4 0 1 2 3\n4 7 6 5 4\n4 4 5 1 0\n4 5 6 2 1\n4 6 7 3 2\n4 7 4 0 3\n");
  std::vector<std::string> notes;
  build(read("[solver]\nsupport_radius = 0.5\n[[material]]\nname = \"a\"\n[[body]]\nmaterial = \"a\"\n"
             "mesh = { file = \"cube.off\", spacing = 0.2 }\n"),
        1, &notes);
  EXPECT_EQ(notes, (std::vector<std::string>{"body[0].mesh: " + (folder_ / "cube.off").string() +
                                             ": the mesh is inside out: its triangles were turned"}));
}

TEST_F(build_scene, reports_all_overlapping_bodies_at_their_places_and_then_all_empty_pins) {
  const std::string body = "[[body]]\nmaterial = \"jelly\"\nbox = { count = [2, 2, 2], spacing = 1.0 }\n";
  const std::string pin = "[[pin]]\nbox = { min = [50, 50, 50], max = [60, 60, 60] }\n";
  const auto found = [&](const std::string& text) {
    try {
      build(read(text), 1);
    } catch (const ConfigError& error) {
      return shown(error);
    }
    return std::vector<std::string>{};
  };
  const std::vector<std::string> bodies = found(k_small_scene + body + body + pin);
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_TRUE(
      bodies[0].starts_with("scene.toml:8: body[1].box: body: bodies 'body[1]' and 'body[0]' overlap"))
      << bodies[0];
  EXPECT_TRUE(bodies[1].starts_with("scene.toml:11: body[2].box: ")) << bodies[1];
  const std::vector<std::string> pins = found(k_small_scene + pin + pin);
  ASSERT_EQ(pins.size(), 2u);
  EXPECT_TRUE(pins[0].starts_with("scene.toml:8: pin[0]: ")) << pins[0];
}

TEST_F(build_scene, of_a_scene_made_in_code_names_what_is_wrong) {
  Scene scene;
  scene.solver.support_radius = 2.0f;
  scene.bodies.push_back({.material = "jelly", .group = {}, .source = Lattice{}});
  EXPECT_EQ(build_error(scene), "body[0].material: unknown material 'jelly'");
}

/// Two cubes in metres, of one material and in steps of a millisecond.
std::string two_cubes(const std::string& material, const std::string& more = "") {
  const std::string body =
      "[[body]]\nmaterial = \"paste\"\n" + more + "box = { count = [4, 4, 4], spacing = 0.01";
  return "[solver]\ngravity = [0, 0, -9.81]\ntime_step = 0.001\n[[material]]\nname = \"paste\"\n"
         "rest_density = 1000\nalpha = 0.3\n" +
         material + '\n' + body + " }\n" + body + ", corner = [1, 0, 0] }\n";
}

TEST_F(build_scene, names_a_material_that_is_damped_too_much_and_says_so_once) {
  for (const char* springs : {"youngs_modulus = 2000", "elastic_time_step = 0.001"}) {
    const std::string text = build_error(read(two_cubes(springs + std::string("\ndamping_time = 100"))));
    EXPECT_NE(text.find("damping_time: 100 is not allowed"), text.npos) << text;
    EXPECT_EQ(text.find("damping_time: 100"), text.rfind("damping_time: 100")) << text;
    EXPECT_NE(text.find("paste"), text.npos) << text;
  }
  const std::string stiff = build_error(read(two_cubes("youngs_modulus = 1e9")));
  EXPECT_EQ(stiff.find("youngs_modulus: 1e+09 is not allowed in body 'body[0]' of material 'paste'"),
            stiff.rfind("youngs_modulus: 1e+09"))
      << stiff;
}

TEST_F(build_scene, says_which_step_carries_a_stiffness_that_is_painted) {
  const auto number_after = [](const std::string& text, const std::string& words) {
    const std::size_t at = text.find(words);
    return at == text.npos ? 0.0f : std::stof(text.substr(at + words.size()));
  };
  const std::string paint = "paint = [{ sphere = { radius = 9 }, stiffness = 1e4 }]\n";
  const auto refused = [&](const std::string& material, const std::string& change) {
    Scene scene = read(two_cubes(material, paint), {change});
    return build_error(scene);
  };
  for (const char* material :
       {"youngs_modulus = 2000", "youngs_modulus = 2000\ndamping_time = 1e-6", "elastic_time_step = 0.02"}) {
    const float step =
        number_after(refused(material, "solver.time_step=0.001"), "solver.time_step (now 0.001) to ");
    ASSERT_GT(step, 0) << refused(material, "solver.time_step=0.001");
    EXPECT_EQ(refused(material, "solver.time_step=" + std::to_string(step * 1e6f) + "e-6"), "no error");
    EXPECT_NE(refused(material, "solver.time_step=" + std::to_string(1.03e6f * step) + "e-6"), "no error");
  }
  const std::string left_out = refused("", "solver.time_step=0.001");
  EXPECT_EQ(left_out.find("solver.time_step"), left_out.npos) << "no step would do: " << left_out;
  const float elastic = number_after(left_out, "material.elastic_time_step to ");
  ASSERT_GT(elastic, 0) << left_out;
  EXPECT_EQ(refused("elastic_time_step = " + std::to_string(elastic), "solver.time_step=0.001"), "no error");
}

TEST_F(build_scene, names_the_paint_or_the_file_that_makes_particles_too_stiff) {
  const auto refused = [&](const std::string& body) {
    return build_error(
        read("[solver]\nsupport_radius = 2.0\ntime_step = 0.15\n[[material]]\nname = "
             "\"jelly\"\n[[body]]\nmaterial = \"jelly\"\n" +
             body));
  };
  const std::string paint =
      "paint = [{ sphere = { radius = 9 }, temperature = 3 }, { sphere = { radius = 9 }, "
      "stiffness = 40 }]\n";
  const std::string box = refused("box = { count = [2, 2, 2], spacing = 1.0 }\n" + paint);
  EXPECT_NE(box.find("body[0].box: paint[1]: makes (1 - alpha) times stiffness 40"), box.npos) << box;
  write("grains.csv", "x,y,z,stiffness\n0,0,0,1\n1,0,0,40\n");
  const std::string file = refused("points = { file = \"grains.csv\", spacing = 1.0 }\n");
  EXPECT_NE(file.find("grains.csv: body.stiffness: makes (1 - alpha) times stiffness 40"), file.npos) << file;
}

TEST_F(build_scene, names_a_spacing_that_is_not_that_of_the_points) {
  std::string points = "x,y,z\n";
  for (int i = 0; i < 27; ++i)
    points += std::to_string(0.5 * (i % 3)) + ',' + std::to_string(0.5 * (i / 3 % 3)) + ',' +
              std::to_string(0.5 * (i / 9)) + '\n';
  write("grains.csv", points);
  const auto notes_of = [&](const std::string& spacing) {
    std::vector<std::string> notes;
    build(read("[solver]\nsupport_radius = 2.0\n[[material]]\nname = \"jelly\"\n[[body]]\nmaterial = "
               "\"jelly\"\npoints = { file = \"grains.csv\", spacing = " +
               spacing + " }\n"),
          1, &notes);
    return notes;
  };
  for (const char* spacing : {"0.36", "0.5", "0.71"}) EXPECT_TRUE(notes_of(spacing).empty()) << spacing;
  EXPECT_EQ(notes_of("0.25").size(), 1u);
  EXPECT_EQ(
      notes_of("1.0"),
      std::vector<std::string>{
          "body[0].points: grains.csv: spacing 1 m is not that of its points, whose nearest are 0.5 m "
          "apart in the median: 8 times the mass, as each stands for a cube as wide as the spacing; give "
          "spacing = 0.5"});
}

TEST_F(build_scene, names_a_column_of_a_file_that_follows_temperature_instead) {
  write("grains.csv", "x,y,z,alpha\n0,0,0,0.5\n1,0,0,0.5\n");
  std::vector<std::string> notes;
  build(read("[solver]\nsupport_radius = 2.0\n[[material]]\nname = \"jelly\"\ntemperature = 300\n"
             "alpha_by_temperature = [[300, 0.1], [310, 1]]\n[[body]]\nmaterial = \"jelly\"\npoints = { file "
             "= \"grains.csv\", spacing = 1.0 }\n"),
        1, &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("its alpha has no effect, as it follows the material's alpha_by_temperature"),
            notes[0].npos)
      << notes[0];
}

TEST_F(build_scene, names_what_a_temperature_is_missing_for) {
  const std::string text = build_error(read(two_cubes("alpha_by_temperature = [[300, 0.1], [310, 1]]")));
  EXPECT_NE(text.find("material.temperature: is missing: alpha_by_temperature needs the temperature of the "
                      "particles at the start"),
            text.npos)
      << text;
}

TEST_F(build_scene, runs_and_comes_to_the_same_state_from_the_printed_scene) {
  const std::vector<std::string> small{"body[0].box.count=[5,5,5]",
                                       "material[0].alpha=[[0.0,0.2],[1.5,0.8]]"};
  const Scene scene = read_scene(MALLOW_DATA_DIR "/scenes/cube.toml", small);
  Simulation first = build(scene, 1);
  Simulation second = build(read_scene(write("printed.toml", print_scene(scene))), 2);
  for (int step = 0; step < 20; ++step) {
    first.step();
    second.step();
  }
  EXPECT_EQ(first.state_hash(), second.state_hash());
  EXPECT_NE(first.positions_by_id()[0], build(scene, 1).positions_by_id()[0]);
}

/// Boxes of side 2, of which `fine` has one vertex more.
constexpr const char* k_box =
    "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

class skin_of_scene : public SceneFixture {
 protected:
  skin_of_scene() {
    write("box.obj", k_box);
    write("fine.obj", std::string(k_box) + "v 1 1 2.25\n");
    write("map.obj", k_mapped_cube);
  }
  Scene scene(const std::string& body, const std::string& alpha = "0.5") const {
    return read("[solver]\nsupport_radius = 0.42\n[[material]]\nname = \"a\"\nalpha = " + alpha +
                "\n[[body]]\nmaterial = \"a\"\n" + body + "\n");
  }
  static Mesh skin_of(const Scene& scene) {
    Simulation simulation = build(scene, 1);
    std::vector<Skin> all = skins(scene, simulation, 1);
    EXPECT_EQ(all.size(), 1u);
    EXPECT_EQ(skinned_bodies(scene), std::vector<bool>{true});
    return all.at(0).update(simulation);
  }
};

TEST_F(skin_of_scene, goes_where_the_bodys_own_mesh_went) {
  const Mesh mesh = skin_of(
      scene("skin = \"fine.obj\"\nmesh = { file = \"box.obj\", spacing = 0.2, rotate = [0, 0, 90], size = 1, "
            "center = [5, 6, 7] }"));
  ASSERT_EQ(mesh.vertices.size(), 9u);
  // Scaled by a half about the middle of the box, which the ninth vertex is outside of.
  EXPECT_LT((mesh.vertices[8] - Vec3(5, 6, 7.625f)).norm(), 1e-5f);
  EXPECT_LT((mesh.vertices[0] - Vec3(5.5f, 5.5f, 6.5f)).norm(), 1e-5f);
}

TEST_F(skin_of_scene, lies_as_it_is_where_the_body_is_not_placed) {
  const Mesh beside = skin_of(scene("skin = \"fine.obj\"\nmesh = { file = \"box.obj\", spacing = 0.2 }"));
  EXPECT_LT((beside.vertices[8] - Vec3(1, 1, 2.25f)).norm(), 1e-5f);
  const Mesh on_box = skin_of(scene("skin = \"box.obj\"\nbox = { count = [10, 10, 10], spacing = 0.2 }"));
  EXPECT_LT((on_box.vertices[6] - Vec3(2, 2, 2)).norm(), 1e-5f);
}

TEST_F(skin_of_scene, in_the_coordinates_of_a_map_is_moved_with_the_mesh) {
  const Mesh mesh =
      skin_of(scene("skin = \"map.obj\"\nmesh = { file = \"map.obj\", spacing = 0.2, center = [0, 0, 1] }"));
  EXPECT_LT((mesh.vertices[0] - Vec3(-1, -1, 0)).norm(), 1e-5f);
}

TEST_F(skin_of_scene, names_the_body_whose_skin_cannot_be) {
  const auto error_of = [&](const Scene& scene) -> std::string {
    try {
      Simulation simulation = build(scene, 1);
      skins(scene, simulation, 1);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "no error";
  };
  const std::string far =
      error_of(scene("skin = \"box.obj\"\nbox = { count = [9, 9, 9], spacing = 0.2, corner = [9, 0, 0] }"));
  EXPECT_NE(far.find("body[0].skin: mesh.vertices[0]: "), std::string::npos) << far;
  const std::string body = "skin = \"box.obj\"\nbox = { count = [9, 9, 9], spacing = 0.2 }";
  const std::string fluid = error_of(scene(body, "[[0, 0], [1, 1]]"));
  EXPECT_NE(fluid.find("is not allowed where alpha reaches 1"), std::string::npos) << fluid;
  EXPECT_EQ(error_of(scene("merges = true\n" + body)), "no error");
  const std::string part = error_of(scene("merges = true\n" + body, "0.1\nplastic_yield = 0.1"));
  EXPECT_NE(part.find("is not allowed on a body that merges and flows"), std::string::npos) << part;
  Scene drained = scene(body);
  Simulation simulation = build(drained, 1);
  const auto warns_of_sinks = [&] {
    return std::ranges::any_of(warnings(drained, simulation.info()), [](const std::string& text) {
      return text.find("body[0]: its skin ends the run where a sink") != std::string::npos;
    });
  };
  EXPECT_FALSE(warns_of_sinks());
  drained.sinks.push_back({});
  EXPECT_TRUE(warns_of_sinks());
  const std::string splits = error_of(scene("splits = true\n" + body, "0.1\nplastic_yield = 0.1"));
  EXPECT_NE(splits.find("is not allowed on a body that splits"), std::string::npos) << splits;
  const std::vector<std::string> missing = problems(
      "[solver]\nsupport_radius = 0.42\n[[material]]\nname = \"a\"\n[[body]]\nmaterial = \"a\"\n"
      "skin = \"none.obj\"\nbox = { count = [9, 9, 9], spacing = 0.2 }\n");
  ASSERT_EQ(missing.size(), 1u);
  EXPECT_NE(missing[0].find("body[0].skin: \"none.obj\" is not allowed: there is no file"), std::string::npos)
      << missing[0];
}

TEST_F(build_scene, paints_what_is_in_a_shape_and_what_a_file_of_points_says) {
  write("points.csv", "x,y,z,alpha,temperature\n20,0,1,0.25,310\n21,0,1,1,320\n");
  const Scene scene = read(R"([solver]
support_radius = 2.1
[[material]]
name = "jelly"
alpha = 0.5
plastic_yield = 0.1
temperature = 300
[[body]]
material = "jelly"
box = { count = [4, 1, 1], spacing = 1.0, jitter = 0.0 }
paint = [
  { plane = { normal = [1, 0, 0], offset = 2 }, alpha = 0.75 },
  { sphere = { radius = 0.6 }, translate = [0.5, 0.5, 0.5], alpha = 1.0, stiffness = 0.25 },
]
[[body]]
material = "jelly"
points = { file = "points.csv", spacing = 1.0 }
)");
  Simulation simulation = build(scene, 1);
  const std::vector<float> alphas{1, 0.75f, 0.5f, 0.5f, 0.25f, 1};
  for (ParticleId id = 0; id < 6; ++id) {
    EXPECT_EQ(simulation.alpha(id), alphas[id]) << id;
    EXPECT_EQ(simulation.stiffnesses()[simulation.row(id)], id == 0 ? 0.25f : 1.0f) << id;
    EXPECT_EQ(simulation.temperatures()[simulation.row(id)], id == 4 ? 310 : id == 5 ? 320 : 300) << id;
  }
}

/// A cube as a mesh file has it.
std::string cube_off(float width) {
  std::ostringstream text;
  text << "OFF\n8 12 0\n";
  for (int corner = 0; corner < 8; ++corner)
    for (int axis = 0; axis < 3; ++axis) text << (corner >> axis & 1 ? width : 0) << (axis < 2 ? ' ' : '\n');
  return text.str() +
         "3 0 2 3\n3 0 3 1\n3 4 5 7\n3 4 7 6\n3 0 1 5\n3 0 5 4\n3 2 6 7\n3 2 7 3\n3 0 4 6\n3 0 6 2\n"
         "3 1 3 7\n3 1 7 5\n";
}

TEST_F(build_scene, notes_a_mesh_that_is_in_centimetres_and_gives_more_particles_than_anyone_waits_for) {
  write("cube.off", cube_off(6));
  const auto notes_of = [&](const std::string& mesh) {
    std::vector<std::string> notes;
    build(read("[solver]\ngravity = [0, 0, -9.81]\n[[body]]\nmaterial = \"jelly\"\nmesh = { file = "
               "\"cube.off\", " +
               mesh + " }\n"),
          2, &notes);
    return notes;
  };
  const std::vector<std::string> notes = notes_of("spacing = 0.1");
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(
      notes[0],
      "body[0].mesh: cube.off: it is about 6 m wide, as the file has it, and gives 216000 particles 0.1 m "
      "apart; give size = 0.06 where the file is in centimetres, or a larger spacing");
  EXPECT_TRUE(notes_of("spacing = 0.2").empty()) << "few enough";
  EXPECT_TRUE(notes_of("spacing = 0.1, size = 6").empty()) << "as it is meant";
}

}  // namespace build_test
}  // namespace mallow
