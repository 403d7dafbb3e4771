#include <pybind11/functional.h>

#include "config/field_tables.h"
#include "live.h"
#include "mallow/body.h"
#include "mallow/level_set.h"
#include "mallow/mesh.h"
#include "parts.h"

namespace mallow::python {
namespace {

void bind_points(py::module_& module) {
  Struct<Body>(module, "Body", Change::live)
      .field("positions", &Body::positions, "", "an array of n x 3 numbers")
      .field("spacing", &Body::spacing)
      .field("velocity", &Body::velocity, "", "3 numbers")
      .field("velocities", &Body::velocities, "", "an array of n x 3 numbers")
      .field("alpha", &Body::alpha, "", "an array of numbers")
      .field("plastic_yield", &Body::plastic_yield, "", "an array of numbers")
      .field("stiffness", &Body::stiffness, "", "an array of numbers")
      .field("temperature", &Body::temperature, "", "an array of numbers")
      .field("merges", &Body::merges)
      .field("splits", &Body::splits)
      .field("notes", &Body::notes, "", "a list of words")
      .done()
      .def("__len__", [](const Body& body) { return body.positions.size(); })
      .def("__repr__", [](const Body& body) {
        return "Body(" + std::to_string(body.positions.size()) +
               " points, spacing=" + py::repr(py::float_(body.spacing)).cast<std::string>() + ")";
      });
  Struct<Lattice>(module, "Lattice", Change::frozen).table().done();
  Struct<Sampling>(module, "Sampling", Change::frozen).table().done();
  Struct<Placement>(module, "Placement", Change::frozen).table().done();
  Struct<Emitter>(module, "Emitter", Change::live)
      .table()
      .field("points", &Emitter::points, "", "an array of n x 3 numbers")
      .field("pose", &Emitter::pose, "", "a Pose")
      .field("keyframes", &Emitter::keyframes, "", "a list of PoseKeyframe")
      .done();
}

void bind_implicit_shapes(py::module_& module) {
  py::class_<ImplicitShape>(module, "ImplicitShape", doc("ImplicitShape"))
      .def(py::init([](DistanceFunction distance, const Aabb& box, std::optional<double> volume,
                       std::vector<std::string> notes) {
             if (!distance) throw py::type_error("ImplicitShape.distance must be a function of a point");
             return ImplicitShape{std::move(distance), box, volume, std::move(notes)};
           }),
           py::arg("distance"), py::arg("bounds"), py::arg("volume") = std::nullopt,
           py::arg("notes") = std::vector<std::string>{})
      .def_property_readonly(
          "distance", [](const ImplicitShape& shape) { return shape.distance; },
          "Signed distance to the shape [m], negative inside: a function of a point.")
      .def_property_readonly(
          "bounds", [](const ImplicitShape& shape) { return Aabb(shape.bounds); },
          "A box that holds the shape.")
      .def_readonly("volume", &ImplicitShape::volume, doc("ImplicitShape.volume"))
      .def_readonly("notes", &ImplicitShape::notes, doc("ImplicitShape.notes"));
  module.def("sphere_shape", &sphere_shape, py::arg("center"), py::arg("radius"), doc("sphere_shape"));
  module.def("moai_shape", &moai_shape, doc("moai_shape"));
  module.def("implicit_shape", &implicit_shape, py::arg("name"), doc("implicit_shape"));
  module.def(
      "implicit_shape_names",
      [] { return std::vector<std::string>(implicit_shape_names().begin(), implicit_shape_names().end()); },
      doc("implicit_shape_names"));
  module.def("place", py::overload_cast<const ImplicitShape&, const Placement&>(&place), py::arg("shape"),
             py::arg("placement"), doc("place"));
  module.def(
      "distance_field",
      [](const ImplicitShape& shape, float voxel_size, bool inside, float band) {
        return distance_field(shape, voxel_size, inside, band);
      },
      py::arg("shape"), py::arg("voxel_size"), py::arg("inside") = false,
      py::arg("band") = std::numeric_limits<float>::infinity(), doc("distance_field"));
  module.def("sample", py::overload_cast<const Lattice&>(&sample), py::arg("lattice"), doc("sample"));
  // With the GIL: the distance function may be one of Python.
  module.def("sample", py::overload_cast<const ImplicitShape&, const Sampling&>(&sample), py::arg("shape"),
             py::arg("sampling"), doc("sample#2"));
}

}  // namespace

void bind_bodies(py::module_& module) {
  bind_points(module);
  bind_implicit_shapes(module);
}

}  // namespace mallow::python
