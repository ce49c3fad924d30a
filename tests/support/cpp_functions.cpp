#include "support/cpp_functions.h"

#include <algorithm>
#include <array>
#include <utility>

#include "support/cpp_tokens.h"

namespace ngs::test {
namespace {

using std::size_t;
using std::string_view;

constexpr size_t kNone = size_t(-1);

template <size_t N>
bool one_of(string_view text, const std::array<string_view, N>& words) {
  return std::find(words.begin(), words.end(), text) != words.end();
}

/// State of a declaration outside of functions, up to the current token.
struct Head {
  size_t begin = 0;
  string_view kind;  // namespace, class, struct, union or enum
  size_t kind_at = kNone;
  size_t operator_at = kNone;    // the word `operator`
  size_t parameters = kNone;     // the opening parenthesis
  bool in_initialisers = false;  // after the colon of a constructor
};

class Reader {
 public:
  explicit Reader(const std::string& source) : tokens_(cpp_tokens(source)), partner_(bracket_partners(tokens_)) {}

  std::vector<CppFunction> functions() {
    read_scope(0, tokens_.size(), "");
    return std::move(functions_);
  }

 private:
  string_view text(size_t i) const { return i < tokens_.size() ? tokens_[i].text : string_view(); }
  bool is_word(size_t i) const { return i < tokens_.size() && tokens_[i].kind == TokenKind::kWord; }
  bool is_symbol(size_t i, string_view symbol) const {
    return i < tokens_.size() && tokens_[i].kind == TokenKind::kSymbol && tokens_[i].text == symbol;
  }
  bool opens_group(size_t i) const { return partner_[i] > i; }
  bool is_attribute(size_t i) const { return is_symbol(i, "[") && is_symbol(i + 1, "["); }
  size_t behind_group(size_t i) const { return partner_[i] + 1; }

  /// The index after the template arguments that begin at `i`; kNone if `<` is a comparison.
  size_t behind_template(size_t i) const {
    if (!is_symbol(i, "<") || i == 0 || !is_word(i - 1)) return kNone;
    for (size_t depth = 0; i < tokens_.size();) {
      if (is_symbol(i, "<") && is_word(i - 1)) ++depth;
      if (is_symbol(i, ">") && --depth == 0) return i + 1;
      if (is_symbol(i, ";") || partner_[i] < i) return kNone;
      i = opens_group(i) ? behind_group(i) : i + 1;
    }
    return kNone;
  }

  void read_scope(size_t i, size_t end, const std::string& prefix) {
    while (i < end) i = read_declaration(i, end, prefix);
  }

  /// Returns the index after the declaration.
  size_t read_declaration(size_t i, size_t end, const std::string& prefix) {
    static constexpr std::array<string_view, 3> kAccess = {"public", "private", "protected"};
    if (one_of(text(i), kAccess) && is_symbol(i + 1, ":")) return i + 2;
    Head head;
    head.begin = i;
    while (i < end) {
      if (is_symbol(i, ";")) return i + 1;
      if (is_symbol(i, "=")) return read_initialiser(i, end, name_of_variable(i));
      if (is_symbol(i, "{") && is_body(head, i)) return read_body(head, i, prefix);
      if (is_symbol(i, "{") && is_scope(head, i)) {
        read_scope(i + 1, partner_[i], prefix + scope_prefix(head));
        if (head.kind == "namespace" || head.kind.empty()) return behind_group(i);
      }
      i = behind_part(head, i);
    }
    throw std::runtime_error("line " + std::to_string(tokens_[head.begin].line) + ": the declaration has no end");
  }

  /// Adds one token or group of a declaration to `head`.
  size_t behind_part(Head& head, size_t i) {
    static constexpr std::array<string_view, 5> kKinds = {"namespace", "class", "struct", "union", "enum"};
    if (const size_t behind = behind_template(i); behind != kNone) return behind;
    if (text(i) == "requires") return behind_requires(i);
    if (text(i) == "operator" && head.parameters == kNone) {
      head.operator_at = i++;
      if (is_symbol(i, "(")) return behind_group(i);  // operator()
      while (!is_word(i) && !is_symbol(i, "(")) ++i;
      return i;
    }
    if (head.kind.empty() && one_of(text(i), kKinds)) head.kind = text(i), head.kind_at = i;
    if (is_symbol(i, ":") && head.parameters != kNone) head.in_initialisers = true;
    if (head.parameters == kNone && opens_parameters(head, i)) head.parameters = i;
    if (!opens_group(i)) return i + 1;
    if (is_symbol(i, "{") && head.kind.empty() && !head.in_initialisers)
      scan_variable(i, partner_[i], name_of_variable(i));
    return behind_group(i);
  }

  bool opens_parameters(const Head& head, size_t i) const {
    static constexpr std::array<string_view, 8> kNoNames = {
        "alignas", "decltype", "noexcept", "explicit", "requires", "__attribute__", "__launch_bounds__", "__declspec"};
    if (!is_symbol(i, "(") || i == head.begin) return false;
    return head.operator_at != kNone || is_symbol(i - 1, ">") || (is_word(i - 1) && !one_of(text(i - 1), kNoNames));
  }

  /// After a requires clause comes a constraint; after an expression optional parameters and braces.
  size_t behind_requires(size_t i) const {
    static constexpr std::array<string_view, 6> kBeforeExpression = {"requires", "&&", "||", "(", "=", "!"};
    const bool expression = i > 0 && one_of(text(i - 1), kBeforeExpression);
    ++i;
    if (is_symbol(i, "(")) i = behind_group(i);
    return expression && is_symbol(i, "{") ? behind_group(i) : i;
  }

  bool is_body(const Head& head, size_t i) const {
    const bool of_member = head.in_initialisers && (is_word(i - 1) || is_symbol(i - 1, ">"));
    return head.parameters != kNone && !of_member;
  }
  bool is_scope(const Head& head, size_t i) const {
    if (text(head.begin) == "extern" && tokens_[i - 1].kind == TokenKind::kLiteral) return true;
    return !head.kind.empty() && head.kind != "enum" && head.parameters == kNone;
  }

  /// "Pack::" for `struct alignas(16) Pack final : Base {`, nothing for namespaces and classes without a name.
  std::string scope_prefix(const Head& head) const {
    if (head.kind.empty() || head.kind == "namespace") return "";
    std::string name;
    for (size_t i = head.kind_at + 1; is_word(i) || is_attribute(i) || is_symbol(i, "(");) {
      if (is_word(i) && text(i) != "final" && text(i) != "alignas") name = std::string(text(i)) + "::";
      i = is_word(i) ? i + 1 : behind_group(i);
    }
    return name;
  }

  /// The word before `=` or `{`, or before the brackets of an array.
  std::string name_of_variable(size_t i) const {
    while (i > 0 && !is_word(i - 1)) i = is_symbol(i - 1, "]") ? partner_[i - 1] : i - 1;
    return i > 0 ? std::string(text(i - 1)) : "";
  }

  std::string name_of_function(const Head& head) const {
    std::string name;
    if (head.operator_at != kNone) {
      for (size_t i = head.operator_at; i < head.parameters; ++i)
        name += std::string(i > head.operator_at && is_word(i) ? " " : "") + std::string(text(i));
      return qualifier(head.operator_at, head.begin) + name;
    }
    size_t i = head.parameters;
    if (is_symbol(i - 1, ">")) i = before_template(i - 1, head.begin) + 1;
    name = text(i - 1);
    if (i >= 2 && is_symbol(i - 2, "~")) name = "~" + name, --i;
    return qualifier(i - 1, head.begin) + name;
  }
  /// "A::B::" before the token at `i`.
  std::string qualifier(size_t i, size_t begin) const {
    std::string names;
    while (i > begin + 1 && is_symbol(i - 1, "::")) {
      i -= 2;
      if (is_symbol(i, ">")) i = before_template(i, begin);
      if (!is_word(i)) break;
      names = std::string(text(i)) + "::" + names;
    }
    return names;
  }
  /// The token before the template arguments that `i` closes.
  size_t before_template(size_t i, size_t begin) const {
    for (size_t depth = 0; i > begin; --i) {
      if (is_symbol(i, ">")) ++depth;
      if (is_symbol(i, "<") && --depth == 0) return i - 1;
    }
    return begin;
  }

  int count_parameters(size_t open) const {
    const size_t close = partner_[open];
    if (close == open + 1 || (close == open + 2 && text(open + 1) == "void")) return 0;
    int count = 1;
    for (size_t i = open + 1; i < close;) {
      if (is_symbol(i, ",")) ++count;
      const size_t behind = behind_template(i);
      i = behind != kNone ? behind : opens_group(i) ? behind_group(i) : i + 1;
    }
    return count;
  }

  size_t read_body(const Head& head, size_t body, const std::string& prefix) {
    const int outer = std::exchange(deepest_, 0);
    for (size_t i = head.parameters; i < body;) i = scan_token(i, 0);
    read_block(body, 0);
    add_function(prefix + name_of_function(head), head.begin, partner_[body], count_parameters(head.parameters));
    deepest_ = outer;
    return behind_group(body);
  }
  void add_function(std::string name, size_t first, size_t last, int parameters) {
    const int line = tokens_[first].line;
    functions_.push_back({std::move(name), line, tokens_[last].line - line + 1, parameters, deepest_});
  }

  /// From `=` to the token after the semicolon; also for `= default;` and `= 0;`.
  size_t read_initialiser(size_t i, size_t end, const std::string& name) {
    const size_t semicolon = end_of_statement(i);
    scan_variable(i, std::min(semicolon, end), name);
    return semicolon + 1;
  }
  /// Looks for lambdas outside of functions.
  void scan_variable(size_t i, size_t end, const std::string& name) {
    while (i < end) {
      if (!begins_lambda(i)) {
        ++i;
        continue;
      }
      const int outer = std::exchange(deepest_, 0);
      const size_t first = i, parameters = behind_captures(i);
      i = read_lambda(i, 0);
      add_function(name, first, i - 1, is_symbol(parameters, "(") ? count_parameters(parameters) : 0);
      deepest_ = outer;
    }
  }

  bool begins_lambda(size_t i) const {
    static constexpr std::array<string_view, 5> kBefore = {"return", "throw", "else", "co_return", "co_yield"};
    static constexpr std::array<string_view, 7> kBehind = {"(", "{", "<", "->", "mutable", "constexpr", "noexcept"};
    if (!is_symbol(i, "[") || is_attribute(i) || i == 0) return false;
    const bool subscript = (is_word(i - 1) && !one_of(text(i - 1), kBefore)) ||
                           tokens_[i - 1].kind == TokenKind::kLiteral ||
                           one_of(text(i - 1), std::array<string_view, 3>{")", "]", ">"});
    if (subscript) return false;
    const bool binding = i > 1 && one_of(text(i - 1), std::array<string_view, 2>{"&", "&&"}) && text(i - 2) == "auto";
    return !binding && one_of(text(partner_[i] + 1), kBehind);
  }
  /// The parameter list, or its replacement.
  size_t behind_captures(size_t i) const {
    i = behind_group(i);
    if (!is_symbol(i, "<")) return i;
    for (size_t depth = 0;; ++i) {
      if (is_symbol(i, "<")) ++depth;
      if (is_symbol(i, ">") && --depth == 0) return i + 1;
    }
  }
  size_t read_lambda(size_t i, int depth) {
    i = behind_captures(i);
    while (!is_symbol(i, "{")) i = opens_group(i) ? behind_group(i) : i + 1;
    return read_block(i, depth);
  }

  size_t scan_token(size_t i, int depth) { return begins_lambda(i) ? read_lambda(i, depth) : i + 1; }

  size_t read_block(size_t open, int depth) {
    for (size_t i = open + 1; i < partner_[open];) i = read_statement(i, depth);
    return behind_group(open);
  }

  /// A statement nested in `depth` control statements. Returns the index after it.
  size_t read_statement(size_t i, int depth) {
    static constexpr std::array<string_view, 4> kControls = {"if", "for", "while", "switch"};
    while (is_attribute(i)) i = behind_group(i);
    if (is_symbol(i, "{")) return read_block(i, depth);
    if (one_of(text(i), kControls)) return read_control(i, depth);
    if (text(i) == "do") return end_of_statement(read_branch(i + 1, depth)) + 1;
    if (text(i) == "try") return read_try(i, depth);
    if (text(i) == "case" || (text(i) == "default" && is_symbol(i + 1, ":"))) return behind_label(i);
    if (const size_t body = body_of_local_class(i); body != kNone) i = behind_group(body);
    const size_t end = end_of_statement(i);
    while (i < end) i = scan_token(i, depth);
    return end + 1;
  }
  /// The body of a control statement at `depth`.
  size_t read_branch(size_t i, int depth) {
    deepest_ = std::max(deepest_, depth + 1);
    return read_statement(i, depth + 1);
  }
  size_t read_control(size_t i, int depth) {
    const bool may_have_else = text(i) == "if";
    while (!is_symbol(i, "(")) ++i;  // if constexpr
    const size_t close = partner_[i];
    while (i < close) i = scan_token(i, depth);
    i = read_branch(close + 1, depth);
    if (!may_have_else || text(i) != "else") return i;
    return text(i + 1) == "if" ? read_control(i + 1, depth) : read_branch(i + 1, depth);
  }
  size_t read_try(size_t i, int depth) {
    i = read_branch(i + 1, depth);
    while (text(i) == "catch") i = read_branch(behind_group(i + 1), depth);
    return i;
  }
  size_t behind_label(size_t i) const {
    while (!is_symbol(i, ":")) i = opens_group(i) ? behind_group(i) : i + 1;
    return i + 1;
  }
  size_t end_of_statement(size_t i) const {
    const size_t begin = i;
    while (i < tokens_.size() && !is_symbol(i, ";") && partner_[i] >= i) i = opens_group(i) ? behind_group(i) : i + 1;
    if (!is_symbol(i, ";"))
      throw std::runtime_error("line " + std::to_string(tokens_[begin].line) + ": the statement has no end");
    return i;
  }
  /// The brace of a class or enum that the statement defines, with its members read; kNone if it defines none.
  size_t body_of_local_class(size_t i) {
    static constexpr std::array<string_view, 4> kKinds = {"class", "struct", "union", "enum"};
    while (text(i) == "static" || text(i) == "const" || text(i) == "constexpr" || text(i) == "typedef") ++i;
    if (!one_of(text(i), kKinds)) return kNone;
    Head head{.begin = i, .kind = text(i), .kind_at = i};
    for (; !is_symbol(i, "{"); ++i)
      if (is_symbol(i, ";") || is_symbol(i, "=") || is_symbol(i, "(")) return kNone;
    if (is_scope(head, i)) read_scope(i + 1, partner_[i], scope_prefix(head));
    return i;
  }

  std::vector<Token> tokens_;
  std::vector<size_t> partner_;
  std::vector<CppFunction> functions_;
  int deepest_ = 0;  // nesting of the current function
};

}  // namespace

std::vector<CppFunction> cpp_functions(const std::string& source) { return Reader(source).functions(); }

}  // namespace ngs::test
