// Purpose: the time that a benchmark's own thread has had.
#pragma once

#include <ctime>

namespace bench {

/// Microseconds: other programs do not count.
inline double processorTime() {
#ifdef CLOCK_THREAD_CPUTIME_ID
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) * 1e6 + double(t.tv_nsec) * 1e-3;
#else
  return double(std::clock()) * (1e6 / CLOCKS_PER_SEC);
#endif
}

}  // namespace bench
