#pragma once
// What the studio answers, and how it refuses: without a word about HTTP, so that a visit can be replayed without it.
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ngs::studio {

struct Reply {
  int status = 200;
  std::string body = "{}";
  std::string type = "application/json";
  std::vector<std::pair<std::string, std::string>> headers = {};
};

/// A request that is not answered: what it is about, what was found there, what was expected, and the way out.
struct Refusal : std::runtime_error {
  Refusal(int http_status, std::string what_it_is, std::string what_was_found, std::string what_was_expected,
          std::string way_out = {});

  int status;
  std::string object, found, expected, remedy;
};

/// As the body of an answer.
Reply reply_of(const Refusal& refusal);

}  // namespace ngs::studio
