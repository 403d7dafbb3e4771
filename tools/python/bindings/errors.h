#pragma once

#include <stdexcept>

namespace mallow::python {

/// An object is in use by another thread: mallow.BusyError.
class BusyError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace mallow::python
