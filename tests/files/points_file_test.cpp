#include "files/file_fixture.h"

namespace mallow {
namespace points_file_test {

TEST(points_file, csv_columns_are_found_by_name_in_any_order) {
  const TemporaryFolder folder;
  const Body body =
      read_points(folder.file("a.csv",
                              "# from a scan\n\n z , id, x,vy,vx,vz,y\r\n"
                              "3,first,1,5,4,6,2\r\n\n# comment\n-3.5, ,+1e-3,0,0,0,.5 # end\n"),
                  0.25f);
  EXPECT_EQ(body.positions, (std::vector<Vec3>{{1, 2, 3}, {1e-3f, 0.5f, -3.5f}}));
  EXPECT_EQ(body.velocities, (std::vector<Vec3>{{4, 5, 6}, {0, 0, 0}}));
  EXPECT_EQ(body.spacing, 0.25f);
  EXPECT_EQ(body.velocity, Vec3(0, 0, 0));
}

TEST(points_file, csv_columns_may_be_called_and_separated_as_other_programs_do) {
  const TemporaryFolder folder;
  const auto points = [&](const char* text) { return read_points(folder.file("a.csv", text), 1); };
  for (const char* text : {
           "\"x\",\"y\",\"z\"\n1,2,3\n",
           "X,Y,Z\n\"1\",\" 2 \",3\n",
           "\xEF\xBB\xBF\"Points:0\",\"Points:1\",\"Points:2\"\r\n1,2,3\r\n",
           "Points_2,Points_1,Points_0,Points_Magnitude\n3,2,1,9\n",
           "\"name, of a point\",position_x,position_y,position_z\n\"a, b\",1,2,3\n",
           "x;y;z\n1;2;3\n",
           "x\ty\tz\tnote\n1\t 2\t3\t\n",
           "x [m], y [m], z (m)\n1,2,3\n",
           "x,y,z,Points:0,Points:1,Points:2\n1,2,3,4,5,6\n",
           "# exported\n \"x\" , \"y\" , \"z\" \n# rows\n 1 , 2 , 3 \n",
       }) {
    const Body body = points(text);
    EXPECT_EQ(body.positions, (std::vector<Vec3>{{1, 2, 3}})) << text;
    EXPECT_TRUE(body.velocities.empty()) << text;
  }
  for (const char* text : {
           "\"Velocity:0\",\"Velocity:1\",\"Velocity:2\",\"Points:0\",\"Points:1\",\"Points:2\"\n4,5,6,1,2,"
           "3\n",
           "VX,VY,VZ,X,Y,Z\n4,5,6,1,2,3\n",
           "x;y;z;v_x;v_y;v_z\n1;2;3;4;5;6\n",
       }) {
    const Body body = points(text);
    EXPECT_EQ(body.positions, (std::vector<Vec3>{{1, 2, 3}})) << text;
    EXPECT_EQ(body.velocities, (std::vector<Vec3>{{4, 5, 6}})) << text;
  }
}

TEST(points_file, where_columns_are_missing_those_that_are_there_are_listed) {
  const TemporaryFolder folder;
  const auto problem = [&](const char* text) {
    return io_problem([&] { read_points(folder.file("a.csv", text), 1); }).message;
  };
  EXPECT_EQ(
      problem("time,\"East\",North\n0,1,2\n"),
      "lacks column 'x'; x, y, z are needed, and vx, vy, vz all or none; there are 'time', 'East', 'North'");
  EXPECT_NE(problem("x y z\n1 2 3\n").find("there are 'x y z'"), std::string::npos);
  EXPECT_NE(problem("X,x,y,z\n1,2,3,4\n").find("'x' is given twice"), std::string::npos);
  EXPECT_NE(problem("Points:0,Points_0,Points:1,Points:2\n1,2,3,4\n").find("is given twice"),
            std::string::npos);
  EXPECT_EQ(problem("x,y,\"z\n1,2,3\n"), "a quote is opened, but not closed");
}

TEST(points_file, without_velocity_columns_there_are_no_velocities) {
  const TemporaryFolder folder;
  EXPECT_TRUE(read_points(folder.file("a.csv", "x,y,z\n1,2,3\n"), 1).velocities.empty());
}

TEST(points_file, state_csv_gives_back_the_same_floats) {
  const TemporaryFolder folder;
  const ParticleFrame frame = three_particles();
  write_state_csv(folder / "a.csv", frame);
  const Body body = read_points(folder / "a.csv", 1);
  EXPECT_EQ(body.positions, frame.positions);
  EXPECT_EQ(body.velocities, frame.velocities);
}

TEST(points_file, ply_points_may_come_without_faces_and_from_a_cache) {
  const TemporaryFolder folder;
  const Body plain = read_points(
      folder.file(
          "a.ply",
          "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
          "end_header\n1 2 3\n4 5 6\n"),
      2);
  EXPECT_EQ(plain.positions, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_TRUE(plain.velocities.empty());
  write_particles(folder / "b.ply", three_particles());
  EXPECT_EQ(read_points(folder / "b.ply", 1).velocities, three_particles().velocities);
}

TEST(points_file, a_bad_value_is_named_with_line_column_and_text) {
  const TemporaryFolder folder;
  const auto problem = [&](const char* text) {
    return io_problem([&] { read_points(folder.file("a.csv", text), 1); });
  };
  const Problem word = problem("x,y,z\n1,2,3\n\n1, 2m ,3\n");
  EXPECT_EQ(word.file, (folder / "a.csv").string());
  EXPECT_EQ(word.line, 4);
  EXPECT_EQ(word.column, 4);
  EXPECT_EQ(word.field, "y");
  EXPECT_EQ(word.message, "'2m' is not allowed: a finite number");
  EXPECT_EQ(problem("x,y,z\n1,2,nan\n").field, "z");
  EXPECT_EQ(problem("x,y,z\ninf,2,3\n").field, "x");
  EXPECT_EQ(problem("x,y,z\n1,1e39,3\n").field, "y");
  EXPECT_EQ(problem("x,y,z\n1,,3\n").message, "is missing; a finite number is needed");
  EXPECT_EQ(problem("x,y,z\n1,2\n").message, "2 values in this row, but the header names 3 columns");
  EXPECT_EQ(problem("x,y,z\n1,2,3,\n").message, "4 values in this row, but the header names 3 columns");
  const Problem alpha = problem("x,y,z,alpha\n1,2,3,1\n1,2,4,1.5\n");
  EXPECT_EQ(alpha.line, 3);
  EXPECT_EQ(alpha.field, "alpha");
  EXPECT_EQ(alpha.message, "'1.5' is not allowed: 0 to 1");
  EXPECT_EQ(problem("x,y,z,stiffness\n1,2,3,-1\n").message, "'-1' is not allowed: 0 or more");
  EXPECT_NE(problem("x,y\n1,2\n").message.find("lacks column 'z'"), std::string::npos);
  EXPECT_NE(problem("x,y,z,vx\n1,2,3,4\n").message.find("lacks column 'vy'"), std::string::npos);
  EXPECT_NE(problem("x,y,z,x\n1,2,3,4\n").message.find("'x' is given twice"), std::string::npos);
  EXPECT_NE(problem("1,2,3\n4,5,6\n").message.find("lacks column 'x'"), std::string::npos);
  EXPECT_NE(problem("x,y,z\n# none\n").message.find("no points"), std::string::npos);
  EXPECT_NE(problem("# nothing\n").message.find("names the columns"), std::string::npos);
}

/// A PLY with x, y, z and further properties, "float alpha", and rows of it.
std::string ply_of(const std::vector<std::string>& more, const std::vector<std::string>& rows) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(rows.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\n";
  for (const std::string& property : more) text += "property " + property + '\n';
  text += "end_header\n";
  for (const std::string& row : rows) text += row + '\n';
  return text;
}

TEST(points_file, columns_of_their_own_become_what_particles_have) {
  const TemporaryFolder folder;
  const auto expect_own = [](const Body& body) {
    EXPECT_EQ(body.positions, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}}));
    EXPECT_EQ(body.alpha, (std::vector<float>{0.25f, 1}));
    EXPECT_EQ(body.stiffness, (std::vector<float>{0, 2.5f}));
    EXPECT_EQ(body.plastic_yield, (std::vector<float>{0.125f, 0}));
    EXPECT_EQ(body.temperature, (std::vector<float>{-10, 293.5f}));
    EXPECT_TRUE(body.notes.empty());
  };
  expect_own(read_points(folder.file("a.csv",
                                     "x,temperature [K],y,z,stiffness,alpha,plastic_yield\n"
                                     "1,-10,2,3,0,0.25,0.125\n4,293.5,5,6,2.5,1,0\n"),
                         1));
  expect_own(read_points(folder.file("a.ply", ply_of({"float temperature", "double stiffness", "float alpha",
                                                      "float plastic_yield"},
                                                     {"1 2 3 -10 0 0.25 0.125", "4 5 6 293.5 2.5 1 0"})),
                         1));
  // Each by itself leaves the others as the material has them.
  for (const std::string name : {"alpha", "stiffness", "plastic_yield", "temperature"}) {
    const Body csv = read_points(folder.file("b.csv", "x,y,z," + name + "\n1,2,3,0.5\n"), 1),
               ply = read_points(folder.file("b.ply", ply_of({"float " + name}, {"1 2 3 0.5"})), 1);
    for (const Body* body : {&csv, &ply}) {
      const std::pair<const char*, const std::vector<float>*> members[] = {
          {"alpha", &body->alpha},
          {"stiffness", &body->stiffness},
          {"plastic_yield", &body->plastic_yield},
          {"temperature", &body->temperature}};
      for (const auto& [member, values] : members)
        EXPECT_EQ(*values, name == member ? std::vector<float>{0.5f} : std::vector<float>{})
            << name << member;
    }
  }
}

TEST(points_file, columns_that_are_not_read_are_noted) {
  const TemporaryFolder folder;
  const auto notes = [&](const char* name, const std::string& text) {
    return read_points(folder.file(name, text), 1).notes;
  };
  const std::string read =
      " not read; those that are: x, y, z, vx, vy, vz, alpha, stiffness, plastic_yield, temperature";
  EXPECT_EQ(notes("a.csv", "id,x,y,z,Time,East\n1,1,2,3,0,0\n"),
            std::vector<std::string>{"columns 'Time', 'East' are" + read});
  EXPECT_EQ(notes("a.ply", ply_of({"float vx", "float vy", "float vz", "float nx"}, {"1 2 3 4 5 6 7"})),
            std::vector<std::string>{"column 'nx' is" + read});
  EXPECT_EQ(notes("a.csv", "x,y,z,id,body\n1,2,3,1,1\n"), std::vector<std::string>{});
  // A colour's alpha is 0 to 255, and no particle's.
  const Body color = read_points(
      folder.file("c.ply",
                  ply_of({"uchar red", "uchar green", "uchar blue", "uchar alpha"}, {"1 2 3 9 9 9 255"})),
      1);
  EXPECT_TRUE(color.alpha.empty());
  EXPECT_EQ(color.notes, std::vector<std::string>{"columns 'red', 'green', 'blue', 'alpha' are" + read});
  EXPECT_EQ(read_points(folder.file("d.ply", ply_of({"uchar alpha"}, {"1 2 3 1"})), 1).alpha,
            std::vector<float>{1});
}

TEST(points_file, columns_that_are_nearly_those_are_refused_with_their_name) {
  const TemporaryFolder folder;
  const std::pair<const char*, const char*> cases[] = {
      {"aplha", "'aplha' is not read; did you mean 'alpha'?"},
      {"Plastic_Yeild", "'plastic_yeild' is not read; did you mean 'plastic_yield'?"},
      {"temp", "'temp' is not read; did you mean 'temperature'?"},
      {"stiffnes", "'stiffnes' is not read; did you mean 'stiffness'?"},
      {"youngs_modulus",
       "'youngs_modulus' is not read: give 'stiffness', a factor on the youngs_modulus of the material"},
      {"modulus", "'modulus' is not read: give 'stiffness', a factor on the youngs_modulus of the material"},
  };
  for (const auto& [name, message] : cases) {
    const auto csv_file = folder.file("a.csv", "x,y,z," + std::string(name) + "\n1,2,3,0\n");
    const auto ply_file = folder.file("a.ply", ply_of({"float " + std::string(name)}, {"1 2 3 0"}));
    const Problem csv = io_problem([&] { read_points(csv_file, 1); });
    EXPECT_EQ(csv.message, std::string("column ") + message);
    EXPECT_EQ(csv.line, 1);
    const Problem ply = io_problem([&] { read_points(ply_file, 1); });
    EXPECT_EQ(ply.message, std::string("column ") + message);
    EXPECT_EQ(ply.file, ply_file.string());
  }
  // Beside the right one, or far from any, they are only noted.
  for (const char* header : {"x,y,z,alpha,alpha2\n1,2,3,1,0\n", "x,y,z,mass,u\n1,2,3,1,0\n"})
    EXPECT_EQ(read_points(folder.file("b.csv", header), 1).notes.size(), 1u) << header;
}

TEST(points_file, a_bad_value_of_a_ply_is_named_with_row_and_property) {
  const TemporaryFolder folder;
  const auto problem = [&](const std::string& property, const std::string& value) {
    return io_problem([&] {
      read_points(folder.file("a.ply", ply_of({"float " + property}, {"1 2 3 0.5", "4 5 6 " + value})), 1);
    });
  };
  const Problem alpha = problem("alpha", "1.5");
  EXPECT_EQ(alpha.file, (folder / "a.ply").string());
  EXPECT_EQ(alpha.line, 10);
  EXPECT_EQ(alpha.field, "vertex 1, alpha");
  EXPECT_EQ(alpha.message, "1.5 is not allowed: 0 to 1");
  EXPECT_EQ(problem("alpha", "-0.5").message, "-0.5 is not allowed: 0 to 1");
  EXPECT_EQ(problem("stiffness", "-1").message, "-1 is not allowed: 0 or more");
  EXPECT_EQ(problem("plastic_yield", "-1").message, "-1 is not allowed: 0 or more");
  for (const char* name : {"alpha", "stiffness", "plastic_yield", "temperature"}) {
    EXPECT_EQ(problem(name, "nan").message, "nan is not allowed: a finite number") << name;
    EXPECT_EQ(problem(name, "1e39").message, "1e+39 is not allowed: a finite number") << name;
  }
  EXPECT_NO_THROW(read_points(folder.file("b.ply", ply_of({"float temperature"}, {"1 2 3 -40"})), 1));
}

}  // namespace points_file_test
}  // namespace mallow
