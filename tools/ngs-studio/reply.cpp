#include "reply.h"

#include <nlohmann/json.hpp>

namespace ngs::studio {

Refusal::Refusal(int http_status, std::string what_it_is, std::string what_was_found, std::string what_was_expected,
                 std::string way_out)
    : std::runtime_error(what_it_is + ": " + what_was_found + ", expected " + what_was_expected),
      status(http_status),
      object(std::move(what_it_is)),
      found(std::move(what_was_found)),
      expected(std::move(what_was_expected)),
      remedy(std::move(way_out)) {}

Reply reply_of(const Refusal& refusal) {
  const nlohmann::ordered_json error{
      {"object", refusal.object}, {"found", refusal.found}, {"expected", refusal.expected}, {"remedy", refusal.remedy}};
  // What was sent is repeated in messages, and need not be text.
  return {refusal.status,
          nlohmann::ordered_json{{"error", error}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

}  // namespace ngs::studio
