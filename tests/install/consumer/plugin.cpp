#include <mallow/mallow.h>

#include <string>

static_assert(MALLOW_VERSION_MAJOR >= 0);

/// 0 where a config is refused with an error of mallow's, which has to be the same type on both sides of a
/// library, and the library is that of the headers.
int check_plugin() {
  try {
    mallow::Simulation simulation({.support_radius = -1});
  } catch (const mallow::ConfigError&) {
    return mallow::version() == std::string(MALLOW_VERSION) ? 0 : 1;
  }
  return 2;
}
