#pragma once
// NGS_CHECK: mistakes of a caller inside ngs (always on). Mistakes of a user are Error, never a check.
#include <stdexcept>
#include <string>

#define NGS_CHECK(condition, message)                                                                                  \
  do {                                                                                                                 \
    if (!(condition)) throw std::logic_error(std::string(__FILE__ ":") + std::to_string(__LINE__) + ": " + (message)); \
  } while (false)
