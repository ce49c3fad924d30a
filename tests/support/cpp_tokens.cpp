#include "support/cpp_tokens.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace ngs::test {
namespace {

using std::size_t;
using std::string_view;

bool starts_word(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

class Lexer {
 public:
  explicit Lexer(string_view source) : source_(source) {}

  std::vector<Token> tokens() {
    while (skip_blanks_and_comments()) {
      const size_t begin = at_;
      const int line = line_;
      const TokenKind kind = read_token();
      tokens_.push_back({kind, source_.substr(begin, at_ - begin), line});
    }
    return std::move(tokens_);
  }

 private:
  char peek(size_t ahead = 0) const { return at_ + ahead < source_.size() ? source_[at_ + ahead] : '\0'; }
  bool at(string_view text) const { return source_.substr(at_, text.size()) == text; }
  void advance_to(size_t end) {
    end = std::min(end, source_.size());
    line_ += int(std::count(source_.begin() + long(at_), source_.begin() + long(end), '\n'));
    at_ = end;
  }

  /// False at the end of the source.
  bool skip_blanks_and_comments() {
    for (; at_ < source_.size();) {
      const char c = peek();
      if (c == '\n') line_is_blank_ = true;
      if (std::isspace(static_cast<unsigned char>(c)) != 0)
        advance_to(at_ + 1);
      else if (at("//"))
        advance_to(source_.find('\n', at_));
      else if (at("/*"))
        advance_to(source_.find("*/", at_) == string_view::npos ? source_.size() : source_.find("*/", at_) + 2);
      else if (c == '#' && line_is_blank_)
        skip_directive();
      else
        return true;
    }
    return false;
  }

  void skip_directive() {
    size_t end = source_.find('\n', at_);
    while (end != string_view::npos && source_[end - 1] == '\\') end = source_.find('\n', end + 1);
    advance_to(end);
  }

  TokenKind read_token() {
    line_is_blank_ = false;
    const char c = peek();
    if (starts_word(c)) return read_word();
    if (std::isdigit(static_cast<unsigned char>(c)) != 0 ||
        (c == '.' && std::isdigit(static_cast<unsigned char>(peek(1))) != 0))
      return read_number();
    if (c == '"' || c == '\'') return read_quoted(c);
    static constexpr std::array<string_view, 5> kLong = {"::", "->", "...", "&&", "||"};
    const auto symbol = std::find_if(kLong.begin(), kLong.end(), [&](string_view s) { return at(s); });
    advance_to(at_ + (symbol == kLong.end() ? 1 : symbol->size()));
    return TokenKind::kSymbol;
  }

  TokenKind read_word() {
    const size_t begin = at_;
    while (in_word(peek())) ++at_;
    const string_view word = source_.substr(begin, at_ - begin);
    const bool prefix = word == "L" || word == "u" || word == "U" || word == "u8";
    if (peek() == '"' && (word == "R" || word == "LR" || word == "uR" || word == "UR" || word == "u8R"))
      return read_raw();
    if (prefix && (peek() == '"' || peek() == '\'')) return read_quoted(peek());
    return TokenKind::kWord;
  }

  TokenKind read_number() {
    for (;; ++at_) {
      const char c = peek(), last = at_ > 0 ? source_[at_ - 1] : '\0';
      const bool sign = (c == '+' || c == '-') && (last == 'e' || last == 'E' || last == 'p' || last == 'P');
      if (!in_word(c) && c != '.' && !(c == '\'' && in_word(peek(1))) && !sign) return TokenKind::kNumber;
    }
  }

  TokenKind read_quoted(char quote) {
    for (++at_; at_ < source_.size() && peek() != quote; ++at_)
      if (peek() == '\\') ++at_;
    advance_to(at_ + 1);
    while (in_word(peek())) ++at_;  // the suffix of a user-defined literal
    return TokenKind::kLiteral;
  }

  TokenKind read_raw() {
    const size_t open = source_.find('(', at_);
    const std::string close = ")" + std::string(source_.substr(at_ + 1, open - at_ - 1)) + "\"";
    const size_t end = source_.find(close, open);
    advance_to(end == string_view::npos ? end : end + close.size());
    return TokenKind::kLiteral;
  }

  string_view source_;
  size_t at_ = 0;
  int line_ = 1;
  bool line_is_blank_ = true;  // so far
  std::vector<Token> tokens_;
};

}  // namespace

std::vector<Token> cpp_tokens(string_view source) { return Lexer(source).tokens(); }

std::vector<size_t> bracket_partners(const std::vector<Token>& tokens) {
  static constexpr string_view kOpening = "([{", kClosing = ")]}";
  std::vector<size_t> partner(tokens.size()), open;
  for (size_t i = 0; i < tokens.size(); ++i) {
    partner[i] = i;
    if (tokens[i].kind != TokenKind::kSymbol || tokens[i].text.size() != 1) continue;
    const char c = tokens[i].text[0];
    if (kOpening.find(c) != string_view::npos) open.push_back(i);
    const size_t closing = kClosing.find(c);
    if (closing == string_view::npos) continue;
    if (open.empty() || tokens[open.back()].text[0] != kOpening[closing])
      throw std::runtime_error("line " + std::to_string(tokens[i].line) + ": '" + c + "' closes nothing");
    partner[i] = open.back(), partner[open.back()] = i;
    open.pop_back();
  }
  if (!open.empty())
    throw std::runtime_error("line " + std::to_string(tokens[open.back()].line) + ": bracket is never closed");
  return partner;
}

}  // namespace ngs::test
