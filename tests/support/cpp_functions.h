#pragma once
// The function definitions of a C++ or CUDA source file and their sizes, read from its tokens: without a compiler, and
// for all of a tree in a moment.
//
//   lines       from the first token of the declaration, template header and attributes included, to the closing brace
//   parameters  of the function; those of its template and of lambdas in it are not counted
//   nesting     the most if, for, while, switch, do and try around one statement, with or without braces. An else-if
//               stands beside its if. A lambda's body is no level of its own, but the control statements around the
//               lambda count for those in its body.
//
// A lambda is part of the function around it. One outside of any function, which initialises a variable, is a function
// of that variable's name. Members of a local class are functions of their own, besides being lines of the enclosing
// one.
#include <string>
#include <vector>

namespace ngs::test {

struct CppFunction {
  std::string name;  // with its classes, without namespaces and template arguments: "Pack::operator+"
  int line = 0;      // of the first token
  int lines = 0, parameters = 0, nesting = 0;
};

/// In the order of their ends. Throws std::runtime_error with the line where brackets do not pair or a declaration
/// has no end.
std::vector<CppFunction> cpp_functions(const std::string& source);

}  // namespace ngs::test
