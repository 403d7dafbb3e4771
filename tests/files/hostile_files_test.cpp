#include <fcntl.h>
#include <sys/stat.h>

#include <ctime>
#include <limits>

#include "files/byte_reader.h"
#include "files/file_fixture.h"
#include "files/text_reader.h"

namespace mallow {
namespace hostile_files_test {

struct Hostile {
  const char* name;
  std::string content;
  int line;             ///< that the error must name; 0: none
  const char* message;  ///< part of what it must say
};

void PrintTo(const Hostile& hostile, std::ostream* out) {
  *out << hostile.name;
}

class hostile_mesh : public testing::TestWithParam<Hostile> {};

TEST_P(hostile_mesh, is_refused_with_its_place_and_reason) {
  const TemporaryFolder folder;
  const auto file = folder.file(GetParam().name, GetParam().content);
  const std::clock_t begin = std::clock();
  const Problem problem = io_problem([&] { read_mesh(file); });
  EXPECT_LT(std::clock() - begin, 1 * CLOCKS_PER_SEC);
  EXPECT_EQ(problem.file, file.string());
  EXPECT_EQ(problem.line, GetParam().line) << to_string(problem);
  EXPECT_NE(to_string(problem).find(GetParam().message), std::string::npos) << to_string(problem);
}

const std::string k_vertex_xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string k_face_list = "property list uchar int vertex_indices\n";

std::string ascii_ply(const std::string& vertices, const std::string& faces, const std::string& rows) {
  return "ply\nformat ascii 1.0\nelement vertex " + vertices + "\n" + k_vertex_xyz + "element face " + faces +
         "\n" + k_face_list + "end_header\n" + rows;
}

std::string huge_binary_ply(const std::string& count) {
  return "ply\nformat binary_little_endian 1.0\nelement vertex " + count + "\n" + k_vertex_xyz +
         "element face 1\n" + k_face_list + "end_header\n" + std::string(64, '\0');
}

std::string endless_list_ply() {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex 0\n" + k_vertex_xyz +
                      "element face 1\nproperty list uint int vertex_indices\nend_header\n";
  append_raw(bytes, std::uint32_t{0xffffffff});
  return bytes + std::string(12, '\0');
}

std::string stl_header(std::uint32_t triangles) {
  std::string bytes(80, ' ');
  append_raw(bytes, triangles);
  return bytes;
}

std::string stl_with_nan() {
  std::string bytes = stl_header(1);
  for (int k = 0; k < 12; ++k) append_raw(bytes, k == 7 ? std::numeric_limits<float>::quiet_NaN() : 1.0f);
  return bytes + std::string(2, '\0');
}

std::string garbage() {
  std::string bytes;
  std::uint32_t state = 1;
  for (int k = 0; k < 5000; ++k) bytes += static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  return bytes;
}

const std::string k_three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
const std::string k_rows = "0 0 0\n1 0 0\n0 1 0\n";

INSTANTIATE_TEST_SUITE_P(
    obj, hostile_mesh,
    testing::Values(
        Hostile{"negative.obj", k_three + "f -1 -2 -4\n", 4, "'-4' is not allowed: only 3 vertex lines"},
        Hostile{"zero.obj", k_three + "f 0 1 2\n", 4, "'0' is not allowed: indices begin at 1"},
        Hostile{"beyond.obj", k_three + "\nf 1 2 3\nf 1 2 4\nf 1 2 3\n", 6,
                "index 4 is not allowed: there are 3"},
        Hostile{"beyond_64_bits.obj", k_three + "f 1 2 99999999999999999999\n", 4, "is not allowed: v, v/vt"},
        Hostile{"word.obj", k_three + "f 1 2 x\n", 4, "'x' is not allowed: v, v/vt"},
        Hostile{"slashes.obj", k_three + "f 1/ 2/ 3/\n", 4, "'1/' is not allowed"},
        Hostile{"more_slashes.obj", k_three + "f 1/1/1/1 2 3\n", 4, "'1/1/1/1' is not allowed"},
        Hostile{"two_corners.obj", k_three + "f 1 2\n", 4, "2 corners are not allowed: at least 3"},
        Hostile{"nan.obj", "v 0 0 0\nv 1 nan 0\n", 2, "y: 'nan' is not allowed: a finite number"},
        Hostile{"infinite.obj", "v 0 0 -inf\n", 1, "z: '-inf' is not allowed: a finite number"},
        Hostile{"too_large.obj", "v 0 0 1e39\n", 1, "z: '1e39' is not allowed: a finite number"},
        Hostile{"two_coordinates.obj", "v 0 0\n", 1, "z: is missing"},
        Hostile{"comma.obj", "v 0,5 0 0\n", 1, "x: '0,5' is not allowed"},
        Hostile{"not_one.obj", "hello\nworld\n", 0, "no vertex line"},
        Hostile{"garbage.obj", garbage(), 0, "no vertex line"}, Hostile{"empty.obj", "", 0, "is empty"},
        Hostile{"endless_line.obj", "v 0 0 0\n" + std::string(k_max_line_bytes + 1, ' ') + "\n", 2,
                "the line is too long"}));

INSTANTIATE_TEST_SUITE_P(
    ply, hostile_mesh,
    testing::Values(
        Hostile{"garbage.ply", garbage(), 1, "the first line must be 'ply'"},
        Hostile{"no_format.ply", "ply\nelement vertex 0\nend_header\n", 3, "format: is missing"},
        Hostile{"odd_format.ply", "ply\nformat binary 1.0\n", 2, "'binary' is not allowed: ascii"},
        Hostile{"odd_version.ply", "ply\nformat ascii 2.0\n", 2, "version '2.0' is not allowed: 1.0"},
        Hostile{"odd_keyword.ply", "ply\nformat ascii 1.0\nelment vertex 0\n", 3, "'elment' is not allowed"},
        Hostile{"odd_type.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty real x\n", 4,
                "'real' is not allowed"},
        Hostile{"float_length.ply", "ply\nformat ascii 1.0\nelement face 0\nproperty list float int v\n", 4,
                "'float' is not allowed"},
        Hostile{"early_property.ply", "ply\nformat ascii 1.0\nproperty float x\n", 3, "before any element"},
        Hostile{"twice.ply", "ply\nformat ascii 1.0\nelement a 0\nelement a 0\n", 4, "'a' is given twice"},
        Hostile{"property_twice.ply", "ply\nformat ascii 1.0\nelement a 0\nproperty int x\nproperty int x\n",
                5, "'x' is given twice"},
        Hostile{"negative_count.ply", "ply\nformat ascii 1.0\nelement vertex -1\n", 3, "'-1' is not allowed"},
        Hostile{"no_end.ply", "ply\nformat ascii 1.0\nelement vertex 1\n", 3, "ends before end_header"},
        Hostile{"long_header.ply",
                "ply\nformat ascii 1.0\ncomment " + std::string(600'000, 'a') + "\ncomment " +
                    std::string(600'000, 'a') + "\n",
                4, "the header is too long: at most 1048576 bytes"},
        Hostile{"escape.ply", "ply\nformat ascii 1.0\nelement \x1b[31m 0\nend_header\n", 0,
                "the file has: ?[31m"},
        Hostile{"huge.ply", huge_binary_ply("4000000000"), 9,
                "line 3 promises 4000000000 rows of at least 12 bytes, but 64 bytes are left"},
        Hostile{"overflow.ply", huge_binary_ply("9223372036854775807"), 9,
                "promises 9223372036854775807 rows"},
        Hostile{"beyond_64_bits.ply", huge_binary_ply("99999999999999999999"), 3,
                "is not allowed: a whole number"},
        Hostile{"huge_ascii.ply", ascii_ply("1000000000", "0", "0 0 0\n"), 9, "promises 1000000000 rows"},
        Hostile{"no_properties.ply", "ply\nformat ascii 1.0\nelement air 999999999999\nend_header\n", 4,
                "has no properties"},
        Hostile{"endless_list.ply", endless_list_ply(), 0, "4294967295 corners are not allowed"},
        Hostile{"no_vertex.ply", "ply\nformat ascii 1.0\nelement face 0\nend_header\n", 0,
                "there is no element 'vertex'; the file has: face"},
        Hostile{"no_z.ply",
                "ply\nformat ascii 1.0\nelement vertex 0\nproperty int x\nproperty int y\nelement face "
                "0\nend_header\n",
                0, "lacks 'z'"},
        Hostile{"no_list.ply",
                "ply\nformat ascii 1.0\nelement vertex 0\n" + k_vertex_xyz + "element face 0\nend_header\n",
                0, "needs a list property"},
        Hostile{"nan.ply", ascii_ply("3", "1", "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n"), 11,
                "vertex 1, z: nan is not allowed: a finite number"},
        Hostile{"too_large.ply", ascii_ply("3", "1", "0 0 0\n1e300 0 0\n0 1 0\n3 0 1 2\n"), 11,
                "1e+300 is not allowed: a finite number"},
        Hostile{"beyond.ply", ascii_ply("3", "1", k_rows + "3 0 1 3\n"), 13,
                "vertex index: 3 is not allowed: a whole number from 0 to 2"},
        Hostile{"negative_index.ply", ascii_ply("3", "1", k_rows + "3 0 1 -1\n"), 13, "-1 is not allowed"},
        Hostile{"two_corners.ply", ascii_ply("3", "1", k_rows + "2 0 1\n"), 13, "2 corners are not allowed"},
        Hostile{"short_row.ply", ascii_ply("3", "1", k_rows + "3 0 1\n"), 13, "is missing"},
        Hostile{"long_row.ply", ascii_ply("3", "1", "0 0 0\n1 0 0 0\n0 1 0\n3 0 1 2\n"), 11, "more numbers"},
        Hostile{"big_length.ply", ascii_ply("3", "1", k_rows + "256 0 1 2\n"), 13,
                "256 is not a number of the declared"},
        Hostile{"missing_row.ply", ascii_ply("3", "2", k_rows + "3 0 1 2      \n"), 13,
                "face 1: the file ends"}));

INSTANTIATE_TEST_SUITE_P(
    stl, hostile_mesh,
    testing::Values(
        Hostile{"garbage.stl", garbage(), 0, "but the file has 5000"},
        Hostile{"short.stl", "abc", 0, "this is not an STL file"},
        Hostile{"huge.stl", stl_header(0xffffffff) + std::string(50, '\0'), 0,
                "4294967295 triangles in the header take 214748364834 bytes, but the file has 134"},
        Hostile{"one_byte_short.stl", stl_header(1) + std::string(49, '\0'), 0,
                "take 134 bytes, but the file has 133"},
        Hostile{"one_byte_long.stl", stl_header(1) + std::string(51, '\0'), 0,
                "take 134 bytes, but the file has 135"},
        Hostile{"nan.stl", stl_with_nan(), 0, "triangle 0, corner 1"},
        Hostile{"no_end.stl", "solid a\n", 1, "ends before endsolid"},
        Hostile{"no_endloop.stl",
                "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                "endfacet\nendsolid\n",
                7, "'endfacet' is not allowed here: endloop"},
        Hostile{"cut.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", 4,
                "where 'vertex' must follow"},
        Hostile{"four_corners.stl",
                "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 1 0\n", 7,
                "'vertex' is not allowed here: endloop"},
        Hostile{"nan_text.stl", "solid\nfacet\nouter loop\nvertex 0 nan 0\n", 4, "y: 'nan' is not allowed"}));

INSTANTIATE_TEST_SUITE_P(
    off, hostile_mesh,
    testing::Values(
        Hostile{"garbage.off", garbage(), 1, "is not allowed: OFF"},
        Hostile{"four.off", "4OFF\n1 0 0\n0 0 0 0\n", 1, "'4OFF' is not allowed"},
        Hostile{"binary.off", std::string("OFF BINARY\n\0\0\0", 14), 1, "binary OFF is not supported"},
        Hostile{"huge.off", "OFF\n4000000000 1 0\n0 0 0\n", 2,
                "4000000000 vertex rows and 1 face are promised"},
        Hostile{"huge_faces.off", "OFF\n1 9223372036854775807 0\n0 0 0\n", 2, "9223372036854775807 faces"},
        Hostile{"negative.off", "OFF\n-1 1 0\n0 0 0\n", 2, "'-1' is not allowed"},
        Hostile{"no_counts.off", "OFF\n", 1, "counts: the file ends here"},
        Hostile{"cut.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n                 ", 5, "vertices: the file ends here"},
        Hostile{"nan.off", "OFF\n3 1 0\n0 0 0\n1 NaN 0\n0 1 0\n3 0 1 2\n", 4, "y: 'NaN' is not allowed"},
        Hostile{"beyond.off", "OFF\n3 1 0\n" + k_rows + "3 0 1 3\n", 6,
                "'3' is not allowed: a whole number from 0 to 2"},
        Hostile{"two_corners.off", "OFF\n3 1 0\n" + k_rows + "2 0 1    \n", 6,
                "'2' is not allowed: a whole number from 3"},
        Hostile{"no_vertices.off", "OFF\n0 1 0\n3 0 1 2\n", 3, "there are no vertices"},
        Hostile{"fraction.off", "OFF\n3 1 0\n" + k_rows + "3 0 1 1.5\n", 6, "'1.5' is not allowed"}));

TEST(hostile_file, what_is_not_a_file_is_refused_by_name) {
  const TemporaryFolder folder;
  const auto message = [](const std::filesystem::path& file) {
    return io_problem([&] { read_mesh(file); }).message;
  };
  EXPECT_EQ(message(folder / "missing.obj"), "cannot be read: No such file or directory");
  std::filesystem::create_directory(folder / "folder.ply");
  EXPECT_EQ(message(folder / "folder.ply"), "is a folder; a file is needed");
  ASSERT_EQ(::mkfifo((folder / "pipe.stl").c_str(), 0600), 0);
  EXPECT_EQ(message(folder / "pipe.stl"), "is a device or pipe; a regular file is needed");
  EXPECT_EQ(message(folder.file("a.fbx", "x")),
            "ending '.fbx' is not allowed for a mesh: .obj, .ply, .stl or .off");
  EXPECT_EQ(message(folder.file("none", "x")),
            "ending '' is not allowed for a mesh: .obj, .ply, .stl or .off");
  EXPECT_EQ(io_problem([&] { read_points(folder / "none", 1); }).message,
            "ending '' is not allowed for points: .ply or .csv");
}

TEST(hostile_file, one_beyond_the_size_limit_is_refused_unread) {
  const TemporaryFolder folder;
  const auto file = folder.file("large.obj", "v");
  std::filesystem::resize_file(file, k_max_file_bytes + 1);  // sparse: takes no room
  EXPECT_EQ(io_problem([&] { read_mesh(file); }).message,
            "2147483648 bytes are not allowed: at most 2147483647");
}

TEST(hostile_file, one_with_more_rows_than_the_limit_is_refused_before_they_take_memory) {
  const TemporaryFolder folder;
  const auto file = folder.file(
      "many.ply",
      "ply\nformat binary_little_endian 1.0\nelement vertex 100000001\nproperty uchar x\nproperty uchar y\n"
      "property uchar z\nelement face 0\n" +
          k_face_list + "end_header\n");
  std::filesystem::resize_file(file, 301'000'000);  // sparse: takes no room
  EXPECT_EQ(io_problem([&] { read_mesh(file); }).message, "at most 100000000 rows of an element are allowed");
}

TEST(hostile_file, one_without_permission_is_refused_with_the_reason) {
  if (::getuid() == 0) GTEST_SKIP() << "root may read everything";
  const TemporaryFolder folder;
  const auto file = folder.file("secret.obj", "v 0 0 0\n");
  std::filesystem::permissions(file, std::filesystem::perms::none);
  EXPECT_EQ(io_problem([&] { read_mesh(file); }).message, "cannot be read: Permission denied");
}

TEST(hostile_file, every_truncation_of_a_binary_ply_mesh_is_refused) {
  const TemporaryFolder folder;
  write_mesh_ply(folder / "a.ply", tetrahedron());
  const std::string whole = content_of(folder / "a.ply");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto cut = folder.file("cut.ply", std::string_view(whole).substr(0, length));
    EXPECT_THROW(read_mesh(cut), IoError) << length << " bytes of " << whole.size();
  }
}

TEST(hostile_file, every_truncation_of_an_ascii_ply_mesh_is_refused) {
  const TemporaryFolder folder;
  const std::string whole = ascii_ply("3", "1", k_rows + "3 0 1 2");
  EXPECT_EQ(read_mesh(folder.file("whole.ply", whole)).triangles.size(), 1u)
      << "the last line end may be missing";
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto cut = folder.file("cut.ply", std::string_view(whole).substr(0, length));
    EXPECT_THROW(read_mesh(cut), IoError) << length << " bytes of " << whole.size();
  }
}

}  // namespace hostile_files_test
}  // namespace mallow
