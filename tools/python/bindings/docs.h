#pragma once

#include <span>
#include <string_view>

namespace mallow::python {

/// What the headers say of a declaration, made by read_docs.py.
struct Doc {
  std::string_view name;
  const char* text;
};
/// By ascending name.
std::span<const Doc> docs();
/// That of "Simulation.step"; overloads are counted from the second on, "Simulation.pin#2". A name that no
/// header has ends the import: it is a mistake of the bindings.
const char* doc(std::string_view name);

}  // namespace mallow::python
