#include "ngs/options/option_set.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>

#include "ngs/core/error.h"
#include "ngs/options/near_matches.h"
#include "ngs/options/option_warnings.h"
#include "support/error_code.h"

namespace ngs {
namespace {

enum class Window { kMean, kPixel };
constexpr NamedValue<Window> kWindows[] = {{Window::kMean, "mean"}, {Window::kPixel, "pixel"}};

struct SampleOptions {  // one option of every kind
  int neighbours = 8;
  std::int64_t offset = -5;
  std::uint64_t salt = 7;
  double tau = 0.6;
  bool antialiased = true;
  std::string note = "x";
  std::vector<std::string> objects;
  Window window = Window::kPixel;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.neighbours, Field<int>{"neighbours", "", "how many", 1, 32});
    visit(self.offset, Field<std::int64_t>{"offset", "px", "moves", INT64_MIN, 10});
    visit(self.salt, Field<std::uint64_t>{"salt", "", "mixes", 1, UINT64_MAX});
    visit(self.tau, Field<double>{"tau", "", "threshold", 0, 1});
    visit(self.antialiased, Flag{"antialiased", "compensates"});
    visit(self.note, Text{"note", "TEXT", "is kept"});
    visit(self.objects, Text{"objects", "NAME", "to cut out"});
    visit(self.window, Choice<Window>{"window", "centre", kWindows});
  }
};

struct Fixture {
  SampleOptions options;
  OptionSet set;
  Fixture() { set.add(options); }
};

std::string message_of(const auto& body) {
  const Error e = test::thrown_by(body);
  CHECK(e.code() == ErrorCode::kUsage);
  return std::string(e.what()) + " | " + e.remedy();
}

}  // namespace

TEST_CASE_FIXTURE(Fixture, "options are unchanged after a round trip through JSON") {
  options = {3, -9, UINT64_MAX, 0.1, false, "y", {"a", "b"}, Window::kMean};
  const Json written = parse_json(set.to_json().dump(), "a test");
  options = {};
  set.set_json(written, "a test");
  CHECK(options.neighbours == 3);
  CHECK(options.offset == -9);
  CHECK(options.salt == UINT64_MAX);
  CHECK(options.tau == 0.1);
  CHECK_FALSE(options.antialiased);
  CHECK(options.note == "y");
  CHECK(options.objects == std::vector<std::string>{"a", "b"});
  CHECK(options.window == Window::kMean);
}

TEST_CASE_FIXTURE(Fixture, "typed text sets every kind of option; the last of several values wins") {
  set.set_text("neighbours", {"3", "4"});
  set.set_text("tau", {"1e-3"});
  set.set_text("antialiased", {"off"});
  set.set_text("objects", {"a", "b"});
  set.set_text("window", {"mean"});
  set.set_text("note", {"12"});  // a text that looks like a number
  CHECK(options.neighbours == 4);
  CHECK(options.tau == 1e-3);
  CHECK_FALSE(options.antialiased);
  CHECK(options.objects == std::vector<std::string>{"a", "b"});
  CHECK(options.window == Window::kMean);
  CHECK(options.note == "12");
}

TEST_CASE_FIXTURE(Fixture, "a value outside its range is an error that states the range; the ends are inside") {
  CHECK(message_of([&] { set.set_text("neighbours", {"0"}); }) == "neighbours = 0, expected in [1, 32] | ");
  CHECK(message_of([&] { set.set_text("neighbours", {"33"}); }) == "neighbours = 33, expected in [1, 32] | ");
  CHECK(message_of([&] { set.set_text("offset", {"11"}); }) ==
        "offset = 11, expected in [-9223372036854775808, 10] px | ");
  CHECK(message_of([&] { set.set_text("salt", {"-1"}); }) == "salt = -1, expected in [1, 18446744073709551615] | ");
  CHECK(message_of([&] { set.set_text("offset", {"18446744073709551615"}); }).find("expected in") != std::string::npos);
  set.set_text("neighbours", {"1"});
  set.set_text("neighbours", {"32"});
  CHECK(options.neighbours == 32);
}

TEST_CASE_FIXTURE(Fixture, "text, fractions for integers and non-finite numbers are errors") {
  CHECK(message_of([&] { set.set_text("neighbours", {"abc"}); }) ==
        "neighbours = \"abc\", expected an integer in [1, 32] | ");
  for (const char* text : {"", "1.5", "8x", "0x8", " 8", "1e1"}) {
    CAPTURE(text);
    CHECK(message_of([&] { set.set_text("neighbours", {text}); }).find("an integer") != std::string::npos);
  }
  CHECK(message_of([&] { set.set_text("tau", {"nan"}); }) == "tau = nan, expected in [0.0, 1.0] | ");
  CHECK(message_of([&] { set.set_text("tau", {"inf"}); }) == "tau = infinity, expected in [0.0, 1.0] | ");
  CHECK(options.tau == 0.6);
}

TEST_CASE_FIXTURE(Fixture, "an unknown name is an error that suggests the nearest names") {
  CHECK(message_of([&] {
          set.set_json({{"neighbors", 3}}, "o.json");
        }) == "o.json: unknown option 'neighbors' | did you mean 'neighbours'?");
  CHECK(message_of([&] {
          set.set_json({{"window", "pixels"}}, "o.json");
        }) == "o.json: window = \"pixels\", expected one of mean, pixel | did you mean 'pixel'?");
}

TEST_CASE_FIXTURE(Fixture, "a wrong JSON type is an error") {
  for (const Json& wrong : {Json{{"neighbours", 8.0}}, Json{{"tau", "0.5"}}, Json{{"antialiased", 1}},
                            Json{{"note", 1}}, Json{{"objects", "a"}}, Json{{"objects", {1}}}, Json{{"window", 0}},
                            Json{{"tau", nullptr}}, Json::array({1}), Json(3)}) {
    CAPTURE(wrong.dump());
    CHECK(message_of([&] { set.set_json(wrong, "o.json"); }).find("expected") != std::string::npos);
  }
}

TEST_CASE("a key that occurs twice in one JSON object is an error") {
  CHECK(message_of([] { parse_json(R"({"a": 1, "a": 2})", "o.json"); }) ==
        "o.json: key 'a' occurs twice, expected once | ");
  CHECK(message_of([] { parse_json(R"({"b": {"a": 1, "c": 2, "a": 3}})", "o.json"); }).find("'a' occurs twice") !=
        std::string::npos);
  CHECK(parse_json(R"({"a": {"a": 1}, "b": [{"a": 1}, {"a": 2}]})", "o.json").size() == 2);
  for (const char* broken : {"", "{", "{}x", "{'a': 1}", "[1,]"}) {
    CAPTURE(broken);
    CHECK(message_of([&] { parse_json(broken, "o.json"); }).find("o.json: not JSON: ") == 0);
  }
}

TEST_CASE_FIXTURE(Fixture, "the schema has type, range, choices and default of every option") {
  options.neighbours = 30;  // the default is the value when the option was added
  const Json schema = set.schema("sample");
  CHECK(schema["additionalProperties"] == false);
  CHECK(schema["properties"].size() == 8);
  CHECK(schema["properties"]["neighbours"] ==
        Json{{"type", "integer"}, {"description", "how many"}, {"minimum", 1}, {"maximum", 32}, {"default", 8}});
  CHECK(schema["properties"]["offset"]["x-unit"] == "px");
  CHECK(schema["properties"]["window"]["enum"] == Json{"mean", "pixel"});
  CHECK(schema["properties"]["objects"]["items"]["type"] == "string");
}

TEST_CASE("a prefix separates two sets of the same options; adding a name twice throws std::logic_error") {
  SampleOptions coarse, fine;
  OptionSet set;
  set.add(coarse, "coarse_");
  set.add(fine, "fine_");
  set.set_text("fine_neighbours", {"9"});
  CHECK(coarse.neighbours == 8);
  CHECK(fine.neighbours == 9);
  CHECK_THROWS_AS(set.add(fine, "fine_"), std::logic_error);
}

TEST_CASE("edit distance counts insertions, deletions, substitutions and swaps") {
  CHECK(edit_distance("", "") == 0);
  CHECK(edit_distance("", "abc") == 3);
  CHECK(edit_distance("abc", "") == 3);
  CHECK(edit_distance("abc", "adc") == 1);
  CHECK(edit_distance("abc", "acb") == 1);
  CHECK(edit_distance("kitten", "sitting") == 3);
  CHECK(near_matches("thread", {"seed", "threads", "tau"}) == std::vector<std::string>{"threads"});
  CHECK(suggestion("zzz", {"seed", "tau"}) == "known: seed, tau");
}

namespace {

struct FieldOptions {
  int levels = 16, layers = 2;
  double rate = 0.1;
  bool literal = false;
  std::string note;
  double weight = 1;
  Window window = Window::kPixel;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.levels, Field<int>{"hash_levels", "", "of the grid", 1, 32}.of("nerf"));
    visit(self.layers, Field<int>{"mlp_layers", "", "of the network", 1, 8}.of("nerf"));
    visit(self.rate, Field<double>{"rate", "", "of descent", 0, 1}.of("joint|contours"));
    visit(self.literal, Flag{"literal", "as printed"});
    visit(self.note, Text{"note", "TEXT", "is kept"}.of("nerf"));
    visit(self.weight, Field<double>{"weight", "", "of the mask", 0, 9}.of("mask,joint|contours"));
    visit(self.window, Choice<Window>{"window", "centre", kWindows});
  }
};

struct Twice {
  int a = 0, b = 0;
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.a, Field<int>{"a", "", "", 0, 1});
    visit(self.b, Field<int>{"a", "", "", 0, 1});
  }
};

}  // namespace

TEST_CASE("an option has its own effect, or the effect of its group if it has none") {
  FieldOptions options;
  OptionSet set;
  set.add(options, OptionGroup{.name = "field", .prefix = "near_", .effect = "start"});
  CHECK(set.at("near_hash_levels").effect == "nerf");
  CHECK(set.at("near_mlp_layers").effect == "nerf");
  CHECK(set.at("near_rate").effect == "joint|contours");
  CHECK(set.at("near_literal").effect == "start");
  CHECK(set.at("near_note").effect == "nerf");
  CHECK(set.at("near_window").group->name == "field");
}

TEST_CASE("describing two options with one name throws std::logic_error") {
  Twice twice;
  OptionSet set;
  CHECK_THROWS_AS(set.add(twice), std::logic_error);
}

TEST_CASE("changed() lists the options whose value differs from the default") {
  FieldOptions options;
  options.layers = 5;  // chosen by the tool, not by the user
  OptionSet set;
  set.add(options);
  CHECK(set.changed().empty());
  set.set_text("hash_levels", {"16"});  // the default again
  CHECK(set.changed().empty());
  set.set_text("hash_levels", {"8"});
  set.set_text("mlp_layers", {"2"});
  REQUIRE(set.changed().size() == 2);
  CHECK(set.changed()[0]->name == "hash_levels");
  CHECK(set.changed()[1]->name == "mlp_layers");
}

TEST_CASE("given options are warned about per effect that is off; other options are not") {
  FieldOptions options;
  OptionSet set;
  set.add(options);
  const auto warnings = [&](const std::vector<std::string_view>& on) {
    return unused_effect_warnings(set,
                                  [&](std::string_view effect) { return std::ranges::find(on, effect) != on.end(); });
  };
  using Texts = std::vector<std::string>;
  CHECK(warnings({}).empty());
  set.set_json({{"hash_levels", 4}, {"rate", 0.5}, {"note", "x"}, {"literal", true}}, "o.json");
  CHECK(warnings({}) ==
        Texts{"--hash-levels, --note: not used with nerf=off", "--rate: not used with joint=off and contours=off"});
  CHECK(warnings({"contours"}) == Texts{"--hash-levels, --note: not used with nerf=off"});
  CHECK(warnings({"nerf"}) == Texts{"--rate: not used with joint=off and contours=off"});
  CHECK(warnings({"nerf", "joint"}).empty());
  set.set_json({{"weight", 2}}, "o.json");
  CHECK(warnings({"nerf", "joint"}) == Texts{"--weight: not used with mask=off"});
  CHECK(warnings({"nerf", "mask"}) == Texts{"--rate, --weight: not used with joint=off and contours=off"});
  CHECK(warnings({"nerf", "mask", "contours"}).empty());
}

TEST_CASE("given options of a group that does not apply are warned about once, with what the group needs") {
  FieldOptions near, far;
  bool is_on = false;
  OptionSet set;
  const auto applies = [&] { return is_on; };
  set.add(near, {.prefix = "near_", .applies = applies, .needs = "--method near"});
  set.add(far, {.prefix = "far_", .applies = applies});
  using Texts = std::vector<std::string>;
  CHECK(unused_group_warnings(set).empty());
  set.set_json({{"near_hash_levels", 4}, {"near_rate", 0.5}, {"far_rate", 0.5}}, "o.json");
  CHECK(unused_group_warnings(set) ==
        Texts{"--near-hash-levels, --near-rate: not used without --method near", "--far-rate: not used"});
  CHECK(unused_effect_warnings(set, [](std::string_view) { return false; }).empty());
  is_on = true;
  CHECK(unused_group_warnings(set).empty());
  CHECK(unused_effect_warnings(set, [](std::string_view) { return false; }).size() == 2);
}

}  // namespace ngs
