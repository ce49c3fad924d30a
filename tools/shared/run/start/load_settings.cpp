// Settings that libraries read when they are loaded, before main. To apply them, the program executes itself again.
//
// GOMP_SPINCOUNT. Threads that wait at the end of a parallel loop spin, in libgomp for minutes by default. On a shared
// machine (make -j, a cluster node, a container with fewer cores than it reports) a spinning thread occupies the core
// that another thread needs: on two busy cores, the optimiser ran 5 times slower than with one thread. 1000 turns, the
// count of libgomp for more threads than processors, cost one or two percent if cores are free. With one of two cores
// busy, a run of bird takes 21 s with 1000 turns, 34 s with 10000 turns.
//
// GLIBC_TUNABLES. Columns of millions of rows use pages of 2 MiB if the system has them, which saves 511 of 512 page
// faults: with 2e7 Gaussians, page faults take a quarter of a draft run (decisions/077).
#include <sys/auxv.h>
#include <unistd.h>

#include <cstdlib>

namespace {

bool is_set(const char* name) { return std::getenv(name) != nullptr; }

[[gnu::constructor]] void load_with_settings(int, char** argv, char**) {
  if (getauxval(AT_SECURE) != 0) return;  // the loader ignores such settings
  const bool waiting = is_set("OMP_WAIT_POLICY") || is_set("GOMP_SPINCOUNT"), pages = is_set("GLIBC_TUNABLES");
  if (waiting && pages) return;
  if (!waiting) setenv("GOMP_SPINCOUNT", "1000", 1);
  if (!pages) setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 1);
  // Use the path of the executable, not the link: the kernel names the process after the file, and top would show
  // "exe".
  char path[4096];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
  if (length <= 0) return;
  path[length] = '\0';
  execv(path, argv);  // if it fails, the run continues without the settings
}

}  // namespace
