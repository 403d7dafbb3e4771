#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "scene/scene_fixture.h"

namespace mallow {
namespace scene_test {

using scene = SceneFixture;

/// Uses every key of every table. points.csv and tetra.off need to be beside it only to be there.
const std::string k_every_key = R"([solver]
time_step = 0.1
time_step_factor = 0.5
support_radius = 2
gravity = [0, 0, -1]
update_interval = 7
formulation = "printed"
acoustic_limit = false
contact = "pressure"
contact_offset = 0.25
wall_pressure = false
volume_iterations = 3
volume_tolerance = 0.25
sleep_speed = 0.5
sleep_time = 2
air_temperature = [[0, 290], [5, 280]]
rotation_iterations = 2
neighbor_slack = 0.125
arithmetic = "native"
memory_limit = 0.5
instruction_level = ")" + std::string(name(InstructionLevel::baseline)) +
                                R"("
[[material]]
name = "jelly \"red\""
alpha = [[0.0, 0.1], [1.5, 1]]
update_threshold = 1.5
plastic_yield = 0.0625
plastic_yield_by_temperature = [[303, 0.5], [309, 0.25]]
plastic_creep = 0.5
merge_flow = 0.25
tear_strain = 0.75
pressure_coefficient = 2.5
viscosity = 0.75
elastic_time_step = 0.05
particle_mass = 1.25
rest_density = 1.125
cohesion = 0.5
friction = 0.25
adhesion = 3.5
damping_time = 0.01
deformation_damping = 0.125
region_radius = 2.25
region_stride = 3
temperature = 300
conductivity = 0.25
specific_heat = 1600
latent_heat = 45000
solidus = 303
liquidus = 309
heat_transfer = 12
alpha_by_temperature = [[303, 0], [309, 1]]
viscosity_by_temperature = [[303, 2], [309, 0.5]]
color = [1, 0.5, 0]
finish = "clay"
[[body]]
material = "jelly \"red\""
group = "g"
velocity = [1, 2, 3]
box = { count = [2, 3, 4], spacing = 0.1, corner = [5, 6, 7], jitter = 0.0625 }
paint = [{ sphere = { radius = 2 }, translate = [5, 6, 7], rotate = [0, 90, 0], alpha = 0.5, stiffness = 0.25, plastic_yield = 0.125, temperature = 310 },
         { plane = {}, alpha = 0.75 }]
[[body]]
material = "jelly \"red\""
sphere = { center = [20, 0, 0], radius = 2, count = 30, jitter = 0.125 }
[[body]]
material = "jelly \"red\""
sphere = { radius = 2, spacing = 0.5 }
[[body]]
material = "jelly \"red\""
skin = "tetra.off"
mesh = { file = "tetra.off", spacing = 0.5, jitter = 0.25, rotate = [90, 0, 0], size = 3, center = [9, 9, 9] }
[[body]]
material = "jelly \"red\""
mesh = { file = "tetra.off", count = 50 }
[[body]]
material = "jelly \"red\""
points = { file = "points.csv", spacing = 0.1 }
[[body]]
material = "jelly \"red\""
implicit = { shape = "moai", spacing = 0.5, jitter = 0.25, rotate = [90, 0, 0], size = 3, center = [9, 9, 9] }
[[body]]
material = "jelly \"red\""
implicit = { shape = "moai", count = 500 }
[[collider]]
plane = { normal = [0, 1, 0], offset = -3 }
translate = [1, 2, 3]
rotate = [0, 0, 90]
velocity = [0, 0, 0.5]
angular_velocity = [0, 0.25, 0]
surface_velocity = [0, 0.5, 0]
restitution = 0.25
friction = 0.125
temperature = [[0, 330], [20, 280]]
heat_transfer = 500
visible = false
[[collider]]
sphere = { center = [1, 2, 3], radius = 4, inside = true }
[[collider]]
box = { min = [-1, -2, -3], max = [1, 2, 3], inside = true }
[[collider]]
union = [
  { plane = { normal = [1, 0, 0], offset = 2 } },
  { sphere = { center = [1, 2, 3], radius = 4, inside = true } },
  { box = { min = [-1, -2, -3], max = [1, 2, 3], inside = true } },
  { capsule = { start = [1, 2, 3], end = [4, 5, 6], radius = 0.5, inside = true } },
  { cylinder = { start = [1, 2, 3], end = [4, 5, 6], radius = 0.5, inside = true } },
  { cone = { start = [1, 2, 3], end = [4, 5, 6], start_radius = 0.5, end_radius = 0.25, inside = true } },
  { hull = { file = "tetra.off", inside = true } },
  { mesh = { file = "tetra.off", voxels = 8, size = 3, center = [9, 9, 9], inside = true } },
]
[[collider]]
capsule = { start = [1, 2, 3], end = [4, 5, 6], radius = 0.5, inside = true }
[[collider]]
cylinder = { start = [1, 2, 3], end = [4, 5, 6], radius = 0.5, inside = true }
[[collider]]
cone = { start = [1, 2, 3], end = [4, 5, 6], start_radius = 0.5, end_radius = 0.25, inside = true }
[[collider]]
hull = { file = "tetra.off", inside = true }
[[collider]]
mesh = { file = "tetra.off", voxels = 8, size = 3, center = [9, 9, 9], inside = true }
[[collider]]
hull = { points = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4.5]] }
keyframes = [{ time = 0.5, translate = [1, 2, 3] }, { time = 1.5, translate = [4, 5, 6], rotate = [0, 0, 90] }]
[[pin]]
box = { min = [0, 0, 0], max = [1, 1, 0] }
velocity = [0, 0, 2]
[[emitter]]
material = "jelly \"red\""
radius = 2
spacing = 0.5
translate = [20, 0, 9]
rotate = [180, 0, 0]
velocity = [0.5, 0, 0]
speed = 1.5
start = 1
stop = 7
jitter = 0.1
most_particles = 5000
merges = true
[[emitter]]
material = "jelly \"red\""
width = 2
height = 3
spacing = 0.5
speed = [[0, 1.5], [2, 0]]
keyframes = [{ time = 0.5, translate = [1, 2, 3] }, { time = 2.5, translate = [4, 5, 6], rotate = [90, 0, 0] }]
[[emitter]]
material = "jelly \"red\""
points = [[0, 0, 0], [0.5, 0, 0], [0, 0.75, 2]]
spacing = 0.5
translate = [40, 0, 9]
[[sink]]
box = { min = [0, 0, -9], max = [1, 1, -5] }
outside = false
[surface]
voxels_per_spacing = 3.5
voxel_size = 0.5
voxels = 64
kernel_radius = 3
particle_radius = 0.25
[run]
frames = 0
frame_time = 0.3
[render]
environment = "tetra.off"
width = 320
height = 240
samples = 1
eye = [1, 2, 3]
target = [4, 5, 6]
field_of_view = 50
frames_per_second = 24
)";

class every_key : public SceneFixture {
 protected:
  every_key() {
    write("tetra.off", "OFF\n4 4 0\n0 0 0\n4 0 0\n0 4 0\n0 0 4\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
    write("points.csv", "x,y,z\n0,0,0\n0.1,0,0\n");
  }
};

TEST_F(scene, fills_in_the_defaults_of_the_configs) {
  const Scene read = SceneFixture::read(k_small_scene);
  EXPECT_EQ(read.solver.support_radius, 2.0f);
  EXPECT_EQ(read.solver.time_step, SolverConfig{}.time_step);
  EXPECT_EQ(read.solver.gravity, SolverConfig{}.gravity);
  EXPECT_EQ(read.run.frames, RunConfig{}.frames);
  EXPECT_FALSE(read.run.frame_time);
  EXPECT_FALSE(read.surface.voxels || read.surface.voxel_size);
  EXPECT_EQ(read.surface.voxels_per_spacing, SurfaceConfig{}.voxels_per_spacing);
  ASSERT_EQ(read.materials.size(), 1u);
  EXPECT_EQ(read.materials[0].material.update_threshold, Material{}.update_threshold);
  EXPECT_EQ(read.materials[0].finish, Finish::jelly);
  ASSERT_EQ(read.bodies.size(), 1u);
  EXPECT_EQ(read.bodies[0].group, "");
  EXPECT_EQ(read.bodies[0].line, 5);
  EXPECT_TRUE(read.colliders.empty());
}

TEST_F(every_key, reaches_its_member) {
  const Scene read = SceneFixture::read(k_every_key);
  EXPECT_EQ(read.solver.time_step, 0.1f);
  EXPECT_EQ(read.solver.gravity, Vec3(0, 0, -1));
  EXPECT_EQ(read.solver.time_step_factor, 0.5f);
  EXPECT_EQ(read.solver.memory_limit, 0.5f);
  EXPECT_EQ(read.solver.update_interval, 7);
  EXPECT_EQ(read.solver.formulation, Formulation::printed);
  EXPECT_FALSE(read.solver.acoustic_limit);
  EXPECT_EQ(read.solver.contact_offset, 0.25f);
  EXPECT_FALSE(read.solver.wall_pressure);
  EXPECT_EQ(read.solver.volume_iterations, 3);
  EXPECT_EQ(read.solver.volume_tolerance, 0.25f);
  EXPECT_EQ(read.solver.rotation_iterations, 2);
  EXPECT_EQ(read.solver.neighbor_slack, 0.125f);
  EXPECT_EQ(read.solver.arithmetic, Arithmetic::native);
  EXPECT_EQ(read.solver.instruction_level, InstructionLevel::baseline);

  const SceneMaterial& material = read.materials.at(0);
  EXPECT_EQ(material.name, "jelly \"red\"");
  ASSERT_EQ(material.material.alpha.keys().size(), 2u);
  EXPECT_EQ(material.material.alpha.keys()[1].time, 1.5f);
  EXPECT_EQ(material.material.alpha.keys()[1].value, 1.0f);
  EXPECT_EQ(material.material.update_threshold, 1.5f);
  EXPECT_EQ(material.material.plastic_yield, 0.0625f);
  EXPECT_EQ(material.material.plastic_creep, 0.5f);
  EXPECT_EQ(material.material.merge_flow, 0.25f);
  EXPECT_EQ(material.material.tear_strain, 0.75f);
  EXPECT_EQ(material.material.pressure_coefficient, 2.5f);
  EXPECT_EQ(material.material.viscosity, 0.75f);
  EXPECT_EQ(material.material.elastic_time_step, 0.05f);
  EXPECT_EQ(material.material.particle_mass, 1.25f);
  EXPECT_EQ(material.material.rest_density, 1.125f);
  EXPECT_EQ(material.material.cohesion, 0.5f);
  EXPECT_EQ(material.material.region_radius, 2.25f);
  EXPECT_EQ(material.material.region_stride, 3);
  EXPECT_EQ(material.color, Vec3(1, 0.5f, 0));
  EXPECT_EQ(material.finish, Finish::clay);

  ASSERT_EQ(read.bodies.size(), 8u);
  EXPECT_EQ(read.bodies[0].group, "g");
  EXPECT_EQ(read.bodies[0].velocity, Vec3(1, 2, 3));
  const auto& lattice = std::get<Lattice>(read.bodies[0].source);
  EXPECT_EQ(lattice.count, (std::array<int, 3>{2, 3, 4}));
  EXPECT_EQ(lattice.spacing, 0.1f);
  EXPECT_EQ(lattice.corner, Vec3(5, 6, 7));
  EXPECT_EQ(lattice.jitter, 0.0625f);
  const auto& ball = std::get<SphereSource>(read.bodies[1].source);
  EXPECT_EQ(ball.center, Vec3(20, 0, 0));
  EXPECT_EQ(ball.radius, 2.0f);
  EXPECT_EQ(ball.sampling.count, 30);
  EXPECT_FALSE(ball.sampling.spacing);
  EXPECT_EQ(ball.sampling.jitter, 0.125f);
  EXPECT_EQ(read.bodies[2].skin, "");
  EXPECT_EQ(read.bodies[3].skin, "tetra.off");
  const auto& mesh = std::get<MeshSource>(read.bodies[3].source);
  EXPECT_EQ(mesh.file, "tetra.off");
  EXPECT_EQ(mesh.sampling.spacing, 0.5f);
  EXPECT_EQ(mesh.placement.rotate, Vec3(90, 0, 0));
  EXPECT_EQ(mesh.placement.size, 3.0f);
  EXPECT_EQ(mesh.placement.center, Vec3(9, 9, 9));
  EXPECT_EQ(std::get<PointsSource>(read.bodies[5].source).spacing, 0.1f);
  EXPECT_EQ(std::get<ImplicitSource>(read.bodies[7].source).sampling.count, 500);

  ASSERT_EQ(read.colliders.size(), 10u);
  EXPECT_EQ(std::get<Plane>(read.colliders[0].shape).offset, -3.0f);
  EXPECT_EQ(read.colliders[0].pose.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(read.colliders[0].pose.rotation.z(), std::sqrt(0.5), 1e-7);
  EXPECT_EQ(read.colliders[0].velocity, Vec3(0, 0, 0.5f));
  EXPECT_EQ(read.colliders[0].angular_velocity, Vec3(0, 0.25f, 0));
  EXPECT_EQ(read.colliders[1].pose.rotation, Eigen::Vector4d(0, 0, 0, 1));
  EXPECT_EQ(read.colliders[0].restitution, 0.25f);
  EXPECT_EQ(read.colliders[0].friction, 0.125f);
  EXPECT_FALSE(read.colliders[0].visible);
  EXPECT_TRUE(read.colliders[1].visible);
  EXPECT_TRUE(std::get<Sphere>(read.colliders[1].shape).inside);
  EXPECT_EQ(std::get<Box>(read.colliders[2].shape).min, Vec3(-1, -2, -3));
  const auto& parts = std::get<Union>(read.colliders[3].shape).parts;
  ASSERT_EQ(parts.size(), 8u);
  EXPECT_NEAR(nearest(std::get<ConvexHull>(read.colliders[7].shape), {1, 1, 0.25f}).distance, 0.25f, 1e-6f);
  EXPECT_TRUE(std::get<ConvexHull>(parts[6]).inside);
  EXPECT_NEAR(bounds(std::get<DistanceField>(read.colliders[8].shape)).max.x(), 10.5f, 0.2f);
  EXPECT_TRUE(std::get<DistanceField>(read.colliders[8].shape).inside);
  EXPECT_EQ(nearest(std::get<ConvexHull>(read.colliders[9].shape), {1, 1, -2}).distance, 2);
  ASSERT_EQ(read.colliders[9].keyframes.size(), 2u);
  EXPECT_EQ(read.colliders[9].keyframes[1].time, 1.5);
  EXPECT_EQ(read.colliders[9].keyframes[1].pose.translation, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(read.colliders[9].pose.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(std::get<Box>(parts[2]).max, Vec3(1, 2, 3));
  EXPECT_EQ(std::get<Capsule>(read.colliders[4].shape).end, Vec3(4, 5, 6));
  EXPECT_TRUE(std::get<Cylinder>(read.colliders[5].shape).inside);
  EXPECT_EQ(std::get<Cone>(read.colliders[6].shape).end_radius, 0.25f);
  EXPECT_EQ(std::get<Cone>(parts[5]).start, Vec3(1, 2, 3));

  EXPECT_EQ(read.emitters.at(1).keyframes.size(), 2u);
  EXPECT_EQ(read.emitters.at(1).keyframes[1].pose.translation, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(read.emitters.at(1).pose.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(read.emitters.at(1).speed.at(1), 0.75f);
  EXPECT_EQ(read.emitters.at(2).points, (std::vector<Vec3>{{0, 0, 0}, {0.5f, 0, 0}, {0, 0.75f, 2}}));

  EXPECT_EQ(read.pins.at(0).box.max, Vec3(1, 1, 0));
  EXPECT_EQ(read.pins.at(0).velocity, Vec3(0, 0, 2));
  EXPECT_EQ(read.surface.voxels_per_spacing, 3.5f);
  EXPECT_EQ(read.surface.voxels, 64);
  EXPECT_EQ(read.surface.voxel_size, 0.5f);
  EXPECT_EQ(read.surface.kernel_radius, 3.0f);
  EXPECT_EQ(read.surface.particle_radius, 0.25f);
  EXPECT_EQ(read.run.frames, 0);
  EXPECT_EQ(read.run.frame_time, 0.3);
  EXPECT_EQ(read.render.width, 320);
  EXPECT_EQ(read.render.height, 240);
  EXPECT_EQ(read.render.samples, 1);
  EXPECT_EQ(read.render.eye, Vec3(1, 2, 3));
  EXPECT_EQ(read.render.target, Vec3(4, 5, 6));
  EXPECT_EQ(read.render.field_of_view, 50.0f);
  EXPECT_EQ(read.render.frames_per_second, 24);
}

/// The first column of describe_scene_keys().
std::set<std::string> described_keys() {
  std::set<std::string> keys;
  std::istringstream lines(describe_scene_keys());
  for (std::string line; std::getline(lines, line);)
    if (!line.starts_with('#')) keys.insert(line.substr(0, line.find(' ')));
  return keys;
}

TEST_F(every_key, that_is_described_is_known_to_the_reader) {
  // A key that is known complains about the value alone; one that is not says so.
  for (std::string key : described_keys()) {
    const std::string path = key;
    std::map<std::string, int> index{{"sphere", 1}, {"mesh", 3}, {"points", 5}, {"implicit", 6}};
    int element = 0;
    if (key.starts_with("body[].") && key.find('.', 7) != std::string::npos)
      element = index[key.substr(7, key.find('.', 7) - 7)];
    const std::vector<std::string> shapes{"plane",    "sphere", "box",  "capsule",
                                          "cylinder", "cone",   "hull", "mesh"};
    for (std::size_t kind = 0; kind < shapes.size(); ++kind) {
      // The union stands after the first three.
      if (key.starts_with("collider[]." + shapes[kind] + '.'))
        element = static_cast<int>(kind < 3 ? kind : kind + 1);
      if (const auto at = key.find("union[]." + shapes[kind] + '.'); at != std::string::npos)
        key.insert(at + 6, std::to_string(kind));
    }
    if (key.starts_with("collider[].union")) element = 3;
    if (const auto at = key.find("keyframes[]"); at != std::string::npos) {
      key.insert(at + 10, "0");
      element = key.starts_with("emitter") ? 1 : 9;
    }
    if (key == "collider[].hull.points") element = 9;
    if (key == "emitter[].points") element = 2;
    if (const auto at = key.find("paint[]"); at != std::string::npos) key.insert(at + 6, "0");
    if (const auto at = key.find("[]"); at != std::string::npos) key.insert(at + 1, std::to_string(element));
    const auto found = problems(k_every_key, {key + "=1979-05-27"});
    ASSERT_FALSE(found.empty()) << key;
    const std::string start = "--set " + key + "=1979-05-27: " + key + ": a date or time is not allowed: ";
    EXPECT_TRUE(
        std::any_of(found.begin(), found.end(), [&](const auto& text) { return text.starts_with(start); }))
        << path << '\n'
        << found.front();
  }
}

TEST_F(every_key, is_described_once_and_printed) {
  std::istringstream lines(describe_scene_keys());
  std::set<std::string> keys;
  // Of two keys that say the same only one may be there.
  const std::string interval = "update_interval = 7", in_seconds = "update_period = 3";
  std::string other = k_every_key;
  other.replace(other.find(interval), interval.size(), in_seconds);
  const std::string spring = "elastic_time_step = 0.05";
  other.replace(other.find(spring), spring.size(), "youngs_modulus = 3");
  const std::string printed =
      print_scene(SceneFixture::read(k_every_key)) + print_scene(SceneFixture::read(other));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#')) continue;
    const std::string key = line.substr(0, line.find(' '));
    EXPECT_TRUE(keys.insert(key).second) << key << " is described twice";
    EXPECT_NE(printed.find(key.substr(key.rfind('.') + 1) + " = "), std::string::npos) << key;
  }
  for (const char* deep :
       {"solver.time_step", "body[].implicit.jitter", "collider[].union[].box.inside", "pin[].box.max"})
    EXPECT_TRUE(keys.contains(deep)) << deep;
}

TEST_F(every_key, stands_below_the_shapes_that_it_may_be_of) {
  const std::string described = describe_scene_keys();
  const auto has = [&](const std::string& line) { return described.find(line) != described.npos; };
  EXPECT_TRUE(has("\n# body[]: exactly one of box, sphere, mesh, points, implicit gives its shape\n"));
  const std::string shapes = "plane, sphere, box, capsule, cylinder, cone, hull, mesh, union";
  EXPECT_TRUE(has("\n# collider[]: exactly one of " + shapes + " gives its shape\n"));
  EXPECT_TRUE(has("\n# body[].paint[]: exactly one of " + shapes + " gives its shape\n"));
}

TEST_F(every_key, says_what_holds_where_nothing_flows) {
  const std::string described = describe_scene_keys();
  EXPECT_NE(described.find("left out: no strain flows; update_threshold alone reshapes it"), described.npos);
}

TEST_F(every_key, survives_printing) {
  const std::string printed = print_scene(SceneFixture::read(k_every_key));
  EXPECT_EQ(print_scene(read_scene(write("printed.toml", printed))), printed);
  EXPECT_NE(printed.find("alpha = [[0.0, 0.1], [1.5, 1.0]]"), std::string::npos) << printed;
}

TEST_F(scene, prints_what_is_left_out_as_a_comment) {
  const std::string printed = print_scene(SceneFixture::read(k_small_scene));
  EXPECT_NE(printed.find("\n# frame_time: solver.time_step\n"), std::string::npos) << printed;
  const Scene again = read_scene(write("printed.toml", printed));
  EXPECT_FALSE(again.run.frame_time);
  EXPECT_EQ(print_scene(again), printed);
}

TEST_F(scene, prints_numbers_that_read_back_to_the_bit) {
  for (const float value : {0.1f, 1.4666667f, 1e-7f, 3.4028235e38f, 1e-45f, 16777216.0f, 0.33333334f}) {
    Scene read = SceneFixture::read(k_small_scene);
    read.solver.time_step = value;
    const Scene again = read_scene(write("printed.toml", print_scene(read)));
    EXPECT_EQ(again.solver.time_step, value);
  }
  for (const double value : {0.1, 1.0 / 24, 0.041666667, 1e-300, 1e300}) {
    Scene read = SceneFixture::read(k_small_scene);
    read.run.frame_time = value;
    EXPECT_EQ(read_scene(write("printed.toml", print_scene(read))).run.frame_time, value);
  }
}

TEST_F(scene, takes_the_short_form_of_an_implicit_shape) {
  const Scene read =
      SceneFixture::read(k_small_scene, {"body[0]={ material = \"jelly\", implicit = \"moai\" }"});
  const auto& source = std::get<ImplicitSource>(read.bodies[0].source);
  EXPECT_EQ(source.shape, "moai");
  EXPECT_EQ(source.sampling.count, 3764);
}

TEST_F(scene, can_be_overridden) {
  const Scene read = SceneFixture::read(
      k_small_scene, {"solver.time_step=0.1", "material[0].alpha=0.5", "run.frames = 10",
                      "solver.formulation=printed", "solver.gravity=[0, 0, -1]", "body[0].box.count[2]=5",
                      "material.jelly.viscosity=0.25", "solver.instruction_level=x86-64-v3"});
  EXPECT_EQ(read.solver.time_step, 0.1f);
  EXPECT_EQ(read.materials[0].material.alpha.at(0), 0.5f);
  EXPECT_EQ(read.run.frames, 10);
  EXPECT_EQ(read.solver.formulation, Formulation::printed);
  EXPECT_EQ(read.solver.gravity, Vec3(0, 0, -1));
  EXPECT_EQ(std::get<Lattice>(read.bodies[0].source).count[2], 5);
  EXPECT_EQ(read.materials[0].material.viscosity, 0.25f);
  EXPECT_EQ(read.solver.instruction_level, InstructionLevel::v3);
}

TEST_F(scene, refuses_a_camera_that_looks_at_itself) {
  const std::string text = k_small_scene + "[render]\neye = [1, 2, 3]\ntarget = ";
  EXPECT_EQ(
      problems(text + "[1, 2, 3]\n"),
      std::vector<std::string>{"scene.toml:10:10: render.target: is not allowed where render.eye is: the "
                               "camera stands at eye and looks at target"});
  EXPECT_TRUE(problems(text + "[1, 2, 4]\n").empty());
}

TEST_F(scene, calls_the_keys_of_what_follows_temperature_temperatures) {
  const auto of = [&](const std::string& keys) {
    return problems(
        "[solver]\nsupport_radius = 2.0\n[[material]]\nname = \"jelly\"\nalpha_by_temperature = " + keys +
        k_small_scene.substr(k_small_scene.find("\n[[body]]")));
  };
  const std::string where = "scene.toml:5:35: material[0].alpha_by_temperature[1]: ";
  EXPECT_EQ(
      of("[[310, 1], [300, 0.1]]"),
      std::vector<std::string>{where + "temperature 300.0 is not allowed: a temperature above 310.0, that "
                                       "of the key before"});
  EXPECT_EQ(of("[[310, 1], 3]"),
            std::vector<std::string>{where + "3 is not allowed: two numbers [temperature, number]"});
  const auto words = of("true");
  ASSERT_EQ(words.size(), 1u);
  EXPECT_NE(words[0].find("[[temperature, number], ...] with temperatures that increase"), words[0].npos)
      << words[0];
}

TEST_F(scene, takes_the_last_of_two_overrides) {
  EXPECT_EQ(SceneFixture::read(k_small_scene, {"run.frames=10", "run.frames=20"}).run.frames, 20);
}

TEST_F(scene, names_the_override_that_is_wrong) {
  const std::pair<const char*, const char*> cases[] = {
      {"solver.time_step=-1", "solver.time_step: -1 is not allowed: a number > 0"},
      {"solver.tim_step=1", "solver: unknown key 'tim_step'; did you mean 'time_step'?"},
      {"run.frames=ten", "run.frames: \"ten\" (a string) is not allowed: a whole number in [0, 2147483647]"},
      {"material[1].alpha=0", "material[1].alpha: does not exist: there are 1, counted from 0"},
      {"material.jam.alpha=0",
       "material.jam.alpha: does not exist: no material has the name 'jam'; known are jelly, rubber, "
       "gelatin, "
       "plasticine, clay, dough, butter, chocolate, toothpaste, shaving_cream, mayonnaise, ketchup, honey "
       "and water"},
      {"pin[0].velocity=[0,0,1]", "pin[0].velocity: does not exist: there is none"},
      {"material.jely.alpha=0",
       "material.jely.alpha: does not exist: no material has the name 'jely'; did you mean 'jelly'?"},
      {"material.jelly={alpha=0.1}",
       "material.jelly: is a whole material: give one key of it at a time, as material.jelly.alpha=0.1"},
      {"material.butter={alpha=0.1}",
       "material.butter: is a whole material: give one key of it at a time, as material.butter.alpha=0.1"},
      {"body.group=1",
       "body.group: does not exist: none of these has the name 'group'; the first is body[0].group"},
      {"solver.time_step.x=1", "solver.time_step.x: does not exist: this is not a table"},
      {"solver[0]=1", "solver[0]: does not exist: this is not a list"},
      {"bodies[0].merges=true", "bodies[0].merges: unknown key 'bodies'; did you mean 'body'?"},
      {"solver.time_step", "is not of the form section.key=value or list[0].key=value"},
      {"solver..time_step=1", "is not of the form section.key=value or list[0].key=value"},
      {"body[x].group=1", "is not of the form section.key=value or list[0].key=value"},
      {"=1", "is not of the form section.key=value or list[0].key=value"},
  };
  const std::string text =
      "[solver]\ntime_step = 0.15\n" + k_small_scene.substr(k_small_scene.find('\n') + 1);
  for (const auto& [given, problem] : cases)
    EXPECT_EQ(problems(text, {given}),
              std::vector<std::string>{std::string("--set ") + given + ": " + problem});
  const auto broken = problems(text, {"solver.gravity=[0, 1"});
  ASSERT_EQ(broken.size(), 1u);
  EXPECT_TRUE(broken[0].starts_with("--set solver.gravity=[0, 1: solver.gravity: ")) << broken[0];
}

TEST_F(scene, names_the_override_that_clashes_with_what_stands_in_the_file) {
  const std::string text =
      k_small_scene +
      "[[emitter]]\nmaterial = \"jelly\"\nradius = 2\nspacing = 1\nstop = 4.8\n[[sink]]\n"
      "box = { min = [0, 0, 0], max = [1, 1, 1] }\n[[collider]]\nplane = {}\nvelocity = [0, 0, "
      "1]\n";
  const std::string with_update = "[solver]\nupdate_interval = 20\n" + text.substr(text.find('\n') + 1);
  const std::pair<const char*, const char*> cases[] = {
      {"emitter[0].start=5", "emitter[0].stop: 4.8 is not allowed: after start, 5 s, or it never flows"},
      {"emitter[0].width=5", "emitter[0].radius: is not allowed beside width"},
      {"emitter[0].radius=9000", "emitter[0].spacing: makes layers of over a million particles"},
      {"solver.update_period=5", "solver.update_interval: is not allowed beside update_period"},
      {"sink[0].box.min=[0,0,2]", "sink[0].box.max: "},
      {"collider[0].keyframes=[{time=1}]", "collider[0].velocity: is not allowed beside keyframes"},
  };
  for (const auto& [given, problem] : cases) {
    const auto found = problems(with_update, {given, "emitter[0].jitter=0.1"});
    ASSERT_FALSE(found.empty()) << given;
    EXPECT_TRUE(found[0].starts_with(std::string("--set ") + given + ": " + problem)) << found[0];
  }
  const auto in_file = problems(with_update +
                                    "[[emitter]]\nmaterial = \"jelly\"\nradius = 2\nspacing = 1\nstart "
                                    "= 5\nstop = 4.8\n",
                                {"emitter[1].jitter=0.1"});
  ASSERT_EQ(in_file.size(), 1u);
  EXPECT_TRUE(in_file[0].starts_with("scene.toml:")) << in_file[0];
}

TEST_F(scene, shows_problems_of_overrides_after_those_of_the_file) {
  const auto found = problems(k_small_scene + "[run]\nframes = -2\n", {"solver.time_step=-1"});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_TRUE(found[0].starts_with("scene.toml:9:10: run.frames: -2 ")) << found[0];
  EXPECT_TRUE(found[1].starts_with("--set solver.time_step=-1: ")) << found[1];
}

TEST(scene_files, all_load_and_print) {
  std::size_t read = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(MALLOW_DATA_DIR "/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    std::string text;
    try {
      text = print_scene(read_scene(entry.path()));
    } catch (const ConfigError& error) {
      // A mesh that a script fetches may not be there; everything else must be right.
      for (const Problem& problem : error.problems())
        EXPECT_NE(problem.message.find("there is no file"), std::string::npos) << to_string(problem);
      continue;
    }
    ++read;
    EXPECT_FALSE(text.empty()) << entry.path();
  }
  EXPECT_GE(read, 6u);
}

TEST(scene_files, cube_shows_every_key) {
  std::ifstream stream(MALLOW_DATA_DIR "/scenes/cube.toml");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  for (const std::string& key : described_keys())
    EXPECT_NE(text.find(key.substr(key.rfind('.') + 1) + " = "), std::string::npos) << key;
}

}  // namespace scene_test
}  // namespace mallow
