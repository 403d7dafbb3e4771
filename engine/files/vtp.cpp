#include <cstdint>
#include <string>

#include "files/byte_reader.h"
#include "files/byte_writer.h"
#include "files/mesh_materials.h"
#include "files/valid_columns.h"
#include "mallow/errors.h"
#include "mallow/files.h"

/// VTK's XML files: VTK User's Guide, "VTK XML Formats". Arrays stand behind the XML as raw bytes, each with
/// its length in front; the XML says where.
namespace mallow {
namespace {

struct ArrayType {
  const char* name;
  std::size_t bytes;
};
constexpr ArrayType k_float32 = {"Float32", 4};
constexpr ArrayType k_int32 = {"Int32", 4};
constexpr ArrayType k_uint8 = {"UInt8", 1};
constexpr ArrayType k_uint32 = {"UInt32", 4};

/// The two halves of a file of polygons or points.
struct PolyData {
  std::string fields;  ///< of the whole, in XML
  std::string xml;     ///< of the piece
  std::string bytes;

  /// Begins an array; the caller appends its numbers to `bytes`.
  void begin_array(const char* name, const ArrayType& type, std::size_t components, std::size_t count) {
    xml += std::string("<DataArray type=\"") + type.name + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
           std::to_string(components) + "\" format=\"appended\" offset=\"" + std::to_string(bytes.size()) +
           "\"/>\n";
    append_little_endian(bytes, std::uint64_t{type.bytes * components * count});
  }
  void add_vectors(const char* name, const std::vector<Vec3>& vectors) {
    begin_array(name, k_float32, 3, vectors.size());
    for (const Vec3& vector : vectors) append_little_endian(bytes, vector);
  }
  void add_numbers(const char* name, const std::vector<float>& numbers) {
    begin_array(name, k_float32, 1, numbers.size());
    for (const float number : numbers) append_little_endian(bytes, number);
  }
  /// A slot may be given again, in the next generation.
  void add_ids(const std::vector<ParticleId>& ids) {
    begin_array("Id", k_uint32, 1, ids.size());
    for (const ParticleId id : ids) append_little_endian(bytes, slot_of(id));
    begin_array("Generation", k_uint32, 1, ids.size());
    for (const ParticleId id : ids) append_little_endian(bytes, generation_of(id));
  }
  void add_bodies(const char* name, const std::vector<std::uint32_t>& bodies) {
    const ArrayType& type = body_bytes(bodies) == k_uint8.bytes ? k_uint8 : k_uint32;
    begin_array(name, type, 1, bodies.size());
    for (const std::uint32_t body : bodies) append_body(bytes, body, type.bytes);
  }
  /// `first`, `first + stride`, ...
  void add_sequence(const char* name, std::size_t first, std::size_t stride, std::size_t count) {
    begin_array(name, k_int32, 1, count);
    for (std::size_t i = 0; i < count; ++i)
      append_little_endian(bytes, static_cast<std::int32_t>(first + i * stride));
  }
  /// A text for each body; each ends with a zero.
  void add_texts(const char* name, const std::vector<std::string>& texts) {
    fields += std::string("<Array type=\"String\" Name=\"") + name + "\" NumberOfTuples=\"" +
              std::to_string(texts.size()) + "\" format=\"appended\" offset=\"" +
              std::to_string(bytes.size()) + "\"/>\n";
    std::string all;
    for (const std::string& text : texts) (all += text) += '\0';
    append_little_endian(bytes, std::uint64_t{all.size()});
    bytes += all;
  }
  /// What bodies and their materials are called, by the numbers that points have; nothing where there are
  /// none. Throws ConfigError where a point's body has no name.
  void add_names(std::span<const MeshBody> bodies, const std::vector<std::uint32_t>& of_points) {
    if (bodies.empty()) return;
    require_bodies(bodies);
    for (const std::uint32_t body : of_points)
      if (body >= bodies.size())
        throw ConfigError("bodies", std::to_string(bodies.size()) + " are not allowed: number " +
                                        std::to_string(body) + " needs one too");
    const NamedBodies named = name_bodies(bodies, [](const std::string& name) { return name; });
    std::vector<std::string> materials;
    for (const std::size_t material : named.material_of) materials.push_back(named.materials[material].title);
    fields += "<FieldData>\n";
    add_texts("BodyNames", named.titles);
    add_texts("MaterialNames", materials);
    fields += "</FieldData>\n";
  }
  void add_points(const std::vector<Vec3>& positions) {
    xml += "<Points>\n";
    add_vectors("Points", positions);
    xml += "</Points>\n";
  }
};

/// A file of which at most this much is read back has less than 2^31 corners, so that they fit 32 bits.
void write_poly_data(const std::filesystem::path& file, const PolyData& data, std::size_t points,
                     std::size_t vertices, std::size_t polygons) {
  std::string content =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "<PolyData>\n" +
      data.fields + "<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfVerts=\"" +
      std::to_string(vertices) + "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
      std::to_string(polygons) + "\">\n" + data.xml +
      "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
  content += data.bytes;
  content += "\n</AppendedData>\n</VTKFile>\n";
  require_readable_size(file, content.size());
  write_whole(file, content);
}

std::string escaped(const std::string& text) {
  std::string xml;
  for (const char c : text) {
    switch (c) {
      case '&':
        xml += "&amp;";
        break;
      case '<':
        xml += "&lt;";
        break;
      case '"':
        xml += "&quot;";
        break;
      case '\t':
      case '\n':
      case '\r':  // readers make spaces of these in an attribute
        xml += "&#" + std::to_string(static_cast<int>(c)) + ';';
        break;
      default:
        xml += c;
    }
  }
  return xml;
}

}  // namespace

void write_mesh_vtp(const std::filesystem::path& file, const Mesh& mesh, std::span<const MeshBody> bodies) {
  require_valid(mesh);
  PolyData data;
  data.add_names(bodies, mesh.material_ids);
  data.xml += "<PointData>\n";
  if (!mesh.normals.empty()) data.add_vectors("Normals", mesh.normals);
  if (!mesh.velocities.empty()) data.add_vectors("Velocity", mesh.velocities);
  if (!mesh.material_ids.empty()) data.add_bodies("Material", mesh.material_ids);
  data.xml += "</PointData>\n";
  data.add_points(mesh.vertices);
  data.xml += "<Polys>\n";
  data.begin_array("connectivity", k_int32, 1, 3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) append_little_endian(data.bytes, vertex);
  }
  data.add_sequence("offsets", 3, 3, mesh.triangles.size());
  data.xml += "</Polys>\n";
  write_poly_data(file, data, mesh.vertices.size(), 0, mesh.triangles.size());
}

void write_particles_vtp(const std::filesystem::path& file, const ParticleFrame& frame,
                         std::span<const MeshBody> bodies) {
  require_valid(frame);
  const std::size_t count = frame.positions.size();
  PolyData data;
  data.add_names(bodies, frame.bodies);
  data.xml += "<PointData>\n";
  data.add_vectors("Velocity", frame.velocities);
  data.add_bodies("Group", frame.bodies);
  if (frame.ids.empty())
    data.add_sequence("Id", 0, 1, count);
  else
    data.add_ids(frame.ids);
  if (!frame.alphas.empty()) data.add_numbers("Alpha", frame.alphas);
  if (!frame.temperatures.empty()) data.add_numbers("Temperature", frame.temperatures);
  data.xml += "</PointData>\n";
  data.add_points(frame.positions);
  data.xml += "<Verts>\n";
  data.add_sequence("connectivity", 0, 1, count);
  data.add_sequence("offsets", 1, 1, count);
  data.xml += "</Verts>\n";
  write_poly_data(file, data, count, count, 0);
}

void write_pvd(const std::filesystem::path& file, std::span<const TimedFile> frames) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
      "<Collection>\n";
  for (const TimedFile& frame : frames) {
    append_number(text += "<DataSet timestep=\"", frame.time, k_double_digits);
    text += "\" part=\"0\" file=\"" + escaped(frame.file.generic_string()) + "\"/>\n";
  }
  write_whole(file, text + "</Collection>\n</VTKFile>\n");
}

}  // namespace mallow
