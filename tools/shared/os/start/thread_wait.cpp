// Sets GOMP_SPINCOUNT before libgomp reads it.
//
// Threads that wait at the end of a parallel loop spin, in libgomp for minutes by default. On a shared machine (make
// -j, a cluster node, a container with fewer cores than it reports) a spinning thread occupies the core that another
// thread needs: on two busy cores, the optimiser ran 5 times slower than with one thread. 1000 turns, the count of
// libgomp for more threads than processors, cost one or two percent if cores are free. With one of two cores busy, a
// run of bird takes 21 s with 1000 turns, 34 s with 10000 turns.
//
// libgomp reads the variable in a constructor. It is linked statically (libngs/cmake/NgsLibraries.cmake), so this
// constructor, of a higher priority, runs first. With a shared libgomp it runs too late: set the variable yourself.
#include <cstdlib>

namespace {

[[gnu::constructor(101)]] void limit_spinning() {
  if (std::getenv("OMP_WAIT_POLICY") != nullptr) return;
#ifdef _WIN32
  if (std::getenv("GOMP_SPINCOUNT") == nullptr) _putenv("GOMP_SPINCOUNT=1000");
#else
  setenv("GOMP_SPINCOUNT", "1000", 0);
#endif
}

}  // namespace
