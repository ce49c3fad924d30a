#pragma once
// Tokens of a C++ or CUDA source file, without comments and preprocessor lines. Both branches of an #if are kept;
// macros are not expanded.
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace ngs::test {

enum class TokenKind { kWord, kNumber, kLiteral, kSymbol };

/// `:: -> ... && ||` are one symbol each; every other symbol is one character, so that `>>` can close two templates.
struct Token {
  TokenKind kind;
  std::string_view text;  // points into the source
  int line;               // of its first character, from 1
};

/// `source` must outlive the tokens.
std::vector<Token> cpp_tokens(std::string_view source);

/// For each bracket `( [ { } ] )` the index of its partner; for other tokens their own index. Throws std::runtime_error
/// if brackets do not pair.
std::vector<std::size_t> bracket_partners(const std::vector<Token>& tokens);

}  // namespace ngs::test
