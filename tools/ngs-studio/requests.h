#pragma once
// Requests as JSON, and their responses. Requests are read by io::JsonReader, whose errors become responses with status
// 400; the object of such an error is the path of the member, "camera.width".
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ngs/interactive/viewpoint.h"
#include "ngs/io/files/json_file.h"

namespace ngs::studio {

// Responses and errors of the studio. They do not depend on the HTTP library, so that --replay needs no server.
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

Reply reply_of(const Refusal& refusal);

using Json = nlohmann::ordered_json;

/// The body of a request, an object; an empty one is {}.
nlohmann::json parse_body(const std::string& body);

/// Three numbers of at most 1e9.
Vec3<double> vector_of(const io::JsonReader& reader, const std::string& key);
live::Viewpoint viewpoint_of(const io::JsonReader& camera);
Json json_of(const live::Viewpoint& viewpoint);

}  // namespace ngs::studio
