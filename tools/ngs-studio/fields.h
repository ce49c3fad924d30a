#pragma once
// Strict reading of JSON requests: unknown members are errors.
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ngs/interactive/viewpoint.h"

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

/// One JSON object of a request. Errors are Refusals (400) that name the member by its path, "camera.width".
class Fields {
 public:
  Fields(const nlohmann::json& object, std::string path);

  bool has(const std::string& name) const { return object_.contains(name); }
  double number(const std::string& name, double least, double most);
  int integer(const std::string& name, int least, int most);
  bool boolean(const std::string& name);
  std::string text(const std::string& name, std::size_t longest);
  Vec3<double> vector(const std::string& name);
  const nlohmann::json& member(const std::string& name);
  Fields object(const std::string& name) { return {member(name), path_of(name)}; }
  std::string path_of(const std::string& name) const { return path_.empty() ? name : path_ + "." + name; }
  /// Call after the last read: throws for members that were never read.
  void end() const;

  [[noreturn]] void refuse(const std::string& name, const std::string& expected) const;

 private:
  const nlohmann::json& object_;
  std::string path_;
  std::set<std::string> read_;
};

/// The body of a request; an empty one is {}.
nlohmann::json parse_body(const std::string& body);

live::Viewpoint viewpoint_of(Fields camera);
Json json_of(const live::Viewpoint& viewpoint);

}  // namespace ngs::studio
