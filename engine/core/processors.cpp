#include "core/processors.h"

#include <omp.h>

#include <algorithm>

#ifdef __linux__
#include <sched.h>

#include <cstddef>
#include <vector>
#endif

namespace mallow {

int processor_count() {
  return std::max(1, omp_get_num_procs());
}

#ifdef __linux__

void use_all_processors() {
  if (omp_get_proc_bind() == omp_proc_bind_false) return;
  cpu_set_t processors;
  CPU_ZERO(&processors);
  for (int place = 0; place < omp_get_num_places(); ++place) {
    std::vector<int> ids(static_cast<std::size_t>(omp_get_place_num_procs(place)));
    omp_get_place_proc_ids(place, ids.data());
    for (const int id : ids) CPU_SET(static_cast<std::size_t>(id), &processors);
  }
  if (CPU_COUNT(&processors) > 0) sched_setaffinity(0, sizeof processors, &processors);
}

int current_processor() {
  return sched_getcpu();
}

void leave_processor(int processor) {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0 || CPU_COUNT(&allowed) < 2) return;
  cpu_set_t others = allowed;
  CPU_CLR(static_cast<std::size_t>(processor), &others);
  // The first call moves it, the second lets it come back when it is idle there.
  if (sched_setaffinity(0, sizeof others, &others) == 0) sched_setaffinity(0, sizeof allowed, &allowed);
}

#else

void use_all_processors() {}
int current_processor() {
  return -1;
}
void leave_processor(int) {}

#endif

}  // namespace mallow
