#include "shared/text/layout.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <sstream>

#include "support/hinted_flags.h"

namespace ngs::cli {
namespace {

int widest(const std::string& text) {
  int widest = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) widest = std::max(widest, columns_of(line));
  return widest;
}

/// The words of a text, whatever lies between them.
std::string words(const std::string& text) {
  std::istringstream in(text);
  std::string all;
  for (std::string word; in >> word;) all += word + " ";
  return all;
}

}  // namespace

TEST_CASE("a text is cut between words, later lines are indented, and a line may be exactly as wide as allowed") {
  CHECK(wrapped("", "", {2, 10}) == "");
  CHECK(wrapped("", "one two three", {2, 7}) == "one two\n  three");
  CHECK(wrapped("", "one two six", {2, 6}) == "one\n  two\n  six");
  CHECK(wrapped("a: ", "one  two ", {0, 10}) == "a: one two");
  CHECK(wrapped("a:", "one two", {1, 9}) == "a: one\n two");
}

TEST_CASE("what follows a first column that is too wide begins behind it, or on the next line") {
  CHECK(wrapped("  --long  ", "help text", {6, 14}) == "  --long  help\n      text");
  CHECK(wrapped("  --long  ", "helping text", {6, 14}) == "  --long\n      helping\n      text");
}

TEST_CASE("a word that fits on no line is cut behind a bar, a comma or a slash, else where the line ends") {
  CHECK(wrapped("", "one|two|three", {2, 7}) == "one|\n  two|\n  three");
  CHECK(wrapped("", "one|two|three", {2, 8}) == "one|two|\n  three");
  CHECK(wrapped("", "on|two|three", {2, 8}) == "on|two|\n  three");
  CHECK(wrapped("", "abcdefghij", {2, 6}) == "abcd\n  efgh\n  ij");
}

TEST_CASE("a mark ends every line but the last") {
  CHECK(wrapped("  ", "tool --flag value -o out", {6, 15, " \\"}) == "  tool --flag \\\n      value \\\n      -o out");
  CHECK(wrapped("  ", "tool --flag value -o out", {6, 16, " \\"}) == "  tool --flag \\\n      value -o \\\n      out");
}

TEST_CASE("columns are those of the terminal: an accent takes none, a wide character two") {
  CHECK(wrapped("", "e\u0301\u0301 \u6f22 x", {0, 4}) == "e\u0301\u0301 \u6f22\nx");
  CHECK(wrapped("", "\u6f22\u6f22\u6f22", {0, 5}) == "\u6f22\u6f22\n\u6f22");
}

TEST_CASE("lines that fit stay as they are; others hang under their last column, or as they were indented") {
  const std::string fits = "a title:\n  name    what it is\n\n";
  CHECK(rewrapped(fits, 20) == fits);
  CHECK(rewrapped("  name    what it is\n", 16) == "  name    what\n          it is\n");
  CHECK(rewrapped("  name  on  what it is\n", 18) == "  name  on  what\n            it is\n");
  CHECK(rewrapped("  one two three\n", 9) == "  one two\n  three\n");
  CHECK(rewrapped("no newline", 20) == "no newline\n");
}

TEST_CASE("no width loses a word or exceeds itself") {
  const std::string text =
      "  --method paper|bce|cob|flash   what decides the labels, e\u0301 and \u6f22\u5b57 included [paper]";
  for (int width = 8; width <= 100; ++width) {
    CAPTURE(width);
    const std::string lines = wrapped("", text, {4, width});
    CHECK(widest(lines) <= width);
    if (width >= 30) CHECK(words(lines) == words(text));
    CHECK(widest(rewrapped(text, width)) <= width);
  }
}

TEST_CASE("COLUMNS decides over the terminal, in bounds; nonsense is as if it were not set") {
  const char* set = std::getenv("COLUMNS");
  const std::string before = set != nullptr ? set : "";
  const auto columns = [](const char* value) {
    setenv("COLUMNS", value, 1);
    return terminal_columns();
  };
  CHECK(columns("80") == 80);
  CHECK(columns("3") == 40);
  CHECK(columns("300") == 120);
  const int unset = (unsetenv("COLUMNS"), terminal_columns());
  CHECK(unset >= 40);
  CHECK(unset <= 120);
  for (const char* nonsense : {"", "wide", "0", "-5"}) CHECK(columns(nonsense) == unset);
  set != nullptr ? setenv("COLUMNS", before.c_str(), 1) : unsetenv("COLUMNS");
}

}  // namespace ngs::cli

namespace ngs {

TEST_CASE("complete commands of a hint are found, up to prose; mentions and placeholders are not") {
  using Commands = std::vector<std::vector<std::string>>;
  const auto of = [](const std::string& hint) { return test::hinted_commands("ngs-joint: hint: " + hint + "\n"); };
  CHECK(of("label it first: ngs-variance scene.json -o boundary.ply") ==
        Commands{{"ngs-variance", "scene.json", "-o", "boundary.ply"}});
  CHECK(of("to convert: ngs-extract '/a b/it'\\''s.ply' --activated --object-ply converted.ply.") ==
        Commands{{"ngs-extract", "/a b/it's.ply", "--activated", "--object-ply", "converted.ply"}});
  CHECK(of("ngs-scene import /c/d -o scene.json, then ngs-fit scene.json -o model.ply") ==
        Commands{{"ngs-scene", "import", "/c/d", "-o", "scene.json"}, {"ngs-fit", "scene.json", "-o", "model.ply"}});
  CHECK(of("ngs-sample scene.json boundary.ply -o queries.ply writes them") ==
        Commands{{"ngs-sample", "scene.json", "boundary.ply", "-o", "queries.ply"}});
  CHECK(of("lower the threshold (ngs-variance scene.json -o b.ply --tau 0.4), or leave it") ==
        Commands{{"ngs-variance", "scene.json", "-o", "b.ply", "--tau", "0.4"}});
  for (const char* incomplete :
       {"write it with ngs-extract --object-ply", "ngs-scene orbit MODEL -o DIR/scene.json", "ngs-fit makes a splat",
        "ngs-scene import ... --ply model.ply", "give a place: ngs-extract a.ply --around X,Y,Z,R", "see --help",
        "label the other object: ngs-variance scene.json --object NAME -o boundary.ply",
        "npx @playcanvas/splat-transform a.sog b.ply", "ngs-scene check SCENE --sheet masks.html"})
    CHECK_MESSAGE(of(incomplete).empty(), incomplete);
  CHECK(test::hinted_commands("ngs-joint: error: run ngs-variance scene.json -o b.ply\n").empty());
}

}  // namespace ngs
