#include <cstddef>
#include <cstdint>

#include "fuzz/formats.h"

/// What libFuzzer calls with every input: a file of the format that this target is built for (MALLOW_FORMAT).
/// An exception that leaves it is a finding, as is what a sanitizer reports.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static mallow::fuzz::Input input(mallow::fuzz::format(MALLOW_FORMAT));
  input.read({reinterpret_cast<const char*>(data), size});
  return 0;
}
