#pragma once
// The options of a tool as data, read by the command line, the options file, the schema, the help text and the report.
// An OptionSet is filled from describe() functions (field.h). It refers to the described structs, which
// must outlive it.
//
// Values from flags and from JSON pass the same checks: right type, finite, in range, known choice. A violation is
// Error(kUsage) "name = value, expected in [a, b]".
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "ngs/core/check.h"
#include "ngs/options/field.h"
#include "ngs/options/name_of.h"

namespace ngs {

using Json = nlohmann::ordered_json;

enum class OptionKind { kBool, kInteger, kReal, kText, kTextList, kChoice };

/// The shortest help that shows a group of options: -h, --help, or --help NAME (and --help all).
enum class Shown { kInShortHelp, kInHelp, kByName };

/// Properties that the options of one struct share in one tool.
struct OptionGroup {
  std::string name = "options";        // for --help NAME; groups of one name share a section of the help
  std::string about = {};              // what follows the name in the help
  std::string prefix = {};             // of the option names: "fit_" -> --fit-steps
  std::string effect = {};             // of options without an effect of their own, see Field::of()
  std::function<bool()> applies = {};  // called once all values are set; false: its options are unused. Empty: true
  std::string needs = {};              // the setting with which it applies: "--method cob"
  Shown shown = Shown::kInHelp;
};

struct OptionEntry {
  std::string name;  // snake_case, unique in its set; the flag has '-' for '_'
  std::string unit;  // of a number; the placeholder of a text
  std::string help;
  OptionKind kind = OptionKind::kBool;
  Json min, max;  // of a number, else null
  std::vector<std::string> choices;
  std::shared_ptr<const OptionGroup> group;
  std::string effect;  // see Field::of(); empty: none is needed
  char letter = '\0';  // short flag; 0: none
  Json default_value;  // the value when it was added
  std::function<Json()> get;
  std::function<void(const Json&)> set;  // checks, then stores
};

/// "--bbox-pad-px" for "bbox_pad_px", "-h" for "h".
std::string option_flag(std::string_view name);

/// False if the group of the option does not apply.
bool is_used(const OptionEntry& entry);

/// Parses `text` as JSON. A key that occurs twice in one object is an error, as is anything after the value.
Json parse_json(std::string_view text, std::string_view source);

class OptionSet {
 public:
  /// Adds every option that Options::describe() visits.
  template <class Options>
  void add(Options& options, OptionGroup group = {});
  template <class Options>
  void add(Options& options, std::string_view prefix) {
    add(options, OptionGroup{.prefix = std::string(prefix)});
  }

  const std::vector<OptionEntry>& entries() const { return entries_; }
  std::vector<std::string> names() const;
  /// Options whose value differs from the default. Whether an option was set does not count, because an options file
  /// sets all.
  std::vector<const OptionEntry*> changed() const;
  /// The entry of this name, or Error(kUsage) that suggests the nearest names.
  const OptionEntry& at(std::string_view name, std::string_view source = {}) const;

  /// Values as typed on a command line: all of them for a text list, else the last one.
  void set_text(std::string_view name, const std::vector<std::string>& texts) const;
  /// `source` names the file in messages.
  void set_json(const Json& values, std::string_view source) const;
  Json to_json() const;
  /// JSON Schema (draft-07) of to_json(), defaults included.
  Json schema(std::string_view title) const;
  /// The schema of one option.
  Json property_schema(std::string_view name) const;

 private:
  void push(OptionEntry entry);

  std::vector<OptionEntry> entries_;
};

namespace option_detail {

template <class T>  // std::int64_t, std::uint64_t, double
struct Range {
  std::string name, unit;
  T min, max;
};
std::int64_t checked(const Range<std::int64_t>& range, const Json& value);
std::uint64_t checked(const Range<std::uint64_t>& range, const Json& value);
double checked(const Range<double>& range, const Json& value);
bool checked_bool(std::string_view name, const Json& value);
std::string checked_text(std::string_view name, const Json& value);
std::vector<std::string> checked_texts(std::string_view name, const Json& value);
std::size_t checked_choice(std::string_view name, const Json& value, const std::vector<std::string>& choices);

/// The visitor that is passed to describe().
struct Binder {
  std::function<void(OptionEntry)> push;
  std::shared_ptr<const OptionGroup> group;

  template <class Descriptor>
  OptionEntry entry(const Descriptor& field, std::string_view unit, OptionKind kind) const {
    OptionEntry e;
    e.name = group->prefix + std::string(field.name);
    e.unit = unit;
    e.help = field.help;
    e.kind = kind;
    e.group = group;
    e.letter = field.notes.letter;
    e.effect = field.notes.effect.empty() ? group->effect : std::string(field.notes.effect);
    return e;
  }

  template <class T>
  void operator()(T& value, const Field<T>& field) const {
    static_assert(std::is_same_v<T, double> || (std::is_integral_v<T> && sizeof(T) >= sizeof(int)),
                  "a number option is int, std::int64_t, std::uint64_t or double");
    using Wide = std::conditional_t<std::is_same_v<T, double>, double,
                                    std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>>;
    OptionEntry e = entry(field, field.unit, std::is_integral_v<T> ? OptionKind::kInteger : OptionKind::kReal);
    e.min = field.min;
    e.max = field.max;
    e.get = [&value] { return Json(value); };
    e.set = [&value, range = Range<Wide>{e.name, e.unit, Wide(field.min), Wide(field.max)}](const Json& json) {
      value = T(checked(range, json));
    };
    push(std::move(e));
  }

  void operator()(bool& value, const Flag& field) const {
    OptionEntry e = entry(field, "", OptionKind::kBool);
    e.get = [&value] { return Json(value); };
    e.set = [&value, name = e.name](const Json& json) { value = checked_bool(name, json); };
    push(std::move(e));
  }

  void operator()(std::string& value, const Text& field) const {
    OptionEntry e = entry(field, field.placeholder, OptionKind::kText);
    e.get = [&value] { return Json(value); };
    e.set = [&value, name = e.name](const Json& json) { value = checked_text(name, json); };
    push(std::move(e));
  }

  void operator()(std::vector<std::string>& value, const Text& field) const {
    OptionEntry e = entry(field, field.placeholder, OptionKind::kTextList);
    e.get = [&value] { return Json(value); };
    e.set = [&value, name = e.name](const Json& json) { value = checked_texts(name, json); };
    push(std::move(e));
  }

  template <class E>
  void operator()(E& value, const Choice<E>& field) const {
    OptionEntry e = entry(field, "", OptionKind::kChoice);
    for (const NamedValue<E>& choice : field.values) e.choices.emplace_back(choice.name);
    e.get = [&value, values = field.values] { return Json(name_of(values, value)); };
    e.set = [&value, values = field.values, name = e.name, names = e.choices](const Json& json) {
      value = values[checked_choice(name, json, names)].value;
    };
    push(std::move(e));
  }
};

}  // namespace option_detail

template <class Options>
void OptionSet::add(Options& options, OptionGroup group) {
  option_detail::Binder binder{[this](OptionEntry e) { push(std::move(e)); },
                               std::make_shared<const OptionGroup>(std::move(group))};
  Options::describe(options, binder);
}

}  // namespace ngs
