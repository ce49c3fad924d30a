#pragma once
// The error of a call that must fail.
#include <doctest/doctest.h>

#include "ngs/core/error.h"

namespace ngs::test {

/// The code of the Error that body() throws; fails the test if it throws none.
ErrorCode code_of(const auto& body) {
  try {
    body();
  } catch (const Error& e) {
    return e.code();
  }
  FAIL("nothing was thrown");
  return ErrorCode::kNumeric;
}

}  // namespace ngs::test
