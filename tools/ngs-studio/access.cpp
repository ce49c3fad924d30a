#include "access.h"

#include <random>

namespace ngs::studio {

Access::Access(std::string token, int port)
    : token_(std::move(token)), cookie_name_("ngs-studio-" + std::to_string(port)) {}

bool Access::is_same_origin(const Caller& caller) const {
  const std::size_t digits = caller.host.find(':') + 1;
  const std::string name = caller.host.substr(0, digits);
  if (name != "127.0.0.1:" && name != "localhost:") return false;
  if (digits == caller.host.size() || caller.host.find_first_not_of("0123456789", digits) != caller.host.npos)
    return false;
  return caller.origin.empty() || caller.origin == "http://" + caller.host;
}

/// Compares in constant time.
bool Access::is_token(std::string_view text) const {
  if (text.size() != token_.size()) return false;
  unsigned differs = 0;
  for (std::size_t i = 0; i < text.size(); ++i) differs |= unsigned(text[i] ^ token_[i]);
  return differs == 0;
}

bool Access::has_token(const Caller& caller) const {
  if (is_token(caller.token)) return true;
  std::string_view rest = caller.cookies;
  while (!rest.empty()) {
    const std::size_t end = rest.find(';');
    std::string_view one = rest.substr(0, end);
    rest = end == rest.npos ? std::string_view() : rest.substr(end + 1);
    while (one.starts_with(' ')) one.remove_prefix(1);
    const std::size_t equals = one.find('=');
    if (equals != one.npos && one.substr(0, equals) == cookie_name_ && is_token(one.substr(equals + 1))) return true;
  }
  return false;
}

std::string Access::cookie() const { return cookie_name_ + "=" + token_ + "; HttpOnly; SameSite=Strict; Path=/"; }

std::string random_token() {
  static const char* const digits = "0123456789abcdef";
  std::random_device random;
  std::string token;
  while (token.size() < 32) token += digits[random() % 16];
  return token;
}

}  // namespace ngs::studio
