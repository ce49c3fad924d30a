#pragma once
// The Python that a case needs.
#include <string>

#include "support/process.h"

namespace ngs::test {

/// A Python that can import `modules` ("numpy, PIL"), the first in PATH or the system's; empty: there is none.
inline std::string python_with(const std::string& modules) {
  for (const char* program : {"python3", "/usr/bin/python3"})
    if (run_command({program, "-c", "import " + modules}).exit_code == 0) return program;
  return {};
}

}  // namespace ngs::test
