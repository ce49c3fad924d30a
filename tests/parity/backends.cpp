#include "parity/backends.h"

#include <cstdio>
#include <cstdlib>

namespace ngs::test {

void check_ratio(const Backend& backend, const std::string& what, double ratio, double bound) {
  INFO(backend.name << ": " << what << ", ratio " << ratio << ", at most " << bound);
  CHECK(ratio <= bound);
  if (std::getenv("NGS_PARITY_TABLE") != nullptr)
    std::printf("parity\t%s\t%s\t%.3g\t%g\n", backend.name.c_str(), what.c_str(), ratio, bound);
}

}  // namespace ngs::test
