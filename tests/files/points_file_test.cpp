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

}  // namespace points_file_test
}  // namespace mallow
