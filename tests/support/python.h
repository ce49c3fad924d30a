#pragma once
// Finds a Python interpreter for a case.
#include <string>

#include "support/process.h"

namespace ngs::test {

/// A Python that can import `modules` ("numpy, PIL"): the first in PATH, else the system's; empty: none.
inline std::string python_with(const std::string& modules) {
  for (const char* program : {"python3", "/usr/bin/python3"})
    if (run_command({program, "-c", "import " + modules}).exit_code == 0) return program;
  return {};
}

}  // namespace ngs::test
