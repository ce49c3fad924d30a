// support/cpp_functions.h on functions of known size.
#include <doctest/doctest.h>

#include <stdexcept>

#include "support/cpp_functions.h"
#include "support/cpp_tokens.h"
#include "support/source_tree.h"

namespace ngs {
namespace {

using test::cpp_functions;
using test::CppFunction;

/// "name lines/parameters/nesting" of every function, separated by "; ".
std::string measured(const std::string& source) {
  std::string text;
  for (const CppFunction& f : cpp_functions(source))
    text += (text.empty() ? "" : "; ") + f.name + " " + std::to_string(f.lines) + "/" + std::to_string(f.parameters) +
            "/" + std::to_string(f.nesting);
  return text;
}

std::string words(const std::string& source) {
  std::string text;
  for (const test::Token& token : test::cpp_tokens(source)) text += std::string(token.text) + " ";
  return text;
}

std::string body_nesting(const std::string& body) { return measured("void f() {" + body + "}"); }

}  // namespace

TEST_CASE("tokens: brackets in comments, strings and preprocessor lines are ignored") {
  CHECK(words("a /* { */ b // }\nc") == "a b c ");
  CHECK(words("#define M(x) \\\n  { x\nint a;\n  # if 1 // (\nb") == "int a ; b ");
  CHECK(words("\"}\\\"{\" '{' L'\\'' u8\"(\"s") == "\"}\\\"{\" '{' L'\\'' u8\"(\"s ");
  CHECK(words("R\"x({)\" )x\" b") == "R\"x({)\" )x\" b ");
  CHECK(words("1'000 0x1p-20 .5e+3f a.b x-1") == "1'000 0x1p-20 .5e+3f a . b x - 1 ");
  CHECK(words("a::b->c>>d<<e") == "a :: b -> c > > d < < e ");
  CHECK(test::cpp_tokens("a\n\nR\"(\n\n)\" b").back().line == 5);
}

TEST_CASE("an unbalanced bracket is an error with the line number") {
  CHECK_THROWS_WITH(cpp_functions("int f() {\n  if (x) }"), "line 2: the statement has no end");
  CHECK_THROWS_WITH(cpp_functions("int f() {\n  (a];\n}"), "line 2: ']' closes nothing");
  CHECK_THROWS_WITH(cpp_functions("int f() {\n"), "line 1: bracket is never closed");
  CHECK_THROWS_WITH(cpp_functions("\nint f()\n"), "line 2: the declaration has no end");
}

TEST_CASE("lines of a function are counted from its template header to its closing brace") {
  CHECK(measured("int f() { return 1; }") == "f 1/0/0");
  CHECK(measured("// above\ntemplate <class T>\n[[nodiscard]] T f(\n    T a)\n{\n  return a;\n}\n// below") ==
        "f 6/1/0");
  CHECK(measured("int f();\nint g() = delete;\nextern int h(int a, int b);\nstruct S { S() = default; virtual int v() "
                 "= 0; };") == "");
  CHECK(cpp_functions("\n\nint f() {\n}")[0].line == 3);
}

TEST_CASE("function names include classes but no namespaces") {
  CHECK(measured("namespace a::b { namespace { struct S : T<int> { int f() {} struct U { void g() {} }; } s; } }") ==
        "S::f 1/0/0; S::U::g 1/0/0");
  CHECK(measured("int A<T>::B::f() const noexcept {} A::~A() {} template <> void g<int>(int) {}") ==
        "A::B::f 1/0/0; A::~A 1/0/0; g 1/1/0");
  CHECK(measured("struct alignas(16) P final { P operator+(P b) const {} void operator()(int i) const {}\n"
                 "explicit operator bool() const {} P& operator=(P&&) noexcept {} bool operator<(P b) const {} };") ==
        "P::operator+ 1/1/0; P::operator() 1/1/0; P::operator bool 1/0/0; P::operator= 1/1/0; P::operator< 1/1/0");
  CHECK(measured("extern \"C\" { int c(int a) {} }\nextern \"C\" int d() {}") == "c 1/1/0; d 1/0/0");
  CHECK(measured("std::ostream& operator<<(std::ostream& o, int x) {}") == "operator<< 1/2/0");
}

TEST_CASE("parameter counts ignore commas of templates, defaults and lambdas") {
  CHECK(measured("void f(void) {}") == "f 1/0/0");
  CHECK(measured("template <class A, class B, int N = 2> NGS_HD void f(std::map<A, B> m, std::array<A, (N > 1 ? 2 : "
                 "3)> a) {}") == "f 1/2/0");
  CHECK(measured(
            "void f(int a = g(1, 2), V v = {1, 2}, P p = std::pair<int, int>(1, 2), bool b = x < y, int c = 0) {}") ==
        "f 1/5/0");
  CHECK(measured("void f(std::function<void(int, int)> g = [](int a, int b) {}, void (*h)(int, int) = nullptr) {}") ==
        "f 1/2/0");
  CHECK(measured("template <class... A> auto f(const A&... a) -> std::tuple<A, A> {}") == "f 1/1/0");
  CHECK(measured("template <class T> requires(sizeof(T) > 1) __launch_bounds__(128, 2) void f(T a, T b) "
                 "noexcept(noexcept(a, b)) {}") == "f 1/2/0");
  CHECK(measured("template <class T> requires requires(T t, int n) { t.x; } void f(T a) requires C<T> {}") ==
        "f 1/1/0");
  CHECK(measured("template <class T> void f(T a) requires(A<T, T> && B) {}") == "f 1/1/0");
}

TEST_CASE("initialisers are part of a constructor, and their braces are not its body") {
  CHECK(measured("struct S : B<int> {\n  S(int a, int b)\n      : B<int>{a, b}, x_{a}, y_(b) {\n    if (a) x_ = 2;\n  "
                 "}\n};") == "S::S 4/2/1");
  CHECK(measured("S::S(int a) : f_([](int x, int y) { if (x) return y; }) {}") == "S::S 1/1/1");
}

TEST_CASE("declarations that resemble functions are not counted") {
  CHECK(measured("int x{3}; std::vector<int> v = {1, 2}; const S s{.a = 1}; S t(1, 2); alignas(8) float y[2]{};") ==
        "");
  CHECK(measured("enum class E : int { a = (1), b }; struct F { int bits : 3; enum { c } d{c}; };") == "");
  CHECK(measured("template <class T> concept C = requires(T t) { { t.f() } -> D<int>; }; using G = int (*)(int);") ==
        "");
  CHECK(measured("static_assert(f(1) == 2); class A; friend class B; template class std::vector<int>;") == "");
  CHECK(measured("std::function<void(int)> g{nullptr}; decltype(f(1)) z{2};") == "");
}

TEST_CASE("nesting counts control statements with and without braces; else-if is on the level of its if") {
  CHECK(body_nesting("a = 1; { { b = 2; } }") == "f 1/0/0");
  CHECK(body_nesting("if (a) b(); else if (c) d(); else if (e) g(); else h();") == "f 1/0/1");
  CHECK(body_nesting("if (a) b(); else { if (c) d(); }") == "f 1/0/2");
  CHECK(body_nesting("for (int i = 0; i < n; ++i) for (auto& [k, v] : m) if constexpr (N > 1) while (x) { y(); }") ==
        "f 1/0/4");
  CHECK(body_nesting("switch (a) { case X::b: { if (c) d(); } default: e(); }") == "f 1/0/2");
  CHECK(body_nesting("do { if (a) b(); } while (c); if (d) e();") == "f 1/0/2");
  CHECK(body_nesting("try { if (a) b(); } catch (const E& e) { while (c) if (d) g(); } catch (...) {}") == "f 1/0/3");
  CHECK(body_nesting("for (;;) [[likely]] { if (a) [[unlikely]] b(); }") == "f 1/0/2");
}

TEST_CASE("a lambda is part of the enclosing function and adds no nesting level") {
  CHECK(body_nesting("if (a) g([&](int x, int y) {\n if (x) return y;\n});") == "f 3/0/2");
  CHECK(body_nesting("for (;;) return [=]<class T>(T x) mutable -> std::vector<T> { for (;;) if (x) y(); }();") ==
        "f 1/0/3");
  CHECK(body_nesting("if (a[0] && b()[1] && S{.x = [] { while (1) {} }}.x) delete[] p;") == "f 1/0/1");
  CHECK(body_nesting("const auto& [x, y] = z; int w[2] = {x, y}; auto [q] = f<int>();") == "f 1/0/0");
  CHECK(body_nesting("A{[] { if (a) b(); }}; kernel<<<g, 1>>>(a);") == "f 1/0/1");
}

TEST_CASE("a lambda outside functions is a function with the name of its variable") {
  CHECK(measured("const auto g = [](int a, int b) { if (a) return b; };") == "g 1/2/1");
  CHECK(measured("static const V v{[] { for (;;) {} }()}; struct S { F h = [](int a) {\n}; };") == "v 1/0/1; h 2/1/0");
}

TEST_CASE("members of a local class are separate functions") {
  CHECK(body_nesting("struct T { int g(int a) { if (a) return a; } }; struct stat s; for (;;) T().g(1);") ==
        "T::g 1/1/1; f 1/0/1");
  CHECK(body_nesting("enum { a, b }; static const struct { int x; } c = {1}; if (b) d();") == "f 1/0/1");
}

TEST_CASE("every source file of the library and the tools can be parsed") {
  std::vector<CppFunction> all;
  for (const test::SourceFile& file : test::code_files()) {
    INFO(file.path);
    std::vector<CppFunction> found;
    CHECK_NOTHROW(found = cpp_functions(file.text));
    all.insert(all.end(), found.begin(), found.end());
  }
  CHECK(all.size() > 1000);
}

}  // namespace ngs
