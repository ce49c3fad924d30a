#include "reply.h"

#include <nlohmann/json.hpp>

namespace ngs::studio {

Refusal::Refusal(int http_status, std::string object_name, std::string value_found, std::string value_expected,
                 std::string remedy_text)
    : std::runtime_error(object_name + ": " + value_found + ", expected " + value_expected),
      status(http_status),
      object(std::move(object_name)),
      found(std::move(value_found)),
      expected(std::move(value_expected)),
      remedy(std::move(remedy_text)) {}

Reply reply_of(const Refusal& refusal) {
  const nlohmann::ordered_json error{
      {"object", refusal.object}, {"found", refusal.found}, {"expected", refusal.expected}, {"remedy", refusal.remedy}};
  // Messages quote the request, which need not be valid UTF-8.
  return {refusal.status,
          nlohmann::ordered_json{{"error", error}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

}  // namespace ngs::studio
