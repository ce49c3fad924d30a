#pragma once
// One option, described once. CLI flag, JSON key, JSON schema, --help line, range check and the provenance
// record are all read from these. An options struct has
//
//   template <class Self, class Visitor> static void describe(Self& self, Visitor&& visit) {
//     visit(self.neighbours, Field<int>{"neighbours", "", "boundary Gaussians per query (before Eq. 8)", 1, 32});
//     visit(self.antialiased, Flag{"antialiased", "apply the opacity compensation"});
//     visit(self.window, Choice<Window>{"window", "centre of the depth window (C12)", kWindowNames});
//   }
//
// Names are snake_case; the flag is the same name with '-'.
#include <span>
#include <string_view>

namespace ngs {

/// A number (int, std::int64_t, std::uint64_t or double) in [min, max].
template <class T>
struct Field {
  std::string_view name, unit, help;
  T min, max;
};

struct Flag {  // bool
  std::string_view name, help;
};

struct Text {  // std::string, or std::vector<std::string> for a repeatable option
  std::string_view name, placeholder, help;
};

template <class E>
struct NamedValue {
  E value;
  std::string_view name;
};

template <class E>
struct Choice {  // an enum class
  std::string_view name, help;
  std::span<const NamedValue<E>> values;
};

}  // namespace ngs
