#include "meshes.h"

#include "mallow/level_set.h"
#include "parts.h"

namespace mallow::python {

Mesh MeshObject::checked() const {
  const Mesh& m = mesh();
  const std::size_t count = m.vertices.size();
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (const std::uint32_t corner : m.triangles[t])
      if (corner >= count)
        throw ConfigError("mesh.triangles", "triangle " + std::to_string(t) + " has the vertex " +
                                                std::to_string(corner) + ", but there are " +
                                                std::to_string(count));
  const auto require = [&](const char* name, std::size_t size) {
    if (size != 0 && size != count)
      throw ConfigError(std::string("mesh.") + name, std::to_string(size) +
                                                         " are not allowed: none, or one for each of " +
                                                         std::to_string(count) + " vertices");
  };
  require("normals", m.normals.size());
  require("velocities", m.velocities.size());
  require("material_ids", m.material_ids.size());
  return m;
}

namespace {

/// The column of a mesh as an array of `columns` numbers a row, without a copy.
template <class Scalar, class T>
py::array shown(const MeshObject& mesh, const std::vector<T> Mesh::*column, py::ssize_t columns) {
  const std::vector<T>& values = mesh.mesh().*column;
  const auto count = static_cast<py::ssize_t>(values.size());
  std::vector<py::ssize_t> shape{count}, strides{sizeof(T)};
  if (columns > 1) {
    shape.push_back(columns);
    strides.push_back(sizeof(Scalar));
  }
  if (count == 0) return sealed(py::array(py::dtype::of<Scalar>(), shape));
  return sealed(view_of(reinterpret_cast<const Scalar*>(values.data()), shape, strides, mesh.cell()));
}

template <class Scalar, class T>
void column(py::class_<MeshObject>& mesh, const char* name, std::vector<T> Mesh::*member, py::ssize_t columns,
            const char* text) {
  mesh.def_property(
      name, [member, columns](const MeshObject& self) { return shown<Scalar, T>(self, member, columns); },
      [member](MeshObject& self, std::vector<T> values) { self.set(member, std::move(values)); }, text);
}

void bind_mesh(py::module_& module) {
  py::class_<MeshObject> mesh(module, "Mesh", doc("Mesh"));
  mesh.def(py::init([](std::vector<Vec3> vertices, std::vector<std::array<std::uint32_t, 3>> triangles,
                       std::vector<Vec3> normals, std::vector<Vec3> velocities,
                       std::vector<std::uint32_t> material_ids) {
             return MeshObject(Mesh{std::move(vertices), std::move(triangles), std::move(normals),
                                    std::move(velocities), std::move(material_ids)});
           }),
           py::arg("vertices") = py::tuple(), py::arg("triangles") = py::tuple(),
           py::arg("normals") = py::tuple(), py::arg("velocities") = py::tuple(),
           py::arg("material_ids") = py::tuple())
      .def("__repr__", [](const MeshObject& self) {
        return "Mesh(" + std::to_string(self.mesh().vertices.size()) + " vertices, " +
               std::to_string(self.mesh().triangles.size()) + " triangles)";
      });
  column<float>(mesh, "vertices", &Mesh::vertices, 3, "Places [m], n x 3.");
  column<std::uint32_t>(mesh, "triangles", &Mesh::triangles, 3, "Vertices of each, n x 3.");
  column<float>(mesh, "normals", &Mesh::normals, 3, doc("Mesh.normals"));
  column<float>(mesh, "velocities", &Mesh::velocities, 3, doc("Mesh.velocities"));
  column<std::uint32_t>(mesh, "material_ids", &Mesh::material_ids, 1, doc("Mesh.material_ids"));
}

}  // namespace

void bind_meshes(py::module_& module) {
  bind_mesh(module);
  module.def(
      "bounds", [](const MeshObject& mesh) { return bounds(mesh.mesh()); }, py::arg("mesh"), doc("bounds#9"));
  module.def(
      "place",
      [](const MeshObject& mesh, const Placement& placement, const std::optional<Aabb>& whole) {
        return MeshObject(place(mesh.checked(), placement, whole));
      },
      py::arg("mesh"), py::arg("placement"), py::arg("whole") = std::nullopt, doc("place#2"));
  module.def(
      "welded", [](const MeshObject& mesh) { return MeshObject(welded(mesh.checked())); }, py::arg("mesh"),
      doc("welded"));
  module.def(
      "why_not_closed", [](const MeshObject& mesh) { return why_not_closed(mesh.checked()); },
      py::arg("mesh"), doc("why_not_closed"));
  module.def(
      "mesh_shape",
      [](const MeshObject& mesh, int voxels, int threads) {
        const Mesh copy = mesh.checked();
        const py::gil_scoped_release release;
        return mesh_shape(copy, voxels, threads);
      },
      py::arg("mesh"), py::arg("voxels") = k_mesh_voxels, py::arg("threads") = 0, doc("mesh_shape"));
  module.def(
      "mesh_collider",
      [](const MeshObject& mesh, int voxels, bool inside, int threads) {
        const Mesh copy = mesh.checked();
        const py::gil_scoped_release release;
        return mesh_collider(copy, voxels, inside, threads);
      },
      py::arg("mesh"), py::arg("voxels") = k_mesh_collider_voxels, py::arg("inside") = false,
      py::arg("threads") = 0, doc("mesh_collider"));
}

}  // namespace mallow::python
