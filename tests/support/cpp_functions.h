#pragma once
// Finds the functions of a C++ or CUDA source file and measures their size, from the tokens alone: no compiler, and
// fast enough for the whole tree.
//
// clang-format off
//   lines       from the first token of the declaration, template header and attributes included, to the closing brace
//   parameters  of the function; not those of its template or of lambdas in it
//   nesting     the maximum number of nested if, for, while, switch, do and try, with or without braces. An else-if has
//               the level of its if. A lambda's body adds no level of its own; the statements around the lambda count.
// clang-format on
//
// A lambda is part of the enclosing function. A lambda outside of functions, which initialises a variable, is a
// function with the variable's name. Members of a local class are functions of their own, and also lines of the
// enclosing one.
#include <string>
#include <vector>

namespace ngs::test {

struct CppFunction {
  std::string name;  // with its classes, without namespaces and template arguments: "Pack::operator+"
  int line = 0;      // of the first token
  int lines = 0, parameters = 0, nesting = 0;
};

/// In the order of their ends. Throws std::runtime_error with the line if brackets do not pair or a declaration has no
/// end.
std::vector<CppFunction> cpp_functions(const std::string& source);

}  // namespace ngs::test
