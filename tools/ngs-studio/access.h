#pragma once
// Who may ask: a browser that was opened with the token, and scripts that were told it.
#include <string>
#include <string_view>

namespace ngs::studio {

/// What a request says of itself. A header that is absent is empty.
struct Caller {
  std::string host, origin, cookies, token;  // token: the header X-Ngs-Token
};

class Access {
 public:
  /// `port` is part of the cookie's name and of the hosts that are answered.
  Access(std::string token, int port);

  bool allows(const Caller& caller) const { return is_here(caller) && knows_token(caller); }
  /// The request is for this server by one of its own names, and comes from no page but its own.
  bool is_here(const Caller& caller) const;
  bool is_token(std::string_view said) const;
  /// For Set-Cookie.
  std::string cookie() const;
  const std::string& token() const { return token_; }

 private:
  bool knows_token(const Caller& caller) const;

  std::string token_, cookie_name_;
  std::string hosts_[2];
};

/// 128 random bits in hexadecimal digits.
std::string random_token();

}  // namespace ngs::studio
