#pragma once
// Responses and errors of the studio. They do not depend on the HTTP library, so that --replay needs no server.
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

/// An error response: the object concerned, the value found, the value expected, and a remedy.
struct Refusal : std::runtime_error {
  Refusal(int http_status, std::string object_name, std::string value_found, std::string value_expected,
          std::string remedy_text = {});

  int status;
  std::string object, found, expected, remedy;
};

/// The error as a JSON body.
Reply reply_of(const Refusal& refusal);

}  // namespace ngs::studio
