#pragma once
// The options of a tool as data, read by the command line, the options file, the schema, the help text and the report.
// An OptionSet is filled from describe() functions (field.h). It refers to the described structs, which
// must outlive it.
//
// Values from flags and from JSON pass the same checks: right type, finite, in range, known choice. A violation is
// Error(kUsage) "name = value, expected in [a, b]".
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
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

  /// Adds one option. Used by add().
  void push(OptionEntry entry);

 private:
  std::vector<OptionEntry> entries_;
};

namespace option_detail {

/// The visitor that is passed to describe(). Only what depends on the type of an enum is compiled per struct.
class Binder {
 public:
  Binder(OptionSet& set, OptionGroup group);

  void operator()(int& value, const Field<int>& field) const;
  void operator()(std::int64_t& value, const Field<std::int64_t>& field) const;
  void operator()(std::uint64_t& value, const Field<std::uint64_t>& field) const;
  void operator()(double& value, const Field<double>& field) const;
  void operator()(bool& value, const Flag& field) const;
  void operator()(std::string& value, const Text& field) const;
  void operator()(std::vector<std::string>& value, const Text& field) const;
  template <class E>
  void operator()(E& value, const Choice<E>& field) const {
    std::vector<std::string> names;
    for (const NamedValue<E>& choice : field.values) names.emplace_back(choice.name);
    add_choice(
        Text{field.name, "", field.help, field.notes}, std::move(names),
        [&value, values = field.values] { return name_of(values, value); },
        [&value, values = field.values](std::size_t index) { value = values[index].value; });
  }

 private:
  void add_choice(const Text& field, std::vector<std::string> names, std::function<std::string()> get,
                  std::function<void(std::size_t index)> set) const;

  OptionSet& set_;
  std::shared_ptr<const OptionGroup> group_;
};

}  // namespace option_detail

template <class Options>
void OptionSet::add(Options& options, OptionGroup group) {
  const option_detail::Binder binder(*this, std::move(group));
  Options::describe(options, binder);
}

}  // namespace ngs
