#pragma once
// One option, described once. CLI flag, JSON key, JSON schema, --help line, range check, provenance record and the
// warning about an unused option all come from this description. An options struct has
//
//   template <class Self, class Visitor> static void describe(Self& self, Visitor&& visit) {
//     visit(self.neighbours, Field<int>{"neighbours", "", "boundary Gaussians per query (before Eq. 8)", 1, 32});
//     visit(self.antialiased, Flag{"antialiased", "apply the opacity compensation"});
//     visit(self.window, Choice<Window>{"window", "centre of the depth window (C12)", kWindowNames});
//     visit(self.levels, Field<int>{"hash_levels", "", "levels of the grid", 1, 32}.of("nerf"));
//   }
//
// Names are snake_case; the flag is the same name with '-' (a one-letter name: -h). Besides the values in braces, a
// descriptor can have:
//
// clang-format off
//   .of("nerf")      the effect that must be on for the option to be used
//                    "joint|contours": one of them must be on; "mask,joint|contours": that, and mask
//   .letter('l')     a short flag, -l
// clang-format on
#include <span>
#include <string_view>

namespace ngs {

/// The values of .of() and .letter(); empty if not given.
struct OptionNotes {
  std::string_view effect = {};
  char letter = '\0';

  constexpr OptionNotes of(std::string_view name) const { return {name, letter}; }
  constexpr OptionNotes with_letter(char c) const { return {effect, c}; }
};

/// A number (int, std::int64_t, std::uint64_t or double) in [min, max].
template <class T>
struct Field {
  std::string_view name, unit, help;
  T min, max;
  OptionNotes notes = {};

  constexpr Field of(std::string_view effect) const { return {name, unit, help, min, max, notes.of(effect)}; }
  constexpr Field letter(char c) const { return {name, unit, help, min, max, notes.with_letter(c)}; }
};

struct Flag {  // bool
  std::string_view name, help;
  OptionNotes notes = {};

  constexpr Flag of(std::string_view effect) const { return {name, help, notes.of(effect)}; }
  constexpr Flag letter(char c) const { return {name, help, notes.with_letter(c)}; }
};

struct Text {  // std::string, or std::vector<std::string> for a repeatable option
  std::string_view name, placeholder, help;
  OptionNotes notes = {};

  constexpr Text of(std::string_view effect) const { return {name, placeholder, help, notes.of(effect)}; }
  constexpr Text letter(char c) const { return {name, placeholder, help, notes.with_letter(c)}; }
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
  OptionNotes notes = {};

  constexpr Choice of(std::string_view effect) const { return {name, help, values, notes.of(effect)}; }
  constexpr Choice letter(char c) const { return {name, help, values, notes.with_letter(c)}; }
};

}  // namespace ngs
