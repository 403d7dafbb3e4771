#pragma once

#include <Python.h>

#include <string>

/// Included before all of pybind11, which says what a function was called with by printing it: an array
/// filled the screen. Only the begin of that stays, and the types that a function takes are called as users
/// call them.
///
/// A macro, as pybind11 2.10 has no place for it: where no overload fits, its dispatcher makes the
/// message and sets the error itself. Exception translators are asked only for what C++ throws, and type
/// casters only say yes or no. What else would do: a last overload of every function that takes anything and
/// raises, which all doc strings and stubs would show; or a wrapper of Python's around every method, which
/// calls would pay for. CMake includes this first in every source of the module, so that all of them have the
/// same dispatcher.
namespace mallow::python {

inline void set_error(PyObject* type, const char* message) {
  constexpr std::size_t k_most = 100;  // characters of what was given
  std::string text = message;
  const std::string begin = "\nInvoked with: ", home = "mallow._mallow.";
  if (const std::size_t at = text.find(begin); at != text.npos) {
    std::string given;
    for (const char c : text.substr(at + begin.size()))
      if (c != '\n' && (c != ' ' || !given.ends_with(' '))) given += c;
    std::size_t most = k_most;
    while (most < given.size() && (static_cast<unsigned char>(given[most]) & 0xc0u) == 0x80u)
      --most;  // UTF-8
    if (given.size() > most) given = given.substr(0, most) + " ...";
    text = text.substr(0, at) + "not " + given;
    for (std::size_t name = text.find(home); name != text.npos; name = text.find(home))
      text.erase(name, home.size());
  }
  (PyErr_SetString)(type, text.c_str());
}

}  // namespace mallow::python

#define PyErr_SetString(type, message) mallow::python::set_error(type, message)
