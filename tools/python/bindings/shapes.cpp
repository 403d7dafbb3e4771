#include "colliders/shapes.h"
#include "config/field_tables.h"
#include "live.h"
#include "mallow/errors.h"
#include "parts.h"

namespace mallow::python {
namespace {

template <class Shape>
void nearest_and_bounds(py::module_& module) {
  module.def(
      "nearest", [](const Shape& shape, const Vec3& x) { return nearest(shape, x); }, py::arg("shape"),
      py::arg("x"), doc("nearest"));
  module.def(
      "bounds", [](const Shape& shape) { return bounds(shape); }, py::arg("shape"), doc("bounds"));
}

template <class Shape>
void primitive(py::module_& module, const char* name) {
  Struct<Shape> bound(module, name, Change::frozen);
  bound.table().done();
  nearest_and_bounds<Shape>(module);
}

void bind_primitives(py::module_& module) {
  Struct<Aabb>(module, "Aabb", Change::frozen).field("min", &Aabb::min).field("max", &Aabb::max).done();
  Struct<SurfacePoint>(module, "SurfacePoint", Change::frozen)
      .field("distance", &SurfacePoint::distance)
      .field("normal", &SurfacePoint::normal)
      .done();
  primitive<Plane>(module, "Plane");
  primitive<Sphere>(module, "Sphere");
  primitive<Box>(module, "Box");
  primitive<Capsule>(module, "Capsule");
  primitive<Cylinder>(module, "Cylinder");
  primitive<Cone>(module, "Cone");
}

/// A shape that has no data is none: it is never made.
void bind_heavy_shapes(py::module_& module) {
  py::class_<ConvexHull>(module, "ConvexHull", doc("ConvexHull"))
      .def_readonly("inside", &ConvexHull::inside, doc("ConvexHull.inside"));
  module.def(
      "convex_hull", [](const std::vector<Vec3>& points, bool inside) { return convex_hull(points, inside); },
      py::arg("points"), py::arg("inside") = false, doc("convex_hull"));
  Struct<DistanceGrid>(module, "DistanceGrid", Change::frozen)
      .field("origin", &DistanceGrid::origin)
      .field("voxel_size", &DistanceGrid::voxel_size)
      .field("size", &DistanceGrid::size)
      .field("distances", &DistanceGrid::distances)
      .done();
  py::class_<DistanceField>(module, "DistanceField", doc("DistanceField"))
      .def(py::init([](const DistanceGrid& grid, bool inside) {
             DistanceField field{std::make_shared<const DistanceGrid>(grid), inside};
             if (const auto problem = ShapeTraits<DistanceField>::problem(field))
               throw ConfigError(problem->key, std::string("must be ") + problem->allowed);
             return field;
           }),
           py::arg("grid"), py::arg("inside") = false)
      .def_property_readonly(
          "grid", [](const DistanceField& field) { return DistanceGrid(*field.grid); },
          doc("DistanceField.grid"))
      .def_readonly("inside", &DistanceField::inside, doc("DistanceField.inside"));
  nearest_and_bounds<ConvexHull>(module);
  nearest_and_bounds<DistanceField>(module);
}

void bind_collider(py::module_& module) {
  py::class_<Union>(module, "Union", doc("Union"))
      .def(py::init([](std::vector<Primitive> parts) {
             if (parts.empty()) throw ConfigError("union", "has no parts: one at least is needed");
             return Union{std::move(parts)};
           }),
           py::arg("parts"))
      .def_property_readonly(
          "parts", [](const Union& self) { return Tuple<Primitive>{self.parts}; }, doc("Union.parts"))
      .def("__repr__", [](const Union& self) {
        return "Union(" + py::repr(py::cast(self.parts)).cast<std::string>() + ")";
      });
  module.def(
      "nearest", [](const Union& shapes, const Vec3& x) { return nearest(shapes, x); }, py::arg("shape"),
      py::arg("x"), doc("nearest#9"));
  Struct<Pose>(module, "Pose", Change::frozen)
      .field("translation", &Pose::translation)
      .field("rotation", &Pose::rotation)
      .done();
  Struct<PoseKeyframe>(module, "PoseKeyframe", Change::frozen)
      .field("time", &PoseKeyframe::time)
      .field("pose", &PoseKeyframe::pose)
      .done();
  Struct<Collider>(module, "Collider", Change::live)
      .field("shape", &Collider::shape, "", "a shape: Plane, Sphere, Box and the like")
      .field("pose", &Collider::pose)
      .table()
      .field("keyframes", &Collider::keyframes, "", "a list of PoseKeyframe")
      .done();
  Struct<ColliderLoad>(module, "ColliderLoad", Change::frozen)
      .field("impulse", &ColliderLoad::impulse)
      .field("torque", &ColliderLoad::torque)
      .done();
  module.def(
      "nearest", [](const Collider& collider, const Vec3& x) { return nearest(collider, x); },
      py::arg("collider"), py::arg("x"), doc("nearest#10"));
  module.def("pose_after", &pose_after, py::arg("collider"), py::arg("seconds"), doc("pose_after"));
  module.def(
      "pose_at",
      [](const std::vector<PoseKeyframe>& keyframes, double time) {
        if (keyframes.empty()) throw ConfigError("keyframes", "are none: one at least is needed");
        return pose_at(keyframes, time);
      },
      py::arg("keyframes"), py::arg("time"), doc("pose_at"));
  module.def("placed", py::overload_cast<const Plane&, const Pose&>(&placed), py::arg("plane"),
             py::arg("pose"), doc("placed"));
  module.def("placed", py::overload_cast<const Aabb&, const Pose&>(&placed), py::arg("box"), py::arg("pose"),
             doc("placed#2"));
}

}  // namespace

void bind_shapes(py::module_& module) {
  bind_primitives(module);
  bind_heavy_shapes(module);
  bind_collider(module);
}

}  // namespace mallow::python
