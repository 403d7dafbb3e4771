#include "core/parallel.h"

#include <omp.h>

namespace mallow {

int thread_count(int requested) {
  return requested > 0 ? requested : omp_get_num_procs();
}

}  // namespace mallow
