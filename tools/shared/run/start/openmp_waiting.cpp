// Threads that wait at the end of a parallel loop spin, in libgomp for minutes by default. On a machine that is
// shared (make -j, a cluster node, a container with fewer cores than it shows) the spinning thread takes the
// very core its partner needs: measured on two busy cores, the optimiser ran 5 times slower than with one
// thread. The 1000 turns that libgomp itself takes where threads are more than processors cost one or two percent
// where cores are free. With one of two cores busy, a run of bird takes 21 s with them, 34 s with 10000 turns.
//
// libgomp reads its settings when it is loaded, before main, so they take effect by starting again.
#include <unistd.h>

#include <cstdlib>

namespace {

[[gnu::constructor]] void wait_politely(int, char** argv, char**) {
  if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
  setenv("GOMP_SPINCOUNT", "1000", 1);
  // By its own path, not by the link: the kernel names the process after the file, and top should not show "exe".
  char path[4096];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
  if (length <= 0) return;
  path[length] = '\0';
  execv(path, argv);  // where it fails, waiting stays as it was
}

}  // namespace
