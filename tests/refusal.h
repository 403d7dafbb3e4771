#pragma once

#include <functional>
#include <string>

#include "mallow/errors.h"

namespace mallow::test {

/// What a call is refused with.
inline std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "nothing was refused";
}

}  // namespace mallow::test
