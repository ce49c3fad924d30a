#pragma once
// The error of a call that must fail.
#include <doctest/doctest.h>

#include "ngs/core/error.h"
#include "support/call_site.h"

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

/// The same, of this code; `says` is in its text, `advises` in its remedy.
Error refused(const auto& body, ErrorCode code, const std::string& says, const std::string& advises = {},
              CallSite where = CallSite::current()) {
  Error e = thrown_by(body);
  INFO(where.text() << "\n" << e.what() << "\n" << e.remedy());
  CHECK(e.code() == code);
  CHECK(std::string(e.what()).find(says) != std::string::npos);
  CHECK(e.remedy().find(advises) != std::string::npos);
  return e;
}

/// The text of the bad input that body() reports; empty if it takes its input.
std::string bad_input(const auto& body) {
  try {
    body();
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::kBadInput);
    return e.what();
  }
  return "";
}

ErrorCode code_of(const auto& body) { return thrown_by(body).code(); }

}  // namespace ngs::test
