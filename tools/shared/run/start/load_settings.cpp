// Settings that libraries read when they are loaded, before main: they take effect by starting again.
//
// GOMP_SPINCOUNT. Threads that wait at the end of a parallel loop spin, in libgomp for minutes by default. On a machine
// that is shared (make -j, a cluster node, a container with fewer cores than it shows) the spinning thread takes the
// very core its partner needs: measured on two busy cores, the optimiser ran 5 times slower than with one
// thread. The 1000 turns that libgomp itself takes where threads are more than processors cost one or two percent
// where cores are free. With one of two cores busy, a run of bird takes 21 s with them, 34 s with 10000 turns.
//
// GLIBC_TUNABLES. Columns of millions of rows are asked of the system in pages of 2 MiB where it has them to give, not
// in 512 times as many faults: at 2e7 Gaussians these take a quarter of a draft (decisions/077).
#include <sys/auxv.h>
#include <unistd.h>

#include <cstdlib>

namespace {

bool is_set(const char* name) { return std::getenv(name) != nullptr; }

[[gnu::constructor]] void load_with_settings(int, char** argv, char**) {
  if (getauxval(AT_SECURE) != 0) return;  // the loader drops such settings
  const bool waiting = is_set("OMP_WAIT_POLICY") || is_set("GOMP_SPINCOUNT"), pages = is_set("GLIBC_TUNABLES");
  if (waiting && pages) return;
  if (!waiting) setenv("GOMP_SPINCOUNT", "1000", 1);
  if (!pages) setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 1);
  // By its own path, not by the link: the kernel names the process after the file, and top should not show "exe".
  char path[4096];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
  if (length <= 0) return;
  path[length] = '\0';
  execv(path, argv);  // where it fails, all stays as it was
}

}  // namespace
