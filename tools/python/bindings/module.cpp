#include <algorithm>
#include <stdexcept>
#include <string>

#include "arrays.h"
#include "docs.h"
#include "mallow/version.h"
#include "parts.h"

namespace mallow::python {

const char* doc(std::string_view name) {
  const auto found = std::ranges::lower_bound(docs(), name, {}, &Doc::name);
  if (found == docs().end() || found->name != name)
    throw std::logic_error("no header declares " + std::string(name));
  return found->text;
}

namespace {

/// For an object that __new__ made and __init__ did not, pybind11 allocates what it is to hold when somebody
/// first looks at it, and constructs nothing: whoever read that crashed.
void* refuse_unconstructed(std::size_t) {
  throw py::type_error("this object was never constructed: __init__ was not called");
}

void refuse_unconstructed_objects(const py::module_& module) {
  for (const auto& [name, value] : py::dict(module.attr("__dict__"))) {
    if (!PyType_Check(value.ptr())) continue;
    auto* const type = reinterpret_cast<PyTypeObject*>(value.ptr());
    for (py::detail::type_info* info : py::detail::all_type_info(type))
      info->operator_new = &refuse_unconstructed;
  }
}

}  // namespace
}  // namespace mallow::python

PYBIND11_MODULE(_mallow, module) {
  using namespace mallow::python;
  module.doc() = "Fast animation of viscoelastic materials: the library of C++ under the same names.";
  module.attr("__version__") = mallow::version();
  module.def("version", &mallow::version, doc("version"));
  bind_errors(module);
  bind_settings(module);
  bind_shapes(module);
  bind_bodies(module);
  bind_reports(module);
  bind_simulation(module);
  bind_meshes(module);
  bind_surfaces(module);
  bind_scenes(module);
  bind_files(module);
  bind_tuning(module);
#ifdef MALLOW_PYTHON_RENDER
  bind_pictures(module);
#endif
  refuse_unconstructed_objects(module);
}
