#pragma once
// The error of a call that must fail.
#include <doctest/doctest.h>

#include "ngs/core/error.h"

namespace ngs::test {

/// The Error that body() throws; fails the test if it throws none.
Error thrown_by(const auto& body) {
  try {
    body();
  } catch (const Error& e) {
    return e;
  }
  FAIL("nothing was thrown");
  return Error(ErrorCode::kNumeric, "");
}

ErrorCode code_of(const auto& body) { return thrown_by(body).code(); }

}  // namespace ngs::test
