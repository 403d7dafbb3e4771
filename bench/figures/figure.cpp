#include "figures/figure.h"

namespace mallow::bench {

std::vector<Figure> figures() {
  return {fig2(), fig3(), fig5a(), fig5b(), fig5c(), fig5d()};
}

}  // namespace mallow::bench
