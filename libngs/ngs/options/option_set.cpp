#include "ngs/options/option_set.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/options/near_matches.h"
#include "ngs/options/strict_json.h"

namespace ngs {
namespace {

/// Parses the whole text, which may begin with '+'.
template <class T>
bool parse_signed(std::string_view text, T& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return parse_number(text, value);
}

/// A typed number as JSON. Other text stays text, so that the check of the option reports it.
Json typed_number(std::string_view text, OptionKind kind) {
  std::int64_t integer = 0;
  std::uint64_t large = 0;
  double real = 0;
  if (parse_signed(text, integer)) return integer;
  if (parse_signed(text, large)) return large;
  if (kind == OptionKind::kReal && parse_signed(text, real)) return real;
  return std::string(text);
}

Json typed_bool(const std::string& text) {
  if (text == "true" || text == "on" || text == "1" || text == "yes") return true;
  if (text == "false" || text == "off" || text == "0" || text == "no") return false;
  return text;
}

/// A value for a message: shortened, and with names for non-finite numbers, which JSON prints as null.
std::string shown(const Json& value) {
  if (value.is_number_float() && !std::isfinite(value.get<double>()))
    return std::isnan(value.get<double>()) ? "nan" : "infinity";
  if (value.is_structured()) return "an " + std::string(value.type_name());
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() <= 80 ? text : text.substr(0, 77) + "...";
}

[[noreturn]] void fail(std::string_view name, const Json& value, const std::string& expected, std::string remedy = {}) {
  throw Error(ErrorCode::kUsage, std::string(name) + " = " + shown(value) + ", expected " + expected,
              std::move(remedy));
}

template <class T>  // std::int64_t, std::uint64_t, double
struct Range {
  std::string name, unit;
  T min, max;
};

template <class T>
std::string describe_range(const Range<T>& range, const char* what) {
  const std::string unit = range.unit.empty() ? "" : " " + range.unit;
  return what + std::string("in [") + Json(range.min).dump() + ", " + Json(range.max).dump() + "]" + unit;
}

std::int64_t checked(const Range<std::int64_t>& range, const Json& value) {
  if (!value.is_number_integer()) fail(range.name, value, describe_range(range, "an integer "));
  const bool fits = !value.is_number_unsigned() || value.get<std::uint64_t>() <= std::uint64_t(INT64_MAX);
  if (!fits || value.get<std::int64_t>() < range.min || value.get<std::int64_t>() > range.max)
    fail(range.name, value, describe_range(range, ""));
  return value.get<std::int64_t>();
}

std::uint64_t checked(const Range<std::uint64_t>& range, const Json& value) {
  if (!value.is_number_integer()) fail(range.name, value, describe_range(range, "an integer "));
  const bool negative = !value.is_number_unsigned() && value.get<std::int64_t>() < 0;
  if (negative || value.get<std::uint64_t>() < range.min || value.get<std::uint64_t>() > range.max)
    fail(range.name, value, describe_range(range, ""));
  return value.get<std::uint64_t>();
}

double checked(const Range<double>& range, const Json& value) {
  if (!value.is_number()) fail(range.name, value, describe_range(range, "a number "));
  const double number = value.get<double>();
  if (!(number >= range.min && number <= range.max)) fail(range.name, value, describe_range(range, ""));
  return number;
}

bool checked_bool(std::string_view name, const Json& value) {
  if (!value.is_boolean()) fail(name, value, "true or false");
  return value.get<bool>();
}

std::string checked_text(std::string_view name, const Json& value) {
  if (!value.is_string()) fail(name, value, "a text");
  return value.get<std::string>();
}

std::vector<std::string> checked_texts(std::string_view name, const Json& value) {
  if (!value.is_array()) fail(name, value, "a list of texts");
  std::vector<std::string> texts;
  for (const Json& item : value) texts.push_back(checked_text(name, item));
  return texts;
}

std::size_t checked_choice(std::string_view name, const Json& value, const std::vector<std::string>& choices) {
  std::string listed;
  for (const std::string& choice : choices) listed += (listed.empty() ? "" : ", ") + choice;
  if (!value.is_string()) fail(name, value, "one of " + listed);
  const auto found = std::find(choices.begin(), choices.end(), value.get<std::string>());
  if (found == choices.end()) fail(name, value, "one of " + listed, suggestion(value.get<std::string>(), choices));
  return std::size_t(found - choices.begin());
}

/// A new entry with everything but its values.
template <class Descriptor>
OptionEntry make_entry(const Descriptor& field, std::string_view unit, OptionKind kind,
                       const std::shared_ptr<const OptionGroup>& group) {
  OptionEntry entry;
  entry.name = group->prefix + std::string(field.name);
  entry.unit = unit;
  entry.help = field.help;
  entry.kind = kind;
  entry.group = group;
  entry.letter = field.notes.letter;
  entry.effect = field.notes.effect.empty() ? group->effect : std::string(field.notes.effect);
  return entry;
}

template <class Wide, class T>
OptionEntry number(T& value, const Field<T>& field, const std::shared_ptr<const OptionGroup>& group) {
  OptionEntry entry =
      make_entry(field, field.unit, std::is_integral_v<T> ? OptionKind::kInteger : OptionKind::kReal, group);
  entry.min = field.min;
  entry.max = field.max;
  entry.get = [&value] { return Json(value); };
  entry.set = [&value, range = Range<Wide>{entry.name, entry.unit, field.min, field.max}](const Json& json) {
    value = T(checked(range, json));
  };
  return entry;
}

}  // namespace

namespace option_detail {

Binder::Binder(OptionSet& set, OptionGroup group)
    : set_(set), group_(std::make_shared<const OptionGroup>(std::move(group))) {}

void Binder::operator()(int& value, const Field<int>& field) const {
  set_.push(number<std::int64_t>(value, field, group_));
}

void Binder::operator()(std::int64_t& value, const Field<std::int64_t>& field) const {
  set_.push(number<std::int64_t>(value, field, group_));
}

void Binder::operator()(std::uint64_t& value, const Field<std::uint64_t>& field) const {
  set_.push(number<std::uint64_t>(value, field, group_));
}

void Binder::operator()(double& value, const Field<double>& field) const {
  set_.push(number<double>(value, field, group_));
}

void Binder::operator()(bool& value, const Flag& field) const {
  OptionEntry entry = make_entry(field, "", OptionKind::kBool, group_);
  entry.get = [&value] { return Json(value); };
  entry.set = [&value, name = entry.name](const Json& json) { value = checked_bool(name, json); };
  set_.push(std::move(entry));
}

void Binder::operator()(std::string& value, const Text& field) const {
  OptionEntry entry = make_entry(field, field.placeholder, OptionKind::kText, group_);
  entry.get = [&value] { return Json(value); };
  entry.set = [&value, name = entry.name](const Json& json) { value = checked_text(name, json); };
  set_.push(std::move(entry));
}

void Binder::operator()(std::vector<std::string>& value, const Text& field) const {
  OptionEntry entry = make_entry(field, field.placeholder, OptionKind::kTextList, group_);
  entry.get = [&value] { return Json(value); };
  entry.set = [&value, name = entry.name](const Json& json) { value = checked_texts(name, json); };
  set_.push(std::move(entry));
}

void Binder::add_choice(const Text& field, std::vector<std::string> names, std::function<std::string()> get,
                        std::function<void(std::size_t index)> set) const {
  OptionEntry entry = make_entry(field, "", OptionKind::kChoice, group_);
  entry.choices = std::move(names);
  entry.get = [get = std::move(get)] { return Json(get()); };
  entry.set = [set = std::move(set), name = entry.name, names = entry.choices](const Json& json) {
    set(checked_choice(name, json, names));
  };
  set_.push(std::move(entry));
}

}  // namespace option_detail

std::string option_flag(std::string_view name) {
  std::string flag = (name.size() == 1 ? "-" : "--") + std::string(name);
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

bool is_used(const OptionEntry& entry) { return !entry.group->applies || entry.group->applies(); }

Json parse_json(std::string_view text, std::string_view source) {
  return parse_strict_json<Json>(text, source, ErrorCode::kUsage);
}

void OptionSet::push(OptionEntry entry) {
  for (const OptionEntry& other : entries_)
    NGS_CHECK(other.name != entry.name, "option '" + entry.name + "' is described twice");
  entry.default_value = entry.get();
  entries_.push_back(std::move(entry));
}

std::vector<std::string> OptionSet::names() const {
  std::vector<std::string> names;
  for (const OptionEntry& entry : entries_) names.push_back(entry.name);
  return names;
}

std::vector<const OptionEntry*> OptionSet::changed() const {
  std::vector<const OptionEntry*> given;
  for (const OptionEntry& entry : entries_)
    if (entry.get() != entry.default_value) given.push_back(&entry);
  return given;
}

const OptionEntry& OptionSet::at(std::string_view name, std::string_view source) const {
  for (const OptionEntry& entry : entries_)
    if (entry.name == name) return entry;
  throw Error(ErrorCode::kUsage,
              (source.empty() ? "" : std::string(source) + ": ") + "unknown option '" + std::string(name) + "'",
              suggestion(name, names()));
}

void OptionSet::set_text(std::string_view name, const std::vector<std::string>& texts) const {
  const OptionEntry& entry = at(name);
  if (entry.kind == OptionKind::kTextList) return entry.set(texts);
  NGS_CHECK(!texts.empty(), "set_text needs a value");
  const std::string& text = texts.back();
  if (entry.kind == OptionKind::kInteger || entry.kind == OptionKind::kReal)
    return entry.set(typed_number(text, entry.kind));
  entry.set(entry.kind == OptionKind::kBool ? typed_bool(text) : Json(text));
}

void OptionSet::set_json(const Json& values, std::string_view source) const {
  if (!values.is_object())
    throw Error(ErrorCode::kUsage,
                std::string(source) + ": found " + values.type_name() + ", expected an object of options");
  for (const auto& item : values.items()) {
    const OptionEntry& entry = at(item.key(), source);
    with_context(source, [&] { entry.set(item.value()); });
  }
}

Json OptionSet::to_json() const {
  Json values = Json::object();
  for (const OptionEntry& entry : entries_) values[entry.name] = entry.get();
  return values;
}

Json OptionSet::property_schema(std::string_view name) const {
  static constexpr const char* kTypes[] = {"boolean", "integer", "number", "string", "array", "string"};
  const OptionEntry& entry = at(name);
  Json property = {{"type", kTypes[int(entry.kind)]}, {"description", entry.help}};
  if (!entry.min.is_null()) property.update({{"minimum", entry.min}, {"maximum", entry.max}});
  if (entry.kind == OptionKind::kTextList) property["items"] = {{"type", "string"}};
  if (!entry.choices.empty()) property["enum"] = entry.choices;
  if (!entry.unit.empty() && !entry.min.is_null()) property["x-unit"] = entry.unit;
  property["default"] = entry.default_value;
  return property;
}

Json OptionSet::schema(std::string_view title) const {
  Json properties = Json::object();
  for (const OptionEntry& entry : entries_) properties[entry.name] = property_schema(entry.name);
  return {{"$schema", "http://json-schema.org/draft-07/schema#"},
          {"title", std::string(title)},
          {"type", "object"},
          {"additionalProperties", false},
          {"properties", std::move(properties)}};
}

}  // namespace ngs
