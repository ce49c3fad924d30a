#pragma once
// Access control: requests need the token, as a cookie (browser) or as a header (scripts).
#include <string>
#include <string_view>

namespace ngs::studio {

/// Headers of a request. An absent header is empty.
struct Caller {
  std::string host, origin, cookies, token;  // token: the header X-Ngs-Token
};

class Access {
 public:
  /// `port` is part of the cookie's name.
  Access(std::string token, int port);

  bool allows(const Caller& caller) const { return is_same_origin(caller) && has_token(caller); }
  /// True if Host is a local name with any port, as behind a tunnel of ssh, and Origin is absent or the same server.
  bool is_same_origin(const Caller& caller) const;
  bool is_token(std::string_view text) const;
  /// Value of Set-Cookie.
  std::string cookie() const;
  const std::string& token() const { return token_; }

 private:
  bool has_token(const Caller& caller) const;

  std::string token_, cookie_name_;
};

/// 128 random bits in hexadecimal digits.
std::string random_token();

}  // namespace ngs::studio
