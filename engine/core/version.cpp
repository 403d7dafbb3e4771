#include "mallow/version.h"

namespace mallow {

const char* version() {
  return MALLOW_VERSION;
}

}  // namespace mallow
