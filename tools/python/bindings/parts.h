#pragma once

#include <pybind11/pybind11.h>

/// The parts of the module, each in the file of its name, in the order in which they need each other.
namespace mallow::python {

void bind_errors(pybind11::module_& module);
void bind_settings(pybind11::module_& module);
void bind_shapes(pybind11::module_& module);
void bind_bodies(pybind11::module_& module);
void bind_reports(pybind11::module_& module);
void bind_simulation(pybind11::module_& module);
void bind_meshes(pybind11::module_& module);
void bind_surfaces(pybind11::module_& module);
void bind_scenes(pybind11::module_& module);
void bind_files(pybind11::module_& module);
void bind_tuning(pybind11::module_& module);
void bind_pictures(pybind11::module_& module);

}  // namespace mallow::python
