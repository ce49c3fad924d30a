#pragma once
// NGS_CHECK: a precondition inside ngs, checked in every build. Invalid user input is an Error, never a check.
#include <stdexcept>
#include <string>

#define NGS_CHECK(condition, message)                                                                                  \
  do {                                                                                                                 \
    if (!(condition)) throw std::logic_error(std::string(__FILE__ ":") + std::to_string(__LINE__) + ": " + (message)); \
  } while (false)
